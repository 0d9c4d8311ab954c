#include "diffusion/scatter_material.h"

namespace pel {

ScreenScatter::Material profileOf(const ShaderMaterial& material) {
    Ref<Profile> profile = material.profile        ? material.profile
                           : material.curvatureLut ? material.curvatureLut->profile()
                                                   : Profile::skin();
    const double radius = profile->radius();
    return {std::move(profile), material.params.diffusionRadius / radius, std::to_array(material.gain),
            material.params.thinThickness > 0};
}

ScatterImages takeIrradiance(ShaderPlan& plan, const Ref<Device>& device, Ref<Buffer>& out, bool inPlace) {
    auto& images = plan.state.images;
    const ImageView& frame = images[PEL_SLOT_RADIANCE];
    resize(out, device, inPlace ? 0 : size_t(frame.width) * frame.height * 3 * sizeof(float));
    ScatterImages taken{
        images[PEL_SLOT_IRRADIANCE], images[PEL_SLOT_POSITION],
        images[PEL_SLOT_POSITION] ? ImageView() : images[PEL_SLOT_DEPTH], images[PEL_SLOT_MATERIAL],
        inPlace ? images[PEL_SLOT_IRRADIANCE] : scratchImage(out, frame, PEL_FORMAT_PLANAR_RGB32F)};
    images[PEL_SLOT_IRRADIANCE] = taken.out;
    return taken;
}

bool ownsIrradiance(const ShaderPlan& plan) {
    return (plan.features & PEL_FEATURE_MAKE_IRRADIANCE) && !plan.state.images[PEL_SLOT_SCATTER_WEIGHT];
}

bool hasRadii(const ShaderPlan& plan) {
    ScatterImages images;
    addRadii(plan, images);
    return usesSkinMaps(plan.state) || images.radii;
}

void addRadii(const ShaderPlan& plan, ScatterImages& images) {
    images.radii = plan.radii;
    if (!plan.radii) images.takeRadii(plan.state.images[PEL_SLOT_SCATTER_WEIGHT]);
}

void addScatterCounts(const ScatterCounts& counts, PelScattering scattering, PelShaderStats& stats) {
    stats.tilesByScattering[scattering] += counts.tilesTapped;
    stats.pixelsScattered += counts.pixelsTapped;
    stats.pixelsKept += counts.pixelsCovered - counts.pixelsTapped;
    stats.scatterTaps += counts.taps;
    stats.pixelsHistory += counts.history;
}

void addKeptChoices(const ScatterCounts& counts, PelShaderStats& stats) {
    uint64_t& chosen = stats.pixelsByChoice[PEL_SCATTERING_SCREEN];
    const uint64_t kept = std::min<uint64_t>(counts.pixelsCovered - counts.pixelsTapped, chosen);
    stats.pixelsByChoice[PEL_SCATTERING_NONE] += kept;
    chosen -= kept;
}

}  // namespace pel
