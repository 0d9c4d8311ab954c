#include "diffusion/scatter_material.h"

namespace pel {

ScreenScatter::Material profileOf(const ShaderMaterial& material) {
    Ref<Profile> profile = material.profile        ? material.profile
                           : material.curvatureLut ? material.curvatureLut->profile()
                                                   : Profile::skin();
    const double radius = profile->radius();
    return {std::move(profile), material.params.diffusionRadius / radius};
}

void addScatterCounts(const ScatterCounts& counts, PelScattering scattering, PelShaderStats& stats) {
    stats.tilesByScattering[scattering] += counts.tilesTapped;
    stats.pixelsScattered += counts.pixelsTapped;
    stats.pixelsKept += counts.pixelsCovered - counts.pixelsTapped;
    stats.scatterTaps += counts.taps;
}

}  // namespace pel
