// The surroundings in the form that shading reads (kernels/shading/environment.cl): levels for specular light
// and for what eyes reflect, and nodes of irradiance for ambient light. Made when the caller sets them.
#include "shared/environment.h"

#include <numbers>

#include "core/launch_policy.h"
#include "shading/launch_ranges.h"
#include "shading/pass.h"
#include "shading/scratch_image.h"

namespace pel {
namespace {

constexpr double pi = std::numbers::pi;
// Samples per lobe. With 32, small lamps show as patterns of dots in rough levels.
constexpr cl_uint lobeSamples = 128;
constexpr cl_uint shareSamples = 512;
constexpr size_t mostSamples = PEL_ENVIRONMENT_LEVELS * lobeSamples + shareSamples;
constexpr cl_uint irradianceMip = 2;  // 16 x 16 texels a face
// Along an edge of a face, of the reduced image at most: twice those of the finest level.
constexpr cl_uint faceTexels = 2 * PEL_ENVIRONMENT_SIZE;

// Hammersley's second coordinate, evenly spread: the reversed binary digits of k.
double radicalInverse(unsigned k) {
    double value = 0;
    for (double digit = 0.5; k; k >>= 1, digit *= 0.5) value += digit * (k & 1);
    return value;
}

// The lobe of a level, as environment_level reads it.
void addLobe(cl_uint level, std::vector<cl_float4>& lobes) {
    if (!level) return lobes.push_back({{0, 0, 1, 0}});  // a mirror's
    const double a2 = std::pow(double(level) / (PEL_ENVIRONMENT_LEVELS - 1), 4);
    const double texel = 4 * pi / (6.0 * PEL_ENVIRONMENT_SIZE * PEL_ENVIRONMENT_SIZE);
    for (cl_uint k = 0; k < lobeSamples; ++k) {
        // The view is along the normal, so the half vector's angle is half the direction's.
        const double along = (k + 0.5) / lobeSamples, half2 = (1 - along) / (1 + (a2 - 1) * along),
                     z = 2 * half2 - 1;
        if (z <= 0) continue;
        const double across = std::sqrt(1 - z * z), turn = 2 * pi * radicalInverse(k);
        const double spread = 1 + half2 * (a2 - 1), share = 4 * pi * spread * spread / (lobeSamples * a2);
        const double mip = std::clamp(0.5 * std::log2(share / texel), 0.0, PEL_ENVIRONMENT_MIPS - 1.001);
        lobes.push_back(
            {{float(across * std::cos(turn)), float(across * std::sin(turn)), float(z), float(mip)}});
    }
}

// Half vectors, as environment_shares reads them.
void addShareSamples(std::vector<cl_float4>& samples) {
    for (cl_uint k = 0; k < shareSamples; ++k) {
        const double along = (k + 0.5) / shareSamples;
        samples.push_back({{float(std::cos(pi * radicalInverse(k))), float(-std::log1p(-along)),
                            float(along / (1 - along)), 0}});
    }
}

class Environment final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) { return bool(plan.state.environment); }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        const cl::Memory before = nodes_ ? nodes_->memory() : cl::Memory();
        resize(nodes_, device, (environmentFloatsOfAll() + 2 * PEL_SHARE_FLOATS) * sizeof(float));
        resize(irradiance_, device, environmentFloats(PEL_ENVIRONMENT_LEAST) * sizeof(float));
        if (nodes_->memory().get() != before.get()) made_ = 0, hasShares_ = false;
        if (!samples_) samples_ = device->allocate(mostSamples * sizeof(cl_float4));
        plan.environmentNodes = nodes_->memory();
        if (!plan.state.reflectionCube) plan.reflectionNodes = nodes_->memory();
        if (!plan.state.ambientCube) plan.ambientNodes = irradiance_->memory();
    }
    size_t bytes() const override {
        return nodes_ ? nodes_->bytes() + irradiance_->bytes() + mostSamples * sizeof(cl_float4) : 0;
    }

    size_t upload(Device& device, ShaderPlan&) override {
        if (starts_.back()) return 0;
        std::vector<cl_float4> samples;
        for (cl_uint level = 0; level < PEL_ENVIRONMENT_LEVELS; ++level) {
            addLobe(level, samples);
            starts_[level + 1] = cl_uint(samples.size());
        }
        addShareSamples(samples);
        const auto* first = reinterpret_cast<const unsigned char*>(samples.data());
        device.writeLater(samples_.get(), {first, first + samples.size() * sizeof samples[0]});
        return samples.size() * sizeof samples[0];
    }

    std::vector<cl::ProgramKey> programs(const Device&, const ShaderPlan& plan) const override {
        return {{{"shading/environment.cl"},
                 {{"PEL_WIDTH", "1"}, {"PEL_FORMAT_ENVIRONMENT", formatCode(plan.state.environment, 1)}}}};
    }

    void enqueueFrame(PassWork& work) override {
        const ShaderState& state = work.plan.state;
        if (made_ == state.environmentNumber && !work.codeAlone) return;
        made_ = 0;
        const ImageView& image = state.environment;
        const bool below = image.height == 6 * image.width, faces = below || image.width == 6 * image.height;
        const cl_uint edge = std::min(image.width, image.height);
        const uint64_t step = !faces ? 0 : edge * (below ? image.rowStride : image.pixelStride);
        // Needed until the levels are made.
        const cl::Memory texels =
            work.device.allocate(8 * PEL_ENVIRONMENT_SIZE * PEL_ENVIRONMENT_SIZE * sizeof(cl_float4));
        const auto range = [&](cl_uint across, cl_uint lines) {
            const size_t group = launchPolicy(work.device).texels;
            return work.codeAlone ? cl::Range{{1, 1, 1}, {group, 1, 1}}
                                  : cl::Range{{across, lines, 1}, {group, 1, 1}};
        };
        const auto nodes = [&](cl_uint across) { return range(across + 2, 6 * (across + 2)); };
        const auto axis = [&](size_t row) {
            const float* a = &state.environmentAxes[3 * row];
            return cl_float4{{a[0], a[1], a[2], 0}};
        };
        const cl_uint size = PEL_ENVIRONMENT_SIZE;
        const cl_uint width = faces ? edge : image.width, height = faces ? edge : image.height,
                      leastWidth = std::min(width, faces ? faceTexels : 4 * faceTexels),
                      leastHeight = std::min(height, faces ? faceTexels : 2 * faceTexels),
                      lines = leastHeight * (faces ? 6 : 1);
        const cl::Memory reduced = work.device.allocate(size_t(leastWidth) * lines * sizeof(cl_float4));
        work.launch(program(), "environment_reduce", range(leastWidth, lines), image,
                    cl_ulong(image.byteOffset), cl_ulong(step), cl_ulong(image.rowStride),
                    cl_ulong(image.planeStride), cl_uint(image.pixelStride), width, height, leastWidth,
                    leastHeight, reduced);
        work.launch(program(), "environment_texels", range(size, 6 * size), reduced, cl_int(faces),
                    leastWidth, leastHeight, axis(0), axis(1), axis(2), texels);
        for (cl_uint mip = 1; mip < PEL_ENVIRONMENT_MIPS; ++mip)
            work.launch(program(), "environment_halve", range(size >> mip, 6 * (size >> mip)), mip, texels);
        cl_uint first = 0;
        for (cl_uint level = 0; level < PEL_ENVIRONMENT_LEVELS; ++level) {
            const cl_uint across = environmentSize(level);
            work.launch(program(), "environment_level", nodes(across), texels, samples_, starts_[level],
                        starts_[level + 1], across, first, nodes_->memory());
            first += environmentFloats(across);
        }
        if (!hasShares_)
            work.launch(program(), "environment_shares", range(PEL_SHARE_NODES, 2 * PEL_SHARE_NODES),
                        samples_, starts_.back(), starts_.back() + shareSamples, first, nodes_->memory());
        const cl_uint least = PEL_ENVIRONMENT_LEAST;
        work.launch(program(), "environment_irradiance", nodes(least), texels, least, irradianceMip,
                    irradiance_->memory());
        if (!work.codeAlone) made_ = state.environmentNumber, hasShares_ = true;
    }

  private:
    Ref<Buffer> nodes_, irradiance_;
    cl::Memory samples_;
    std::array<cl_uint, PEL_ENVIRONMENT_LEVELS + 1> starts_{};  // in it, of the lobe of each level; of shares
    bool hasShares_ = false;                                    // which are the same for every image
    uint64_t made_ = 0;  // ShaderState.environmentNumber that the nodes are of
};

}  // namespace

constinit const PassKind environmentPass = passKind<Environment>("environment");

}  // namespace pel
