// Irradiance scattered under the surface, with shadow-map texels as the lit surface (docs/mathematics.md,
// sections 9 and 10, "Light space").
//
// Far light is the sum over the shadow-map texels. Near the receiver the sum over pixels, divided by its
// weights, is blended in where it is the more reliable one. At the receiver itself irradiance is known.
// Input: both pyramids, the flags of light_classify. Output: the flagged parts, in an image like the
// irradiance; other pixels keep their value. One work-item: one pixel, with several lanes a part of
// a tile. Variants: PEL_HIDDEN is 0, PEL_FORMAT_OUT; PEL_FORMAT_THICKNESS: of the body, which the irradiance
// of pixels includes already; PEL_HALF: sample_light first sums at every second pixel along both axes, and
// scatter_light only at pixels without a sample beside them.
#include "lib/diffusion/item.clh"
#include "lib/diffusion/lit_surface.clh"
#include "lib/diffusion/windowed.clh"
#include "lib/shading/kept_by_slab.clh"
#include "lib/shading/material_id.clh"

#define PART (1 << PEL_PART_LEVEL)         // pixels along a side
#define PARTS (PEL_DIFFUSION_TILE / PART)  // along a side of a tile
// Pixels of a work-item: with several lanes a whole part, which takes 0.8 of the time on a CPU.
#define EACH(pixelsOfPart) (PEL_WIDTH == 1 ? 1 : (pixelsOfPart))
#define SAMPLES_ALIKE \
    16.0f  // squared distance over the area of a pixel; farther: another part of the surface
// Radii of two windows: of the irradiance of the pixel itself, in points of a texel, and of the camera's
// samples, in texels. Lengths are measured on the surface, where the cosine to the light counts as at least
// OWN_COSINE or SHOWN_COSINE: points lie closer together along the slope, and only a limited ring of texels
// is summed as points.
#define OWN_WINDOW 2.0f
#define OWN_COSINE 0.4f
#define SHOWN_WINDOW 1.0f
#define SHOWN_COSINE 0.35f
#define MIN_COSINE 0.1f
// A map locates an edge to a fifth of a texel, pixels to a step over the root of 12: the factor of the
// squared step.
#define STEP_OVER_TEXEL 2.0f
// Pixels are fully trusted if their accumulated weight deviates from a plane's by at most this, and not at
// all from three times that on.
#define WEIGHT_OFF 0.1f
// A difference that the tilt of triangles against smooth normals explains, over light at normal incidence.
#define AGREE 0.02f
#define NEARLY_PLANE 0.03f  // of the weight
#define MAX_PARTS 4.0f      // of a block

typedef struct Pixel {
    float3 p, e;
    float area, size;
    uint id;
} Pixel;

static inline Pixel pixelAt(__global const float* at, uint stride) {
    Pixel pixel;
    pixel.area = at[PEL_PLANE_AREA * stride];
    pixel.size = at[PEL_PLANE_SIZE * stride];
    pixel.id = as_uint(at[PEL_PLANE_ID * stride]);
    pixel.p = pointAt(at, stride);
    pixel.e = (float3)(at[PEL_PLANE_RED * stride], at[PEL_PLANE_GREEN * stride], at[PEL_PLANE_BLUE * stride]);
    return pixel;
}

// A texel of a light at a point: its width across the light, and the cosine of the light.
typedef struct Texel {
    float width, cosine;
    float3 toLight;
} Texel;

static inline Texel texelAt(__global const PelLightMap* map, float3 p, float3 normal) {
    floatw w;
    texelOf(map, spread3(p), &w);
    Texel texel;
#if PEL_WIDTH == 1
    texel.width = map->texel * w;
#else
    texel.width = map->texel * w.s0;
#endif
    texel.toLight = toLightFrom(map, p);
    texel.cosine = fabs(dot(texel.toLight, normal));
    return texel;
}

