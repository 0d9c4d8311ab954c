// Shading one pixel (section 6 of the mathematics), term by term, in double precision.
//
// Inputs must be valid: unit vectors, w in [0, 1], radii above 0. Results for NaN, zero vectors and the like
// are not defined, except where a comment says so.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "reference/vec.h"

namespace reference {

// --- cubes ---

// An irradiance cube map: bilinear between the texels' centres of a face; on edges and corners of the cube
// the mean of the faces that meet there.
struct CubeMap {
    int size = 0;             // texels along an edge
    std::vector<Rgb> texels;  // faces +x, -x, +y, -y, +z, -z, each row by row
    const Rgb& at(int face, int x, int y) const { return texels[(size_t(face) * size + y) * size + x]; }
};

// The axes of each face: outwards, along its rows and down its columns [OpenGL 4.6, table 8.19].
struct CubeFace {
    Vec3 out, right, down;
};
extern const CubeFace cubeFaces[6];

// The direction of point (s, t) of a face, -1 to 1, s to the right and t down, as OpenGL and Direct3D have
// it; not unit.
Vec3 cubeDirection(int face, double s, double t);
// Light along a direction; texels below 0 count as 0. The zero vector gives 0.
Rgb sampleCube(const CubeMap& cube, Vec3 direction);

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
// Bilinear between the texels' centres, clamped.
double sampleMap(const ShadowMap& map, double u, double v);

// From depths in the map to lengths along the light.
struct DepthDecoding {
    bool perspective = false;
    double range = 1;     // parallel: length that depths 0 to 1 span
    double a = 0, b = 1;  // perspective: length = 1/(a depth + b)
    double distance(double depth) const { return perspective ? 1 / (a * depth + b) : range * depth; }
};
using Matrix4 = std::array<std::array<double, 4>, 4>;  // rows; multiplies columns
// (u, v, depth) of a position moved inwards along the normal by offset.
Vec3 shadowCoordinates(const Matrix4& worldToShadow, Vec3 position, Vec3 normal, double offset);

// Mean over taps, given in the unit disk, of max0(z - z_tap). A tap that is 0 long from the light takes part
// as any.
double thickness(const ShadowMap& map, Vec3 uvDepth, const std::vector<Vec2>& taps, double filterRadius,
                 const DepthDecoding& decoding);
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

// --- one pixel, one material, any number of lights ---

struct ScatterTable {
    Table table;                   // D(u, r) or T(w, width)
    double least = 1, most = 100;  // radii of curvature, or penumbra widths; length
    double diffusionRadius = 2.7;  // length
    double sharpening = 10;        // of a shadow table
};

struct Material {
    Rgb albedo{1, 1, 1};
    double diffusionRadius = 2.7;  // length
    Rgb normalBlend{1, 0.3, 0};
    double shadowFilterWidth = 8;  // length
    Rgb deepScatterColor;
    double deepScatterRadius = 6;  // length
    double specular = 0, roughness = 0.3, f0 = 0.028;
    bool ggx = false;
    double roughness2 = 0.15, lobeMix = 0.15;
    double deepScatterAmbient = 0;
    const ScatterTable* curvatureLut = nullptr;  // none: no scattering at the terminator, delta = 0
    const ScatterTable* shadowLut = nullptr;     // none: the wide shadow as it is, in all channels
};

struct Pixel {
    Vec3 geometric, shading, blurred, toViewer;
    double curvature = 0;  // 1/length
    double ambientOcclusion = 1;
    Rgb indirect;               // irradiance / pi beside the lights and the ambient
    bool hasThickness = false;  // of its own, from an image
    double thickness = 0;       // length
};

// A light as this pixel sees it.
struct PixelLight {
    Vec3 toLight;
    Rgb color;  // falloff included
    double wideShadow = 1;
    bool hasThickness = false;
    double thickness = 0;  // length
};

struct Shaded {
    Rgb scattered;  // albedo * light * direct * shadow
    Rgb ambient, deepScatter, specular;
    Rgb sum() const { return scattered + ambient + deepScatter + specular; }
};
// Terms of one light. Specular light is multiplied by the sharpened shadow (of the shadow table's sharpening;
// by the wide shadow without a table).
Shaded shadeLight(const Material& material, const Pixel& pixel, const PixelLight& light);
Shaded shadePixel(const Material& material, const Pixel& pixel, const std::vector<PixelLight>& lights,
                  const Ambient& ambient);

// Light of a point or spot at a place: color / distance², nothing beyond range (0: no limit); a spot's cone
// fades by a smoothstep of the cosine to its axis.
struct Lamp {
    Vec3 position;
    Rgb color;
    double range = 0;  // length
    bool spot = false;
    Vec3 axis;  // unit, away from the lamp
    double cosInner = 1, cosOuter = 0;
};
PixelLight lampAt(const Lamp& lamp, Vec3 position);

}  // namespace reference
