// Presets from which descriptions of tables start, by name: in scenes, in manifests and on the command line.
#pragma once
#include <cstdint>
#include <string_view>

#include "pellucid/pellucid.h"

namespace pellucid::io {

enum class LutPreset { material, faceworks };  // as a material makes it of its profile; as FaceWorks does
inline constexpr std::string_view lutPresets[] = {"material", "faceworks"};

inline PelCurvatureLutDesc presetCurvature(LutPreset preset) {
    return preset == LutPreset::faceworks ? pelCurvatureLutDescFaceWorks() : pelCurvatureLutDescDefaults();
}
inline PelShadowLutDesc presetShadow(LutPreset preset) {
    return preset == LutPreset::faceworks ? pelShadowLutDescFaceWorks() : pelShadowLutDescDefaults();
}

inline PelLutInfo presetInfo(LutPreset preset, PelLutKind kind = PEL_LUT_CURVATURE) {
    PelLutInfo info = pelLutInfoDefaults();
    info.kind = kind;
    info.curvature = presetCurvature(preset);
    info.shadow = presetShadow(preset);
    return info;
}

// Scenes and manifests of version 1 start from FaceWorks' tables, so that old files keep their meaning.
constexpr int64_t lutPresetVersions = 2;
constexpr LutPreset presetOfVersion(int64_t version) {
    return version < 2 ? LutPreset::faceworks : LutPreset::material;
}

}  // namespace pellucid::io