static inline float3 shareOfPixel(__global const float* nodes, const PelProfileTable table, float area) {
    const Vec3w share = shareOfArea(nodes, table, (floatw)(area));
#if PEL_WIDTH == 1
    return (float3)(share.x, share.y, share.z);
#else
    return (float3)(share.x.s0, share.y.s0, share.z.s0);
#endif
}

// Light over accumulated weight; `e` where the weight is 0.
static inline float3 meanLight(float3 light, float3 weight, float3 e) {
    return (float3)(weight.x > 0.0f ? light.x / weight.x : e.x, weight.y > 0.0f ? light.y / weight.y : e.y,
                    weight.z > 0.0f ? light.z / weight.z : e.z);
}

// The weights of blocks add up to nearly that of a plane. Returns the factor that makes it exact where the
// difference is small.
static inline float asOfPlane(float weight, float plane) {
    const float off = weight / plane - 1.0f;
    if (!(fabs(off) < 2.0f * NEARLY_PLANE)) return 1.0f;  // NaN too: a window that holds all light
    const float trust = clamp(2.0f - fabs(off) * (1.0f / NEARLY_PLANE), 0.0f, 1.0f);
    return (1.0f + off * (1.0f - trust)) / (1.0f + off);
}

// Blend weight between the camera's samples and the shadow map's. Pixels are trusted where both differ by
// no more than the normals of a surface and of its triangles may, or where pixels are finer and show all of
// the surface.
static inline float3 trustInPixels(float3 byPixels, float3 byTexels, float3 weight, float3 window,
                                   float cosine, float texel, float step) {
    const float finer = texel * texel / fma(STEP_OVER_TEXEL * step, step, texel * texel);
    const float3 least = (float3)(FLT_MIN), off = fabs(weight / fmax(window, least) - 1.0f),
                 whole = clamp(1.5f - off * (0.5f / WEIGHT_OFF), 0.0f, 1.0f),
                 apart = fabs(byPixels - byTexels) * cosine / fmax(fmax(byPixels, byTexels), least);
    return fmax(clamp(2.0f - apart * (1.0f / AGREE), 0.0f, 1.0f), finer * whole);
}

// What the body at a pixel keeps of light that falls on its side.
static inline float3 keptAt(__global const PelDiffusionFrame* frame, __global const PelProfileTable* tables,
                            __global uchar* thickness, uint x, uint y, uint id) {
#if PEL_FORMAT_THICKNESS
    __global const PelProfileTable* table = tables + frame->tableOf[id] - 1;
    const uint start = vectorStart(x, frame->width);
    const floatw t = loadScalar(PEL_FORMAT_THICKNESS, imageSpan(thickness, &frame->thickness, start, y));
    const Vec3w path = loadUniform3(table->path), s = loadUniform3(table->absorption),
                kept =
                    vec3(keptBySlab(t, path.x, s.x), keptBySlab(t, path.y, s.y), keptBySlab(t, path.z, s.z));
    const maskw mine = lanesw() + (int)start == (intw)((int)x);
    return sumOfLanes3(select3(same3(0.0f), kept, mine));
#else
    return (float3)(1.0f);
#endif
}

