// The ambient cube map and the reflection cube map of eyes, in the form that the shading kernel reads
// (lib/shading/ambient_cube.clh). Both are made from the caller's six faces in each execution.
#include "core/launch_policy.h"
#include "shading/launch_ranges.h"
#include "shading/pass.h"
#include "shading/scratch_image.h"

namespace pel {
namespace {

uint32_t edgeOf(const ImageView& faces) {
    return std::min(faces.width, faces.height);
}

// The cube map `Faces` of a state, as nodes in `Nodes` of a plan.
template <ImageView ShaderState::*Faces, cl::Memory ShaderPlan::*Nodes, uint32_t Feature>
class CubeNodes final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) { return plan.state.*Faces && plan.features & Feature; }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        const size_t across = edgeOf(plan.state.*Faces) + size_t(2);
        resize(nodes_, device, 18 * across * across * sizeof(float));
        plan.*Nodes = nodes_->memory();
    }
    size_t bytes() const override { return nodes_ ? nodes_->bytes() : 0; }

    std::vector<cl::ProgramKey> programs(const Device&, const ShaderPlan& plan) const override {
        return {{{"shading/ambient_cube.cl"},
                 {{"PEL_WIDTH", "1"}, {"PEL_FORMAT_CUBE", formatCode(plan.state.*Faces, 1)}}}};
    }

    void enqueueFrame(PassWork& work) override {
        const ImageView& faces = work.plan.state.*Faces;
        const cl_uint size = edgeOf(faces);
        // Bytes from one face to the next.
        const uint64_t step = faces.height > faces.width ? size * faces.rowStride : size * faces.pixelStride;
        cl::Launch launch(program(), "ambient_cube", faces.buffer->memory(), cl_ulong(faces.byteOffset),
                          cl_ulong(step), cl_ulong(faces.rowStride), cl_ulong(faces.planeStride),
                          cl_uint(faces.pixelStride), size, nodes_->memory());
        work.launch(launch, {{size + size_t(2), 6 * (size + size_t(2)), 1},
                             {launchPolicy(work.device).texels, 1, 1}});
    }

  private:
    Ref<Buffer> nodes_;
};

}  // namespace

constinit const PassKind ambientCubePass =
    passKind<CubeNodes<&ShaderState::ambientCube, &ShaderPlan::ambientNodes, PEL_FEATURE_AMBIENT_CUBE>>(
        "ambient_cube");
constinit const PassKind reflectionCubePass = passKind<
    CubeNodes<&ShaderState::reflectionCube, &ShaderPlan::reflectionNodes, PEL_FEATURE_REFLECTION_CUBE>>(
    "reflection_cube");

}  // namespace pel
