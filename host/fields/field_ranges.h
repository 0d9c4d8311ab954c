// Ranges of the number fields of pellucid.h, from the rows of pellucid_fields.h: the library checks fields
// where they are set, and readers of files accept the same values.
#pragma once
#include <pellucid/pellucid_fields.h>

#include <limits>
#include <sstream>
#include <string>

// Constants of the rows. Products of a few values between TINY and HUGE are still normal floats.
#define PEL_TINY 1e-6f
#define PEL_HUGE 1e18f
#define PEL_ABOVE_0 1.401298464e-45f  // the smallest positive float
#define PEL_FINITE 3.402823466e38f
#define PEL_NONE std::numeric_limits<float>::quiet_NaN()  // no special value

namespace pel {

struct FieldRange {
    float min, max, special = PEL_NONE;
    constexpr bool holds(float v) const { return (v >= min && v <= max) || v == special; }
};

// The valid values, for messages: "it must be ...".
inline std::string describe(const FieldRange& r) {
    std::ostringstream text;
    if (r.special == r.special) text << r.special << ", or ";
    if (r.min <= -PEL_HUGE && r.max >= PEL_HUGE)
        text << "a finite number";
    else if (r.max < PEL_HUGE)
        text << "from " << r.min << " to " << r.max;
    else if (r.min > 0 && r.min < PEL_TINY)
        text << "more than 0";
    else
        text << r.min << " or more";
    if (r.max >= PEL_HUGE && r.max < PEL_FINITE) text << ", and at most " << r.max;
    return text.str();
}

namespace range {
constexpr FieldRange any{-PEL_FINITE, PEL_FINITE}, notNegative{0, PEL_FINITE},
    positive{PEL_ABOVE_0, PEL_FINITE}, atLeastOne{1, PEL_FINITE}, zeroToOne{0, 1};
#define PEL_RANGE_(type, name, value, min, max, special, ...) constexpr FieldRange name{min, max, special};
namespace material {
PEL_EACH_MATERIAL_FIELD(PEL_RANGE_)
}
namespace light {
PEL_EACH_LIGHT_FIELD(PEL_RANGE_)
PEL_EACH_DIRECTIONAL_LIGHT_FIELD(PEL_RANGE_)
PEL_EACH_POSITIONAL_LIGHT_FIELD(PEL_RANGE_)
PEL_EACH_SPOT_LIGHT_FIELD(PEL_RANGE_)
PEL_EACH_SPHERE_LIGHT_FIELD(PEL_RANGE_)
PEL_EACH_RECTANGLE_LIGHT_FIELD(PEL_RANGE_)
PEL_EACH_SHADOW_MAP_FIELD(PEL_RANGE_)
}  // namespace light
namespace options {
PEL_EACH_OPTION_FIELD(PEL_RANGE_)
}
namespace scatter {
PEL_EACH_SCATTER_PARAM_FIELD(PEL_RANGE_)
}
namespace curvatureLut {
PEL_EACH_CURVATURE_LUT_FIELD(PEL_RANGE_)
}
namespace shadowLut {
PEL_EACH_SHADOW_LUT_FIELD(PEL_RANGE_)
}
namespace skin {
PEL_EACH_SKIN_FIELD(PEL_RANGE_)
}
namespace eye {
PEL_EACH_EYE_FIELD(PEL_RANGE_)
}
namespace eyeLut {
PEL_EACH_EYE_LUT_FIELD(PEL_RANGE_)
}
#undef PEL_RANGE_
}  // namespace range

}  // namespace pel
