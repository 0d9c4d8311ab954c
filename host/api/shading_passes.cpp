#include "api/shading_passes.h"

#include "diffusion/passes.h"
#include "shading/passes.h"

namespace pel {

// A pass reads what earlier passes made.
std::span<const PassKind> shadingPasses() {
    static const PassKind passes[] = {
        ambientCubePass,    reflectionCubePass, irisesPass,       classifyTilesPass, tapCellsPass,
        blurNormalsPass,    normalMapPass,      shadowBoundsPass, wideShadowPass,    irradiancePass,
        prepareScatterPass, diskPass,           separablePass,    texturePass,       scatterPass,
        lightScatterPass,   weighScatterPass,   curvaturePass,    shadePass};
    return passes;
}

}  // namespace pel
