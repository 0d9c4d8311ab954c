// Converts the host's image of the surroundings to the levels that shading reads (shared/environment.h;
// section 6 of the mathematics, "environment").
//
// environment_reduce: the image, equirectangular or six faces, in at most as many texels as are needed.
// environment_texels: its mean over each texel of a cube. environment_halve: one mip of it from the finer
// one. environment_level: nodes of one level, or of irradiance, by samples of the lobe that read the mip
// whose texels are as large as a sample's share of the sphere [Krivanek, Colbert, Real-time Shading with
// Filtered Importance Sampling, EGSR 2008]. Means are over solid angle, so that small lamps keep their light.
//
// One work-item: one texel or node, PEL_WIDTH 1. Variants: PEL_FORMAT_ENVIRONMENT, PEL_GROUP.
#include "lib/image/cube_map.clh"
#include "shared/environment.h"

// Which texels of a row of `from` one of `to` texels covers, and by how much of itself times `from`.
typedef struct Cover {
    uint begin, end, from, to;
} Cover;
static inline Cover coverOf(uint x, uint from, uint to) {
    return (Cover){x * from, (x + 1) * from, from, to};
}
static inline uint firstOf(const Cover* c) {
    return c->begin / c->to;
}
static inline uint endOf(const Cover* c) {
    return (c->end - 1) / c->to + 1;
}
static inline float overlap(const Cover* c, uint i) {
    return (float)(min(c->end, (i + 1) * c->to) - max(c->begin, i * c->to));
}

// `image`: width x height texels, or faces of `width` texels along an edge, `step` bytes apart; `least`: the
// same of `texels`, whose faces lie one below the other.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void environment_reduce(
    __global const uchar* restrict image, ulong offset, ulong step, ulong row, ulong plane, uint pixel,
    uint width, uint height, uint leastWidth, uint leastHeight, __global float4* restrict texels) {
    const uint x = get_global_id(0), line = get_global_id(1);
    if (x >= leastWidth || line >= leastHeight * (step ? 6 : 1)) return;
    image += offset + line / leastHeight * step;
    const Cover across = coverOf(x, width, leastWidth),
                down = coverOf(line % leastHeight, height, leastHeight);
    float3 sum = (float3)(0.0f);
    float whole = 0.0f;
    for (uint j = firstOf(&down); j < endOf(&down); ++j) {
        const float solid = step ? 1.0f : sinpi(((float)j + 0.5f) / (float)height);
        for (uint i = firstOf(&across); i < endOf(&across); ++i) {
            __global const uchar* p = image + (ulong)j * row + (ulong)i * pixel;
            const float3 value = (float3)(pixelComponent(PEL_FORMAT_ENVIRONMENT, p, plane, 0),
                                          pixelComponent(PEL_FORMAT_ENVIRONMENT, p, plane, 1),
                                          pixelComponent(PEL_FORMAT_ENVIRONMENT, p, plane, 2));
            const float weight = solid * overlap(&down, j) * overlap(&across, i);
            sum += weight * select((float3)(0.0f), min(value, PEL_ENVIRONMENT_LARGEST),
                                   (value > 0.0f) & isfinite(value));
            whole += weight;
        }
    }
    texels[line * leastWidth + x] = (float4)(sum / whole, 0.0f);
}

// The mean of the reduced image over a sample of about `angle` x `angle` radians round a direction. Samples
// share each texel among them, wherever they lie, so that none is left out or counted twice.
static inline float4 surroundingsAlong(__global const float4* image, bool faces, uint width, uint height,
                                       float3 d, float angle) {
    float u, v, wide, high;  // in texels
    if (faces) {
        const CubePoint p = cubePoint(vec3(d.x, d.y, d.z));
        const float r2 = fma(p.u, p.u, fma(p.v, p.v, 1.0f));
        image += (uint)p.face * width * width;
        u = fma(p.u, 0.5f, 0.5f) * (float)width, v = fma(p.v, 0.5f, 0.5f) * (float)width;
        wide = high = angle * 0.5f * (float)width * sqrt(r2 * sqrt(r2));
    } else {
        // +y is the upper edge and +z the middle of the row, as in OpenEXR's latitude-longitude maps.
        const float length = sqrt(dot(d, d));
        u = (0.5f - 0.5f * M_1_PI_F * atan2(d.x, d.z)) * (float)width;
        v = M_1_PI_F * acos(clamp(d.y / length, -1.0f, 1.0f)) * (float)height;
        wide = angle * 0.5f * M_1_PI_F * (float)width * length / sqrt(fma(d.x, d.x, d.z * d.z));
        high = angle * M_1_PI_F * (float)height;
    }
    wide = min(wide, (float)width), high = min(high, (float)height);  // Inf at the poles
    const float left = u - 0.5f * wide, right = u + 0.5f * wide, up = v - 0.5f * high, down = v + 0.5f * high;
    const int columns = (int)width, rows = (int)height;
    float4 sum = (float4)(0.0f);
    float whole = 0.0f;
    for (float y = floor(up); y < down; y += 1.0f) {
        const int j = clamp((int)y, 0, rows - 1);
        for (float x = floor(left); x < right; x += 1.0f) {
            const int i = (int)x, wrapped = faces ? clamp(i, 0, columns - 1) : (i + columns) % columns;
            const float weight = (min(down, y + 1.0f) - max(up, y)) * (min(right, x + 1.0f) - max(left, x));
            sum += weight * image[j * columns + wrapped];
            whole += weight;
        }
    }
    return sum / whole;
}

