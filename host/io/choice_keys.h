// Names of choices in files and on the command line, by their numbers in pellucid.h.
#pragma once
#include <cstdint>
#include <string_view>

#include "shared/choices.h"
#include "shared/features.h"

namespace pellucid::io {

#define PELLUCID_KEY(name, number, key) key,
inline constexpr std::string_view lightTypes[] = {PEL_EACH_LIGHT_TYPE(PELLUCID_KEY)};
inline constexpr std::string_view shadowProjections[] = {PEL_EACH_SHADOW_PROJECTION(PELLUCID_KEY)};
inline constexpr std::string_view shadowContents[] = {PEL_EACH_SHADOW_CONTENT(PELLUCID_KEY)};
inline constexpr std::string_view specularModels[] = {PEL_EACH_SPECULAR_MODEL(PELLUCID_KEY)};
inline constexpr std::string_view scatterings[] = {PEL_EACH_SCATTERING(PELLUCID_KEY)};
inline constexpr std::string_view lutKinds[] = {PEL_EACH_LUT_KIND(PELLUCID_KEY)};
inline constexpr std::string_view curvatureForms[] = {PEL_EACH_CURVATURE_FORM(PELLUCID_KEY)};
inline constexpr std::string_view lutAxes[] = {PEL_EACH_LUT_AXIS(PELLUCID_KEY)};
inline constexpr std::string_view lutEncodings[] = {PEL_EACH_LUT_ENCODING(PELLUCID_KEY)};
inline constexpr std::string_view profileKinds[] = {PEL_EACH_PROFILE_KIND(PELLUCID_KEY)};
inline constexpr std::string_view estimators[] = {PEL_EACH_ESTIMATOR(PELLUCID_KEY)};
inline constexpr std::string_view quantities[] = {PEL_EACH_QUANTITY(PELLUCID_KEY)};
inline constexpr std::string_view smoothingWeights[] = {PEL_EACH_SMOOTHING_WEIGHTS(PELLUCID_KEY)};
#undef PELLUCID_KEY
struct FeatureKey {
    uint32_t bit;  // of PelFeature
    std::string_view key;
};
#define PELLUCID_FEATURE(name, bit, kernel, material, key) {1u << bit, key},
inline constexpr FeatureKey featureKeys[] = {PEL_EACH_FEATURE(PELLUCID_FEATURE)};
#undef PELLUCID_FEATURE

}  // namespace pellucid::io
