// A shader over images that a test has as vectors.
#pragma once
#include <algorithm>
#include <pellucid/pellucid.hpp>
#include <vector>

namespace scatter_scene {

struct ShownImages {
    pellucid::Device device;
    uint32_t width, height;
    pellucid::Shader shader;
    pellucid::Buffer out;

    ShownImages(const pellucid::Device& on, uint32_t w, uint32_t h)
        : device(on), width(w), height(h), shader(on), out(on, std::vector<float>(3 * size_t(w) * h)) {
        shader.set(PEL_SLOT_RADIANCE, pellucid::imageDesc(out, PEL_FORMAT_RGB32F, w, h));
    }
    // One to four values per pixel.
    void set(PelImageSlot slot, const std::vector<float>& values) {
        constexpr PelFormat formats[] = {PEL_FORMAT_R32F, PEL_FORMAT_RG32F, PEL_FORMAT_RGB32F,
                                         PEL_FORMAT_RGBA32F};
        set(slot, values, formats[values.size() / (size_t(width) * height) - 1]);
    }
    void set(PelImageSlot slot, const std::vector<uint8_t>& ids) { set(slot, ids, PEL_FORMAT_R8_UINT); }
    // A map of a light, by default the first one.
    void setMap(PelLightSlot slot, const std::vector<float>& values, uint32_t w, uint32_t h,
                uint32_t light = 0) {
        shader.set(
            light, slot,
            pellucid::imageDesc(pellucid::Buffer(device, values),
                                values.size() == size_t(w) * h ? PEL_FORMAT_R32F : PEL_FORMAT_RG32F, w, h));
    }
    std::vector<float> execute() {
        shader.commit();
        shader.execute();
        return out.readAll<float>();
    }

  private:
    template <class T>
    void set(PelImageSlot slot, const std::vector<T>& values, PelFormat format) {
        shader.set(slot, pellucid::imageDesc(pellucid::Buffer(device, values), format, width, height));
    }
};

// Of an albedo of 1 and without the gain of curved bodies: the result is the scattered irradiance.
inline PelMaterial whiteMaterial(const pellucid::Profile& profile, PelScattering scattering) {
    PelMaterial material = pelMaterialDefaults();
    material.profile = profile.get();
    material.scattering = scattering;
    material.curvatureGain = 0;
    std::fill_n(material.albedo, 3, 1.0f);
    return material;
}

}  // namespace scatter_scene
