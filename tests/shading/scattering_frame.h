// A frame for tests of all methods of scattering.
#pragma once
#include "pass_scene.h"

namespace shade_test {

// A relief whose two materials scatter by a method, under a light with a shadow map from above.
inline Frame scatteringFrame(PelScattering scattering, uint32_t width, uint32_t height) {
    Frame f = reliefFrame(3, width, height, 0.5f);
    Light light;
    PelLight& l = light.params;
    l.toLight[0] = 0.6f, l.toLight[1] = 0, l.toLight[2] = 0.8f;
    const float rows[16] = {1 / 60.0f, 0, 0, 0.1f, 0, 1 / 60.0f, 0, 0.1f, 0, 0, -0.01f, 0.5f, 0, 0, 0, 1};
    std::copy_n(rows, 16, l.worldToShadow);
    l.shadowDepthRange = 100;
    l.shadowFilterTexels = 16;
    light.mapSize = 64;
    light.map.components = 1;
    for (uint32_t i = 0; i < 64 * 64; ++i) {  // the relief that the camera sees, under a roof
        const auto pixel = [](uint32_t texel, uint32_t most) {
            const float length = (float(texel) + 0.5f) * 60 / 64 - 6;
            return size_t(std::clamp(length / 0.5f, 0.0f, float(most - 1)));
        };
        const size_t seen = pixel(i / 64, f.height) * f.width + pixel(i % 64, f.width);
        light.map.values.push_back(
            i % 64 > 40 ? 0.2f : 0.5f - 0.01f * f.slots[PEL_SLOT_POSITION].values[3 * seen + 2]);
    }
    f.lights.push_back(light);
    f.camera.position[2] = 200;
    f.ambient.constant[0] = 0.1f;
    for (auto& [id, m] : f.materials) {
        m = pelMaterialDefaults();
        m.scattering = scattering;
        m.thicknessTaps = 8;
    }
    Random random(8);
    const auto scalars = [&](PelImageSlot slot, uint32_t components) {
        f.slots[slot].components = components;
        for (size_t i = 0; i < components * f.pixels(); ++i)
            f.slots[slot].values.push_back(random.uniform(0.2f, 1));
    };
    scalars(PEL_SLOT_SCATTER_WEIGHT, scattering == PEL_SCATTERING_SCREEN ? 2 : 1);
    scalars(PEL_SLOT_MEAN_CURVATURE, 1);
    scalars(PEL_SLOT_UV, 2);
    return f;
}

}  // namespace shade_test
