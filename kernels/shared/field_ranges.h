// The values that number fields of pellucid.h may have, once: the library checks them where they are set, and readers of files take
// the same. X(field, least, most, special): every component lies between `least` and `most`, or is `special`, which has a meaning of its
// own (PEL_NONE: there is no such value).
#ifndef PEL_SHARED_FIELD_RANGES
#define PEL_SHARED_FIELD_RANGES

// Products of a few such values are still normal floats.
#define PEL_TINY 1e-6f
#define PEL_HUGE 1e18f
// Above 0, and any that is finite.
#define PEL_ABOVE_0 1.401298464e-45f
#define PEL_FINITE 3.402823466e38f
#define PEL_NONE std::numeric_limits<float>::quiet_NaN()

#define PEL_EACH_MATERIAL_RANGE(X)                            \
    X(albedo, 0, PEL_HUGE, PEL_NONE)                          \
    X(diffusionRadius, PEL_TINY, PEL_HUGE, 0)                 \
    X(normalBlend, 0, 1, -1)                                  \
    X(shadowFilterWidth, PEL_TINY, PEL_HUGE, 0)               \
    X(transmission, 0, PEL_HUGE, PEL_NONE)                    \
    X(curvatureGain, 0, PEL_HUGE, PEL_NONE)                   \
    X(deepScatterColor, 0, PEL_HUGE, PEL_NONE)                \
    X(deepScatterRadius, PEL_TINY, PEL_HUGE, PEL_NONE)        \
    X(deepScatterNormalOffset, -PEL_HUGE, PEL_HUGE, PEL_NONE) \
    X(deepScatterAmbient, 0, PEL_HUGE, PEL_NONE)              \
    X(thicknessFilterRadius, 0, 1, PEL_NONE)                  \
    X(thicknessTaps, 8, 32, 0)                                \
    X(specular, 0, PEL_HUGE, PEL_NONE)                        \
    X(roughness, 0, PEL_HUGE, PEL_NONE)                       \
    X(roughness2, 0, PEL_HUGE, PEL_NONE)                      \
    X(lobeMix, 0, 1, PEL_NONE)                                \
    X(f0, 0, 1, PEL_NONE)                                     \
    X(uvScale, PEL_TINY, PEL_HUGE, PEL_NONE)                  \
    X(thinThickness, 0, PEL_HUGE, PEL_NONE)                   \
    PEL_EACH_SCATTER_CONTROL_RANGE(X)

// Of PelMaterial and of PelScatterControls.
#define PEL_EACH_SCATTER_CONTROL_RANGE(X) \
    X(scatterTaps, 8, 256, 0)             \
    X(albedoBefore, 0, 1, PEL_NONE)       \
    X(borderColor, 0, 1, PEL_NONE)

// Checked whatever the type of a light is; the others only where its type has them.
#define PEL_EACH_LIGHT_RANGE(X)                  \
    X(color, 0, PEL_HUGE, PEL_NONE)              \
    X(shadowFilterTexels, 4, 256, 0)             \
    X(shadowCascades, 0, 4, PEL_NONE)            \
    X(shadowBias, 0, PEL_HUGE, -1)               \
    X(shadowSoftness, 1e-3f, PEL_HUGE, -1)       \
    X(shadowConeSlope, 0, PEL_HUGE, -1)          \
    X(shadowMinDeviation, 0, PEL_HUGE, PEL_NONE) \
    X(shadowBleeding, 0, 0.999f, PEL_NONE)
#define PEL_EACH_PLACED_LIGHT_RANGE(X) X(range, 0, PEL_HUGE, PEL_NONE)
#define PEL_EACH_SPOT_RANGE(X)       \
    X(spotCosInner, -1, 1, PEL_NONE) \
    X(spotCosOuter, -1, 1, PEL_NONE)

#define PEL_EACH_OPTION_RANGE(X)   \
    X(targetError, 0, 1, PEL_NONE) \
    X(millimetresPerUnit, PEL_TINY, PEL_HUGE, PEL_NONE)

#define PEL_EACH_CURVATURE_LUT_RANGE(X)            \
    X(width, 1, 16384, PEL_NONE)                   \
    X(height, 1, 16384, PEL_NONE)                  \
    X(diffusionRadius, PEL_ABOVE_0, PEL_FINITE, 0) \
    X(radiusMin, PEL_ABOVE_0, PEL_FINITE, 0)       \
    X(radiusMax, PEL_ABOVE_0, PEL_FINITE, 0)

