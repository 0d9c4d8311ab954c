// Surfaces whose curvature is known in closed form, and triangle meshes of them of several qualities.
#pragma once

#include <functional>

#include "reference/curvature.h"

namespace reference {

struct SurfacePoint {
    Vec3 position, normal;  // normal outward (up for the plane and the saddle)
    PrincipalCurvatures curvature;
};

// A surface over a rectangle of parameters.
struct Surface {
    std::function<SurfacePoint(double, double)> at;
    double uBegin, uEnd, vBegin, vEnd;
    bool wrapsU = false, wrapsV = false;  // the end of the range is its beginning again
};

// Lengths as given; patches where a closed mesh would need a pole.
Surface planeSurface(double side);
Surface sphereSurface(double radius);  // a belt of +-60 degrees of latitude
Surface cylinderSurface(double radius, double height);
Surface coneSurface(double halfAngle, double slantBegin, double slantEnd);  // slant: distance from the apex
Surface torusSurface(double majorRadius, double minorRadius);
Surface ellipsoidSurface(double a, double b, double c);  // semi-axes; a belt of +-60 degrees
Surface monkeySaddle(double side);                       // z = x³ - 3 x y² over a square round the origin
// Half of it and some more, by a map that keeps angles: triangulations of scattered points stay what they
// are.
Surface ellipsoidCap(double a, double b, double c);

SurfacePoint ellipsoidPoint(Vec3 onUnitSphere, double a, double b, double c);

struct AnalyticMesh {
    Mesh mesh;
    std::vector<SurfacePoint> truth;  // per vertex
};

enum class Tessellation {
    regular,         // a grid, every cell cut along the same diagonal
    irregular,       // vertices moved by up to 80 % of half a cell, diagonals at random
    valenceVarying,  // diagonals alternate: every other vertex has 8 neighbours, the rest 4
};

// A grid of columns x rows cells; UVs are the parameters scaled to [0, 1].
AnalyticMesh tessellate(const Surface& surface, int columns, int rows, Tessellation kind, uint32_t seed = 1);
// An icosahedron split `splits` times, on an ellipsoid (a sphere when the semi-axes are equal): closed, no
// UVs.
AnalyticMesh icosphere(double a, double b, double c, int splits);

// Moves every vertex by a Gaussian of `fraction` of its mean edge length in each direction, and estimates the
// normals from the moved mesh.
void addNoise(Mesh& mesh, double fraction, uint32_t seed);

}  // namespace reference
