// The frozen scenes by which methods of scattering are measured, and their ground truth.
#pragma once

#include "diffusion/lit_scenes.h"

namespace pellucid::bench {

constexpr float sceneAlbedo = 0.8f;
constexpr double radiusScales[] = {1, 4};  // of the profile

struct FrozenScene {
    const char *name, *title;
    std::function<lit_scenes::Body(const std::string& headFile)> body;
    lit_scenes::SceneRequest request;
    uint32_t materials = 1;
    bool quick = false;  // among those of --quick
};
const std::vector<FrozenScene>& frozenScenes();

// Frames of the first scene while something moves.
struct FrozenClip {
    const char *name, *title;
    double lightStep, cameraStep;  // degrees a frame
};
constexpr FrozenClip frozenClips[] = {{"light-turns", "the light turns by 2 degrees a frame", 2, 0},
                                      {"camera-orbits", "the camera turns by 0.25 degrees a frame", 0, 0.25}};
constexpr int clipFrames = 16;
constexpr double clipScale = 4;
lit_scenes::SceneRequest clipRequest(const FrozenClip& clip, int frame);

// Christensen-Burley with the radii of a usual Blender material: d = 0.292, 0.109, 0.054 mm.
Profile usualProfile();

// Of RGB, in radiance with `sceneAlbedo`; three values for each of `pixels`.
struct Truth {
    std::vector<size_t> pixels;        // drawn among the covered ones
    std::vector<float> first, second;  // two halves of a random walk: as noisy, and independent
    std::vector<float> surface;        // the surface integral
};
// Throws std::runtime_error where `folder` has none, or has that of another scene.
Truth readTruth(const std::string& folder, const std::string& name, const lit_scenes::LitScene& scene);

// Light in a window of a scene's picture, for errors that depend on neighbours.
struct Crop {
    std::vector<size_t> pixels;  // row by row
    int width;
    std::vector<float> light;  // RGB, in radiance with `sceneAlbedo`
    double noise;              // FLIP of the light's own noise
};
// Throws std::runtime_error where `folder` has none.
Crop readCrop(const std::string& folder, const std::string& name, const lit_scenes::LitScene& scene);

// A part of a scene's picture that reports show, at the larger radius.
struct ShownPart {
    const char* scene;
    double x, y, width;  // middle and width, as parts of the picture
    float exposure;

    int side(const lit_scenes::LitScene& scene) const { return int(width * scene.width) / 2 * 2; }
    std::vector<size_t> pixels(const lit_scenes::LitScene& scene) const;  // of the square, row by row
};
constexpr ShownPart shownParts[] = {{"side-4", 0.46, 0.56, 0.5, 1}, {"ear-4", 0.61, 0.52, 0.36, 2.5f}};
// RGB of light there, the same for 2 x 2 pixels, in radiance with `sceneAlbedo`. Throws as readCrop().
std::vector<float> readPart(const std::string& folder, const ShownPart& part,
                            const lit_scenes::LitScene& scene);

// The results of each method on PoCL, for an albedo of 1: three values for each of `pixels`.
struct KeptPictures {
    std::vector<size_t> pixels;
    std::vector<std::vector<float>> light;
};
// Throws as readTruth(), and where others than `methods` are kept.
KeptPictures readPictures(const std::string& folder, const std::string& name,
                          const lit_scenes::LitScene& scene, size_t methods);
void writePictures(const std::string& folder, const std::string& name, const lit_scenes::LitScene& scene,
                   const std::vector<std::vector<float>>& wholePictures);

// The pixels that show the points of frame 0 in each frame (SIZE_MAX: none does), and light there without
// noise that differs between frames.
struct ClipTruth {
    std::vector<std::vector<size_t>> pixels;
    std::vector<std::vector<float>> light;  // RGB
};
ClipTruth readClip(const std::string& folder, const FrozenClip& clip,
                   const std::vector<lit_scenes::LitScene>& frames);

}  // namespace pellucid::bench
