// Draws a mesh into its texture (docs/mathematics.md, section 7).
//
// texture_owner: 1 + the last triangle that holds the centre of each texel, borders included; one work-item
// is one triangle. texture_tiles: flags of tiles with such a texel; one work-item is one tile.
// texture_stretch: length of a texel along u and v. texture_edges, after it: how far the island of each texel
// extends along its row and column, into the third and fourth number of its stretch; one work-item is one row
// or column. texture_draw: values of vertices; one work-item is one texel. Lengths are in the unit of
// positions.
#include "lib/diffusion/item.clh"
#include "lib/diffusion/texels.clh"
#include "lib/image/image.clh"
#include "lib/mesh/mesh_vertex.clh"

// How far beyond an edge a texel may lie for the rounding of coordinates, as a share of the triangle's height
// there, and of the texture's sides, for slivers.
#define BEYOND 1e-5f
#define BEYOND_OF_SIDES 1e-6f

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void texture_owner(
    __global const PelTextureFrame* restrict frame, __global const uint* restrict indices,
    __global const float* restrict uvs, __global uint* owners) {
    const uint triangle = itemOfFolded();
    if (triangle >= frame->triangles) return;
    const UvTriangle t = uvTriangle(frame, indices, uvs, triangle);
    if (!(fabs(t.twice) > 0.0f)) return;
    const float2 low = fmin(t.a, fmin(t.a + t.ab, t.a + t.ac)),
                 high = fmax(t.a, fmax(t.a + t.ab, t.a + t.ac));
    const int x0 = max((int)floor(low.x), 0), x1 = min((int)ceil(high.x), (int)frame->width - 1);
    const float texels = BEYOND_OF_SIDES * (float)(frame->width + frame->height);
    const float3 edges = (float3)(length(t.ac - t.ab), length(t.ac), length(t.ab)),
                 beyond = fmax((float3)(BEYOND), edges * (texels / fabs(t.twice)));
    const int y0 = max((int)floor(low.y), 0), y1 = min((int)ceil(high.y), (int)frame->height - 1);
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const float3 share = sharesAt(&t, (float)x, (float)y);
            if (all(share >= -beyond)) atomic_max(&owners[(size_t)y * frame->width + x], triangle + 1);
        }
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void texture_tiles(
    __global const PelTextureFrame* restrict frame, __global const uint* restrict owners,
    __global uint* tiles, __global uint* restrict counters) {
    const uint tile = itemOfFolded(), tilesY = (frame->height + PEL_TEXTURE_TILE - 1) / PEL_TEXTURE_TILE;
    if (tile >= frame->tilesX * tilesY) return;
    const uint left = tile % frame->tilesX * PEL_TEXTURE_TILE, top = tile / frame->tilesX * PEL_TEXTURE_TILE;
    uint covered = 0;
    for (uint y = top; y < min(top + PEL_TEXTURE_TILE, frame->height); ++y)
        for (uint x = left; x < min(left + PEL_TEXTURE_TILE, frame->width); ++x)
            covered += owners[(size_t)y * frame->width + x] != 0;
    tiles[tile] = covered > 0;
    if (!covered) return;
    atomic_inc(&counters[PEL_COUNT_TEXTURE_TILES]);
    atomic_add(&counters[PEL_COUNT_TEXELS_COVERED], covered);
}

