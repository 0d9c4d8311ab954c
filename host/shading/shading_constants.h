// The shading constants of a shader: frame, materials, lights and look-up tables, sent when they change.
#pragma once
#include <cfloat>

#include "shading/scratch_image.h"

namespace pel {

struct ShaderState;

class ShadingConstants {
  public:
    // Returns the bytes sent. If there are several tables they are copied into one buffer. `variants`:
    // features of each variant of the shading kernel; `listTiles`: PelShadeFrame.listTiles.
    size_t update(Device& device, const ShaderState& state, const std::vector<uint32_t>& variants,
                  uint32_t listTiles);
    // The tiles of the next launches: `tiles` from `firstTile` on, with scratch images that begin at a row of
    // pixels.
    void setBand(Device& device, uint32_t firstTile, uint32_t tiles, uint32_t scratchRow);

    const PelShadeFrame& frame() const { return frame_; }
    const cl::Memory& frameMemory() const { return frameUpload_.memory(); }
    const cl::Memory& materials() const { return materialUpload_.memory(); }
    const cl::Memory& lights() const { return lightUpload_.memory(); }
    const cl::Memory& luts() const { return luts_; }
    const cl::Memory& eyes() const { return eyeUpload_.memory(); }
    // Distinct buffers of the lights' images: the kernel's arguments light0...
    const std::vector<cl::Memory>& lightBuffers() const { return lightBuffers_; }
    size_t scratchBytes() const;

  private:
    void gatherLuts(Device& device, const ShaderState& state);
    uint32_t offsetOf(const Lut* lut) const;  // texels, in luts()
    PelShadeLut describe(const Lut* lut, float materialRadius) const;
    std::vector<PelShadeEye> describeEyes(const ShaderState& state) const;
    uint32_t lightBuffer(const cl::Memory& memory);
    void fillFrame(const ShaderState& state);
    std::vector<PelShadeMaterial> describeMaterials(const ShaderState& state,
                                                    const std::vector<uint32_t>& variants) const;
    std::vector<PelShadeLight> describeLights(const ShaderState& state);

    PelShadeFrame frame_{};
    std::array<uint32_t, 3> band_{};  // tiles, firstTile and scratchRow as the device has them
    CachedUpload frameUpload_, materialUpload_, lightUpload_, eyeUpload_;
    std::vector<Ref<Lut>> gathered_;
    std::vector<uint32_t> offsets_;  // texels, of gathered_
    cl::Memory luts_;
    size_t lutBytes_ = 0;
    std::vector<cl::Memory> lightBuffers_;
};

// Where the kernel finds an image; all zero for none.
PelShadeImage describeImage(const struct ImageView& view);

// The fields that PelShadeLight and PelLightMap have in common.
template <class To>
void describeLamp(const PelLight& light, To& to) {
    to.type = light.type;
    std::ranges::copy(light.toLight, to.toLight);
    std::ranges::copy(light.position, to.position);
    std::ranges::copy(light.spotDirection, to.spotDirection);
    to.spotCosOuter = light.spotCosOuter;
    to.spotScale = 1 / std::max(light.spotCosInner - light.spotCosOuter, 1e-6f);
    std::ranges::copy(light.color, to.color);
    to.range2 = light.range > 0 ? std::min(light.range * light.range, FLT_MAX) : FLT_MAX;
    to.radius = light.radius;
    std::ranges::copy(light.halfWidth, to.halfWidth);
    std::ranges::copy(light.halfHeight, to.halfHeight);
    if (light.shadowExponent != 0) to.perExponent = float(std::log(2.0) / light.shadowExponent);
}

}  // namespace pel
