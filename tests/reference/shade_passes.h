// The images that the shading pass makes itself when its caller has none (docs/guide/shading.md, "Blurred
// normals", "Wide shadow"): the definitions, in double precision, pixel by pixel.
#pragma once

#include <optional>

#include "reference/shade.h"

namespace reference {

// --- normals blurred on screen ---

struct SurfacePixels {
    int width = 0, height = 0;
    std::vector<Vec3> normals, positions;
    std::vector<int> ids;       // 0: background
    std::vector<double> radii;  // length, by id
};

// Per pixel with an id; none where the pixel's normal or position is NaN or Inf. `doubtful`, if given, is set
// for pixels whose result depends on a decision (the pixels between taps, the begin of an edge) that rounding
// could change.
std::vector<std::optional<Vec3>> blurredNormals(const SurfacePixels& surface,
                                                std::vector<bool>* doubtful = nullptr);

// --- normals from a map ---

struct NormalLevel {
    int width = 0, height = 0;
    std::vector<Vec3> texels;
};
Vec3 sampleRepeated(const NormalLevel& level, double u, double v);
// log2 of the longer side of a pixel's footprint, in texels of a map of that size.
double footprintLevel(const std::array<double, 4>& gradient, int width, int height);
Vec3 trilinear(const std::vector<NormalLevel>& levels, double u, double v, double level);
// `side`: -1 turns the bitangent round.
Vec3 fromTangentSpace(Vec3 texel, Vec3 tangent, Vec3 normal, double side);

// --- the wide shadow ---

// A light by its axes: texel (i, j) looks along forward (parallel) or along forward + right (u - 1/2) extent
// + ...
struct ShadowView {
    Vec3 right, down, forward;  // unit, orthogonal
    Vec3 origin;                // parallel: any point whose u, v are 1/2 and z is 0; perspective: the light
    double extent = 1;          // length that the map spans a side; perspective: at distance 1
    DepthDecoding decoding;
};
struct WideFilterParams {
    double width = 8, bias = 0.5, softness = 0.25, coneSlope = 0.5;
    int maxTexels = 48;
};
double wideShadow(const ShadowMap& map, const ShadowView& view, Vec3 position, Vec3 normal,
                  const WideFilterParams& params);

// --- the sharp shadow (section 6) ---

double sharpShadow(const ShadowMap& map, const ShadowView& view, Vec3 position, Vec3 normal);

// --- cubes ---

// Six faces of size * size texels, +x -x +y -y +z -z. Depth along the axis of a face by `decoding`, or,
// radial, decoding.range * depth from the light.
struct CubeShadowMap {
    int size = 0;
    std::vector<double> depth;  // one face after the other, row by row
    bool radial = false;
    DepthDecoding decoding;
    // The nearest surface along a direction of any length, as a multiple of it: from the texel that it meets,
    // and bilinear (of 1 / distance along the axis of its face, or of the distance).
    double nearestReach(Vec3 direction) const;
    double bilinearReach(Vec3 direction) const;
};
// The direction through the centre of texel (column, row) of a face, which may lie beyond it; 1 along its
// axis.
Vec3 shadowCubeDirection(int face, double column, double row, int size);
int shadowCubeFace(Vec3 direction);

// point: seen from the light, in the space of the cube, moved inwards already. filterRadius in UV of a face.
double cubeThickness(const CubeShadowMap& map, Vec3 point, const std::vector<Vec2>& taps,
                     double filterRadius);
double cubeWideShadow(const CubeShadowMap& map, Vec3 point, Vec3 normal, const WideFilterParams& params);

// --- cascades ---

// The finest of these matrices' maps that holds a point with all within a radius (length) of it, -1 if none
// does.
int cascadeOf(const std::vector<Matrix4>& worldToShadow, Vec3 position, double radius);
// How far u (row 0) or v (row 1) goes per length.
double uvPerLength(const Matrix4& worldToShadow, int row);

// --- what may be filtered beforehand ---

struct MomentParams {
    double minDeviation = 0.25;  // length
    double bleeding = 0.1;
};
// `second`: means of z squared, beside the map's means of z.
double momentShadow(const ShadowMap& map, const std::vector<double>& second, const ShadowView& view,
                    Vec3 position, Vec3 normal, const WideFilterParams& params, const MomentParams& moments);
// The map holds means of exp(c z).
double exponentialShadow(const ShadowMap& map, double c, const ShadowView& view, Vec3 position, Vec3 normal,
                         const WideFilterParams& params);
// Bilinear exponentials, then their logarithms.
double exponentialThickness(const ShadowMap& map, double c, Vec3 uvDepth, const std::vector<Vec2>& taps,
                            double filterRadius, const DepthDecoding& decoding);

}  // namespace reference
