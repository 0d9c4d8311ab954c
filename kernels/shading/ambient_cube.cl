// The nodes of an ambient cube map (lib/shading/ambient_cube.clh) from the host's six faces, in its layout.
//
// On an edge: the mean of both faces' outermost texels, taken where their mean direction is the node's. For a
// node at t along the edge that is at t (1 - 1 / 2n) on each face; at a corner it is the mean of three. Both
// are right to second order in the size of a texel, as is the bilinear interpolation. Negative values become
// 0; NaN and Inf are kept.
//
// One work-item: one node, PEL_WIDTH 1. Variants: PEL_FORMAT_CUBE, PEL_GROUP.
#include "lib/image/cube_map.clh"

typedef struct Faces {
    __global const uchar* first;
    ulong step, row, plane;  // bytes from face to face, from row to row, from plane to plane
    uint pixel;              // bytes from pixel to pixel
    uint size;               // texels along an edge
} Faces;

static inline float4 cubeTexel(const Faces* f, uint face, int x, int y) {
    __global const uchar* p = f->first + face * f->step + (ulong)y * f->row + (ulong)x * f->pixel;
    const float4 texel = (float4)(pixelComponent(PEL_FORMAT_CUBE, p, f->plane, 0),
                                  pixelComponent(PEL_FORMAT_CUBE, p, f->plane, 1),
                                  pixelComponent(PEL_FORMAT_CUBE, p, f->plane, 2), 0.0f);
    return select(texel, (float4)(0.0f), texel < 0.0f);
}

// Linear between the two texels next to coordinate s in [-1, 1]. A texel of weight 0 is not read, whatever it
// holds.
static inline float cubeNeighbours(uint size, float s, int* first, int* second) {
    const float at = clamp(fma(s, 0.5f * (float)size, 0.5f * (float)size - 0.5f), 0.0f, (float)(size - 1));
    *first = (int)at;
    const float fraction = at - (float)*first;
    *second = fraction > 0.0f ? *first + 1 : *first;
    return fraction;
}

static inline float4 cubeSample(const Faces* f, uint face, float s, float t) {
    int x0, x1, y0, y1;
    const float fx = cubeNeighbours(f->size, s, &x0, &x1), fy = cubeNeighbours(f->size, t, &y0, &y1);
    const float4 upper = mix(cubeTexel(f, face, x0, y0), cubeTexel(f, face, x1, y0), fx);
    const float4 lower = mix(cubeTexel(f, face, x0, y1), cubeTexel(f, face, x1, y1), fx);
    return mix(upper, lower, fy);
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void ambient_cube(
    __global const uchar* restrict image, ulong offset, ulong step, ulong row, ulong planeStep, uint pixel,
    uint size, __global float* restrict nodes) {
    const uint i = get_global_id(0), across = size + 2, face = get_global_id(1) / across,
               j = get_global_id(1) % across;
    if (i >= across || face >= 6) return;
    const Faces f = {image + offset, step, row, planeStep, pixel, size};
    const bool edgeS = i == 0 || i > size, edgeT = j == 0 || j > size;
    float4 value;
    if (!edgeS && !edgeT) {
        value = cubeTexel(&f, face, (int)i - 1, (int)j - 1);
    } else {
        const float perSize = 1.0f / (float)size, inward = 1.0f - 0.5f * perSize;
        const float s = edgeS ? (i ? 1.0f : -1.0f) : fma((float)(2 * i - 1), perSize, -1.0f) * inward;
        const float t = edgeT ? (j ? 1.0f : -1.0f) : fma((float)(2 * j - 1), perSize, -1.0f) * inward;
        const Vec3w d = cubeVector((int)face, s, t, 1.0f);
        float4 sum = (float4)(0.0f);
        float count = 0.0f;
        for (uint axis = 0; axis < 3; ++axis) {
            const float along = axis == 0 ? d.x : axis == 1 ? d.y : d.z;
            if (fabs(along) < 1.0f) continue;
            const uint other = 2 * axis + (along < 0.0f ? 1 : 0);
            const Vec3w at = cubeComponents((int)other, d);
            sum += cubeSample(&f, other, at.x, at.y);
            count += 1.0f;
        }
        value = sum / count;
    }
    const size_t at = (size_t)(face * across + j) * across + i, plane = (size_t)6 * across * across;
    nodes[at] = value.x;
    nodes[at + plane] = value.y;
    nodes[at + 2 * plane] = value.z;
}
