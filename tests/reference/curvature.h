// Mesh data (section 5 of the mathematics) in double precision: curvature per vertex, its smoothing, UV
// scale.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "reference/vec.h"

namespace reference {

using Triangle = std::array<int, 3>;
struct Mesh {
    std::vector<Vec3> positions;  // length
    std::vector<Vec3> normals;    // unit, as many as positions
    std::vector<Vec2> uvs;        // as many as positions, or none
    std::vector<Triangle> triangles;
};

// corner(a, b, c) for each corner a of every triangle, b and c after it.
template <class Corner>
void forCorners(const Mesh& mesh, const Corner& corner) {
    for (const Triangle& t : mesh.triangles)
        for (int i = 0; i < 3; ++i) corner(t[i], t[(i + 1) % 3], t[(i + 2) % 3]);
}

// (least + largest)/2 of |dn|/|dp| over the edges that meet in a vertex, 1/length. Edges of no length are
// skipped; a vertex without any other edge has 0.
std::vector<double> edgeCurvature(const Mesh& mesh);

// One pass replaces each vertex by the mean over the corners it has in triangles of the other two corners'
// values, so that an interior edge counts twice and a border edge once. A vertex in no triangle becomes 0.
std::vector<double> smoothed(const Mesh& mesh, std::vector<double> values, int passes);

// The heat equation on the surface until a point has spread over a standard deviation of `radius`
// (docs/guide/curvature.md, "Smoothing"; kernels/mesh/curvature_diffuse.cl): cotangents over Voronoi areas
// or, by area, those that are positive, over a third of the triangles' areas. `stages`: the library's number
// of stages, which limits how fast a vertex evens out. A triangle with a corner of at most this squared sine
// has no plane.
constexpr double flatTriangle = 1e-10;
struct RadiusSmoothing {
    double radius = 0;  // length
    double crease = 0;  // radians; 0: none stays
    int stages = 1;
    bool byArea = false;
};
std::vector<double> smoothedToRadius(const Mesh& mesh, std::vector<double> values,
                                     const RadiusSmoothing& how);

// Principal curvatures, first >= second, 1/length; positive where the surface curves away from the normal (a
// sphere with outward normals has two positive ones).
struct PrincipalCurvatures {
    double first = 0, second = 0;
    double mean() const { return 0.5 * (first + second); }
    double gaussian() const { return first * second; }
};

// Rusinkiewicz, Estimating Curvatures and Their Derivatives on Triangle Meshes, 3DPVT 2004: each triangle's
// second fundamental form by least squares on its three normal differences, turned into each corner's tangent
// plane and averaged with the part of the triangle's area that lies nearest to the corner. A triangle faces
// the side that the corner's normal is on, whatever its order. Triangles of no area are skipped; a vertex
// without any other has 0, 0.
std::vector<PrincipalCurvatures> tensorCurvature(const Mesh& mesh);

// Share of the triangle's area nearest to each of its corners.
std::array<double, 3> voronoiAreas(Vec3 a, Vec3 b, Vec3 c);

// Geometric mean over triangles of longest edge / longest UV edge, length per UV unit. Triangles where either
// is 0 or below 1e-6 of the mesh's largest of its kind are skipped. 0 when none is left.
double uvScale(const Mesh& mesh);

// Unit normals per vertex from the triangles around it, weighted by their angle there (Thuermer & Wuethrich
// 1998).
std::vector<Vec3> estimatedNormals(const Mesh& mesh);

// The two-ring fit of docs/mathematics.md, section 5 ("The quadric fit").
struct QuadricCurvature : PrincipalCurvatures {
    Vec3 firstDirection, secondDirection;  // unit, signs arbitrary
    Vec3 normal;                           // unit, of the fitted surface
    bool measured = false;                 // false: no neighbour at another place
    bool replaced = false;                 // the given normal was not believed
    bool low = false;                      // the points do not tell all terms apart even so
    bool border = false;
    int points = 0;  // distinct vertices that tell about this one
    // The smallest relative distance of a decision (replace the normal, leave a point out, fit once more)
    // from its threshold: if it is as small as float rounding, single precision may decide the other way.
    double margin = 1, lowMargin = 1;  // the latter of `low`, on which nothing else depends
};

// Positions and normals must be finite and the triangles consistently ordered, each with three corners of its
// own.
std::vector<QuadricCurvature> quadricCurvature(const Mesh& mesh);

// --- from a G-buffer: |fwidth N| / |fwidth P|, where fwidth never crosses an edge ---

struct ScreenImage {
    int width = 0, height = 0;
    std::vector<Vec3> normals, positions;  // row by row
    std::vector<uint32_t> ids;             // or none
};

// 1/length per pixel; 0 for pixels with id 0, with a normal or position that is not finite, or without a
// neighbour to compare with. A neighbour lies beyond an edge if its id differs or the step to it leans by
// more than asin(edge) out of the surface at either end.
std::vector<double> screenCurvature(const ScreenImage& image, double edge);

}  // namespace reference
