// The irises of all eyes in one buffer, in the form that shading samples (kernels/eye/iris_texels.cl). The
// first execution after a commit makes them.
#include "shading/features.h"

#include <utility>

#include "core/handle_table.h"
#include "core/launch_policy.h"
#include "eye/eye.h"
#include "shading/launch_ranges.h"
#include "shading/pass.h"
#include "shading/scratch_image.h"

namespace pel {
namespace {

size_t texelsOf(cl_uint side) {
    return size_t(irisRowTexels(side)) * irisRows(side);
}

class Irises final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) { return plan.features & PEL_FEATURE_EYE; }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        size_t texels = 0;
        for (const auto& [id, material] : plan.state.materials)
            if (material.eye) texels += texelsOf(irisTexels(*material.eye));
        if (texels > UINT32_MAX)
            fail(PEL_ERROR_UNSUPPORTED, "the irises of all eyes hold ", texels, " texels; 2^32 is the most");
        resize(texels_, device, texels * sizeof(cl_float4));
        plan.irises = texels_->memory();
    }
    size_t bytes() const override { return texels_ ? texels_->bytes() : 0; }

    std::vector<cl::ProgramKey> programs(const Device&, const ShaderPlan& plan) const override {
        std::vector<cl::ProgramKey> keys;
        for (const auto& [id, material] : plan.state.materials)
            if (material.eye)
                keys.push_back(
                    {{"eye/iris_texels.cl"},
                     {{"PEL_WIDTH", "1"}, {"PEL_FORMAT_IRIS", formatCode(material.eye->iris, 1)}}});
        return keys;
    }

    size_t upload(Device&, ShaderPlan&) override {
        pending_ = true;
        return 0;
    }

    void enqueueFrame(PassWork& work) const override {
        if (!std::exchange(pending_, false)) return;
        const size_t group = launchPolicy(work.device).texels;
        size_t eye = 0;
        cl_uint first = 0;
        for (const auto& [id, material] : work.plan.state.materials) {
            if (!material.eye) continue;
            const ImageView& image = material.eye->iris;
            const cl_uint side = irisTexels(*material.eye);
            cl::Launch launch(program(eye), "iris_texels", memoryOf(image), cl_ulong(image.byteOffset),
                              cl_ulong(image.rowStride), cl_ulong(image.planeStride),
                              cl_uint(image.pixelStride), side, cl_uint(material.eye->params.irisSeed), first,
                              texels_->memory());
            const auto square = [&](size_t texels) {
                return work.codeAlone ? cl::Range{{1, 1, 1}, {group, 1, 1}}
                                      : cl::Range{{texels, texels, 1}, {group, 1, 1}};
            };
            work.launch(launch, square(side + size_t(1)));
            for (cl_uint level = 1; level < irisLevels(side); ++level) {
                cl::Launch halve(program(eye), "iris_level", side, level, first, texels_->memory());
                work.launch(halve, square((side >> level) + size_t(1)));
            }
            ++eye;
            first += cl_uint(texelsOf(side));
        }
    }

  private:
    Ref<Buffer> texels_;
    mutable bool pending_ = false;  // until the first execution after a commit
};

Ref<Lut> causticsOf(const Ref<Device>& device, const ShaderEye& eye) {
    PelEyeLutDesc desc = pelEyeLutDescOf(&eye.params);
    desc.profile = nullptr;
    if (!eye.irisProfile) return integrateEyeLut(device, desc);
    const LentHandle<PelProfile, Profile> lent{eye.irisProfile};
    desc.profile = lent.get();
    return integrateEyeLut(device, desc);
}

}  // namespace

void prepareEyes(const Ref<Device>& device, std::map<uint32_t, ShaderMaterial>& materials) {
    for (auto& [id, material] : materials) {
        if (!material.eye || (material.eye->caustics && material.eye->ambientKnown)) continue;
        ShaderEye& eye = *material.eye;
        for (const auto& [otherId, other] : materials) {
            if (!other.eye || !sameShape(other.eye->params, eye.params)) continue;
            if (other.eye->ambientKnown) {
                eye.ambient = other.eye->ambient;
                eye.ambientKnown = true;
            }
            if (!eye.caustics && other.eye->ownCaustics &&
                other.eye->irisProfile.get() == eye.irisProfile.get())
                eye.caustics = other.eye->caustics;
        }
        if (!eye.ambientKnown) eye.ambient = ambientNodes(eye.params);
        eye.ambientKnown = true;
        if (!eye.caustics) eye.caustics = causticsOf(device, eye);
    }
}

constinit const PassKind irisesPass = passKind<Irises>();

}  // namespace pel
