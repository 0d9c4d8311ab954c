// Irradiance on a mesh, with ray-traced shadows, on triangles split until it is linear on each.
#pragma once
#include <pellucid/pellucid.hpp>

#include "sample/scene.h"

namespace pellucid::sample {

// A light of PelLight with hard shadows: a point light or a directional one.
struct SurfaceLight {
    enum class Type { Directional, Point, SpotLight };
    Type type = Type::Directional;
    Vec3 toLight{0, 0, 1};         // unit; directional
    Vec3 position;                 // point, spot
    Vec3 spotDirection{0, 0, -1};  // unit
    double spotCosInner = 0.9, spotCosOuter = 0.8;
    double range = 0;                      // 0: no limit
    std::array<double, 3> color{1, 1, 1};  // irradiance at right angles; of point and spot times distance^2
};

struct Lighting {
    std::vector<SurfaceLight> lights;
    // Light from all around, unoccluded, of a unit normal; may be empty.
    std::function<std::array<double, 3>(Vec3)> ambient;
};

// A place on the mesh.
struct SurfacePoint {
    uint32_t triangle;
    std::array<double, 3> weights;
};

struct Surface {
    Vec3 position, normal;  // normal: of the triangle, unit, outwards
};
Surface surfaceAt(const Mesh& mesh, const SurfacePoint& point);

// The place on the mesh that is nearest to each of `positions` (xyz), and how far away it is.
std::vector<SurfacePoint> nearestPoints(const Scene& scene, std::span<const float> positions,
                                        std::vector<double>& distances);

// RGB per point. The cosine is that of the interpolated normals. Shadow rays begin at the smooth surface that
// these imply, so that facets cast no shadows on each other [Hanika 2021, "Hacking the shadow terminator"].
std::vector<float> irradianceAt(const Scene& scene, const Lighting& lighting,
                                std::span<const SurfacePoint> points);

// The same for one point, on the calling thread.
std::array<double, 3> irradianceAt(const Scene& scene, const Lighting& lighting, const SurfacePoint& point);

struct LitMesh {
    std::vector<float> positions;     // xyz of each corner: three corners per triangle, none shared
    std::vector<float> irradiance;    // RGB of each corner
    std::vector<uint32_t> triangles;  // 0, 1, 2, ...
};

struct LitMeshOptions {
    double coarsest = INFINITY;  // length; longer edges are split whatever the light
    double finest = 0;           // length; shorter edges are not
    // Part of the brightest irradiance by which the middle of an edge may differ from the mean of its ends.
    double deviation = 0.003;
    size_t mostTriangles = 40'000'000;
    uint32_t material = 0;  // only triangles of this id give light; 0: all
};

// `progress`: told a fraction again and again, and may throw. Throws std::length_error beyond mostTriangles.
LitMesh lightMesh(const Scene& scene, const Lighting& lighting, const LitMeshOptions& options,
                  const std::function<void(double)>& progress = {});

// Light that leaves a lit mesh after scattering in it (docs/mathematics.md, section 9), by the library.

// RGB per point. `points`: xyz each; may be empty. `desc` gives profile, radius, unit, cut and tolerance;
// mesh, points and result are filled in here.
std::vector<float> scatteredAt(const Device& device, const LitMesh& lit, const std::vector<float>& points,
                               PelSurfaceIntegralDesc desc);

}  // namespace pellucid::sample
