// Shading one pixel (section 6 of the mathematics), term by term, in double precision.
//
// Inputs are taken as they are: unit vectors, w in [0, 1], radii above 0. What NaN, zero vectors and the like
// give is not defined here, except where a comment says so.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "reference/cube.h"
#include "reference/vec.h"

namespace reference {

// --- tables ---

struct Table {
    int width = 0, height = 0;
    std::vector<Rgb> texels;  // row-major, the first row at coordinate 0
};
// s, t in [0, 1] across the whole table, so that texel (x, y) lies at ((x + 1/2)/width, (y + 1/2)/height);
// clamped.
Rgb bilinear(const Table& table, double s, double t);

// f = diffusion radius of the LUT / of the material; lengths in one unit.
double radiusRatio(double lutRadius, double materialRadius);
// Row coordinates in [0, 1], not yet clamped; 0 where both ends of the axis are the same.
double curvatureRow(double curvature, double radiusMin, double radiusMax, double f);
double shadowRow(double cosine, double filterWidth, double widthMin, double widthMax,
                 double f);  // cosine = Ng.L
double blurredNormalMip(double mapSize, double diffusionRadius, double uvScale);

// --- diffuse terms ---

// delta: LUT - max0(Nb.L) per channel. blend: how far Nb replaces N where the light is level with Nb or
// beyond; (1, 0.3, 0) for skin.
Rgb direct(Rgb delta, Vec3 shading, Vec3 blurred, Vec3 toLight, Rgb blend = {1, 0.3, 0});
double sharpenedShadow(double wide, double sharpening);

// The normals at which R, G and B of the ambient light are taken.
std::array<Vec3, 3> ambientNormals(Vec3 shading, Vec3 blurred, Rgb blend = {1, 0.3, 0});
// Irradiance / pi: constant plus real orthonormal spherical harmonics in the order 1; y, z, x; xy, yz, 3z²-1,
// xz, x²-y². Negative sums are 0.
// A cube map's light is added to that.
struct Ambient {
    Rgb constant;
    std::array<Rgb, 9> harmonics{};
    const CubeMap* cube = nullptr;
};
Rgb irradiance(const Ambient& ambient, Vec3 normal);
Rgb ambientTerm(const Ambient& ambient, Vec3 shading, Vec3 blurred, Rgb blend = {1, 0.3, 0});

// --- light through thin parts ---

struct ShadowMap {
    int width = 0, height = 0;
    std::vector<double> depth;  // row = v
};
enum class MapFilter { nearest, bilinear };
double sampleMap(const ShadowMap& map, double u, double v,
                 MapFilter filter);  // texel centres as above, clamped

// From depths in the map to lengths along the light.
struct DepthDecoding {
    bool perspective = false;
    double range = 1;     // parallel: length that depths 0 to 1 span
    double a = 0, b = 1;  // perspective: length = 1/(a depth + b)
    double distance(double depth) const { return perspective ? 1 / (a * depth + b) : range * depth; }
};
// a, b of the projection matrix with depth = m22 + m23/z_view, z_view = handedness * distance (+1 left-, -1
// right-handed).
DepthDecoding perspectiveDecoding(double m22, double m23, double handedness);

using Matrix4 = std::array<std::array<double, 4>, 4>;  // rows; multiplies columns
// (u, v, depth) of a position moved inwards along the normal by offset.
Vec3 shadowCoordinates(const Matrix4& worldToShadow, Vec3 position, Vec3 normal, double offset);

// Mean over taps, given in the unit disk, of max0(z - z_tap). A tap that is 0 long from the light takes part
// as any.
double thickness(const ShadowMap& map, Vec3 uvDepth, const std::vector<Vec2>& taps, double filterRadius,
                 const DepthDecoding& decoding, MapFilter filter);
// The taps of the pixel in that column and row, turned by 2 pi (column a + row b), a and b the powers -1 and
// -2 of the plastic number 1.3247 (the R2 sequence), each rounded to 32 bits.
std::vector<Vec2> turnedTaps(std::vector<Vec2> taps, uint32_t column, uint32_t row);
double deepScatter(double thickness, double radius, Vec3 blurred, Vec3 toLight);

// --- specular ---

double schlick(double cosine, double f0);
// rho_s (N.L) max0(P F / |L+V|²), Beckmann's P evaluated directly; 0 where N.L <= 0 or L = -V.
double specular(Vec3 shading, Vec3 toLight, Vec3 toViewer, double roughness, double intensity,
                double f0 = 0.028);

// The same of two lobes of GGX with Smith's correlated masking, times pi: intensity (N.L) pi BRDF.
double ggxLobe(Vec3 shading, Vec3 toLight, Vec3 toViewer, double roughness);  // D G / (4 (N.L) (N.V))
double specularGgx(Vec3 shading, Vec3 toLight, Vec3 toViewer, double roughness, double roughness2,
                   double lobeMix, double intensity, double f0 = 0.028);

}  // namespace reference
