// A G-buffer, a scene and their look-up tables on the device, ready to be shaded.
#pragma once
#include <utility>
#include <vector>

#include "command.h"
#include "io/image/image_file.h"
#include "io/scene/scene_file.h"

namespace pellucid::cli {

// The look-up tables of scenes: each distinct one is read or integrated once.
class LutStore {
  public:
    explicit LutStore(const Device& device) : device_(device) {}
    // An empty handle for an empty name.
    Lut get(const io::SceneFile& scene, const std::string& name, PelLutKind kind);
    // Made by the formulas of FaceWorks.
    Lut faceworks(const Profile& profile, PelLutKind kind);

  private:
    Device device_;
    std::vector<std::pair<io::SceneLut, Lut>> luts_;
    std::vector<std::pair<std::pair<std::string, PelLutKind>, Lut>> faceworks_;  // by the profile's name
};

// Shadow maps by file, already in memory.
using ShadowMaps = std::map<std::string, io::Image>;

class Frame {
  public:
    // Uploads what the scene names and commits. `outputs`: slots beside radiance that are wanted. `shadowMaps` holds maps that are in memory already, by the
    // name that the scene gives them; others are read from files. Throws FileError when a channel is missing.
    Frame(const Device& device, const io::Image& gbuffer, const io::SceneFile& scene, LutStore& luts,
          const ShadowMaps& shadowMaps = {}, const PelShaderOptions& options = pelShaderOptionsDefaults(),
          const std::vector<PelImageSlot>& outputs = {});

    void shade() { shader_.execute(); }
    // RGB per pixel, interleaved; 0 where there is no material.
    std::vector<float> radiance() const { return radiance_.readAll<float>(); }
    // One of `outputs`: RGB interleaved, or a value per pixel of PEL_SLOT_OUT_THICKNESS.
    std::vector<float> output(PelImageSlot slot) const { return outputs_.at(slot).readAll<float>(); }
    PelShaderStats stats() const { return shader_.stats(); }
    std::string warnings() const { return shader_.warnings(); }
    // Material `id` with every default filled in.
    PelMaterial material(uint32_t id) const { return shader_.material(id); }
    uint64_t inputBytes() const { return inputBytes_; }

  private:
    void setMaterial(const io::SceneFile& scene, const io::SceneMaterial& m, LutStore& luts);
    void setEye(const Device& device, const io::SceneFile& scene, const io::SceneEye& e);
    void setNormalMap(const Device& device, uint32_t id, const std::string& file);
    void setScatteredTexture(const Device& device, uint32_t id, const std::string& file);
    // Curvature from normals and positions or depth of the G-buffer (pelScreenCurvature).
    PelImageDesc measureCurvature(const Device& device, const io::Image& gbuffer, const io::SceneFile& scene);
    PelImageDesc uploadCube(const Device& device, const std::string& file);
    PelImageDesc upload(const Device& device, const io::Image& image, const std::vector<std::string>& channels);

    Shader shader_;
    Buffer radiance_;
    std::vector<Buffer> inputs_;
    std::map<PelImageSlot, Buffer> outputs_;
    uint64_t inputBytes_ = 0;
};

// Sentences about sizes that are probably wrong: depth that is not device depth, bodies whose size does not
// match their profile.
std::vector<std::string> unlikely(const io::Image& gbuffer, const io::SceneFile& scene);

// Writes RGB radiance as R, G, B of a float EXR, lengths as Thickness.V.
void writeRadiance(const std::string& path, int width, int height, const std::vector<float>& radiance);
void writeThickness(const std::string& path, int width, int height, const std::vector<float>& lengths);

// The counters as an object of a report.
nlohmann::ordered_json toJson(const PelShaderStats& stats);

}  // namespace pellucid::cli
