// Smooth random fields in space: sums of plane waves. Their blur by a Gaussian is exact (each wave only gets
// weaker), so one field gives the sharp surface, its band limit at the pixel's size and its blur over the
// diffusion radius alike.
#pragma once
#include <cstdint>
#include <vector>

#include "sample/vector.h"

namespace pellucid::sample {

// The footprint of a point on a surface, in its tangent plane: a Gaussian of standard deviation sigma, longer
// by `stretch` along `along`.
struct Footprint {
    Vec3 normal;          // unit
    double sigma = 0;     // mm
    Vec3 along{0, 0, 0};  // unit in the tangent plane, or zero
    double stretch = 1;   // >= 1: the view's foreshortening
};

class WaveField {
  public:
    // Wavelengths spread over the octave around `wavelength` (mm). Same seed, same field. Few waves show as a
    // weave where the light picks out those of one direction: about 100 look random, 32 do for soft fields.
    WaveField(double wavelength, int waves, uint32_t seed);

    // Height of mean square 1 over a surface, blurred over the footprint.
    double value(Vec3 p, const Footprint& footprint) const;
    // Slope along the tangent plane, of mean square 1, blurred over each footprint; out[i] for footprints[i].
    // Returns the mean square that the blur over the first footprint takes away.
    double slope(Vec3 p, const Footprint* footprints, int count, Vec3* out) const;

  private:
    struct Wave {
        Vec3 k;        // rad/mm
        double phase;  // rad
    };
    std::vector<Wave> waves_;
};

}  // namespace pellucid::sample
