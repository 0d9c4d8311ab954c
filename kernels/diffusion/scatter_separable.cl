// Irradiance scattered under the surface by two filters, along the rows of the picture and then along its
// columns, by the line spread of the profile [Jimenez et al. 2015; docs/mathematics.md, section 10,
// "Separable"].
//
// A tap stands for a piece of the line. Where the surface leaves the plane across the view, the tap is
// weighted by the line spread at its true distance. Input: the surface (gather_surface.cl), pieces and line
// spreads. Output: filter_rows: irradiance and -, four floats a pixel; filter_columns: an image like the
// irradiance, in which pixels that do not gather keep their value. One work-group takes tiles, one work-item
// columns of their pixels. Variants: PEL_FORMAT_IRRADIANCE, PEL_FORMAT_OUT; PEL_HALF: rows are filtered only
// at even columns, sample_columns filters at every second pixel along both axes, and filter_columns only at
// pixels without a sample beside them; PEL_HISTORY: only light from beyond the pixel is written
// (blend_history.cl).
#include "lib/diffusion/gather.clh"
#include "lib/diffusion/item.clh"

typedef struct Line {
    __global const PelGatherFrame* frame;
    __global const float* points;
    __global const float* light;  // per pixel, `lightStride` floats apart
    uint lightStride;
    __global const PelGatherMaterial* material;
    __global const float* nodes;
    long step;        // in the image, from one pixel of the line to the next
    int first, last;  // pixels of the line, counted from the receiver
    float size;       // length of a pixel
    size_t here;
    float3 p;
    uint id;
    float4 own;
} Line;

typedef struct LineSums {
    float4 light, weight;
} LineSums;

// Adds the contribution of pixel `k` of the line to a share of the light. Returns 1 if the pixel was read.
static inline uint addPixel(const Line* line, __global const PelGatherTap* tap, int k, float part,
                            LineSums* sums) {
    const float4 share = part * shareOf(tap);
    if (k < line->first || k > line->last || k == 0) {
        sums->light += share * line->own, sums->weight += share;
        return 0;
    }
    const size_t there = (size_t)((long)line->here + k * line->step);
    const float4 q = gathered(line->points, there, PEL_GATHER_POINT);
    const uint other = as_uint(gathered(line->points, there, PEL_GATHER_LIGHT).w);
    if (other != line->id && (!other || !line->material->anyBorder)) {  // its light may be undefined
        sums->light += share * line->own, sums->weight += share;
        return 1;
    }
    const float4 flows = flow(line->material, line->id, other);
    const float3 between = q.xyz - line->p;
    const float plane = (float)k * line->size;
    const float4 brings =
        part * flows *
        tapBrings(line->nodes, line->material->table, tap, dot(between, between) / (plane * plane));
    sums->light += brings * PEL_LOAD4(line->light + there * line->lightStride);
    sums->weight += brings;
    // Light that is held back at a border is replaced by the light of the pixel itself.
    const float4 kept = select((float4)(0.0f), share, flows <= 0.0f);
    sums->light += kept * line->own, sums->weight += kept;
    return 1;
}

static inline float4 filterLine(const Line* line, __global const PelGatherTap* taps, float radius,
                                uint* taken) {
    LineSums sums;
    sums.light = sums.weight = (float4)(0.0f);
    const float perPixel = radius / line->size;
    for (uint i = line->material->firstTap, end = i + line->material->taps; i < end; ++i) {
        // A piece narrower than a pixel covers at most two. Of a wider piece the pixels at its centre, one
        // pixel wide, are read.
        const float a = taps[i].place[0] * perPixel, b = taps[i].place[1] * perPixel, middle = 0.5f * (a + b),
                    half_ = 0.5f * fmin(b - a, 1.0f);
        const int first = (int)floor(middle - half_ + 0.5f), last = (int)floor(middle + half_ + 0.5f);
        const float beyond = last > first ? (middle + half_ - (float)last + 0.5f) / (2.0f * half_) : 0.0f;
        *taken += addPixel(line, &taps[i], first, 1.0f - beyond, &sums);
        if (last > first) *taken += addPixel(line, &taps[i], last, beyond, &sums);
    }
    return select(sums.light / sums.weight, line->own, isless(sums.weight, (float4)(1e-6f)));
}

