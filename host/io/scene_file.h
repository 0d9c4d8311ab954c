// The scene file of `pellucid shade` (TOML): everything about a frame that is not in the G-buffer. docs/scene-file.md lists
// every key.
#pragma once
#include <pellucid/pellucid.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace pellucid::io {

// Where a look-up table comes from: an EXR file written by `pellucid lut`, or a description to integrate.
template <class Desc>
using LutSource = std::variant<std::string, Desc>;

struct SceneMaterial {
    uint32_t id = 1;  // in the material channel
    PelMaterial material = pelMaterialDefaults();
    std::optional<LutSource<PelCurvatureLutDesc>> curvatureLut;  // none: no direct scattering
    std::optional<LutSource<PelShadowLutDesc>> shadowLut;        // none: shadows stay grey
};

struct SceneLight {
    PelLight light = pelLightDefaults();
    std::string wideShadow;        // channel of the G-buffer; "": no shadow
    std::string shadowMapFile;     // image file; "": no thickness from this light
    std::string shadowMapChannel;  // in that file
};

struct SceneFile {
    // G-buffer channels by slot, one name per component. PEL_SLOT_RADIANCE is never among them.
    std::map<PelImageSlot, std::vector<std::string>> channels;
    std::vector<SceneMaterial> materials;
    std::vector<SceneLight> lights;
    PelAmbient ambient = pelAmbientDefaults();
    PelCamera camera = pelCameraDefaults();
    std::string source;  // the file, for messages

    // A path named in the file, relative to the file's folder.
    std::string resolve(const std::string& path) const;
};

// Throws FileError with the line: syntax, unknown key (with the nearest known one), wrong type, wrong length of an array, a
// value outside its range, a matrix that is singular, two materials of one id.
SceneFile readScene(const std::string& path);

// Writes what readScene reads back to the same values (floats with all their digits). Complete or not at all.
void writeScene(const std::string& path, const SceneFile& scene);

}  // namespace pellucid::io
