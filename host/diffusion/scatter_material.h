// What methods that scatter irradiance ask of a material.
#pragma once
#include "diffusion/screen_scatter.h"
#include "shading/features.h"
#include "shading/shader_plan.h"

namespace pel {

// Its profile, that of its curvature table, or skin's, stretched to its diffusion radius.
ScreenScatter::Material profileOf(const ShaderMaterial& material);

// Whether its irradiance is scattered, by whatever method.
inline bool scattersIrradiance(const ShaderMaterial& material) {
    return readsIrradiance(material) && material.params.scattering != PEL_SCATTERING_NONE;
}
// By taps on a disk, not by the whole profile.
inline bool scattersOnDisk(const ShaderMaterial& material) {
    return material.params.scattering == PEL_SCATTERING_SCREEN && material.params.scatterTaps > 0;
}
// By taps at all.
inline bool scattersByTaps(const ShaderMaterial& material) {
    return scattersOnDisk(material) || material.params.scattering == PEL_SCATTERING_SEPARABLE;
}
// What 0 stands for.
inline uint32_t scatterTapsOf(PelScattering scattering, uint32_t taps) {
    return taps || scattering != PEL_SCATTERING_SEPARABLE ? taps : 25;
}

// The plan's images for a method that scatters into `out`, which from now on is the plan's irradiance.
ScatterImages takeIrradiance(ShaderPlan& plan, const Ref<Device>& device, Ref<Buffer>& out, bool inPlace = false);

void addScatterCounts(const ScatterCounts& counts, PelScattering scattering, PelShaderStats& stats);
// Of materials of PEL_SCATTERING_AUTO that scatter on the screen: those that kept their irradiance have chosen nothing.
void addKeptChoices(const ScatterCounts& counts, PelShaderStats& stats);

}  // namespace pel
