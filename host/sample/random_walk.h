// Random walks of light in a body (docs/mathematics.md, section 14), which the surface integral approximates.
#pragma once
#include "sample/lit_mesh.h"

namespace pellucid::sample {

// Homogeneous, with isotropic scattering.
struct Medium {
    std::array<double, 3> meanFreePath{1, 1, 1};  // per channel, unit of positions
    std::array<double, 3> albedo{};               // per channel, of a single scattering: 0 to 1
    double refractiveIndex = 1;  // relative to the outside; 1: index-matched, else smooth Fresnel
};

// Light of one wavelength, 1/unit of positions.
struct Wave {
    double scattering = 0;  // of both layers, isotropic
    double outerAbsorption = 0, absorption = 0;
    std::array<double, 3> weight{};  // share in each channel; negative where a colour space is narrow
};

// All points at most `thickness` away from the nearest triangle belong to the outer layer.
struct LayeredMedium {
    LayeredMedium() = default;
    LayeredMedium(const Medium& medium);  // of one layer and one wavelength per channel
    double thickness = 0, refractiveIndex = 1;
    std::vector<Wave> waves;
};

enum class Boundary { IndexMatched, Fresnel };
constexpr double fresnelIndex = 1.4;  // of skin; the only one for which burleyMedium has fits

double mostReflectance(Boundary boundary);

// The medium whose half-space reflects `reflectance` of diffuse light, and scatters it like Burley's profile
// of length `burleyLength`, (exp(-r/d) + exp(-r/3d)) / (8 pi d r). Both are fits to walks of half-spaces
// (docs/mathematics.md, section 14). Their errors, for a reflectance from 0.07 to 0.95: 0.0021 of the
// reflectance (0.0001 at 0.8; Fresnel: 0.0024), 0.7 % of the mean free path (Fresnel: 0.9 %). A reflectance
// of 0, or above mostReflectance, is moved inwards, so that walks scatter and end.
Medium burleyMedium(const std::array<double, 3>& burleyLength, const std::array<double, 3>& reflectance,
                    Boundary boundary);

// The triangles of a scene that enclose one medium. The scene must outlive it.
class WalkBody {
  public:
    // `material`: only triangles of this id enclose the medium, all others just cast shadows; 0: all
    // triangles. Throws std::invalid_argument if the scene has no such triangle.
    WalkBody(const Scene& scene, uint32_t material);

    const Scene& lit() const { return lit_; }                  // the whole scene, for shadows
    const Scene& body() const { return own_ ? *own_ : lit_; }  // the boundary of the medium
    // The triangle of the whole scene that a triangle of the boundary is.
    uint32_t litTriangle(uint32_t triangle) const { return own_ ? triangles_[triangle] : triangle; }
    bool encloses(uint32_t litTriangle) const;
    uint32_t material() const { return material_; }

  private:
    const Scene& lit_;
    uint32_t material_;
    std::unique_ptr<Scene> own_;
    std::vector<uint32_t> triangles_;
};

struct WalkOptions {
    uint32_t samples = 64;  // walks per point, channel and half
    double noise = 0;  // if above 0: take as many samples as the mean of both halves needs for this noise
    uint64_t seed = 1;
    // Called by the calling thread with the finished fraction, about ten times a second. May throw to cancel.
    std::function<void(double)> progress;
};

constexpr uint32_t maxWalkSamples = 1u << 16;

// Two independent estimates with the same noise. Where E is the irradiance of a surface point (1 under a
// light of colour 1 that faces it), the values are the radiance of the body times pi, and equal
// reflectance times E on a large, evenly lit plane.
struct WalkedLight {
    std::vector<float> first, second;  // RGB per point
    uint32_t samples = 0;              // per point, channel and half
    double noise = 0;                  // standard error of the mean of both halves, root mean square
    uint64_t lost = 0;                 // walks that left through a hole of the mesh; they count as dark
};

// Walks from each of `points` (on triangles of the whole scene that enclose the medium) until the surface is
// met, and takes the irradiance there, with ray-traced visibility. Threads do not change the result.
WalkedLight walkLight(const WalkBody& body, const Lighting& lighting, std::span<const SurfacePoint> points,
                      const LayeredMedium& medium, const WalkOptions& options);

}  // namespace pellucid::sample
