// Renders the G-buffer that a deferred renderer gives Pellucid: one sample through each pixel's centre.
#pragma once
#include <cstddef>

#include "sample/camera.h"
#include "sample/look.h"
#include "sample/scene.h"

namespace pellucid::sample {

// Float images in planes: value(c, x, y) at data[(c * height + y) * width + x], row 0 on top.
struct Image {
    int width = 0, height = 0, channels = 0;
    std::vector<float> data;

    Image() = default;
    Image(int w, int h, int c, float value = 0)
        : width(w), height(h), channels(c), data(size_t(w) * size_t(h) * size_t(c), value) {}

    size_t planeSize() const { return size_t(width) * size_t(height); }
    float* plane(int c) { return data.data() + planeSize() * size_t(c); }
    const float* plane(int c) const { return data.data() + planeSize() * size_t(c); }
    float& at(int c, int x, int y) { return plane(c)[size_t(y) * size_t(width) + size_t(x)]; }
    float at(int c, int x, int y) const { return plane(c)[size_t(y) * size_t(width) + size_t(x)]; }
};

// Fine relief and colour that a head mesh lacks, from random fields in world space.
struct SkinDetail {
    bool enabled = true;
    double poreWavelength = 1.2;  // mm
    double poreSlope = 0.12;      // root mean square of the slope
    double roughness = 0.35;      // of the material: slopes too fine for a pixel add to it
    double foldWavelength = 9;    // mm: relief that stays in the blurred normal
    double foldSlope = 0.05;
    double furrowWavelength = 1.3;  // mm, where a zone has furrows
    double blotchWavelength = 14;   // mm, of pigment and blood
    double blotchAmount = 0.06;     // root mean square of their relative change
    uint32_t seed = 1;
};

struct GBufferOptions {
    SkinDetail detail;
    double diffusionRadius = 2.7;  // mm: radius of the blurred normal's blur
    std::vector<Look> looks;       // of material ids 1, 2, ...; ids beyond are skin
    std::vector<SkinZone> zones;   // of skin
    std::vector<EyeLook> eyes;     // an eye's pixel belongs to the nearest
    bool thickness = false;        // measure it: one more ray per pixel
};

constexpr float backgroundDepth = 1e10f;  // mm, of viewDepth where nothing was hit

// Background pixels have 0 everywhere, but for the depth. Unit vectors, mm.
struct GBuffer {
    int width = 0, height = 0;
    Image position;         // 3, world, mm
    Image geometricNormal;  // 3, Ng: the vertex normals interpolated, not turned to the viewer
    Image shadingNormal;    // 3, N: Ng bent by pores and folds, band-limited to the pixel
    Image blurredNormal;  // 3, Nb: Ng bent by the same relief blurred with a Gaussian of diffusionRadius / 2.
                          // That is the blur of a normal map read bilinearly at the mip whose texels are one
                          // diffusion radius wide (box and tent: rho^2/12 + rho^2/6 = (rho/2)^2)
    Image curvature;      // 1, 1/mm, interpolated from the vertices
    Image albedo;         // 3, linear
    Image specular;       // 1, factor of the material's specular, 1 but for zones of skin
    Image roughness;      // 1, factor of the material's roughness: zones, and relief that the pixel blurs
    Image uv;             // 2, or empty when the mesh has none
    Image thickness;      // 1, mm of the sheet that loses as much light as the body does, for
                          // PEL_SLOT_THICKNESS; 0: unknown, as below a surface that encloses nothing. Empty
                          // unless asked for
    Image viewDepth;      // 1, mm along the camera's axis; backgroundDepth where nothing was hit
    Image coverage;       // 1, 1 or 0
    std::vector<uint32_t> material;  // id per pixel, 0 background
};

// A pixel of three planes.
inline Vec3 vectorAt(const Image& image, int x, int y) {
    return {image.at(0, x, y), image.at(1, x, y), image.at(2, x, y)};
}

// Pixels do not depend on the number of threads. Throws std::invalid_argument for a negative size.
GBuffer renderGBuffer(const Scene& scene, const Camera& camera, int width, int height,
                      const GBufferOptions& options = {});

}  // namespace pellucid::sample
