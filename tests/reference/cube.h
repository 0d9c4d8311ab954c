// An irradiance cube map, in double precision: bilinear between the texels' centres of a face; on edges and
// corners of the cube the mean of the faces that meet there.
#pragma once

#include <vector>

#include "reference/vec.h"

namespace reference {

struct CubeMap {
    int size = 0;             // texels along an edge
    std::vector<Rgb> texels;  // faces +x, -x, +y, -y, +z, -z, each row by row
    const Rgb& at(int face, int x, int y) const { return texels[(size_t(face) * size + y) * size + x]; }
};

// What points out of each face, along its rows and down them [OpenGL 4.6, table 8.19].
struct CubeFace {
    Vec3 out, right, down;
};
extern const CubeFace cubeFaces[6];

// The direction of point (s, t) of a face, -1 to 1, s to the right and t down, as OpenGL and Direct3D have
// it; not unit.
Vec3 cubeDirection(int face, double s, double t);
// Light along a direction; texels below 0 count as 0. The zero vector gives 0.
Rgb sampleCube(const CubeMap& cube, Vec3 direction);

}  // namespace reference
