// Light in a scattering medium, photon by photon, which profiles and the surface integral approximate.
#pragma once

#include <cstdint>
#include <vector>

namespace reference {

// A homogeneous, index-matched medium with isotropic scattering.
struct Medium {
    double meanFreePath;  // length
    double albedo;        // of a single scattering
};

struct WalkResult {
    std::vector<double> radiance;  // per bin: radiance / irradiance that the light has at right angles
    std::vector<double> error;     // its standard error
    double reflected = 0;          // part of the light that comes out again
    double transmitted = 0;        // of a slab: part that comes out below
    double straight = 0;           // of that no further aside than the slab is thick
};

// A ball under a parallel light. Light enters diffusely, with the cosine's distribution, and what comes out
// counts as diffuse. Bins are of N.L from -1 to 1, equally wide.
WalkResult walkBall(const Medium& medium, double radius, int bins, uint64_t photons, uint64_t seed);

// A slab between the planes z = 0 and -thickness (infinite: a half-space), lit from above at one point: bins
// of the distance from there at which light comes out on top, equally wide up to `reach`. radiance: energy
// per area, of the light that enters.
WalkResult walkSlab(const Medium& medium, double thickness, double reach, int bins, uint64_t photons,
                    uint64_t seed);

}  // namespace reference
