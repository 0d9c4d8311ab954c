// Shades a G-buffer as described by a scene file, for `pellucid shade`, the demo and the Python package.
#pragma once
#include <map>
#include <set>

#include "io/scene/scene_file.h"
#include "pellucid/pellucid.hpp"

namespace pellucid::io {

// Channels that become one image with that many components. "" is the only channel of a file.
using ChannelGroup = std::vector<std::string>;

// Format of an image by its number of components minus one.
inline constexpr PelFormat groupFormats[] = {PEL_FORMAT_R32F, PEL_FORMAT_RG32F, PEL_FORMAT_RGB32F,
                                             PEL_FORMAT_RGBA32F};

// Maps a buffer while this object lives.
class MappedBuffer {
  public:
    explicit MappedBuffer(Buffer buffer)
        : buffer_(std::move(buffer)), at_(static_cast<float*>(buffer_.map())) {}
    MappedBuffer(MappedBuffer&& other) noexcept = default;
    ~MappedBuffer() {
        if (buffer_) pelBufferUnmap(buffer_.get());
    }
    float* at() const { return at_; }

  private:
    Buffer buffer_;
    float* at_;
};

class DeviceImages {
  public:
    explicit DeviceImages(const Device& device) : device_(device) {}

    // Reads the groups whose channels exist in the file. The returned image lists all channels and has no
    // pixels. Throws as readImage() does.
    Image read(const std::string& path, const std::set<ChannelGroup>& groups);
    // `image` was returned by read(). nullptr: these channels were not read.
    const OwnedImage* find(const Image& image, const ChannelGroup& channels) const;

  private:
    Device device_;
    std::map<std::pair<std::string, ChannelGroup>, OwnedImage> images_;  // by file
};

// The channel groups that a scene reads from its G-buffer.
std::set<ChannelGroup> gbufferGroups(const SceneFile& scene);
// The names in all groups; "" among them where a file's only channel is.
std::set<std::string> namesOf(const std::set<ChannelGroup>& groups);

// Interleaved channels of an image whose pixels are in host or device memory.
class PixelValues {
  public:
    PixelValues(const Image& image, const ChannelGroup& channels, const DeviceImages* images);
    const float* at() const { return mapped_ ? mapped_->at() : own_.data(); }

  private:
    std::vector<float> own_;
    std::optional<MappedBuffer> mapped_;
};

// The look-up tables of scenes: each distinct one is read or integrated once.
class LutStore {
  public:
    explicit LutStore(const Device& device) : device_(device) {}
    // The name "" gives an empty handle.
    Lut get(const SceneFile& scene, const std::string& name, PelLutKind kind);
    // A table made by the formulas of FaceWorks, of the profile that this name or file of a scene means.
    Lut faceworks(const std::string& source, const Profile& profile, PelLutKind kind);

  private:
    Device device_;
    std::vector<std::pair<SceneLut, Lut>> luts_;
    std::vector<std::pair<std::pair<std::string, PelLutKind>, Lut>> faceworks_;
};

// Shadow maps by file, already in memory.
using ShadowMaps = std::map<std::string, Image>;

// The channels that a scene reads from the file of a shadow map.
struct ShadowMapFile {
    std::set<ChannelGroup> groups;  // {""}: a light names no channel
    bool cube = false;
};
std::map<std::string, ShadowMapFile> shadowMapsOf(const SceneFile& scene);
ShadowMaps readShadowMaps(const SceneFile& scene);
// Reads into the device's memory; the returned images have no pixels.
ShadowMaps readShadowMaps(const SceneFile& scene, DeviceImages& images);

// `options` with the options of the scene added.
PelShaderOptions withOptionsOf(const SceneFile& scene, PelShaderOptions options);

class SceneFrame {
  public:
    // Uploads and sets the images of the scene and commits. `outputs`: slots to write besides radiance.
    // `shadowMaps`: maps and surroundings that are already in memory, by their names in the scene; others are
    // read from files.
    // The G-buffer must outlive the last update(). `buildOnly`: builds programs with progress instead of
    // committing; show() must follow (prepareFrame()). Throws FileError if a channel is missing.
    SceneFrame(const Device& device, const Image& gbuffer, const SceneFile& scene, LutStore& luts,
               const ShadowMaps& shadowMaps = {},
               const PelShaderOptions& options = pelShaderOptionsDefaults(),
               const std::vector<PelImageSlot>& outputs = {}, bool buildOnly = false);

    // Replaces the G-buffer and the shadow maps, and commits. Textures, cube maps and tables are kept.
    // `images` holds pixels that were read into the device's memory.
    void show(const Image& gbuffer, const SceneFile& scene, const ShadowMaps& shadowMaps = {},
              const DeviceImages* images = nullptr);

    // Sets materials, lights, ambient light, camera and options again. Files are not read a second time.
    void update(const SceneFile& scene, LutStore& luts,
                const PelShaderOptions& options = pelShaderOptionsDefaults());

