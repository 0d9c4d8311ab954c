// Irradiance scattered under the surface, gathered by a few taps on a disk around each pixel
// (docs/mathematics.md, section 10, "Screen space").
//
// Taps lie on a disk across the view, at radii that follow the profile. A tap brings its share of the
// light, times R at its true distance over R on the disk, times the surface of its pixel over that of the
// disk. Input: the surface (gather_surface.cl), taps and profiles. Output: an image like the irradiance;
// pixels that do not gather keep their value. One work-group takes tiles, one work-item columns of their
// pixels. Variants: PEL_FORMAT_IRRADIANCE, PEL_FORMAT_OUT; PEL_HALF: sample_disk first gathers at every
// second pixel along both axes, and scatter_disk only at pixels without a sample beside them; PEL_HISTORY:
// only light from beyond the pixel is written (blend_history.cl).
#include "lib/diffusion/gather.clh"
#include "lib/diffusion/item.clh"

static inline __attribute__((always_inline)) float4 gatherDisk(
    __global const PelGatherFrame* frame, __global const float* points, __global const PelGatherMaterial* m,
    __global const PelGatherTap* taps, __global const float* nodes, uint x, uint y, uint* taken) {
    const size_t here = (size_t)y * frame->width + x;
    const float4 p = gathered(points, here, PEL_GATHER_POINT), e = gathered(points, here, PEL_GATHER_LIGHT),
                 pixel = gathered(points, here, PEL_GATHER_PIXEL);
    const uint id = as_uint(e.w);
    const PelProfileTable table = m->table;
    const uint column = x >> PEL_HALF, row = y >> PEL_HALF;  // of the pixels that gather
    const float turn = 6.28318531f * turnOf(column, row, frame->frameIndex);
    const float cosine = cos(turn), sine = sin(turn);
    const uint set = ((column & 1u) + 2u * (row & 1u) + frame->frameIndex) % PEL_GATHER_TURNS;
    const float perX = 1.0f / pixel.x, perY = 1.0f / pixel.y, perArea = perX * perY;
    float4 light = (float4)(0.0f), weight = (float4)(0.0f), missing = (float4)(0.0f);
    for (uint i = m->firstTap + set * m->taps, end = i + m->taps; i < end; ++i) {
        const float a = taps[i].place[0] * pixel.z, b = taps[i].place[1] * pixel.z;
        const int dx = (int)floor((cosine * a - sine * b) * perX + 0.5f),
                  dy = (int)floor((sine * a + cosine * b) * perY + 0.5f);
        const float4 share = shareOf(&taps[i]);
        const int tx = (int)x + dx, ty = (int)y + dy;
        if (!dx && !dy) {
            light += share * e, weight += share;
            continue;
        }
        if (tx < 0 || ty < 0 || tx >= (int)frame->width || ty >= (int)frame->height) {
            missing += share;
            continue;
        }
        ++*taken;
        const size_t there = (size_t)ty * frame->width + tx;
        const float4 q = gathered(points, there, PEL_GATHER_POINT),
                     f = gathered(points, there, PEL_GATHER_LIGHT);
        const float4 flows = flow(m, id, as_uint(f.w));
        const float3 between = q.xyz - p.xyz;
        const float u = (float)dx * pixel.x, v = (float)dy * pixel.y;
        const float stretch = dot(between, between) / (u * u + v * v);
        const float4 brings = flows * tapBrings(nodes, table, &taps[i], stretch) * (q.w * perArea);
        light += brings * f, weight += brings;
        missing += select(share, (float4)(0.0f), flows > 0.0f);
    }
    light += missing * e, weight += missing;
    return select(light / weight, e, isless(weight, (float4)(1e-6f)));
}

#if PEL_HALF
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void sample_disk(
    __global const PelGatherFrame* restrict frame, __global const float* restrict points,
    __global const PelGatherMaterial* restrict materials, __global const PelGatherTap* restrict taps,
    __global const float* restrict nodes, __global const uint* restrict tiles, __global float* samples,
    __global uint* restrict counters) {
    const uint count = frame->tilesX * frame->tilesY;
    uint pixels = 0, taken = 0;
    for (uint tile = get_group_id(0); tile < count; tile += get_num_groups(0)) {
        if (!(tiles[tile] & PEL_TILE_GATHERS)) continue;
        for (uint item = get_local_id(0); item < PEL_TILE_SAMPLES; item += PEL_GROUP) {
            GatherPixel p;
            if (!loadSample(frame, points, materials, tile, item, &p)) continue;
            storeSample(frame, points, nodes, &p,
                        gatherDisk(frame, points, p.material, taps, nodes, p.x, p.y, &taken), samples);
            ++pixels;
        }
    }
    PEL_ADD_COUNT(&counters[PEL_COUNT_PIXELS_TAPPED], pixels);
    PEL_ADD_COUNT(&counters[PEL_COUNT_TAPS], taken);
}
#endif

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void scatter_disk(
    __global const PelGatherFrame* restrict frame, __global const float* restrict points,
    __global const PelGatherMaterial* restrict materials, __global const PelGatherTap* restrict taps,
    __global const float* restrict nodes, __global const uint* restrict tiles,
    __global const float* restrict samples, __global uchar* irradiance, __global uchar* out,
    __global uint* restrict counters) {
    const uint count = frame->tilesX * frame->tilesY;
    uint pixels = 0, taken = 0;
    for (uint tile = get_group_id(0); tile < count; tile += get_num_groups(0)) {
        if (!(tiles[tile] & PEL_TILE_GATHERS) && frame->inPlace) continue;
        for (uint item = get_local_id(0); item < PEL_TILE_ITEMS; item += PEL_GROUP) {
            GatherPixel p;
            if (!loadPixel(frame, points, materials, columnOf(frame, tile, item), rowOf(frame, tile, item),
                           &p))
                continue;
            float4 scattered = (float4)(0.0f);
            if (p.material && !betweenSamples(frame, points, nodes, samples, &p, &scattered))
                scattered = gatherDisk(frame, points, p.material, taps, nodes, p.x, p.y, &taken), ++pixels;
            storeGathered(frame, points, nodes, &p, scattered, PEL_FORMAT_IRRADIANCE, irradiance,
                          PEL_FORMAT_OUT, out);
        }
    }
    PEL_ADD_COUNT(&counters[PEL_COUNT_PIXELS_TAPPED], pixels);
    PEL_ADD_COUNT(&counters[PEL_COUNT_TAPS], taken);
}
