// Blurred normals from shading normals, on screen (docs/shading.md, "Blurred normals"): a separable mean over the surface
// within the material's diffusion radius, which stops at depth edges and at other materials.
//
// Along one axis, first x, then y, the taps k = 1..PEL_BLUR_TAPS to each side lie `step` pixels apart, so that the last one
// is about one radius away on the surface: step = ceil(radius / (PEL_BLUR_TAPS s)), s the distance to the nearer of the two
// neighbours. A tap's weight is (1 - d^2 / radius^2)^2, d its distance in space. The walk ends at the border, at another
// material, beyond the radius, and at a depth edge: a step more than PEL_BLUR_GAP times as long as the longest before it.
// Taps with a NaN or Inf are passed over.
//
// Inputs: shading normals, positions or depth, material ids. Output: (Nb, 1) per pixel of a material without normal map;
// NaN where the pixel's own normal or position is. One work-group: a run of tiles; one work-item: one pixel at a time
// (PEL_WIDTH 1). Launches: prepare_normals, blur_normals along x, blur_normals along y.
#include "lib/tiles.clh"
#include "shared/shade_passes.h"

// w: 1, or 0 where the normal or the position is no number.
__kernel __attribute__((reqd_work_group_size(PEL_PASS_GROUP, 1, 1))) void prepare_normals(
    __global const PelShadeFrame* frame, __global const uint* list, __global uchar* material, __global uchar* normal,
    __global uchar* position, __global uchar* depth, __global float4* normals, __global float4* positions) {
    const TileRun run = tileRun(frame, list);
    for (uint i = run.begin; i < run.end; ++i) {
        const uint2 origin = tileOrigin(frame, list, i);
        for (uint pixel = get_local_id(0); pixel < PEL_TILE_PIXELS; pixel += PEL_PASS_GROUP) {
            const uint x = origin.x + pixel % PEL_TILE_WIDTH, y = origin.y + pixel / PEL_TILE_WIDTH;
            if (x >= frame->width || y >= frame->height) continue;
            if (!hasMaterial(frame, loadIds(frame, material, x, y))) continue;
            const Vec3w n = loadNormal(PEL_FORMAT_NORMAL_SHADING,
                                       imageSpan(normal, &frame->images[PEL_IMAGE_NORMAL_SHADING], x, y));
            const Vec3w p = loadPosition(frame, position, depth, x, y);
            const size_t at = (size_t)y * frame->width + x;
            const bool valid = finite3(n) && finite3(p);
            normals[at] = valid ? (float4)(n.x, n.y, n.z, 1.0f) : (float4)(0.0f);
            positions[at] = valid ? (float4)(p.x, p.y, p.z, 0.0f) : (float4)(0.0f);
        }
    }
}

typedef struct Field {
    __global const PelShadeFrame* frame;
    __global uchar* material;
    __global const float4 *normals, *positions;
    uint id;
} Field;

// Whether (x, y) is a pixel of the material that is being blurred.
static inline bool sameMaterial(const Field* f, int x, int y) {
    return x >= 0 && y >= 0 && x < (int)f->frame->width && y < (int)f->frame->height &&
           loadIds(f->frame, f->material, (uint)x, (uint)y) == f->id;
}

// Distance to a direct neighbour; Inf where there is none to compare with.
static inline float neighbourDistance(const Field* f, int x, int y, float4 p) {
    if (!sameMaterial(f, x, y)) return INFINITY;
    const size_t at = (size_t)y * f->frame->width + (size_t)x;
    return f->normals[at].w == 0.0f ? INFINITY : length(f->positions[at] - p);
}

// The mean along (dx, dy), one of them 1, the other 0.
static inline float4 blurAlong(const Field* f, int x, int y, int dx, int dy, float radius) {
    const size_t centre = (size_t)y * f->frame->width + (size_t)x;
    const float4 p = f->positions[centre];
    float4 sum = (float4)(f->normals[centre].xyz, 1.0f);
    const float s = fmin(neighbourDistance(f, x - dx, y - dy, p), neighbourDistance(f, x + dx, y + dy, p));
    if (!(s < INFINITY)) return sum;
    const float taps = ceil(radius / (s * PEL_BLUR_TAPS)); // Inf or NaN where two pixels lie in one place
    const int step = (int)fmin(fmax(taps, 1.0f), (float)PEL_BLUR_STEP_MAX);
    const float perRadius2 = 1.0f / (radius * radius);
    for (int side = -1; side <= 1; side += 2) {
        float4 before = p;
        float longest = (float)step * s;
        for (int k = 1; k <= PEL_BLUR_TAPS; ++k) {
            const int qx = x + side * k * step * dx, qy = y + side * k * step * dy;
            if (!sameMaterial(f, qx, qy)) break;
            const size_t at = (size_t)qy * f->frame->width + (size_t)qx;
            const float4 n = f->normals[at];
            if (n.w == 0.0f) continue;
            const float4 q = f->positions[at];
            const float gap = length(q - before);
            const float d2 = dot(q - p, q - p) * perRadius2;
            if (gap > PEL_BLUR_GAP * longest || d2 >= 1.0f) break;
            const float weight = (1.0f - d2) * (1.0f - d2);
            sum += weight * (float4)(n.xyz, 1.0f);
            longest = fmax(longest, gap);
            before = q;
        }
    }
    return (float4)(sum.xyz / sum.w, 1.0f);
}

// `from` and `to` differ; along y `to` may hold the unblurred normals.
__kernel __attribute__((reqd_work_group_size(PEL_PASS_GROUP, 1, 1))) void blur_normals(
    __global const PelShadeFrame* frame, __global const PelShadeMaterial* materials, __global const uint* list,
    __global uchar* material, __global const float4* from, __global const float4* positions, __global float4* to,
    uint alongY) {
    const TileRun run = tileRun(frame, list);
    for (uint i = run.begin; i < run.end; ++i) {
        const uint2 origin = tileOrigin(frame, list, i);
        for (uint pixel = get_local_id(0); pixel < PEL_TILE_PIXELS; pixel += PEL_PASS_GROUP) {
            const uint x = origin.x + pixel % PEL_TILE_WIDTH, y = origin.y + pixel / PEL_TILE_WIDTH;
            if (x >= frame->width || y >= frame->height) continue;
            const uint id = loadIds(frame, material, x, y);
            if (!hasMaterial(frame, id) || materials[id].hasNormalMap) continue;
            const Field field = {frame, material, from, positions, id};
            const size_t at = (size_t)y * frame->width + x;
            float4 n = from[at];
            if (n.w != 0.0f) n = blurAlong(&field, (int)x, (int)y, !alongY, (int)alongY, materials[id].diffusionRadius);
            if (alongY) {
                const float length2 = dot(n.xyz, n.xyz);
                if (n.w == 0.0f)
                    n = (float4)(NAN); // the shading pass makes it the invalid colour
                else if (length2 > 1e-12f)
                    n = (float4)(n.xyz / sqrt(length2), 1.0f);
                else
                    n = to[at];
            }
            to[at] = n;
        }
    }
}
