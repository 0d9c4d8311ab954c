#include "shading/scatter_controls.h"

#include "shading/features.h"
#include "shading/image_slots.h"

namespace pel {
namespace {

bool byTaps(const PelMaterial& m) {
    return m.scattering == PEL_SCATTERING_SEPARABLE ||
           (m.scattering == PEL_SCATTERING_SCREEN && m.scatterTaps);
}

void checkMaterial(uint32_t id, const ShaderMaterial& material, const ShaderState& state) {
    const PelMaterial& m = material.params;
    if (m.thinThickness > 0 && (!material.profile || !readsIrradiance(material)))
        invalidArgument("material ", id, " has a thinThickness of ", m.thinThickness, " and ",
                        material.profile ? "takes its light from tables" : "no profile",
                        "; it needs a profile and another scattering than preintegrated");
    if (m.thinThickness > 0 && state.images[PEL_SLOT_IRRADIANCE] && !state.images[PEL_SLOT_IRRADIANCE_BACK])
        invalidArgument(
            "material ", id, " has a thinThickness of ", m.thinThickness,
            ", and there is an irradiance image, and no back irradiance image: the light of the other side "
            "is not known");
    if (m.scattering == PEL_SCATTERING_TEXTURE && (!material.scatteredTexture || !state.images[PEL_SLOT_UV]))
        invalidArgument("material ", id, " takes light that was scattered in its texture, and there is no ",
                        material.scatteredTexture
                            ? "UV image to sample it by"
                            : "such texture: pelShaderSetScatteredTexture gives it one");
    if (!readsIrradiance(material) || m.scattering == PEL_SCATTERING_NONE || byTaps(m)) return;
    if (m.borderColor[0] > 0 || m.borderColor[1] > 0 || m.borderColor[2] > 0)
        fail(PEL_ERROR_UNSUPPORTED, "material ", id, " has a borderColor and scatters by \"",
             scatteringName(m.scattering),
             "\"; separable, and screen with scatterTaps of 8 to 256, let light flow over borders");
    if (const ImageView& weight = state.images[PEL_SLOT_SCATTER_WEIGHT];
        weight && weight.info().components > 1 && m.scattering != PEL_SCATTERING_TEXTURE)
        fail(PEL_ERROR_UNSUPPORTED,
             "the scatter weight image has a second component, the radius, and material ", id,
             " scatters by \"", scatteringName(m.scattering),
             "\"; separable, and screen with scatterTaps of 8 to 256, take it");
}

}  // namespace

void checkScattering(const ShaderState& state) {
    for (const auto& [id, material] : state.materials) checkMaterial(id, material, state);
}

}  // namespace pel
