// The surroundings in the form that shading reads (kernels/shading/environment.cl): levels for specular light
// and for what eyes reflect, and nodes of irradiance for ambient light. Made when the caller sets them.
#include "shared/environment.h"

#include "core/launch_policy.h"
#include "shading/launch_ranges.h"
#include "shading/pass.h"
#include "shading/scratch_image.h"

namespace pel {
namespace {

// Of the lobes. With 32, small lamps show as patterns of dots in rough levels.
constexpr cl_uint lobeSamples = 128;
constexpr cl_uint shareSamples = 1024;
constexpr cl_uint irradianceMip = 2;  // 16 x 16 texels a face

class Environment final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) { return bool(plan.state.environment); }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        const cl::Memory before = nodes_ ? nodes_->memory() : cl::Memory();
        resize(nodes_, device, (environmentFloatsOfAll() + 2 * PEL_SHARE_FLOATS) * sizeof(float));
        resize(irradiance_, device, environmentFloats(PEL_ENVIRONMENT_LEAST) * sizeof(float));
        if (nodes_->memory().get() != before.get()) made_ = 0, hasShares_ = false;
        plan.environmentNodes = nodes_->memory();
        if (!plan.state.reflectionCube) plan.reflectionNodes = nodes_->memory();
        if (!plan.state.ambientCube) plan.ambientNodes = irradiance_->memory();
    }
    size_t bytes() const override { return nodes_ ? nodes_->bytes() + irradiance_->bytes() : 0; }

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
        work.launch(program(), "environment_texels", range(size, 6 * size), image, cl_ulong(image.byteOffset),
                    cl_ulong(step), cl_ulong(image.rowStride), cl_ulong(image.planeStride),
                    cl_uint(image.pixelStride), faces ? edge : image.width, image.height, axis(0), axis(1),
                    axis(2), texels);
        for (cl_uint mip = 1; mip < PEL_ENVIRONMENT_MIPS; ++mip)
            work.launch(program(), "environment_halve", range(size >> mip, 6 * (size >> mip)), mip, texels);
        cl_uint first = 0;
        for (cl_uint level = 0; level < PEL_ENVIRONMENT_LEVELS; ++level) {
            const float root = float(level) / (PEL_ENVIRONMENT_LEVELS - 1);
            const cl_uint across = environmentSize(level);
            work.launch(program(), "environment_level", nodes(across), texels, across, root * root,
                        level ? lobeSamples : cl_uint(1), first, nodes_->memory());
            first += environmentFloats(across);
        }
        if (!hasShares_)
            work.launch(program(), "environment_shares", range(PEL_SHARE_NODES, 2 * PEL_SHARE_NODES),
                        shareSamples, first, nodes_->memory());
        const cl_uint least = PEL_ENVIRONMENT_LEAST;
        work.launch(program(), "environment_irradiance", nodes(least), texels, least, irradianceMip,
                    irradiance_->memory());
        if (!work.codeAlone) made_ = state.environmentNumber, hasShares_ = true;
    }

  private:
    Ref<Buffer> nodes_, irradiance_;
    bool hasShares_ = false;  // which are the same for every image
    uint64_t made_ = 0;       // ShaderState.environmentNumber that the nodes are of
};

}  // namespace

constinit const PassKind environmentPass = passKind<Environment>("environment");

}  // namespace pel
