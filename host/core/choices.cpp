// The public header documents choices, and is read by C compilers on its own: it must agree with the lists.
#include "shared/choices.h"
#include "shared/features.h"

#include <pellucid/pellucid.h>

namespace {

#define LIGHT(name, number, key) static_assert(PEL_LIGHT_##name == number);
#define PROJECTION(name, number, key) static_assert(PEL_SHADOW_##name == number);
#define CONTENT(name, number, key) static_assert(PEL_SHADOW_CONTENT_##name == number);
#define MODEL(name, number, key) static_assert(PEL_SPECULAR_##name == number);
#define SCATTERING(name, number, key) static_assert(PEL_SCATTERING_##name == number);
#define LUT(name, number, key) static_assert(PEL_LUT_##name == number);
#define FORM(name, number, key) static_assert(PEL_FORM_##name == number);
#define AXIS(name, number, key) static_assert(PEL_AXIS_##name == number);
#define PROFILE(name, number, key) static_assert(PEL_PROFILE_##name == number);
#define ESTIMATOR(name, number, key) static_assert(PEL_CURVATURE_##name == number);
#define QUANTITY(name, number, key) static_assert(PEL_QUANTITY_##name == number);
#define FEATURE(name, bit, kernel, material, key) \
    static_assert(int(PEL_FEATURE_##name) == int(PEL_BIT_##name));
#define WEIGHTS(name, number, key) static_assert(PEL_SMOOTHING_##name == number);
PEL_EACH_LIGHT_TYPE(LIGHT)
PEL_EACH_SHADOW_PROJECTION(PROJECTION)
PEL_EACH_SHADOW_CONTENT(CONTENT)
PEL_EACH_SPECULAR_MODEL(MODEL)
PEL_EACH_SCATTERING(SCATTERING)
PEL_EACH_LUT_KIND(LUT)
PEL_EACH_LUT_ENCODING(LUT)
PEL_EACH_CURVATURE_FORM(FORM)
PEL_EACH_LUT_AXIS(AXIS)
PEL_EACH_PROFILE_KIND(PROFILE)
PEL_EACH_ESTIMATOR(ESTIMATOR)
PEL_EACH_QUANTITY(QUANTITY)
PEL_EACH_QUANTITY_OF_SEVERAL(QUANTITY)
PEL_EACH_SMOOTHING_WEIGHTS(WEIGHTS)
PEL_EACH_FEATURE(FEATURE)

}  // namespace
