#include "frames.h"

#include <algorithm>
#include <cmath>

namespace pellucid::bench {

FrameImages foldedSkin(uint32_t width, uint32_t height, float mapRelief) {
    FrameImages f;
    f.width = width, f.height = height;
    f.id.assign(size_t(width) * height, 1);
    const auto appendUnit = [](std::vector<float>& to, float x, float y) {
        const float length = std::sqrt(x * x + y * y + 1);
        to.insert(to.end(), {x / length, y / length, 1 / length});
    };
    for (uint32_t row = 0; row < height; ++row)
        for (uint32_t column = 0; column < width; ++column) {
            const float x = float(column), y = float(row);
            const float a = 1.6f * std::sin(x / 110), b = 1.2f * std::cos(y / 85);
            f.position.insert(f.position.end(),
                              {0.1f * (x - 0.5f * float(width)), 0.1f * (0.5f * float(height) - y),
                               12 * std::sin((x + y) / 150)});
            appendUnit(f.geometric, a, b);
            appendUnit(f.shading, a + 0.1f * std::sin(x / 3), b + 0.1f * std::sin(y / 4));
            appendUnit(f.blurred, 0.9f * a, 0.9f * b);
            f.curvature.push_back(0.05f + 0.02f * float((column / 7 + row / 5) % 10));
            f.albedo.insert(f.albedo.end(), {0.8f, 0.5f, 0.4f});
            f.wideShadow.push_back(std::clamp(0.5f + 3 * std::sin((x - y) / 140), 0.0f, 1.0f));
        }
    f.mapSize = 1024;
    for (uint32_t y = 0; y < f.mapSize; ++y)
        for (uint32_t x = 0; x < f.mapSize; ++x)
            f.map.push_back(flatMapDepth + mapRelief * std::sin(float(x) / 60) * std::cos(float(y) / 50));
    // The numbers of FaceWorks, which the oracle takes unchanged.
    f.material.diffusionRadius = 2.7f;
    f.material.shadowFilterWidth = 8;
    f.material.normalBlend[0] = 1, f.material.normalBlend[1] = 0.3f, f.material.normalBlend[2] = 0;
    f.material.specular = 0.8f;
    const float toLight[3] = {0.8f, 0.36f, 0.48f},
                rows[16] = {0.004f, 0, 0, 0.5f, 0, 0.004f, 0, 0.5f, 0, 0, -0.004f, 0.5f, 0, 0, 0, 1};
    std::copy_n(toLight, 3, f.light.toLight);
    std::copy_n(rows, 16, f.light.worldToShadow);
    f.light.shadowDepthRange = 250;
    for (int i = 0; i < 9; ++i)
        for (int c = 0; c < 3; ++c) f.ambient.sh[i][c] = 0.3f / float(1 + i + c);
    f.camera.position[2] = 600;
    return f;
}

Frame::Frame(const Device& device, FrameImages images)
    : device_(device),
      images_(std::move(images)),
      position_(device, images_.position),
      geometric_(device, images_.geometric),
      shading_(device, images_.shading),
      blurred_(device, images_.blurred),
      albedo_(device, images_.albedo),
      curvature_(device, images_.curvature),
      wideShadow_(device, images_.wideShadow),
      id_(device, images_.id),
      map_(device, images_.map),
      target_(device, images_.position.size() * sizeof(float)),
      curvatureLut_(device, pelCurvatureLutDescFaceWorks()),
      shadowLut_(device, pelShadowLutDescFaceWorks()) {}

PelMaterial Frame::material(const FrameSettings& settings) const {
    constexpr float color[3] = {0.9f, 0.4f, 0.3f};
    PelMaterial m = images_.material;
    m.thicknessTaps = settings.taps;
    if (settings.taps) std::copy_n(color, 3, m.deepScatterColor);
    if (settings.terms == Terms::scattering) m.scattering = PEL_SCATTERING_PREINTEGRATED;
    return m;
}

std::vector<PelLight> Frame::lights(const FrameSettings& settings) const {
    std::vector<PelLight> lights(settings.lights, images_.light);
    for (uint32_t i = 1; i < settings.lights; ++i)
        std::swap(lights[i].toLight[i % 3], lights[i].toLight[(i + 1) % 3]);
    for (PelLight& light : lights) light.shadowFilterTexels = 0;
    return lights;
}

Shader Frame::shader(const FrameSettings& settings) const {
    Shader shader(device_);
    const auto set = [&](PelImageSlot slot, const Buffer& image, PelFormat format) {
        shader.set(slot, imageDesc(image, format, images_.width, images_.height));
    };
    set(PEL_SLOT_RADIANCE, target_, PEL_FORMAT_RGB32F);
    set(PEL_SLOT_MATERIAL, settings.ids.empty() ? id_ : Buffer(device_, settings.ids), PEL_FORMAT_R8_UINT);
    set(PEL_SLOT_POSITION, position_, PEL_FORMAT_RGB32F);
    set(PEL_SLOT_NORMAL_SHADING, shading_, PEL_FORMAT_RGB32F);
    set(PEL_SLOT_ALBEDO, albedo_, PEL_FORMAT_RGB32F);
    shader.set(lights(settings)).set(images_.camera);
    if (settings.terms != Terms::plain) {
        shader.set(images_.ambient);
        for (uint32_t i = 0; i < settings.lights; ++i)
            shader.set(i, PEL_LIGHT_WIDE_SHADOW,
                       imageDesc(wideShadow_, PEL_FORMAT_R32F, images_.width, images_.height));
    }
    if (settings.terms == Terms::scattering) {
        set(PEL_SLOT_NORMAL_GEOMETRIC, geometric_, PEL_FORMAT_RGB32F);
        set(PEL_SLOT_NORMAL_BLURRED, blurred_, PEL_FORMAT_RGB32F);
        set(PEL_SLOT_CURVATURE, curvature_, PEL_FORMAT_R32F);
        shader.setMaterial(1, material(settings), curvatureLut_, shadowLut_);
    } else {
        shader.setMaterial(1, material(settings));
    }
    if (settings.taps)
        for (uint32_t i = 0; i < settings.lights; ++i)
            shader.set(i, PEL_LIGHT_SHADOW_MAP,
                       imageDesc(map_, PEL_FORMAT_R32F, images_.mapSize, images_.mapSize));
    PelShaderOptions options = pelShaderOptionsDefaults();
    options.everyPixel = settings.everyPixel;
    shader.set(options).commit();
    return shader;
}

}  // namespace pellucid::bench
