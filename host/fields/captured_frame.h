// The input of one frame as a capture hands it from the library (shading/capture.h) to the module that writes
// files (io/scene/capture). Handles are the library's and valid during the call.
#pragma once
#include <pellucid/pellucid.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace pel {

// The parameters of a profile's creation; lengths in mm.
struct ProfileRecipe {
    PelProfileKind kind = PEL_PROFILE_SKIN;
    std::string name;
    // burley: mean free path and albedo, or with `byDistance` only the distance; dipole: absorption and
    // reduced scattering, 1/mm
    float first[3]{}, second[3]{}, eta = 0;
    PelBurleyFit fit{};
    bool byDistance = false;
    std::vector<std::array<float, 4>> rows;  // gaussians: variance and weights; table: distance and values
    PelSkin skin{};                          // skin layers
};

struct CapturedImage {
    uint32_t width = 0, height = 0, components = 0;
    std::vector<float> values;  // interleaved, as kernels decode the image's format
    explicit operator bool() const { return !values.empty(); }
};

// Profiles are numbers in CapturedFrame.profiles; -1: none. The structures' own handles are NULL.
struct CapturedEye {
    PelEye eye{};
    int irisProfile = -1;
    PelLut caustics = nullptr;  // the caller's; NULL: made for the eye
    CapturedImage iris;
};
struct CapturedMaterial {
    uint32_t id = 0;
    PelMaterial material{};
    float scale = -1;  // of a PelScatter, whose other settings are in `material`
    int profile = -1;
    PelLut curvature = nullptr, shadow = nullptr;
    std::vector<CapturedImage> normalMap;
    CapturedImage scatteredTexture;
    std::optional<CapturedEye> eye;
};
struct CapturedLight {
    PelLight light{};
    std::array<CapturedImage, PEL_LIGHT_SLOT_COUNT> images;
};

struct CapturedFrame {
    std::optional<PelScatterParams> scatter;  // of a PelScatter: its materials scatter PEL_SLOT_IRRADIANCE
    PelShaderOptions options{};
    std::array<CapturedImage, PEL_SLOT_COUNT> images;  // inputs
    std::array<bool, PEL_SLOT_COUNT> outputs{};        // set, beside radiance
    std::vector<CapturedMaterial> materials;
    std::vector<CapturedLight> lights;
    std::vector<ProfileRecipe> profiles;
    PelAmbient ambient{};
    PelCamera camera{};
    CapturedImage ambientCube, reflectionCube, environment;
    std::array<float, 9> environmentAxes{};
};

// The module's function, named "pellucidCapture": writes a scene into an empty folder. Returns an error
// message; "": success.
using WriteCapture = std::string (*)(const CapturedFrame& frame, const std::string& folder);

}  // namespace pel
