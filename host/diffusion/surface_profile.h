// Data of a profile for the surface integral: energy within a distance, and bounds of the derivatives of R.
// In units of positions.
#pragma once
#include "core/device.h"
#include "lut/profile.h"
#include "shared/surface_integral.h"

namespace pel {

struct SurfaceProfile {
    std::vector<cl_float4> rows;  // two per distance, as PEL_SURFACE_ROWS says
    double firstLog2;             // log2 of the first distance
    double reach;                 // length; R is 0 beyond in all channels
    Three cut;                    // length; 0: R does not end abruptly
    double piece;                 // of the parameter along an edge that one rule takes
    // sup over s >= the row's distance of the Hessian's norm (1/length^4) and of the gradient's (1/length^3).
    std::vector<double> curving, fall;

    double distance(size_t row) const;
    size_t count() const { return curving.size(); }
};

// Lengths of the profile times `scale` are in units of positions. `cut`: lengths where R ends, 0 for none;
// the rest is scaled to 1 on a plane.
SurfaceProfile tabulateProfile(const ProfileShape& shape, double scale, const Three& cut);

}  // namespace pel
