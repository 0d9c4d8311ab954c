// The two-ring fit of docs/guide/curvature.md ("The fit, exactly") in double precision.
#pragma once

#include "reference/curvature.h"

namespace reference {

struct QuadricCurvature : PrincipalCurvatures {
    Vec3 firstDirection, secondDirection;  // unit, signs arbitrary
    Vec3 normal;                           // unit, of the fitted surface
    bool measured = false;                 // false: no neighbour at another place
    bool replaced = false;                 // the given normal was not believed
    bool low = false;                      // the points do not tell all terms apart even so
    bool border = false;
    int points = 0;  // distinct vertices that tell about this one
    // How near the nearest yes-or-no decision (replace the normal, leave a point out, fit once more) came to
    // its threshold, relative: where it is as small as float rounding, single precision may decide the other
    // way.
    double margin = 1, lowMargin = 1;  // the latter of `low`, on which nothing else depends
};

// Positions and normals must be finite and the triangles consistently ordered, each with three corners of its
// own.
std::vector<QuadricCurvature> quadricCurvature(const Mesh& mesh);

}  // namespace reference