// Texels before a mip, in all finer ones.
static inline uint mipStart(uint mip) {
    uint start = 0;
    for (uint m = 0; m < mip; ++m) start += 6 * (PEL_ENVIRONMENT_SIZE >> m) * (PEL_ENVIRONMENT_SIZE >> m);
    return start;
}

// The solid angle of a small square at (u, v) of a face, over its area.
static inline float solidAt(float u, float v) {
    const float r2 = fma(u, u, fma(v, v, 1.0f));
    return 1.0f / (r2 * sqrt(r2));
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void environment_texels(
    __global const float4* restrict image, int faces, uint width, uint height, float4 axisX, float4 axisY,
    float4 axisZ, __global float4* restrict texels) {
    const uint size = PEL_ENVIRONMENT_SIZE, x = get_global_id(0), line = get_global_id(1);
    if (x >= size || line >= 6 * size) return;
    // Texels of the image along an edge of the cube, about. Three samples lie along two of them where texels
    // of the cube are largest.
    const uint across = faces ? width : (height + 1) / 2;
    const uint samples = (2 * across + size - 1) / size;
    const float perSide = 2.0f / (float)(size * samples);
    float4 sum = (float4)(0.0f);
    float whole = 0.0f;
    for (uint i = 0; i < samples * samples; ++i) {
        const float u = ((float)(x * samples + i % samples) + 0.5f) * perSide - 1.0f;
        const float v = ((float)(line % size * samples + i / samples) + 0.5f) * perSide - 1.0f;
        const float solid = solidAt(u, v);
        const Vec3w way = cubeVector((int)(line / size), u, v, 1.0f);
        const float3 d = (float3)(way.x, way.y, way.z);
        sum += solid * surroundingsAlong(image, faces, width, height,
                                         (float3)(dot(axisX.xyz, d), dot(axisY.xyz, d), dot(axisZ.xyz, d)),
                                         perSide * sqrt(solid));
        whole += solid;
    }
    texels[line * size + x] = sum / whole;
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void environment_halve(
    uint mip, __global float4* restrict texels) {
    const uint size = PEL_ENVIRONMENT_SIZE >> mip, x = get_global_id(0), line = get_global_id(1);
    if (x >= size || line >= 6 * size) return;
    __global const float4* from = texels + mipStart(mip - 1) + 4 * line * size + 2 * x;
    float4 sum = (float4)(0.0f);
    float whole = 0.0f;
    for (uint k = 0; k < 4; ++k) {
        const float u = ((float)(4 * x + 2 * (k % 2)) + 1.0f) / (float)(2 * size) - 1.0f;
        const float v = ((float)(4 * (line % size) + 2 * (k / 2)) + 1.0f) / (float)(2 * size) - 1.0f;
        const float solid = solidAt(u, v);
        sum += solid * from[k / 2 * 2 * size + k % 2];
        whole += solid;
    }
    texels[mipStart(mip) + line * size + x] = sum / whole;
}

// Bilinear in one face of a mip.
static inline float4 texelsAt(__global const float4* texels, uint mip, const CubePoint p) {
    const uint size = PEL_ENVIRONMENT_SIZE >> mip;
    const float x = clamp(fma(p.u, 0.5f * (float)size, 0.5f * (float)size - 0.5f), 0.0f, (float)(size - 1));
    const float y = clamp(fma(p.v, 0.5f * (float)size, 0.5f * (float)size - 0.5f), 0.0f, (float)(size - 1));
    const uint i = (uint)x, j = (uint)y, i1 = min(i + 1, size - 1), j1 = min(j + 1, size - 1);
    __global const float4* face = texels + mipStart(mip) + (uint)p.face * size * size;
    const float4 upper = mix(face[j * size + i], face[j * size + i1], x - (float)i);
    const float4 lower = mix(face[j1 * size + i], face[j1 * size + i1], x - (float)i);
    return mix(upper, lower, y - (float)j);
}

// The direction of a work-item's node, and where it is stored.
static inline bool nodeOf(uint size, Vec3w* n, size_t* at) {
    const uint i = get_global_id(0), across = size + 2, face = get_global_id(1) / across,
               j = get_global_id(1) % across;
    if (i >= across || face >= 6) return false;
    const float u = i == 0 ? -1.0f : i > size ? 1.0f : ((float)(2 * i) - 1.0f) / (float)size - 1.0f;
    const float v = j == 0 ? -1.0f : j > size ? 1.0f : ((float)(2 * j) - 1.0f) / (float)size - 1.0f;
    *n = normalize3(cubeVector((int)face, u, v, 1.0f));
    *at = (face * across + j) * across + i;
    return true;
}

static inline void storeNode(__global float* nodes, size_t at, uint size, float4 value) {
    const size_t plane = (size_t)6 * (size + 2) * (size + 2);
    nodes[at] = value.x;
    nodes[at + plane] = value.y;
    nodes[at + 2 * plane] = value.z;
}

// Irradiance / pi: the sum over the texels of a mip.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void environment_irradiance(
    __global const float4* restrict texels, uint size, uint mip, __global float* restrict nodes) {
    Vec3w n;
    size_t at;
    if (!nodeOf(size, &n, &at)) return;
    const uint edge = PEL_ENVIRONMENT_SIZE >> mip;
    float4 sum = (float4)(0.0f);
    float whole = 0.0f;
    for (uint k = 0; k < 6 * edge * edge; ++k) {
        const float u = ((float)(2 * (k % edge)) + 1.0f) / (float)edge - 1.0f;
        const float v = ((float)(2 * (k / edge % edge)) + 1.0f) / (float)edge - 1.0f;
        const Vec3w d = cubeVector((int)(k / (edge * edge)), u, v, 1.0f);
        const float r2 = fma(u, u, fma(v, v, 1.0f));
        const float weight = max(dot3(n, d), 0.0f) / (r2 * r2);  // cosine times solid angle
        sum += weight * texels[mipStart(mip) + k];
        whole += weight;
    }
    storeNode(nodes, at, size, sum / whole);
}

// `lobes`, from `begin` to `end`: directions by their components across the normal and along it, which is
// their weight, and the mip that they read. `first`: floats of the levels before.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void environment_level(
    __global const float4* restrict texels, __global const float4* restrict lobes, uint begin, uint end,
    uint size, uint first, __global float* restrict nodes) {
    Vec3w n;
    size_t at;
    if (!nodeOf(size, &n, &at)) return;
    Vec3w right, down;
    cubeTangents(n, &right, &down);
    float4 sum = (float4)(0.0f);
    float weights = 0.0f;
    for (uint k = begin; k < end; ++k) {
        const float4 s = lobes[k];
        const CubePoint p = cubePoint(vec3(fma(right.x, s.x, fma(down.x, s.y, n.x * s.z)),
                                           fma(right.y, s.x, fma(down.y, s.y, n.y * s.z)),
                                           fma(right.z, s.x, fma(down.z, s.y, n.z * s.z))));
        const uint finer = (uint)s.w;
        sum += s.z * mix(texelsAt(texels, finer, p), texelsAt(texels, finer + 1, p), s.w - (float)finer);
        weights += s.z;
    }
    storeNode(nodes + first, at, size, sum / weights);
}

