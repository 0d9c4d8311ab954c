// The ambient cube map in the form that the shading kernel reads (lib/shading/ambient_cube.clh), made from
// the host's six faces once per execution.
#include <algorithm>

#include "shading/launch_ranges.h"
#include "shading/passes.h"

namespace pel {
namespace {

constexpr size_t group = 16;

uint32_t edgeOf(const ImageView& faces) {
    return std::min(faces.width, faces.height);
}

class AmbientCube final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) { return bool(plan.state.ambientCube); }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        const size_t across = edgeOf(plan.state.ambientCube) + size_t(2),
                     bytes = 18 * across * across * sizeof(float);
        if (bytes != bytes_) {
            bytes_ = 0;
            nodes_ = cl::Memory();
            nodes_ = device->allocate(bytes);
            bytes_ = bytes;
        }
        plan.ambientNodes = nodes_;
    }
    size_t bytes() const override { return bytes_; }

    std::vector<cl::ProgramKey> programs(const Device&, const ShaderPlan& plan) const override {
        return {{{"shading/ambient_cube.cl"},
                 {{"PEL_GROUP", text(group)},
                  {"PEL_WIDTH", "1"},
                  {"PEL_FORMAT_CUBE", text(formatCode(plan.state.ambientCube, 1))}}}};
    }

    void enqueueFrame(PassWork& work) const override {
        const ImageView& faces = work.plan.state.ambientCube;
        const cl_uint size = edgeOf(faces);
        // Bytes from one face to the next.
        const uint64_t step = faces.height > faces.width ? size * faces.rowStride : size * faces.pixelStride;
        cl::Launch launch(program(), "ambient_cube");
        launch.arg(faces.buffer->memory())
            .arg(cl_ulong(faces.byteOffset))
            .arg(cl_ulong(step))
            .arg(cl_ulong(faces.rowStride));
        launch.arg(cl_ulong(faces.planeStride)).arg(cl_uint(faces.pixelStride)).arg(size).arg(nodes_);
        work.launch(launch, {{size + size_t(2), 6 * (size + size_t(2)), 1}, {group, 1, 1}});
    }

  private:
    cl::Memory nodes_;
    size_t bytes_ = 0;
};

}  // namespace

constinit const PassKind ambientCubePass = passKind<AmbientCube>();

}  // namespace pel
