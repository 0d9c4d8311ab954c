// Triangulations of scattered points, as scanners, sculpting and remeshing leave them: neighbours of any
// number, small triangles beside large ones.
#pragma once

#include "reference/surfaces.h"

namespace reference {

// Triangles in the unit square, counter-clockwise.
struct FlatMesh {
    std::vector<Vec2> points;
    std::vector<Triangle> triangles;
};

std::vector<Vec2> uniformPoints(int count, uint32_t seed);

// The dual of the Voronoi diagram of the points, on a grid of 2^30 cells a side. No two may be equal.
FlatMesh delaunay(const std::vector<Vec2>& points);

FlatMesh flatGrid(int columns, int rows);
// Splits `part` of the triangles at their centroids, then `part` of what these became, and so on, `rounds`
// times.
FlatMesh poked(const FlatMesh& mesh, double part, int rounds, uint32_t seed);

// The unit square on a surface's rectangle of parameters; normals are the surface's, no UVs.
AnalyticMesh lifted(const FlatMesh& mesh, const Surface& surface);

// Set for vertices that are at most `rows` edges from a border, its own vertices included.
std::vector<bool> nearBorder(const Mesh& mesh, int rows);

}  // namespace reference
