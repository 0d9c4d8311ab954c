// Shadow maps of other forms than one plain depth map (docs/guide/shading.md, "Forms of shadow map"): the
// definitions, in double precision, texel by texel.
#pragma once

#include "reference/shade_passes.h"

namespace reference {

// --- cubes ---

// Six faces of size * size texels, +x -x +y -y +z -z. Depth along the axis of a face by `decoding`, or,
// radial, decoding.range * depth from the light.
struct CubeShadowMap {
    int size = 0;
    std::vector<double> depth;  // one face after the other, row by row
    bool radial = false;
    DepthDecoding decoding;
    // Where the light sees something first along a direction of any length, as a multiple of it: the texel
    // that it meets, and bilinear (of 1 / distance along the axis of its face, or of the distance).
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
