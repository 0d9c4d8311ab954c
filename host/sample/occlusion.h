// Ambient occlusion, soft shadows and bounced light of a G-buffer, by rays.
#pragma once
#include "sample/gbuffer.h"
#include "sample/lit_mesh.h"
#include "sample/sky.h"

namespace pellucid::sample {

// The share of diffuse light from all round that reaches each pixel past the mesh: the fraction of `rays`
// cosine-distributed rays that hit nothing. One plane, 1 on the background. Pixels take the directions of a 4
// x 4 pattern, and the mean over as many similar neighbours; threads do not change the result. Throws
// std::invalid_argument for `rays` below 1. `hair`: of curves, or none.
Image ambientOcclusion(const Scene& scene, const GBuffer& gbuffer, int rays = 8, const Scene* hair = nullptr);

// The same for light from a disk around `toLight` (unit), of this radius at a distance of 1: the visible
// share of the part above the pixel's horizon; 1 where there is none.
Image softShadow(const Scene& scene, const GBuffer& gbuffer, Vec3 toLight, double radius, int rays,
                 const Scene* hair = nullptr);

// The lighting of a mesh of one albedo. `lamps`: in PelLight's unit; `rays`: to each pixel.
struct Bounces {
    std::vector<SurfaceLight> lamps;
    Sky sky;
    Rgb albedo{0.5, 0.5, 0.5};
    int rays = 8;
    const Scene* hair = nullptr;  // of curves, or none: rays that meet it first bring nothing
};
// Irradiance / pi, RGB, of light that reaches each pixel after one to three diffuse reflections off the mesh,
// by paths of cosine-distributed rays; 0 on the background. Shared over pixels as the occlusion is. Throws
// std::invalid_argument for `rays` below 1.
Image bouncedLight(const Scene& scene, const GBuffer& gbuffer, const Bounces& bounces);

// Resamples one of these images to another size of the same view: each pixel takes the mean of its neighbours
// that show the same surface, or else the one nearest in space.
Image enlarged(const Image& image, const GBuffer& from, const GBuffer& to);

}  // namespace pellucid::sample