#define PEL_EACH_SHADOW_LUT_RANGE(X)               \
    X(width, 1, 16384, PEL_NONE)                   \
    X(height, 1, 16384, PEL_NONE)                  \
    X(diffusionRadius, PEL_ABOVE_0, PEL_FINITE, 0) \
    X(widthMin, PEL_ABOVE_0, PEL_FINITE, 0)        \
    X(widthMax, PEL_ABOVE_0, PEL_FINITE, 0)        \
    X(sharpening, 1, PEL_FINITE, PEL_NONE)         \
    X(closedEnds, 0, 1, PEL_NONE)

#define PEL_EACH_SPECULAR_LUT_RANGE(X) \
    X(width, 1, 16384, PEL_NONE)       \
    X(height, 1, 16384, PEL_NONE)

// Of PelEye and of PelEyeLutDesc.
#define PEL_EACH_EYE_SHAPE_RANGE(X)               \
    X(scleraRadius, PEL_TINY, PEL_HUGE, PEL_NONE) \
    X(corneaRadius, PEL_TINY, PEL_HUGE, PEL_NONE) \
    X(corneaConic, -100, 100, PEL_NONE)           \
    X(limbusRadius, PEL_TINY, PEL_HUGE, PEL_NONE) \
    X(chamberDepth, PEL_TINY, PEL_HUGE, PEL_NONE) \
    X(corneaIndex, 1, 3, PEL_NONE)                \
    X(aqueousIndex, 1, 3, PEL_NONE)               \
    X(irisRadius, PEL_TINY, PEL_HUGE, 0)          \
    X(irisConcavity, 0, PEL_HUGE, PEL_NONE)

#define PEL_EACH_EYE_RANGE(X)               \
    PEL_EACH_EYE_SHAPE_RANGE(X)             \
    X(limbusWidth, 0, PEL_HUGE, PEL_NONE)   \
    X(limbusDarkening, 0, 1, PEL_NONE)      \
    X(pupilRadius, 0, PEL_HUGE, PEL_NONE)   \
    X(texturePupil, 0, 0.95f, PEL_NONE)     \
    X(irisColor, 0, PEL_HUGE, -1)           \
    X(tearRoughness, 1e-3f, 1, PEL_NONE)    \
    X(wetLineRoughness, 1e-3f, 1, PEL_NONE) \
    X(tearIndex, 1, 3, PEL_NONE)

#define PEL_EACH_EYE_LUT_RANGE(X) \
    PEL_EACH_EYE_SHAPE_RANGE(X)   \
    X(width, 2, 1024, PEL_NONE)   \
    X(height, 2, 1024, PEL_NONE)  \
    X(depth, 2, 256, PEL_NONE)    \
    X(millimetresPerUnit, PEL_TINY, PEL_HUGE, PEL_NONE)

#ifdef __cplusplus
#include <limits>
#include <sstream>
#include <string>

namespace pel {

struct FieldRange {
    float least, most, special = PEL_NONE;
    constexpr bool holds(float v) const { return (v >= least && v <= most) || v == special; }
};

// What would be right, for messages: "it must be ...".
inline std::string describe(const FieldRange& r) {
    std::ostringstream text;
    if (r.special == r.special) text << r.special << ", or ";
    if (r.least <= -PEL_HUGE && r.most >= PEL_HUGE)
        text << "a finite number";
    else if (r.most < PEL_HUGE)
        text << "from " << r.least << " to " << r.most;
    else if (r.least > 0 && r.least < PEL_TINY)
        text << "more than 0";
    else
        text << r.least << " or more";
    if (r.most >= PEL_HUGE && r.most < PEL_FINITE) text << ", and at most " << r.most;
    return text.str();
}

namespace range {
constexpr FieldRange any{-PEL_FINITE, PEL_FINITE}, notNegative{0, PEL_FINITE},
    positive{PEL_ABOVE_0, PEL_FINITE}, atLeastOne{1, PEL_FINITE}, zeroToOne{0, 1};
#define PEL_RANGE_(field, least, most, special) constexpr FieldRange field{least, most, special};
namespace material {
PEL_EACH_MATERIAL_RANGE(PEL_RANGE_)
}
namespace light {
PEL_EACH_LIGHT_RANGE(PEL_RANGE_)
PEL_EACH_PLACED_LIGHT_RANGE(PEL_RANGE_)
PEL_EACH_SPOT_RANGE(PEL_RANGE_)
}  // namespace light
namespace options {
PEL_EACH_OPTION_RANGE(PEL_RANGE_)
}
namespace curvatureLut {
PEL_EACH_CURVATURE_LUT_RANGE(PEL_RANGE_)
}
namespace shadowLut {
PEL_EACH_SHADOW_LUT_RANGE(PEL_RANGE_)
}
namespace eye {
PEL_EACH_EYE_RANGE(PEL_RANGE_)
}
namespace eyeLut {
PEL_EACH_EYE_LUT_RANGE(PEL_RANGE_)
}
#undef PEL_RANGE_
}  // namespace range

}  // namespace pel
#endif

#endif