// Scattered light of a pixel; `kept`: keptAt. Returns false if the pixel keeps its irradiance.
static PEL_OUT_OF_LINE bool scatterPixel(__global const PelDiffusionFrame* frame,
                                         __global const float* pyramid,
                                         __global const PelProfileTable* tables, __global const float* nodes,
                                         __global const PelLightMap* maps, uint mapCount,
                                         __global const float* lights, int x, int y, const Pixel* here,
                                         float3 kept, uint* blocks, uint* texels, float3* result) {
    const uint stride = frame->level[0].stride;
    __global const float* at = pyramid + pyramidRow(&frame->level[0], y) + x;
    const PelProfileTable table = tableAt(tables + frame->tableOf[here->id] - 1, at, stride);
    const float3 right = shorterWay(at, 1, stride),
                 down = shorterWay(at, (long)stride * PEL_PYRAMID_PLANES, stride),
                 across = cross(right, down);
    const float longest = sqrt(fmax(dot(right, right), dot(down, down))), shortest = sqrt(here->size);
    Receiver receiver;
    receiver.p = here->p;
    receiver.id = here->id;
    receiver.margin = 0.0f;
    receiver.directed = table.directed;
    receiver.normal = outwardNormal(frame, at, stride);
    const float3 normal = across * rsqrt(fmax(dot(across, across), FLT_MIN));
    float texel = 0.0f, point = 0.0f, shown = 0.0f;  // the longest on the surface
    float steepest = 1.0f;                           // smallest cosine
    for (uint k = 0; k < mapCount; ++k) {
        const Texel t = texelAt(maps + k, here->p, normal);
        if (!(t.width > 0.0f && t.width < FLT_MAX)) continue;
        steepest = fmin(steepest, fmax(t.cosine, MIN_COSINE));
        texel = fmax(texel, t.width / fmax(t.cosine, MIN_COSINE));
        shown = fmax(shown, t.width / fmax(t.cosine, SHOWN_COSINE));
        point = fmax(point, t.width / fmax(t.cosine, OWN_COSINE));
    }
    LitReceiver lit;
    lit.p = here->p;
    lit.id = here->id;
    lit.directed = table.directed;
    lit.normal = receiver.normal;
    lit.curvature = at[PEL_PLANE_CURVATURE * stride];
    lit.own = OWN_WINDOW * point * (1.0f / PEL_TEXEL_ACROSS);
    receiver.rho = lit.shown = fmax(SHOWN_WINDOW * shown, lit.own);
    if (!(lit.own > 0.0f)) return false;
    const float3 none = (float3)(0.0f);
    const float3 ownWindow = shareOfWindow(nodes, table, lit.own),
                 window = shareOfWindow(nodes, table, lit.shown);
    const float3 gain = directedGainAt(table, lit.curvature),
                 ownLight = here->e * ownWindow * directedGainWithin(gain, ownWindow);
    float3 far = none, between = none, asPlane = none;
    for (uint k = 0; k < mapCount;) {
        LitSums sums;
        clearLitSums(&sums);
        const uint number = maps[k].light;
        float3 color = vload3(0, maps[k].color);
        float faced = 0.0f;
        for (; k < mapCount && maps[k].light == number; ++k) {
            const Texel t = texelAt(maps + k, here->p, normal);
            const float3 along = t.toLight - normal * dot(normal, t.toLight);
            lit.slab = slabOf(table, receiver.normal, t.toLight);
            faced = table.slab > 0.0f ? facing(receiver.normal, t.toLight) : 1.0f;
            lit.along = along * rsqrt(fmax(dot(along, along), 1e-12f));
            lit.parts = (uint)(fmin(1.0f / fmax(t.cosine, 0.01f), MAX_PARTS) + 0.5f);
            *texels += addLitSurface(&sums, maps + k, lights, nodes, table, &lit);
        }
        if (PEL_FORMAT_THICKNESS) color *= 1.0f + (kept - 1.0f) * faced;
        far += color * sumOfLanes3(sums.far);
        const float3 light = color * sumOfLanes3(sums.between), weight = sumOfLanes3(sums.weight);
        between += light;
        asPlane += light * (float3)(asOfPlane(weight.x, window.x - ownWindow.x),
                                    asOfPlane(weight.y, window.y - ownWindow.y),
                                    asOfPlane(weight.z, window.z - ownWindow.z));
    }
    Windowed screen;
    clearWindowed(&screen);
    PelProfileTable seen = table;
    seen.reach = fmin(table.reach, 2.0f * receiver.rho);
    uint levels = 1;
    while (levels < frame->levels && (float)(1u << levels) * shortest < seen.reach) ++levels;
    *blocks += addScreen(&screen, frame, pyramid, nodes, seen, &receiver, x, y, levels);
    const float3 own = shareOfPixel(nodes, table, here->area);
    const float3 nearWeight = own + sumOfLanes3(screen.nearWeight),
                 nearLight = own * here->e + sumOfLanes3(screen.nearLight);
    const float3 byPixels = window * meanLight(nearLight, nearWeight, here->e), byTexels = ownLight + asPlane;
    const float3 trust = trustInPixels(byPixels, byTexels, nearWeight, window, steepest, texel, longest);
    *result = (far + ownLight + between + trust * (byPixels - byTexels)) / gain;
    return true;
}

