#include "shading/material.h"

#include "lut/profile.h"

namespace pel {

void resolveMaterial(ShaderMaterial& material) {
    PelMaterial& m = material.params = material.given;
    if (m.diffusionRadius == 0)
        m.diffusionRadius = material.curvatureLut ? material.curvatureLut->diffusionRadius()
                            : material.shadowLut  ? material.shadowLut->diffusionRadius()
                                                  : float(Profile::skin()->radius());
}

}  // namespace pel