static inline float3 valueAt(__global const PelTextureFrame* frame, __global const uint* indices,
                             __global const float* uvs, __global const float* values, VertexLayout layout,
                             uint triangle, float x, float y) {
    const UvTriangle t = uvTriangle(frame, indices, uvs, triangle);
    const uint3 v = vload3(triangle, indices);
    const float3 share = sharesAt(&t, x, y);
    return share.x * vertexLoad3(values, layout, v.x) + share.y * vertexLoad3(values, layout, v.y) +
           share.z * vertexLoad3(values, layout, v.z);
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void texture_edges(
    __global const PelTextureFrame* restrict frame, __global const uint* restrict indices,
    __global const float* restrict uvs, __global const float* restrict positions, VertexLayout layout,
    __global const uint* restrict islands, __global const uint* restrict owners, __global uint* stretch) {
    const uint line = itemOfFolded();
    if (line >= frame->height + frame->width) return;
    const bool down = line >= frame->height;
    const uint count = down ? frame->height : frame->width;
    const size_t first = down ? line - frame->height : (size_t)line * frame->width,
                 step = down ? frame->width : 1;
    uint begin = 0, before = 0;  // of the present run: its first texel, and the owner of its last one
    for (uint k = 0; k <= count; ++k) {
        const size_t at = first + k * step;
        const uint owner = k < count ? owners[at] : 0;
        bool goesOn = owner && before;
        if (goesOn && islands[owner - 1] != islands[before - 1]) {
            // The surface goes on where vertices are split but the texture is not: the texels are neighbours.
            const float x = (float)(at % frame->width), y = (float)(at / frame->width);
            const float3 apart =
                valueAt(frame, indices, uvs, positions, layout, owner - 1, x, y) -
                valueAt(frame, indices, uvs, positions, layout, before - 1, x - !down, y - down);
            goesOn = length(apart) <=
                     2.0f * (as_float(stretch[at * 4 + down]) + as_float(stretch[(at - step) * 4 + down]));
        }
        if (!goesOn) {
            for (uint i = begin; before && i < k; ++i) {
                const uint run = PEL_TEXEL_COVERED | (i - begin) | (k - 1 - i) << 16;
                // Alone, for another work-item writes the number beside it.
                stretch[(first + i * step) * 4 + (down ? 3 : 2)] = run;
            }
            begin = k;
        }
        before = owner;
    }
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void texture_stretch(
    __global const PelTextureFrame* restrict frame, __global const uint* restrict indices,
    __global const float* restrict uvs, __global const float* restrict positions, VertexLayout layout,
    __global const uint* restrict owners, __global float4* stretch) {
    const size_t texel = itemOfFolded();
    if (texel >= (size_t)frame->width * frame->height) return;
    float2 result = (float2)(0.0f);
    const uint owner = owners[texel];
    if (owner) {
        const UvTriangle t = uvTriangle(frame, indices, uvs, owner - 1);
        const uint3 v = vload3(owner - 1, indices);
        const float3 a = vertexLoad3(positions, layout, v.x), b = vertexLoad3(positions, layout, v.y) - a,
                     c = vertexLoad3(positions, layout, v.z) - a;
        const float per = 1.0f / t.twice;
        const float3 alongU = (b * t.ac.y - c * t.ab.y) * per, alongV = (c * t.ab.x - b * t.ac.x) * per;
        result = (float2)(length(alongU), length(alongV));
        if (!isfinite(result.x) || !isfinite(result.y)) result = 0.0f;
    }
    stretch[texel].xy = result;
}

__constant int2 beside[8] = {(int2)(-1, 0),  (int2)(1, 0),  (int2)(0, -1), (int2)(0, 1),
                             (int2)(-1, -1), (int2)(1, -1), (int2)(-1, 1), (int2)(1, 1)};

// The triangle on the texel, or on a neighbour; 0: none.
static inline uint nearestOwner(__global const PelTextureFrame* frame, __global const uint* owners, int x,
                                int y) {
    uint owner = owners[(size_t)y * frame->width + x];
    for (int k = 0; k < 8 && !owner; ++k) {
        const int u = x + beside[k].x, v = y + beside[k].y;
        if (u >= 0 && v >= 0 && u < (int)frame->width && v < (int)frame->height)
            owner = owners[(size_t)v * frame->width + u];
    }
    return owner;
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void texture_draw(
    __global const PelTextureFrame* restrict frame, __global const uint* restrict indices,
    __global const float* restrict uvs, __global const float* restrict values, VertexLayout layout,
    __global const uint* restrict owners, uint unit, __global uchar* out) {
    const uint x = itemOfFolded() % frame->width, y = itemOfFolded() / frame->width;
    if (y >= frame->height) return;
    const uint owner = nearestOwner(frame, owners, (int)x, (int)y);
    float3 value = (float3)(0.0f);
    if (owner) {
        value = valueAt(frame, indices, uvs, values, layout, owner - 1, (float)x, (float)y);
        if (unit) value *= rsqrt(fmax(dot(value, value), FLT_MIN));
    }
    storeColor(PEL_FORMAT_OUT, imageSpan(out, &frame->out, x, y), vec3(value.x, value.y, value.z), 1);
}
