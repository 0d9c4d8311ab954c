// The sum of section 6: one pixel, one material, any number of lights.
#pragma once

#include "reference/shade.h"

namespace reference {

struct ScatterTable {
    Table table;                   // D(u, r) or T(w, width)
    double least = 1, most = 100;  // radii of curvature, or penumbra widths; length
    double diffusionRadius = 2.7;  // length
    double sharpening = 10;        // of a shadow table
};

struct Material {
    Rgb albedo{1, 1, 1};
    double diffusionRadius = 2.7;  // length
    Rgb normalBlend{1, 0.3, 0};
    double shadowFilterWidth = 8;  // length
    Rgb deepScatterColor;
    double deepScatterRadius = 6;  // length
    double specular = 0, roughness = 0.3, f0 = 0.028;
    bool ggx = false;
    double roughness2 = 0.15, lobeMix = 0.15;
    double deepScatterAmbient = 0;
    const ScatterTable* curvatureLut = nullptr;  // none: no scattering at the terminator, delta = 0
    const ScatterTable* shadowLut = nullptr;     // none: the wide shadow as it is, in all channels
};

struct Pixel {
    Vec3 geometric, shading, blurred, toViewer;
    double curvature = 0;  // 1/length
    double ambientOcclusion = 1;
    bool hasThickness = false;  // of its own, from an image
    double thickness = 0;       // length
};

// A light as this pixel sees it.
struct PixelLight {
    Vec3 toLight;
    Rgb color;  // falloff included
    double wideShadow = 1;
    bool hasThickness = false;
    double thickness = 0;  // length
};

struct Shaded {
    Rgb scattered;  // albedo * light * direct * shadow
    Rgb ambient, deepScatter, specular;
    Rgb sum() const { return scattered + ambient + deepScatter + specular; }
};
// Terms of one light. Specular light is multiplied by the sharpened shadow (of the shadow table's sharpening;
// by the wide shadow without a table).
Shaded shadeLight(const Material& material, const Pixel& pixel, const PixelLight& light);
Shaded shadePixel(const Material& material, const Pixel& pixel, const std::vector<PixelLight>& lights,
                  const Ambient& ambient);

// Light of a point or spot at a place: color / distance², nothing beyond range (0: no limit); a spot's cone
// fades by a smoothstep of the cosine to its axis.
struct Lamp {
    Vec3 position;
    Rgb color;
    double range = 0;  // length
    bool spot = false;
    Vec3 axis;  // unit, away from the lamp
    double cosInner = 1, cosOuter = 0;
};
PixelLight lampAt(const Lamp& lamp, Vec3 position);

}  // namespace reference
