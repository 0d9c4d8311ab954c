#include "shading/scatter_controls.h"

#include "shading/features.h"
#include "shading/image_slots.h"

namespace pel {
namespace {

[[noreturn]] void notYet(const std::string& what) {
    fail(PEL_ERROR_UNSUPPORTED, what, " is set, which this build of the library does not have");
}

}  // namespace

void checkScattering(const ShaderState& state) {
    bool irradiance = false;
    for (const auto& [id, material] : state.materials) {
        const PelMaterial& m = material.params;
        irradiance |= readsIrradiance(material);
        if (m.thinThickness > 0 && (!material.profile || !readsIrradiance(material)))
            invalidArgument("material ", id, " has a thinThickness of ", m.thinThickness, " and ",
                            material.profile ? "takes its light from tables" : "no profile",
                            "; it needs a profile and another scattering than preintegrated");
        if (m.scattering == PEL_SCATTERING_SCREEN && m.scatterTaps)
            notYet(text("PelMaterial.scatterTaps of material ", id));
        if (!readsIrradiance(material) || m.scattering == PEL_SCATTERING_NONE) continue;
        if (m.albedoBefore > 0) notYet(text("PelMaterial.albedoBefore of material ", id));
        if (m.borderColor[0] > 0 || m.borderColor[1] > 0 || m.borderColor[2] > 0)
            notYet(text("PelMaterial.borderColor of material ", id));
        if (m.thinThickness > 0) notYet(text("PelMaterial.thinThickness of material ", id));
    }
    for (PelImageSlot slot : {PEL_SLOT_SCATTER_WEIGHT, PEL_SLOT_IRRADIANCE_BACK})
        if (irradiance && state.images[slot]) notYet(text("the ", slotName(slot), " image"));
}

}  // namespace pel
