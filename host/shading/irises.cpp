// The irises of all eyes in one buffer, in the form that shading samples (kernels/eye/iris_texels.cl). An
// execution makes only irises that have changed.
#include "shading/features.h"

#include "core/handle_table.h"
#include "core/launch_policy.h"
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
        const cl::Memory before = texels_ ? texels_->memory() : cl::Memory();
        resize(texels_, device, texels * sizeof(cl_float4));
        if (texels_->memory().get() != before.get()) made_.clear();
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

    void enqueueFrame(PassWork& work) override {
        const size_t group = launchPolicy(work.device).texels;
        size_t eye = 0;
        cl_uint first = 0;
        for (const auto& [id, material] : work.plan.state.materials) {
            if (!material.eye) continue;
            const ImageView& image = material.eye->iris;
            const cl_uint side = irisTexels(*material.eye);
            const Made now{first, side, material.eye->params.irisSeed, material.eye->textureNumber};
            first += cl_uint(texelsOf(side));
            if (made_.size() <= eye) made_.emplace_back();
            Made& made = made_[eye++];
            if (made == now) continue;
            made = {};
            cl::Launch launch(program(eye - 1), "iris_texels", image, cl_ulong(image.byteOffset),
                              cl_ulong(image.rowStride), cl_ulong(image.planeStride),
                              cl_uint(image.pixelStride), side, cl_uint(now.seed), now.first,
                              texels_->memory());
            const auto square = [&](size_t texels) {
                return work.codeAlone ? cl::Range{{1, 1, 1}, {group, 1, 1}}
                                      : cl::Range{{texels, texels, 1}, {group, 1, 1}};
            };
            work.launch(launch, square(side + size_t(1)));
            for (cl_uint level = 1; level < irisLevels(side); ++level) {
                cl::Launch halve(program(eye - 1), "iris_level", side, level, now.first, texels_->memory());
                work.launch(halve, square((side >> level) + size_t(1)));
            }
            made = now;
        }
        made_.resize(eye);  // others may be overwritten
    }

  private:
    // The inputs that an iris was made from.
    struct Made {
        cl_uint first = 0, side = 0, seed = 0;
        uint64_t texture = 0;  // ShaderEye.textureNumber
        bool operator==(const Made&) const = default;
    };

    Ref<Buffer> texels_;
    std::vector<Made> made_;
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

void adoptEyes(std::map<uint32_t, ShaderMaterial>& materials,
               const std::map<uint32_t, ShaderMaterial>& from) {
    for (auto& [id, material] : materials) {
        if (!material.eye) continue;
        ShaderEye& eye = *material.eye;
        for (const auto& [otherId, other] : from) {
            if (!other.eye || !sameShape(other.eye->params, eye.params)) continue;
            if (other.eye->ambientKnown) {
                eye.ambient = other.eye->ambient;
                eye.ambientKnown = true;
            }
            if (!eye.caustics && other.eye->ownCaustics &&
                other.eye->irisProfile.get() == eye.irisProfile.get())
                eye.caustics = other.eye->caustics;
        }
    }
}

void prepareEyes(const Ref<Device>& device, std::map<uint32_t, ShaderMaterial>& materials) {
    for (auto& [id, material] : materials) {
        if (!material.eye || (material.eye->caustics && material.eye->ambientKnown)) continue;
        ShaderEye& eye = *material.eye;
        adoptEyes(materials, materials);
        if (!eye.ambientKnown) eye.ambient = ambientNodes(eye.params);
        eye.ambientKnown = true;
        if (!eye.caustics) eye.caustics = causticsOf(device, eye);
    }
}

bool pretendEyes(const Ref<Device>& device, std::map<uint32_t, ShaderMaterial>& materials) {
    bool some = false;
    for (auto& [id, material] : materials) {
        if (!material.eye || material.eye->caustics) continue;
        PelLutInfo info = pelLutInfoDefaults();
        info.kind = PEL_LUT_EYE;
        info.eye = pelEyeLutDescOf(&material.eye->params);
        info.eye.profile = nullptr;
        material.eye->caustics = make<Lut>(device, info);
        some = true;
    }
    return some;
}

constinit const PassKind irisesPass = passKind<Irises>("irises");

}  // namespace pel
