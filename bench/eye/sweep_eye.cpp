// What eyes cost, and what the time buys, as a table in Markdown:
//   table: 64 x 64 x 32 by this library and by random paths (sampled_caustics.cl), in turns; RMS of the table's mean,
//          against photons in double precision
//   frame: 1920 x 1080 of which an eye fills 5 % or next to nothing, against the same pixels as skin, in turns
//   picture: of an eye, with tables of several sizes: the time to make the table, and RMS against the tracer
// Medians. `bench/plot eyes` draws the table.
//   sweep_eye [all|frame|picture|table] [photons, 1e8]
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "eye/eye_lut_error.h"
#include "eye/eye_picture.h"
#include "reference/eye_square.h"
#include "shared/eye.h"

using namespace pellucid;
using namespace eye_test;
using Clock = std::chrono::steady_clock;

namespace {

double median(std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + ptrdiff_t(v.size() / 2), v.end());
    return v[v.size() / 2];
}

void row(const std::string& what, double ms, double error = -1) {
    std::printf("| %s | %.3g |", what.c_str(), ms);
    if (error >= 0) std::printf(" %.2g", error);
    std::printf(" |\n");
}

template <class Run>
double milliseconds(Run&& run) {
    const auto start = Clock::now();
    run();
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// The truth of each slice, once.
struct Truth {
    reference::Eye eye = referenceOf(pelEyeDefaults());
    PelEyeLutDesc desc = pelEyeLutDescDefaults();
    std::vector<reference::Caustic> slices;
    explicit Truth(uint64_t photons) {
        for (uint32_t z = 0; z < desc.depth; ++z)
            slices.push_back(tracePhotons(eye, largestAngle(eye) * z / (desc.depth - 1), int(desc.width),
                                          int(desc.height), photons / desc.depth, 17 + z));
    }
    // at(texel of the stacked image)
    template <class At>
    LutError errorOf(At&& at) const {
        LutError e;
        size_t k = 0;
        for (const reference::Caustic& slice : slices) {
            for (const double should : slice.texels) {
                const double is = at(k++);
                e.sum2 += (is - should) * (is - should), e.sum += should, e.texels += 1;
                e.flux += is * 2 * eye.iris / desc.width * eye.iris / desc.height;
            }
            e.trueFlux += slice.flux;
            e.bounced += slice.bounced;
        }
        return e;
    }
};

void require(cl_int code, const char* what) {
    if (code != CL_SUCCESS)
        throw std::runtime_error(std::string(what) + ": OpenCL error " + std::to_string(code));
}

// The kernel of random paths, on the library's own device.
class Paths {
  public:
    Paths(const Device& device, size_t texels) : texels_(texels), sums_(device, texels * 4) {
        void *context, *id, *queue;
        check(pelDeviceGetCl(device.get(), &context, &id, &queue));
        queue_ = cl_command_queue(queue);
        std::ifstream in(PELLUCID_SOURCE_DIR "/bench/eye/sampled_caustics.cl");
        std::stringstream text;
        text << in.rdbuf();
        const std::string source = text.str();
        const char* pointer = source.c_str();
        cl_int code;
        program_ = clCreateProgramWithSource(cl_context(context), 1, &pointer, nullptr, &code);
        require(code, "clCreateProgramWithSource");
        const auto device_ = cl_device_id(id);
        require(clBuildProgram(program_, 1, &device_, "-cl-std=CL1.2 -I" PELLUCID_SOURCE_DIR "/kernels",
                               nullptr, nullptr),
                "clBuildProgram");
        kernel_ = clCreateKernel(program_, "sampled_caustics", &code);
        require(code, "clCreateKernel");
    }
    ~Paths() {
        clReleaseKernel(kernel_);
        clReleaseProgram(program_);
    }
    Paths(const Paths&) = delete;
    Paths& operator=(const Paths&) = delete;

    // Milliseconds.
    double run(const PelEyeShape& shape, const PelEyeLutDesc& desc, float perSlice, cl_uint photons,
               cl_uint items) const {
        const std::vector<cl_uint> zeros(texels_);
        sums_.write(zeros.data(), texels_ * 4);
        void* memory = nullptr;
        check(pelBufferGetCl(sums_.get(), &memory));
        cl_uint next = 0;
        const auto set = [&](const auto& value) {
            require(clSetKernelArg(kernel_, next++, sizeof value, &value), "clSetKernelArg");
        };
        set(shape), set(desc.width), set(desc.height), set(perSlice), set(photons), set(cl_mem(memory));
        const size_t global[2] = {items, desc.depth}, local[2] = {1, 1};
        return milliseconds([&] {
            require(clEnqueueNDRangeKernel(queue_, kernel_, 2, nullptr, global, local, 0, nullptr, nullptr),
                    "clEnqueueNDRangeKernel");
            clFinish(queue_);
        });
    }
    std::vector<cl_uint> hits() const { return sums_.readAll<cl_uint>(); }

  private:
    size_t texels_;
    Buffer sums_;
    cl_command_queue queue_;
    cl_program program_;
    cl_kernel kernel_;
};

void tables(uint64_t photons) {
    const Truth truth(photons);
    const PelEyeLutDesc& desc = truth.desc;
    const Device device("");
    const reference::Eye& e = truth.eye;
    const PelEyeShape shape{float(e.sclera * e.sclera),
                            float(e.cornea),
                            float(1 + e.conic),
                            float(e.limbus),
                            float(e.limbusZ()),
                            float(e.apexZ()),
                            float(e.iris),
                            float(e.irisZ()),
                            0,
                            float(e.nCornea),
                            float(e.nAqueous),
                            0};
    const size_t texels = size_t(desc.width) * desc.height * desc.depth;
    const float perSlice = float(largestAngle(e) / (desc.depth - 1));
    const Paths paths(device, texels);
    constexpr cl_uint items = 512, counts[] = {8, 32, 128, 512};
    std::vector<double> ours, sampled[std::size(counts)];
    double errors[std::size(counts)];
    std::vector<float> made;
    for (int round = 0; round < 6; ++round) {
        ours.push_back(milliseconds([&] {
            const Lut lut(device, desc);
            if (!round) made = lut.read<float>(PEL_LUT_FLOAT);
        }));
        for (size_t i = 0; i < std::size(counts); ++i) {
            sampled[i].push_back(paths.run(shape, desc, perSlice, counts[i], items));
            if (round) continue;
            const std::vector<cl_uint> hits = paths.hits();
            // One photon stands for this area of the beam; both halves fall on one.
            const double area = 4 * 1.1 * e.limbus * e.limbus / (double(counts[i]) * items) / 2;
            const double texel = 2 * e.iris / desc.width * e.iris / desc.height;
            errors[i] = truth.errorOf([&](size_t k) { return hits[k] * area / texel; }).rms();
        }
    }
    ours.erase(ours.begin());  // which built the program
    const LutError error = truth.errorOf([&](size_t k) { return double(made[3 * k]); });
    row("table 64x64x32, wavefront", median(ours), error.rms());
    for (size_t i = 0; i < std::size(counts); ++i) {
        char name[64];
        std::snprintf(name, sizeof name, "table 64x64x32, %.2g million paths",
                      counts[i] * items * desc.depth * 1e-6);
        row(name, median(sampled[i]), errors[i]);
    }
    std::fprintf(stderr, "flux error %.2g; share of light after a reflection inside %.2g\n",
                 error.fluxError(), error.bounced / error.trueFlux);
}

// Skin everywhere, and a square of a share of the pixels, which shows the front of a ball: skin or an eye.
struct CostFrame {
    static constexpr uint32_t width = 1920, height = 1080;
    Buffer position, normal, id, curvature, out;
    CostFrame(const Device& device, double share) {
        const size_t n = size_t(width) * height;
        const reference::EyeSquare square(width, height, share);
        position = Buffer(device, square.position), normal = Buffer(device, square.normal);
        id = Buffer(device, square.id);
        curvature = Buffer(device, std::vector<float>(n, 1.0f / 12));
        out = Buffer(device, std::vector<float>(3 * n));
    }
    Shader shader(const Device& device, bool withEye, PelScattering scattering) const {
        Shader s(device);
        const Profile profile = Profile::skin();
        PelMaterial skin = pelMaterialDefaults();
        skin.scattering = scattering;
        skin.profile = profile.get();
        skin.specular = 1;
        PelMaterial sclera = skin;
        if (withEye) sclera.specular = 0;
        PelCamera camera = pelCameraDefaults();
        camera.position[2] = 400;
        s.set(camera).setMaterial(1, skin).setMaterial(2, sclera);
        if (withEye) s.setEye(2, pelEyeDefaults());
        PelLight light = pelLightDefaults();
        light.toLight[0] = 0.6f, light.toLight[2] = 0.8f;
        PelAmbient ambient = pelAmbientDefaults();
        for (float& c : ambient.constant) c = 0.3f;
        s.set(std::vector{light}).set(ambient);
        s.set(PEL_SLOT_RADIANCE, imageDesc(out, PEL_FORMAT_RGB32F, width, height));
        s.set(PEL_SLOT_POSITION, imageDesc(position, PEL_FORMAT_RGB32F, width, height));
        s.set(PEL_SLOT_NORMAL_SHADING, imageDesc(normal, PEL_FORMAT_RGB32F, width, height));
        s.set(PEL_SLOT_CURVATURE, imageDesc(curvature, PEL_FORMAT_R32F, width, height));
        s.set(PEL_SLOT_MATERIAL, imageDesc(id, PEL_FORMAT_R8_UINT, width, height));
        s.commit().execute();
        return s;
    }
};

// A median, and how far the true one may be from it with 95 % (by the ranks of a sorted sample).
struct Estimate {
    double value, error;
    explicit Estimate(std::vector<double> v) : value(median(v)) {
        std::sort(v.begin(), v.end());
        const auto ranks = size_t(std::sqrt(double(v.size())));
        error = 0.5 * (v[v.size() / 2 + ranks] - v[v.size() / 2 - ranks]);
    }
};

void shading() {
    const Device device("");
    const std::pair<PelScattering, const char*> methods[] = {{PEL_SCATTERING_NONE, "none"},
                                                             {PEL_SCATTERING_PREINTEGRATED, "preintegrated"}};
    // A few pixels show what does not depend on the size of an eye.
    for (const double percent : {5.0, 0.05}) {
        const CostFrame frame(device, percent / 100);
        for (const auto& [method, name] : methods) {
            Shader both[2] = {frame.shader(device, false, method), frame.shader(device, true, method)};
            std::vector<double> times[2], more;
            for (int i = 0; i < 201; ++i) {
                for (Shader& shader : both) {
                    shader.execute();
                    times[&shader - both].push_back(shader.stats().deviceMilliseconds);
                }
                more.push_back(times[1].back() - times[0].back());
            }
            char begin[64];
            std::snprintf(begin, sizeof begin, "frame, %s, eye on %g %%: ", name, percent);
            row(std::string(begin) + "as skin", median(times[0]));
            row(std::string(begin) + "as an eye", median(times[1]));
            const Estimate added(more);
            row(std::string(begin) + "what it adds", added.value);
            row(std::string(begin) + "error of that (95 %)", added.error);
            const PelShaderStats stats = both[1].stats();
            std::fprintf(stderr, "%llu of %llu tiles have an eye\n",
                         static_cast<unsigned long long>(stats.tilesEye),
                         static_cast<unsigned long long>(stats.tilesShaded));
        }
    }
}

void sizes() {
    EyeScene scene;
    scene.makeTexture(256);
    scene.addLight({0.9, 0.3, 0.35}, {1, 0.9, 0.8});
    const EyePicture picture(scene);
    const std::vector<double> truth = picture.trace(20'000'000);
    for (const uint32_t side : {16u, 24u, 32u, 48u, 64u, 96u, 128u}) {
        const Device device("");
        PelEyeLutDesc desc = pelEyeLutDescOf(&scene.eye);
        desc.width = desc.height = side, desc.depth = side / 2;
        Lut lut(device, desc);
        std::vector<double> times;
        for (int i = 0; i < 5; ++i) times.push_back(milliseconds([&] { lut = Lut(device, desc); }));
        const PictureError error = differenceOf(picture, picture.shade(nullptr, &desc), truth);
        const std::string size =
            std::to_string(side) + "x" + std::to_string(side) + "x" + std::to_string(side / 2);
        row("picture, table " + size, median(times), error.rms);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::string what = argc > 1 ? argv[1] : "all";
    std::printf("| case | ms | RMS error |\n|---|---|---|\n");
    if (what == "all" || what == "frame") shading();
    if (what == "all" || what == "table") tables(argc > 2 ? uint64_t(std::atof(argv[2])) : 100'000'000);
    if (what == "all" || what == "picture") sizes();
}
