// Properties of materials that the scattering methods share.
#pragma once
#include "diffusion/screen_scatter.h"
#include "shading/features.h"

namespace pel {

// The profile of the material, of its curvature table, or skin, scaled to the diffusion radius.
ScreenScatter::Material profileOf(const ShaderMaterial& material);

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
