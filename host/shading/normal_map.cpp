// Blurred normals from the materials' normal maps.

#include "shading/launch_ranges.h"
#include "shading/pass.h"
#include "shading/shading_constants.h"

namespace pel {
namespace {

bool alsoBlurs(const ShaderPlan& plan) {
    return plan.features & PEL_FEATURE_BLUR_NORMALS;
}

PelNormalMap describeNormalMap(const ShaderMaterial& material, uint32_t id, bool fallback) {
    PelNormalMap map{};
    map.count = uint32_t(material.normalMap.size());
    for (uint32_t i = 0; i < map.count; ++i) map.levels[i] = describeImage(material.normalMap[i]);
    map.material = id;
    map.fallback = fallback;
    const ImageView& finest = material.normalMap[0];
    const double size = std::max(finest.width, finest.height), scale = material.params.uvScale;
    map.baseLevel = float(std::log2(std::max(size * material.params.diffusionRadius, scale) / scale));
    return map;
}

class NormalMap final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) { return plan.features & PEL_FEATURE_NORMAL_MAP; }

    // If there is a blur, it has made the image already; its halo and its list of tiles are the same.
    PassScratch scratch(const ShaderPlan& plan) const override {
        return alsoBlurs(plan) ? PassScratch{} : PassScratch{3 * sizeof(float), 3 * planeGuardBytes, 0};
    }
    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        if (alsoBlurs(plan))
            normals_.reset();
        else if (!normals_)
            normals_.emplace(PEL_SLOT_NORMAL_BLURRED);
        if (normals_) normals_->allocate(device, plan);
        ids_.clear();
        for (const auto& [id, material] : plan.state.materials)
            if (!material.normalMap.empty()) ids_.push_back(id);
    }
    size_t bytes() const override {
        size_t bytes = normals_ ? normals_->bytes() : 0;
        for (const CachedUpload& one : constants_) bytes += one.bytes();
        return bytes;
    }

    std::vector<cl::ProgramKey> programs(const Device& device, const ShaderPlan& plan) const override {
        const auto code = [&](PelImageSlot slot) { return formatCode(plan.state.images[slot], 1); };
        const ImageView& tangent = plan.state.images[PEL_SLOT_TANGENT];
        const PelImageSlot normal = geometricNormalSlot(plan.state);
        cl::Defines defines = surfaceDefines(device, plan.state, 1);
        defines["PEL_FEATURES"] = defines["PEL_FORMAT_POSITION"] = defines["PEL_FORMAT_DEPTH"] = 0;
        defines["PEL_FORMAT_NORMAL"] = code(normal);
        defines["PEL_NORMAL_SLOT"] = int(normal);
        defines["PEL_FORMAT_UV"] = code(PEL_SLOT_UV);
        defines["PEL_FORMAT_UV_GRADIENT"] = code(PEL_SLOT_UV_GRADIENT);
        defines["PEL_FORMAT_TANGENT"] = code(PEL_SLOT_TANGENT);
        defines["PEL_TANGENT_COMPONENTS"] = tangent.info().components;
        defines["PEL_TANGENT_UNORM"] =
            int(tangent.info().kind == FormatKind::UNORM || tangent.info().kind == FormatKind::OCTAHEDRAL);
        defines["PEL_FORMAT_NORMAL_MAP"] = formatCode(plan.state.materials.at(ids_[0]).normalMap[0], 1);
        return {{{"shading/normal_map.cl"}, defines}};
    }

    size_t upload(Device& device, ShaderPlan& plan) override {
        constants_.resize(ids_.size());
        size_t bytes = 0;
        for (size_t k = 0; k < ids_.size(); ++k) {
            // Without a blur the first launch gives materials without a map their geometric normal.
            const PelNormalMap map =
                describeNormalMap(plan.state.materials.at(ids_[k]), ids_[k], k == 0 && !alsoBlurs(plan));
            bytes += constants_[k].update(device, &map, sizeof map);
        }
        return bytes;
    }
    void moveScratch(Device& device, const ShaderPlan& plan, const ShadingConstants& constants,
                     uint32_t row) override {
        if (normals_) normals_->move(device, plan, constants, row);
    }

    void enqueue(PassWork& work) override {
        const ShaderState& state = work.plan.state;
        for (size_t k = 0; k < ids_.size(); ++k) {
            cl::Launch launch(program(), "normal_map", work.constants.frameMemory(),
                              work.constants.materials(), work.plan.tileLists);
            for (PelImageSlot slot : {PEL_SLOT_MATERIAL, geometricNormalSlot(state), PEL_SLOT_UV,
                                      PEL_SLOT_UV_GRADIENT, PEL_SLOT_TANGENT})
                launch.arg(state.images[slot]);
            launch.args(constants_[k].memory(), state.materials.at(ids_[k]).normalMap[0],
                        state.images[PEL_SLOT_NORMAL_BLURRED], cl_uint(work.plan.scratchPlane));
            work.launch(launch, tileRange(work.device, work.tiles()));
        }
    }

  private:
    std::vector<uint32_t> ids_;  // of materials with a map
    std::vector<CachedUpload> constants_;
    std::optional<ScratchPlanes> normals_;  // empty: those of the blur
};

}  // namespace

constinit const PassKind normalMapPass = passKind<NormalMap>("normal_map");

}  // namespace pel
