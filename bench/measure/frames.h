// Frames for measurements of shading: images in the host's memory, and shaders that read them.
#pragma once
#include <pellucid/pellucid.hpp>

#include <cstdint>
#include <vector>

namespace pellucid::bench {

struct FrameImages {
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> id;                                           // 1: skin, 0: background
    std::vector<float> position, geometric, shading, blurred, albedo;  // 3 per pixel; mm
    std::vector<float> curvature, wideShadow;                          // 1 per pixel; 1/mm
    uint32_t mapSize = 0;                                              // texels a side
    std::vector<float> map;                                            // depth seen from `light`
    PelMaterial material = pelMaterialDefaults();
    PelLight light = pelLightDefaults();
    PelAmbient ambient = pelAmbientDefaults();
    PelCamera camera = pelCameraDefaults();
};

// A screen of folded skin, 10 pixels per mm, under one directional light. `mapRelief` is the relief of the
// shadow map as part of its depth range: 0 for one plane at `flatMapDepth`, so that the thickness needs no
// taps.
constexpr float flatMapDepth = 0.45f;
FrameImages foldedSkin(uint32_t width, uint32_t height, float mapRelief = 0.05f);

enum class Terms {
    plain,      // Lambert and specular light, without shadow and ambient light
    lit,        // with a plain shadow and ambient light: what a renderer without scattering computes
    scattering  // pre-integrated scattering by the tables of FaceWorks
};

// What a shader computes of a frame.
struct FrameSettings {
    Terms terms = Terms::scattering;
    uint32_t taps = 0;           // of thickness; 0: no deep scatter
    uint32_t lights = 1;         // the frame's own, and others from elsewhere
    std::vector<uint8_t> ids{};  // in place of the frame's
    bool everyPixel = false;     // no interpolation between pixels
};

class Frame {
  public:
    Frame(const Device& device, FrameImages images);

    const FrameImages& images() const { return images_; }
    const Lut& curvatureLut() const { return curvatureLut_; }
    const Lut& shadowLut() const { return shadowLut_; }
    // Radiance of the last shader that was executed.
    const Buffer& target() const { return target_; }

    PelMaterial material(const FrameSettings& settings) const;
    std::vector<PelLight> lights(const FrameSettings& settings) const;
    Shader shader(const FrameSettings& settings) const;  // committed

  private:
    Device device_;
    FrameImages images_;
    Buffer position_, geometric_, shading_, blurred_, albedo_, curvature_, wideShadow_, id_, map_, target_;
    Lut curvatureLut_, shadowLut_;
};

}  // namespace pellucid::bench