// Of pixel `at` of a tile, part by part: one of `across` along a side of a part, `step` apart.
static inline uint2 pixelOfTile(__global const PelDiffusionFrame* frame, uint tile, uint at, uint across) {
    const uint part = at / (across * across), step = PART / across;
    return (uint2)(tile % frame->tilesX * PEL_DIFFUSION_TILE + part % PARTS * PART + at % across * step,
                   tile / frame->tilesX * PEL_DIFFUSION_TILE + part / PARTS * PART +
                       at / across % across * step);
}

static inline Pixel pixelIn(__global const PelDiffusionFrame* frame, __global const float* pyramid, uint x,
                            uint y) {
    return pixelAt(pyramid + pyramidRow(&frame->level[0], (int)y) + x, frame->level[0].stride);
}

#if PEL_HALF
#define SAMPLES (PEL_DIFFUSION_TILE * PEL_DIFFUSION_TILE / 4)  // of a tile

// Number of a sample in a tile.
static inline uint sampleInTile(uint x, uint y) {
    return y % PEL_DIFFUSION_TILE / 2 * (PEL_DIFFUSION_TILE / 2) + x % PEL_DIFFUSION_TILE / 2;
}

// Light of the pixel itself, which samples leave out.
static inline float3 ownLightOf(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                                __global const PelProfileTable* tables, __global const float* nodes, uint x,
                                uint y, const Pixel* here) {
    const PelProfileTable table =
        tableAt(tables + frame->tableOf[here->id] - 1, pyramid + pyramidRow(&frame->level[0], (int)y) + x,
                frame->level[0].stride);
    return shareOfPixel(nodes, table, here->area) * here->e;
}

// The mean of the samples round a pixel that are on its surface. Returns false if there are none.
static inline bool meanOfLight(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                               __global const uint* parts, __global const float* samples, uint x, uint y,
                               const Pixel* here, float3* mean) {
    float4 sum = (float4)(0.0f);
    for (uint sy = y & ~1u; sy <= y + (y & 1) && sy < frame->height; sy += 2)
        for (uint sx = x & ~1u; sx <= x + (x & 1) && sx < frame->width; sx += 2) {
            const uint tile = sy / PEL_DIFFUSION_TILE * frame->tilesX + sx / PEL_DIFFUSION_TILE,
                       part = sy % PEL_DIFFUSION_TILE / PART * PARTS + sx % PEL_DIFFUSION_TILE / PART;
            if (!(parts[tile] >> part & 1)) continue;
            const Pixel there = pixelIn(frame, pyramid, sx, sy);
            const float3 d = there.p - here->p;
            if (there.id == here->id && there.area > 0.0f &&
                dot(d, d) <= SAMPLES_ALIKE * fmax(there.area, here->area))
                sum += vload4(tile * SAMPLES + sampleInTile(sx, sy), samples);
        }
    if (sum.w > 0.0f) *mean = sum.xyz / sum.w;
    return sum.w > 0.0f;
}

