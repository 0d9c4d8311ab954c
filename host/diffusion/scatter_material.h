// Properties of materials that the scattering methods share.
#pragma once
#include "diffusion/screen_scatter.h"
#include "shading/features.h"

namespace pel {

// The profile of the material, of its curvature table, or skin, scaled to the diffusion radius.
ScreenScatter::Material profileOf(const ShaderMaterial& material);

// Whether the irradiance of the material is scattered, by any method.
inline bool scattersIrradiance(const ShaderMaterial& material) {
    return readsIrradiance(material) && material.params.scattering != PEL_SCATTERING_NONE;
}
// By taps on a disk, not by the whole profile.
inline bool scattersOnDisk(const ShaderMaterial& material) {
    return material.params.scattering == PEL_SCATTERING_SCREEN && material.params.scatterTaps > 0;
}
// By taps, on a disk or along lines.
inline bool scattersByTaps(const ShaderMaterial& material) {
    return scattersOnDisk(material) || material.params.scattering == PEL_SCATTERING_SEPARABLE;
}
// Replaces 0 by the default.
inline uint32_t scatterTapsOf(PelScattering scattering, uint32_t taps) {
    return taps || scattering != PEL_SCATTERING_SEPARABLE ? taps : 25;
}

// The images of the plan for a method that scatters into `out`, which becomes the irradiance of the plan.
ScatterImages takeIrradiance(ShaderPlan& plan, const Ref<Device>& device, Ref<Buffer>& out,
                             bool inPlace = false);

// Whether irradiance is a scratch image that is not read after scattering, so that it can be overwritten.
bool ownsIrradiance(const ShaderPlan& plan);

// Whether the profile's radius varies per pixel, and its image.
bool hasRadii(const ShaderPlan& plan);
void addRadii(const ShaderPlan& plan, ScatterImages& images);

void addScatterCounts(const ScatterCounts& counts, PelScattering scattering, PelShaderStats& stats);
// Counts pixels of PEL_SCATTERING_AUTO that kept their irradiance as not scattered.
void addKeptChoices(const ScatterCounts& counts, PelShaderStats& stats);

}  // namespace pel