// Scattered along the row (`down` 0) or the column of a pixel that has a material.
static inline float4 filterPixel(__global const PelGatherFrame* frame, __global const float* points,
                                 __global const float* light, uint lightStride,
                                 __global const PelGatherMaterial* material,
                                 __global const PelGatherTap* taps, __global const float* nodes, uint x,
                                 uint y, bool down, uint* taken) {
    Line line;
    line.frame = frame, line.points = points, line.light = light, line.lightStride = lightStride;
    line.material = material, line.nodes = nodes;
    line.here = (size_t)y * frame->width + x;
    const float4 pixel = gathered(points, line.here, PEL_GATHER_PIXEL);
    const float radius = fabs(pixel.z);
    line.step = down ? (long)frame->width : 1;
    line.first = -(int)(down ? y : x);
    line.last = (int)(down ? frame->height - 1 - y : frame->width - 1 - x);
    line.size = down ? pixel.y : pixel.x;
    line.p = gathered(points, line.here, PEL_GATHER_POINT).xyz;
    line.id = as_uint(gathered(points, line.here, PEL_GATHER_LIGHT).w);
    line.own = PEL_LOAD4(light + line.here * lightStride);
    return filterLine(&line, taps, radius, taken);
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void filter_rows(
    __global const PelGatherFrame* restrict frame, __global const float* restrict points,
    __global const PelGatherMaterial* restrict materials, __global const PelGatherTap* restrict taps,
    __global const float* restrict nodes, __global const uint* restrict tiles, __global float* rows,
    __global uint* restrict counters) {
    const uint count = frame->tilesX * frame->tilesY;
    uint taken = 0;
    for (uint tile = get_group_id(0); tile < count; tile += get_num_groups(0)) {
        if (!tiles[tile]) continue;
        for (uint item = get_local_id(0); item < PEL_TILE_ITEMS >> PEL_HALF; item += PEL_GROUP) {
            // At half rate a pixel, and the next one of its row.
            const uint x = columnOf(frame, tile, item << PEL_HALF), y = rowOf(frame, tile, item << PEL_HALF);
            if (x >= frame->width || y >= frame->height) continue;
            const size_t at = (size_t)y * frame->width + x;
            float4 light = gathered(points, at, PEL_GATHER_LIGHT);
            const uint material = frame->materialOf[as_uint(light.w)];
            const float4 pixel = gathered(points, at, PEL_GATHER_PIXEL);
            // Pixels that do not scatter are written too, since the other filter reads them.
            if (PEL_HALF && x + 1 < frame->width)
                PEL_STORE4(gathered(points, at + 1, PEL_GATHER_LIGHT), rows + 4 * (at + 1));
            if (material && pixel.x > 0.0f && pixel.z != 0.0f)
                light = filterPixel(frame, points, points + PEL_GATHER_LIGHT, PEL_GATHER_FLOATS,
                                    &materials[material - 1], taps, nodes, x, y, false, &taken);
            PEL_STORE4(light, rows + 4 * at);
        }
    }
    PEL_ADD_COUNT(&counters[PEL_COUNT_TAPS], taken);
}

#if PEL_HALF
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void sample_columns(
    __global const PelGatherFrame* restrict frame, __global const float* restrict points,
    __global const PelGatherMaterial* restrict materials, __global const PelGatherTap* restrict taps,
    __global const float* restrict nodes, __global const uint* restrict tiles, __global const float* rows,
    __global float* samples, __global uint* restrict counters) {
    const uint count = frame->tilesX * frame->tilesY;
    uint pixels = 0, taken = 0;
    for (uint tile = get_group_id(0); tile < count; tile += get_num_groups(0)) {
        if (!(tiles[tile] & PEL_TILE_GATHERS)) continue;
        for (uint item = get_local_id(0); item < PEL_TILE_SAMPLES; item += PEL_GROUP) {
            GatherPixel p;
            if (!loadSample(frame, points, materials, tile, item, &p)) continue;
            storeSample(frame, points, nodes, &p,
                        filterPixel(frame, points, rows, 4, p.material, taps, nodes, p.x, p.y, true, &taken),
                        samples);
            ++pixels;
        }
    }
    PEL_ADD_COUNT(&counters[PEL_COUNT_PIXELS_TAPPED], pixels);
    PEL_ADD_COUNT(&counters[PEL_COUNT_TAPS], taken);
}
#endif

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void filter_columns(
    __global const PelGatherFrame* restrict frame, __global const float* restrict points,
    __global const PelGatherMaterial* restrict materials, __global const PelGatherTap* restrict taps,
    __global const float* restrict nodes, __global const uint* restrict tiles, __global const float* rows,
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
                scattered =
                    filterPixel(frame, points, rows, 4, p.material, taps, nodes, p.x, p.y, true, &taken),
                ++pixels;
            storeGathered(frame, points, nodes, &p, scattered, PEL_FORMAT_IRRADIANCE, irradiance,
                          PEL_FORMAT_OUT, out);
        }
    }
    PEL_ADD_COUNT(&counters[PEL_COUNT_PIXELS_TAPPED], pixels);
    PEL_ADD_COUNT(&counters[PEL_COUNT_TAPS], taken);
}