    void shade() { shader_.execute(); }
    // RGB per pixel, interleaved; 0 where there is no material.
    std::vector<float> radiance() const { return radiance_.readAll<float>(); }
    // One of `outputs`: RGB interleaved, or a value per pixel of PEL_SLOT_OUT_THICKNESS.
    std::vector<float> output(PelImageSlot slot) const { return outputs_.at(slot).readAll<float>(); }
    PelShaderStats stats() const { return shader_.stats(); }
    std::vector<PelPassStats> passes() const { return shader_.passes(); }
    std::string warnings() const { return shader_.warnings(); }
    // Material `id` with every default filled in.
    PelMaterial material(uint32_t id) const { return shader_.material(id); }
    uint64_t inputBytes() const;

  private:
    void setPictures(const Image& gbuffer, const SceneFile& scene);  // radiance, outputs, channels
    // All but the channels
    void set(const SceneFile& scene, LutStore& luts, const PelShaderOptions& options);
    void setMaterial(const SceneFile& scene, const SceneMaterial& m, LutStore& luts);
    void setLights(const SceneFile& scene);
    // Images of files are kept by their names, wide shadows by their channels.
    const Image* givenImage(const std::string& file) const;
    PelImageDesc mapOf(const std::string& file, const std::string& channel, const std::string& second);
    const std::vector<PelImageDesc>& normalMap(const std::string& file);
    const std::vector<PelImageDesc>& normalMapLevels(const std::vector<std::string>& files);
    // One profile per name or file, also if several materials use it.
    Profile profileOf(const std::string& nameOrPath);
    PelImageDesc colorImage(const std::string& file, const char* need);
    // Curvature from normals and positions or depth of the G-buffer (pelScreenCurvature).
    PelImageDesc measureCurvature(const SceneFile& scene);
    PelImageDesc cubeImage(const std::string& file);
    // The environment that is set, as file and axes: setting it again would reduce it again.
    std::pair<std::string, std::array<float, 9>> environment_;
    void setEye(const SceneFile& scene, const SceneEye& e);
    PelImageDesc upload(const Image& image, const std::vector<std::string>& channels,
                        std::vector<Buffer>& to);

    Device device_;
    std::vector<PelImageSlot> wanted_;  // beside radiance
    const Image* gbuffer_ = nullptr;
    std::vector<float> before_;  // initial content of radiance; empty: 0
    // While the constructor or show() runs.
    const ShadowMaps* shadowMaps_ = nullptr;
    const DeviceImages* deviceImages_ = nullptr;
    Shader shader_;
    Buffer radiance_;
    std::vector<Buffer> pictures_, files_;  // of the G-buffer and shadow maps; of other files
    std::map<PelImageSlot, Buffer> outputs_;
    std::map<std::vector<std::string>, PelImageDesc> maps_, images_;            // of pictures_, of files_
    std::map<std::vector<std::string>, std::vector<PelImageDesc>> normalMaps_;  // of files_
    std::map<std::string, Profile> profiles_;
    std::map<std::string, Lut> caustics_;     // by their files
    std::set<uint32_t> materials_;            // that are set
    std::map<uint32_t, std::string> irises_;  // of materials that are eyes: their textures
    uint32_t updates_ = 0;
};

// Scatters the irradiance of a scene with SceneFile::scatter. The light is RGB per pixel, interleaved.
struct ScatteredFrame {
    std::vector<float> light;
    PelScatterStats stats;
};
ScatteredFrame scatterFrame(const Device& device, const Image& gbuffer, const SceneFile& scene);

// Warnings about values that are probably wrong: depth that is not device depth, objects whose size does not
// match their profile.
std::vector<std::string> unlikely(const Image& gbuffer, const SceneFile& scene,
                                  const DeviceImages* images = nullptr);

// Writes RGB radiance as R, G, B of a float EXR, lengths as Thickness.V.
void writeRadiance(const std::string& path, int width, int height, const std::vector<float>& radiance);
void writeThickness(const std::string& path, int width, int height, const std::vector<float>& lengths);

// A frame without its G-buffer and shadow maps, which SceneFrame::show() supplies. Builds the programs and
// launches each kernel on an image of 16 x 2 pixels, so that compilers run before the first frame, and
// reports progress to the device; with PelShaderOptions.buildInBackground show() does. Reads the files of the
// scene except G-buffer and shadow maps; look-up tables are kept in `luts`. Throws as SceneFrame does.
SceneFrame prepareFrame(const Device& device, const SceneFile& scene, LutStore& luts,
                        const PelShaderOptions& options = pelShaderOptionsDefaults(),
                        const std::vector<PelImageSlot>& outputs = {});
// Fills the driver's cache of programs, and `luts`. `images`: images of the scene that are not in files yet.
void buildPrograms(const Device& device, const SceneFile& scene, LutStore& luts,
                   const ShadowMaps& images = {});

}  // namespace pellucid::io
