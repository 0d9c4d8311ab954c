// Blurred normals from a tangent-space normal map (section 6, "blurred-normal mip"): trilinear, at the level
// whose texels are as long as the diffusion radius, but never sharper than the pixel's own level of detail.
//
// Inputs: UV, their gradients (or none), tangents, geometric normals, ids, one material's map. Output: planes
// of Nb for pixels of that material, and the geometric normal if PelNormalMap.fallback is set; NaN where an
// input is. One work-group: a run of tiles; one work-item: one pixel at a time (PEL_WIDTH 1).
// PEL_NORMAL_SLOT: the slot of the geometric normals.
#include "lib/image/planes.clh"
#include "lib/shading/normal_map.clh"
#include "lib/shading/tiles.clh"

#define PEL_AT(buffer, slot) imageSpan(buffer, &frame->images[slot], x, y)

static inline Vec3w mappedNormal(__global const PelShadeFrame* frame, __global const PelNormalMap* chain,
                                 __global uchar* map, __global uchar* uv, __global uchar* gradient,
                                 __global uchar* tangent, Vec3w ng, uint x, uint y) {
    const Span uvSpan = PEL_AT(uv, PEL_IMAGE_UV), tangentSpan = PEL_AT(tangent, PEL_IMAGE_TANGENT);
    const float u = gatherComponent(PEL_FORMAT_UV, uvSpan, 0), v = gatherComponent(PEL_FORMAT_UV, uvSpan, 1);
    const Vec3w t = loadNormal(PEL_FORMAT_TANGENT, tangentSpan);
    float side = 1.0f;
    if (PEL_TANGENT_COMPONENTS > 3) {
        const float w = gatherComponent(PEL_FORMAT_TANGENT, tangentSpan, 3);
        side = w < (PEL_TANGENT_UNORM ? 0.5f : 0.0f) ? -1.0f : 1.0f;
    }
    bool valid = finite3(ng) && finite3(t) && finitew(u) && finitew(v);
    float level = chain->baseLevel;
    if (PEL_FORMAT_UV_GRADIENT) {
        const Span span = PEL_AT(gradient, PEL_IMAGE_UV_GRADIENT);
        const float4 g = (float4)(gatherComponent(PEL_FORMAT_UV_GRADIENT, span, 0),
                                  gatherComponent(PEL_FORMAT_UV_GRADIENT, span, 1),
                                  gatherComponent(PEL_FORMAT_UV_GRADIENT, span, 2),
                                  gatherComponent(PEL_FORMAT_UV_GRADIENT, span, 3));
        valid = valid && finitew(g.x) && finitew(g.y) && finitew(g.z) && finitew(g.w);
        if (valid)
            level =
                fmax(level, footprintLevel(g, (float)chain->levels[0].width, (float)chain->levels[0].height));
    }
    if (!valid) return vec3(NAN, NAN, NAN);
    const float3 m = sampleNormalMap(PEL_FORMAT_NORMAL_MAP, map, chain, u, v, level);
    const Vec3w b = scale3(cross3(ng, t), side);
    return normalize3(add3(add3(scale3(t, m.x), scale3(b, m.y)), scale3(ng, m.z)));
}

__kernel __attribute__((reqd_work_group_size(PEL_PASS_GROUP, 1, 1))) void normal_map(
    __global const PelShadeFrame* restrict frame, __global const PelShadeMaterial* restrict materials,
    __global const uint* restrict list, __global uchar* restrict material, __global uchar* restrict normal,
    __global uchar* restrict uv, __global uchar* restrict gradient, __global uchar* restrict tangent,
    __global const PelNormalMap* restrict chain, __global uchar* restrict map, __global float* restrict to,
    uint plane) {
    const TileRun run = tileRun(frame, list);
    for (uint i = run.begin; i < run.end; ++i) {
        const uint2 origin = tileOrigin(frame, list, i);
        for (uint pixel = get_local_id(0); pixel < PEL_TILE_PIXELS; pixel += PEL_PASS_GROUP) {
            const uint x = origin.x + pixel % PEL_TILE_WIDTH, y = origin.y + pixel / PEL_TILE_WIDTH;
            if (x >= frame->width || y >= frame->height) continue;
            const uint id = loadIds(frame, material, x, y);
            if (!hasMaterial(frame, id)) continue;
            const bool plain = chain->fallback && !materials[id].hasNormalMap;
            if (id != chain->material && !plain) continue;
            const Vec3w ng = loadNormal(PEL_FORMAT_NORMAL, PEL_AT(normal, PEL_NORMAL_SLOT));
            storePlanes(to, plane, scratchIndex(frame, x, y),
                        plain ? ng : mappedNormal(frame, chain, map, uv, gradient, tangent, ng, x, y), 1);
        }
    }
}
