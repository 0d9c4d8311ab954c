// A material that leaves nothing to defaults: that of FaceWorks, whose numbers an oracle takes as they are.
#pragma once
#include <pellucid/pellucid.hpp>

namespace fixture {

inline PelMaterial faceworksMaterial() {
    PelMaterial m = pelMaterialDefaults();
    m.scattering = PEL_SCATTERING_PREINTEGRATED;
    m.diffusionRadius = 2.7f;
    m.shadowFilterWidth = 8;
    m.normalBlend[0] = 1;
    m.normalBlend[1] = 0.3f;
    m.normalBlend[2] = 0;
    return m;
}

}  // namespace fixture
