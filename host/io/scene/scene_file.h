// The scene file of `pellucid shade`: TOML that names the channels of a G-buffer, and describes lights,
// materials and tables (docs/guide/scene-file.md); the fields are those of pellucid.h.
#pragma once
#include <algorithm>
#include <array>
#include <optional>

#include "io/image/image_file.h"
#include "io/lut/lut_preset.h"

namespace pellucid::io {

// A look-up table by name: read from a file, or integrated; the description's profile handle is not used.
struct SceneLut {
    std::string name;                                   // materials refer to it
    PelLutInfo info = presetInfo(LutPreset::material);  // kind; and what to integrate if `file` is empty
    std::string file;                                   // a float or half EXR written by `pellucid lut`
    std::vector<std::string> expected;                  // keys that the file must confirm
    std::string profile;                                // a material's name or a profile file; "": skin
    int line = 0;                                       // of the scene file; 0: made by a program
};

// How tables are made for a material that names none.
enum class ScenePreset { none, faceworks };

struct SceneMaterial {
    uint32_t id = 1;  // value in the material channel, 1 to 255
    PelMaterial material = pelMaterialDefaults();
    float scale = -1;  // of SceneFile::scatter: as pelScatterSetMaterial's; -1: follows from unit_mm
    // Name of a SceneLut; "": the profile's; without a profile no direct scattering
    std::string curvatureLut;
    std::string shadowLut;  // name of a SceneLut; "": the profile's; without a profile a plain shadow
    // A material's name or a profile file, from which defaults follow; "": none
    std::string profile;
    ScenePreset preset = ScenePreset::none;
    std::string scatteredTexture;  // image of light that was scattered in texture space, linear; "": none
    std::string normalMap;  // image of tangent-space normals, x, y, z from 0 to 1 as in 8-bit files; "": none
    // Alternative: its levels, the finest first, x, y, z from -1 to 1
    std::vector<std::string> normalMapLevels;
    int line = 0;
};

// An eye around a material, which is its sclera.
struct SceneEye {
    uint32_t material = 1;  // its id
    PelEye eye = pelEyeDefaults();
    std::string irisTexture;  // square image, linear; "": fibres are drawn
    std::string irisProfile;  // a material's name or a profile file; "": light does not scatter in the iris
    std::string caustics;     // a float or half EXR written by `pellucid lut eye`; "": made for this eye
    int line = 0;
};

// One of a light's cascades beyond the first, whose matrix and range are in PelLight.
struct SceneCascade {
    std::string file;           // "": the first's
    std::string channel;        // "": the only one
    std::string secondChannel;  // of second moments
};

struct SceneLight {
    PelLight light = pelLightDefaults();
    std::string wideShadow;        // channel of the G-buffer; "": the light casts no shadow
    std::string shadowMapFile;     // image of depths seen from the light; "": no thickness from this light
    std::string shadowMapChannel;  // its channel; "": the only one
    std::string secondChannel;     // of second moments; "": none
    std::array<SceneCascade, 3> cascades;  // PEL_LIGHT_CASCADE_1 to 3
    int line = 0;

    // Those of the cascades that PelLight.shadowCascades needs; it may not be checked yet.
    std::span<const SceneCascade> furtherCascades() const {
        const size_t wanted = std::max(light.shadowCascades, 1u) - 1;
        return std::span(cascades).first(std::min(wanted, cascades.size()));
    }
};

struct SceneFile {
    std::string source;   // the file, for messages
    std::string gbuffer;  // image file; "": the user names one
    // Of the G-buffer per image slot; empty: slot not set
    std::array<std::vector<std::string>, PEL_SLOT_COUNT> channels;
    // Scenes set the fields in optionKeys() of scene_keys.h
    PelShaderOptions options = pelShaderOptionsDefaults();
    // The frame is that of a PelScatter: irradiance is scattered, and nothing is shaded. Its matrix is the
    // camera's
    std::optional<PelScatterParams> scatter;
    std::string reflectionCube;  // image of the surroundings that eyes reflect, as ambientCube; "": none
    std::string environment;     // image of pelShaderSetEnvironment; "": none
    float environmentAxes[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    // Image of an irradiance cube map, six faces below or beside one another; "": none
    std::string ambientCube;
    // EXR files to write per output slot beside radiance; "": none
    std::array<std::string, PEL_SLOT_COUNT> outputs;
    PelCamera camera = pelCameraDefaults();
    PelAmbient ambient = pelAmbientDefaults();
    std::vector<SceneLight> lights;
    std::vector<SceneMaterial> materials;
    std::vector<SceneEye> eyes;
    std::vector<SceneLut> luts;

    const SceneLut* lut(const std::string& name, PelLutKind kind) const;  // nullptr if there is none
};

// Reads and checks a scene. Paths in it are returned relative to the working folder. Throws FileError with
// the line: bad TOML, unknown key (with the most similar known key), wrong type, value out of its range,
// wrong number of values, a name that does not exist.
SceneFile readScene(const std::string& path);
// The same from text. `path` is for messages, and the scene's paths are relative to it.
SceneFile parseScene(const std::string& path, const std::string& text);

// The files that a scene reads, and names of profiles in place of files; some are "".
std::vector<std::string*> filesOf(SceneFile& scene);

// Appends planes, one for each component, to the G-buffer as channels "NAME.X" and so on, and names them in
// the scene for `slot`.
void addPlanes(SceneFile& scene, Image& gbuffer, PelImageSlot slot, const std::string& name,
               const std::string& components, std::span<const float> planes,
               ChannelType type = ChannelType::Float);

// The text of a scene file.
std::string sceneText(const SceneFile& scene);
// Writes a scene that readScene reads back to the same values, floats to the bit. File paths are written
// unchanged. Throws FileError for a scene that readScene would refuse, such as one with a matrix of NaN.
void writeScene(const std::string& path, const SceneFile& scene);

}  // namespace pellucid::io