// Writes light from beyond the pixel, and 1; 0 where the pixel keeps its irradiance.
__kernel PEL_WORK_GROUP(PEL_GROUP) void sample_light(
    __global const PelDiffusionFrame* restrict frame, __global const float* restrict pyramid,
    __global const PelProfileTable* restrict tables, __global const float* restrict nodes,
    __global const uint* restrict parts, __global const PelLightMap* restrict maps, uint mapCount,
    __global const float* restrict lights, __global uchar* thickness, __global float* samples,
    __global uint* restrict counters) {
    const uint each = EACH(PART * PART / 4), runs = max(SAMPLES / (PEL_GROUP * each), 1u),
               count = frame->tilesX * frame->tilesY * runs;
    uint pixels = 0, blocks = 0, texels = 0;
    for (uint run = get_group_id(0); run < count; run += get_num_groups(0)) {
        const uint tile = run / runs, first = (run % runs * PEL_GROUP + get_local_id(0)) * each;
        if (first >= SAMPLES || !(parts[tile] >> first / (PART * PART / 4) & 1)) continue;
        for (uint at = first; at < first + each; ++at) {
            const uint2 place = pixelOfTile(frame, tile, at, PART / 2);
            const uint x = place.x, y = place.y;
            if (x >= frame->width || y >= frame->height) continue;
            const Pixel here = pixelIn(frame, pyramid, x, y);
            float3 s;
            float4 sample = (float4)(0.0f);
            if (here.area > 0.0f &&
                scatterPixel(frame, pyramid, tables, nodes, maps, mapCount, lights, (int)x, (int)y, &here,
                             keptAt(frame, tables, thickness, x, y, here.id), &blocks, &texels, &s)) {
                s -= ownLightOf(frame, pyramid, tables, nodes, x, y, &here);
                sample = (float4)(fmax(s, (float3)(0.0f)), 1.0f);
                ++pixels;
            }
            vstore4(sample, tile * SAMPLES + sampleInTile(x, y), samples);
        }
    }
    PEL_ADD_COUNT(&counters[PEL_COUNT_LIGHT_PIXELS], pixels);
    PEL_ADD_COUNT(&counters[PEL_COUNT_LIGHT_TEXELS], texels);
}
#endif

__kernel PEL_WORK_GROUP(PEL_GROUP) void scatter_light(
    __global const PelDiffusionFrame* restrict frame, __global const float* restrict pyramid,
    __global const PelProfileTable* restrict tables, __global const float* restrict nodes,
    __global const uint* restrict parts, __global const PelLightMap* restrict maps, uint mapCount,
    __global const float* restrict lights, __global uchar* thickness, __global const float* restrict samples,
    __global uchar* out, __global uint* restrict counters) {
    // Tiles, part by part, in runs of as many work-items as a group has.
    const uint size = PEL_DIFFUSION_TILE * PEL_DIFFUSION_TILE, each = EACH(PART * PART),
               runs = max(size / (PEL_GROUP * each), 1u), count = frame->tilesX * frame->tilesY * runs;
    uint pixels = 0, blocks = 0, texels = 0;
    for (uint run = get_group_id(0); run < count; run += get_num_groups(0)) {
        const uint tile = run / runs, first = (run % runs * PEL_GROUP + get_local_id(0)) * each;
        if (first >= size || !(parts[tile] >> first / (PART * PART) & 1)) continue;
        for (uint at = first; at < first + each; ++at) {
            const uint2 place = pixelOfTile(frame, tile, at, PART);
            const uint x = place.x, y = place.y;
            if (x >= frame->width || y >= frame->height) continue;
            const Pixel here = pixelIn(frame, pyramid, x, y);
            if (!(here.area > 0.0f)) continue;
            float3 s;
#if PEL_HALF
            if (meanOfLight(frame, pyramid, parts, samples, x, y, &here, &s)) {
                s += ownLightOf(frame, pyramid, tables, nodes, x, y, &here);
            } else
#endif
            {
                if (!scatterPixel(frame, pyramid, tables, nodes, maps, mapCount, lights, (int)x, (int)y,
                                  &here, keptAt(frame, tables, thickness, x, y, here.id), &blocks, &texels,
                                  &s))
                    continue;
                ++pixels;
            }
            s = fmax(s, (float3)(0.0f));
            // One lane of the vector that holds the pixel.
            const uint start = vectorStart(x, frame->width);
            const maskw mine = lanesw() + (int)start == (intw)((int)x);
            storeColor(PEL_FORMAT_OUT, imageSpan(out, &frame->out, start, y), spread3(s), mine);
        }
    }
    PEL_ADD_COUNT(&counters[PEL_COUNT_LIGHT_PIXELS], pixels);
    PEL_ADD_COUNT(&counters[PEL_COUNT_LIGHT_TEXELS], texels);
}