// The shares of both models (shared/environment.h), by half vectors sampled in proportion to the
// distribution. `samples`, from `begin` to `end`: the cosine of half a turn, and the squared tangent of the
// half vector over that of the roughness, of Beckmann's distribution and of GGX.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void environment_shares(
    __global const float4* restrict samples, uint begin, uint end, uint first,
    __global float* restrict nodes) {
    const uint i = get_global_id(0), j = get_global_id(1) % PEL_SHARE_NODES,
               ggx = get_global_id(1) / PEL_SHARE_NODES;
    if (i >= PEL_SHARE_NODES || ggx > 1) return;
    const float nv = max((float)i / (float)(PEL_SHARE_NODES - 1), 0.02f), across = sqrt(1.0f - nv * nv);
    const float root = (float)j / (float)(PEL_SHARE_NODES - 1), a = max(root * root, 1e-3f), a2 = a * a;
    float ofF0 = 0.0f, rest = 0.0f;
    for (uint k = begin; k < end; ++k) {
        const float4 s = samples[k];
        const float tangent2 = a2 * (ggx ? s.z : s.y);
        const float nh = rsqrt(1.0f + tangent2), sine = sqrt(max(1.0f - nh * nh, 0.0f));
        const float vh = fma(nh, nv, sine * across * s.x);
        const float nl = fma(2.0f * vh, nh, -nv);
        if (!(nl > 0.0f && vh > 0.0f)) continue;
        const float masking = nl * sqrt(fma(nv * nv, 1.0f - a2, a2)) + nv * sqrt(fma(nl * nl, 1.0f - a2, a2));
        const float weight = ggx ? 2.0f * nl * vh / (masking * nh) : nl / (vh * nh);
        const float base = 1.0f - vh, base5 = base * base * base * base * base;
        ofF0 = fma(weight, 1.0f - base5, ofF0);
        rest = fma(weight, base5, rest);
    }
    const uint at = first + ggx * PEL_SHARE_FLOATS + j * PEL_SHARE_NODES + i;
    nodes[at] = ofF0 / (float)(end - begin);
    nodes[at + PEL_SHARE_NODES * PEL_SHARE_NODES] = rest / (float)(end - begin);
}
