// The shader's pass of maps of skin (PEL_SLOT_SKIN): albedo for the slot of the plan, and the radius of each
// pixel.
#include <cstring>

#include "core/launch_policy.h"
#include "diffusion/passes.h"
#include "diffusion/scatter_material.h"
#include "fields/field_ranges.h"
#include "lut/skin.h"
#include "shading/launch_ranges.h"
#include "shading/shading_constants.h"
#include "shared/skin_maps.h"

namespace pel {
namespace {

class SkinMapsPass final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) { return usesSkinMaps(plan.state); }

    PassScratch scratch(const ShaderPlan&) const override { return {pixelBytes, 0, 0, true}; }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        auto& images = plan.state.images;
        const ImageView& frame = images[PEL_SLOT_RADIANCE];
        const size_t pixels = size_t(frame.width) * frame.height;
        resize(albedo_, device, albedoBytes * pixels);
        resize(radii_, device, radiusBytes * pixels);
        skin_ = images[PEL_SLOT_SKIN], ids_ = images[PEL_SLOT_MATERIAL], given_ = images[PEL_SLOT_ALBEDO];
        weight_ = ScatterImages();
        weight_.takeRadii(images[PEL_SLOT_SCATTER_WEIGHT]);
        images[PEL_SLOT_ALBEDO] = scratchImage(albedo_, frame, PEL_FORMAT_RGBA16F);
        plan.radii = scratchImage(radii_, frame, PEL_FORMAT_R16F);
    }
    size_t bytes() const override {
        return (albedo_ ? albedo_->bytes() + radii_->bytes() : 0) + tables_.bytes();
    }

    std::vector<cl::ProgramKey> programs(const Device& device, const ShaderPlan& plan) const override {
        const auto code = [&](const ImageView& view) { return formatCode(view, device.info().mathWidth); };
        return {{{"shading/skin_maps.cl"},
                 {{"PEL_FORMAT_SKIN", code(skin_)},
                  {"PEL_OXYGENATIONS", oxygenations()},
                  {"PEL_FORMAT_MATERIAL", code(ids_)},
                  {"PEL_FORMAT_ALBEDO", code(given_)},
                  {"PEL_FORMAT_RADIUS", code(weight_.radii)},
                  {"PEL_RADIUS_COMPONENT", weight_.radiusComponent},
                  {"PEL_FORMAT_OUT_ALBEDO", code(plan.state.images[PEL_SLOT_ALBEDO])},
                  {"PEL_FORMAT_OUT_RADII", code(plan.radii)}}}};
    }

    size_t upload(Device& device, ShaderPlan& plan) override {
        PelSkinMaps maps{};
        std::vector<PelSkin> skins;
        const ImageView& frame = plan.state.images[PEL_SLOT_RADIANCE];
        maps.width = frame.width, maps.height = frame.height;
        maps.most[0] = range::skin::melanin.max, maps.most[1] = range::skin::blood.max;
        maps.skin = describeImage(skin_);
        maps.ids = describeImage(ids_);
        maps.albedo = describeImage(given_);
        maps.radii = describeImage(weight_.radii);
        maps.outAlbedo = describeImage(plan.state.images[PEL_SLOT_ALBEDO]);
        maps.outRadii = describeImage(plan.radii);
        for (const auto& [id, material] : plan.state.materials) {
            PelSkinMapsMaterial& to = maps.materials[id];
            to.set = 1;
            std::copy_n(material.params.albedo, 3, to.albedo);
            if (!takesSkinMaps(material)) continue;
            const PelSkin& skin = *material.profile->pigments();
            const auto alike = [&](const PelSkin& other) { return !std::memcmp(&other, &skin, sizeof skin); };
            const auto at = std::ranges::find_if(skins, alike);
            to.table = uint32_t(at - skins.begin()) + 1;
            if (at == skins.end()) skins.push_back(skin);
            to.own[0] = skin.melanin, to.own[1] = skin.blood, to.own[2] = skin.oxygenation;
        }
        constants_.update(device, maps);
        const bool same = skins.size() == skins_.size() && oxygenations() == tabulated_ &&
                          !std::memcmp(skins.data(), skins_.data(), skins.size() * sizeof(PelSkin));
        if (same) return sizeof maps;
        std::vector<float> values;
        for (const PelSkin& skin : skins) {
            const std::vector<float> table = skinTable(skin, oxygenations());
            values.insert(values.end(), table.begin(), table.end());
        }
        const size_t sent = tables_.update(device, values);
        skins_ = std::move(skins), tabulated_ = oxygenations();
        return sizeof maps + sent;
    }

    void enqueueFrame(PassWork& work) override {
        const ImageView& frame = work.plan.state.images[PEL_SLOT_RADIANCE];
        work.launch(program(), "skin_maps", vectorRange(work.device, frame.width, frame.height), constants_,
                    tables_, skin_, ids_, given_, weight_.radii, *albedo_, *radii_);
    }

  private:
    // Half floats, because memory bandwidth limits the frame.
    static constexpr size_t albedoBytes = 8, radiusBytes = 2, pixelBytes = albedoBytes + radiusBytes;

    int oxygenations() const { return skin_.info().components > 2 ? PEL_SKIN_OXYGENATIONS : 1; }

    Ref<Buffer> albedo_, radii_;
    ImageView skin_, ids_, given_;  // given_: the caller's albedo
    ScatterImages weight_;
    std::vector<PelSkin> skins_;
    int tabulated_ = 0;
    CachedUpload constants_, tables_;
};

}  // namespace

constinit const PassKind skinMapsPass = passKind<SkinMapsPass>("skin_maps");

}  // namespace pel
