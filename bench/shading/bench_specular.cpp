// Beckmann's distribution from a table against direct evaluation, in Kelemen and Szirmay-Kalos' specular: time per evaluation and,
// beside it, the error against double precision, at 1 and 16 lanes.
//
// Half vectors are spread round the normals as each pixel's own roughness has it, so that the highlight is seen; m from 0.1 to 0.6.
// `read` only reads the pixels: subtract it. Counters: evaluations per second; the largest difference from the oracle over its
// largest value, of all pixels and of those with m from 0.25 to 0.35. A table of 2048 texels a side is 16 MiB.
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <benchmark/benchmark.h>

#include <pellucid/pellucid.hpp>

#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

#include "reference/shade.h"

using namespace pellucid;
using reference::Vec3;

namespace {

constexpr cl_uint pixels = 2048, items = 4096, rounds = 64;  // 80 KiB of pixels

const Device& device() {
    static const Device device("");
    return device;
}

void require(cl_int code, const char* what) {
    if (code != CL_SUCCESS)
        throw std::runtime_error(std::string(what) + ": OpenCL error " + std::to_string(code));
}

struct Pixels {
    std::vector<float> planes;  // n, l, v: three planes each; m
    std::vector<double> truth;
    double peak = 0;
};

const Pixels& randomPixels() {
    static const Pixels made = [] {
        Pixels p;
        p.planes.resize(10 * pixels);
        std::mt19937 engine(3);
        std::normal_distribution<double> normal;
        std::uniform_real_distribution<double> uniform(0, 1);
        const auto unit = [&] {
            return reference::normalized(Vec3{normal(engine), normal(engine), normal(engine)});
        };
        for (size_t i = 0; i < pixels;) {
            const double m = 0.1 + 0.5 * uniform(engine);
            const Vec3 n = unit(), bend = unit(), view = unit();
            // Slopes of Beckmann's distribution are normal with a variance of m^2 / 2 each.
            const Vec3 half =
                reference::normalized(n + m * 0.7071 * std::abs(normal(engine)) * (bend - dot(bend, n) * n));
            const Vec3 light = 2 * dot(view, half) * half - view;
            if (dot(n, view) < 0.1 || dot(n, light) < 0.05) continue;
            const Vec3 vectors[3] = {n, light, view};
            Vec3 rounded[3];
            for (int k = 0; k < 3; ++k)
                for (int c = 0; c < 3; ++c)
                    rounded[k][c] = p.planes[size_t(3 * k + c) * pixels + i] = float(vectors[k][c]);
            p.planes[size_t(9) * pixels + i] = float(m);
            p.truth.push_back(reference::specular(rounded[0], rounded[1], rounded[2], float(m), 1));
            p.peak = std::max(p.peak, p.truth.back());
            ++i;
        }
        return p;
    }();
    return made;
}

std::vector<float> readTable(uint32_t size) {
    PelSpecularLutDesc desc = pelSpecularLutDescDefaults();
    desc.width = desc.height = size;
    const Lut lut(device(), desc);
    const auto rgb = lut.read<float>(PEL_LUT_FLOAT);
    std::vector<float> texels;
    for (size_t i = 0; i < rgb.size(); i += 3) texels.push_back(rgb[i]);
    return texels;
}

cl_kernel makeKernel(const char* name, int term, int lanes) {
    void *context, *id;
    check(pelDeviceGetCl(device().get(), &context, &id, nullptr));
    std::ifstream in(PELLUCID_SOURCE_DIR "/bench/shading/specular_terms.cl");
    std::stringstream text;
    text << in.rdbuf();
    const std::string source = text.str();
    const char* pointer = source.c_str();
    cl_int code;
    cl_program program = clCreateProgramWithSource(cl_context(context), 1, &pointer, nullptr, &code);
    require(code, "clCreateProgramWithSource");
    const std::string options =
        "-cl-std=CL1.2 -I" PELLUCID_SOURCE_DIR "/kernels -DPEL_WIDTH=" + std::to_string(lanes) +
        " -DPEL_TERM=" + std::to_string(term);
    const auto device = cl_device_id(id);
    require(clBuildProgram(program, 1, &device, options.c_str(), nullptr, nullptr), "clBuildProgram");
    cl_kernel kernel = clCreateKernel(program, name, &code);
    require(code, name);
    clReleaseProgram(program);
    return kernel;
}

void setArguments(cl_kernel kernel, const Buffer& pixel, const Buffer& table, cl_uint size,
                  const cl_uint* turns, const Buffer& out) {
    cl_uint next = 0;
    const auto set = [&](size_t bytes, const void* value) {
        require(clSetKernelArg(kernel, next++, bytes, value), "clSetKernelArg");
    };
    const auto buffer = [&](const Buffer& b) {
        void* memory;
        check(pelBufferGetCl(b.get(), &memory));
        set(sizeof memory, &memory);
    };
    buffer(pixel);
    set(sizeof pixels, &pixels);
    buffer(table);
    set(sizeof size, &size);
    set(sizeof size, &size);
    if (turns) set(sizeof *turns, turns);
    buffer(out);
}

void run(cl_kernel kernel, size_t count) {
    void* queue;
    check(pelDeviceGetCl(device().get(), nullptr, nullptr, &queue));
    require(clEnqueueNDRangeKernel(cl_command_queue(queue), kernel, 1, nullptr, &count, nullptr, 0, nullptr,
                                   nullptr),
            "launch");
    require(clFinish(cl_command_queue(queue)), "clFinish");
}

// size: of the table; 0: none
void specular(benchmark::State& state, int term, int lanes, uint32_t size) {
    const Pixels& p = randomPixels();
    const Buffer pixel(device(), p.planes), table(device(), size ? readTable(size) : std::vector<float>(4));
    const Buffer out(device(), size_t(items) * 16 * sizeof(float));
    cl_kernel repeat = makeKernel("repeat_term", term, lanes), each = makeKernel("each_term", term, lanes);
    const size_t work = items * 16 / size_t(lanes);
    setArguments(repeat, pixel, table, size, &rounds, out);
    run(repeat, work);
    for (auto _ : state) run(repeat, work);
    state.SetItemsProcessed(state.iterations() * int64_t(items) * 16 * rounds);
    if (term != 0) {
        setArguments(each, pixel, table, size, nullptr, out);
        run(each, pixels / size_t(lanes));
        const auto values = out.readAll<float>();
        // Of all, and of those as rough as skin.
        double worst = 0, worstSkin = 0, peakSkin = 0;
        for (size_t i = 0; i < pixels; ++i) {
            const double error = std::abs(values[i] - p.truth[i]);
            worst = std::max(worst, error / p.peak);
            const float m = p.planes[size_t(9) * pixels + i];
            if (m < 0.25f || m > 0.35f) continue;
            worstSkin = std::max(worstSkin, error);
            peakSkin = std::max(peakSkin, p.truth[i]);
        }
        state.counters["worst"] = worst;
        state.counters["worst_skin"] = worstSkin / peakSkin;
    }
    clReleaseKernel(repeat);
    clReleaseKernel(each);
}

#define CASE(name, ...) \
    BENCHMARK_CAPTURE(specular, name, __VA_ARGS__)->Unit(benchmark::kMillisecond)->UseRealTime()

CASE(read_1lane, 0, 1, 0u);
CASE(direct_1lane, 1, 1, 0u);
CASE(table128_1lane, 2, 1, 128u);
CASE(table512_1lane, 2, 1, 512u);
CASE(table2048_1lane, 2, 1, 2048u);
CASE(read_16lanes, 0, 16, 0u);
CASE(direct_16lanes, 1, 16, 0u);
CASE(table128_16lanes, 2, 16, 128u);
CASE(table512_16lanes, 2, 16, 512u);
CASE(table2048_16lanes, 2, 16, 2048u);

}  // namespace

BENCHMARK_MAIN();
