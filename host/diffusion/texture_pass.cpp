// The shader's pass of materials that take light scattered in texture space (PEL_SCATTERING_TEXTURE). It
// reads irradiance from its slot of the plan and replaces it by that light.
#include "core/launch_policy.h"
#include "diffusion/passes.h"
#include "diffusion/scatter_material.h"
#include "shading/launch_ranges.h"
#include "shading/shading_constants.h"
#include "shared/texture_scatter.h"

namespace pel {
namespace {

class TexturePass final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) { return anyMaterial(plan.state, takes); }

    PassScratch scratch(const ShaderPlan&) const override { return {3 * sizeof(float), 0, 0, true}; }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        auto& images = plan.state.images;
        ImageView& slot = images[PEL_SLOT_IRRADIANCE];
        const ImageView& frame = images[PEL_SLOT_RADIANCE];
        resize(out_, device, size_t(frame.width) * frame.height * 3 * sizeof(float));
        irradiance_ = slot;
        uv_ = images[PEL_SLOT_UV], ids_ = images[PEL_SLOT_MATERIAL];
        slot = scratchImage(out_, frame, PEL_FORMAT_PLANAR_RGB32F);
        target_ = slot;
        if (!counters_) counters_ = device->allocate(PEL_DIFFUSION_COUNTERS * sizeof(cl_uint));
        samples_.clear();
        for (const auto& [id, material] : plan.state.materials)
            if (takes(material)) samples_.push_back({id, material.scatteredTexture});
    }
    size_t bytes() const override { return out_ ? out_->bytes() : 0; }

    std::vector<cl::ProgramKey> programs(const Device&, const ShaderPlan&) const override {
        std::vector<cl::ProgramKey> keys;
        for (const Sample& sample : samples_)
            keys.push_back({{"diffusion/sample_texture.cl"},
                            {{"PEL_WIDTH", 1},
                             {"PEL_FORMAT_TEXTURE", formatCode(sample.texture, 1)},
                             {"PEL_FORMAT_UV", formatCode(uv_, 1)},
                             {"PEL_FORMAT_MATERIAL", formatCode(ids_, 1)},
                             {"PEL_FORMAT_IRRADIANCE", formatCode(irradiance_, 1)},
                             {"PEL_FORMAT_OUT", formatCode(target_, 1)}}});
        return keys;
    }

    size_t upload(Device& device, ShaderPlan&) override {
        constants_.resize(samples_.size());
        size_t bytes = 0;
        for (size_t i = 0; i < samples_.size(); ++i) {
            PelTextureSample s{};
            s.width = target_.width, s.height = target_.height;
            s.tilesX = (s.width + PEL_TEXTURE_TILE - 1) / PEL_TEXTURE_TILE;
            s.id = samples_[i].id;
            s.copies = i == 0;
            s.texture = describeImage(samples_[i].texture);
            s.uv = describeImage(uv_);
            s.ids = describeImage(ids_);
            s.irradiance = describeImage(irradiance_);
            s.out = describeImage(target_);
            bytes += constants_[i].update(device, s);
        }
        return bytes;
    }

    void enqueue(PassWork& work) override {
        work.device.fill(counters_.get(), 0, PEL_DIFFUSION_COUNTERS * sizeof(cl_uint), 0);
        const size_t tiles = size_t((target_.width + PEL_TEXTURE_TILE - 1) / PEL_TEXTURE_TILE) *
                             ((target_.height + PEL_TEXTURE_TILE - 1) / PEL_TEXTURE_TILE);
        for (size_t i = 0; i < samples_.size(); ++i)
            work.launch(program(i), "sample_texture", groupRange(work.device, tiles), constants_[i],
                        samples_[i].texture, uv_, ids_, irradiance_, target_, counters_);
    }

    void addStats(Device& device, const ShaderPlan&, uint64_t, PelShaderStats& stats) const override {
        ScatterCounts counts{};
        device.read(counters_.get(), 0, sizeof counts, &counts, true);
        addScatterCounts(counts, PEL_SCATTERING_TEXTURE, stats);
    }

  private:
    struct Sample {
        uint32_t id;
        ImageView texture;
    };
    static bool takes(const ShaderMaterial& material) {
        return material.params.scattering == PEL_SCATTERING_TEXTURE;
    }

    Ref<Buffer> out_;
    ImageView irradiance_, uv_, ids_, target_;
    cl::Memory counters_;
    std::vector<Sample> samples_;
    std::vector<CachedUpload> constants_;  // of each
};

}  // namespace

constinit const PassKind texturePass = passKind<TexturePass>("scatter_texture", 1u << PEL_SCATTERING_TEXTURE);

}  // namespace pel
