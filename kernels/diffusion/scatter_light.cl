// Irradiance scattered under the surface, with the texels of shadow maps as lit surface (docs/mathematics.md, sections 9 and 10, "Light space").
//
// Near the point the sum runs over pixels and is divided by its weights; further away it is that over the lights' texels, as it stands.
//
// Input: both pyramids, the words of light_classify. Output: pixels of its parts in an image like the irradiance's; others stay. One
// work-group takes tiles, one work-item parts of them, pixel by pixel. Variants: PEL_HIDDEN is 0, PEL_FORMAT_OUT.
#include "lib/diffusion/windowed.clh"
#include "lib/image/image.clh"
#include "lib/shading/material_id.clh"

#define PART 4             // pixels along a side
#define WINDOW 1.5f        // width, in steps from pixel to pixel or in texels
#define LEAST_COSINE 0.2f  // to the light: texels on steeper surface count as if they were as long as on this
#define NEARLY_PLANE 0.012f  // of the whole mass

typedef struct Pixel {
    float3 p, e;
    float area, size;
    uint id;
} Pixel;

static inline float3 pointAt(__global const float* at, uint stride) {
    return (float3)(at[PEL_PLANE_X * stride], at[PEL_PLANE_Y * stride], at[PEL_PLANE_Z * stride]);
}

static inline Pixel pixelAt(__global const float* at, uint stride) {
    Pixel pixel;
    pixel.area = at[PEL_PLANE_AREA * stride];
    pixel.size = at[PEL_PLANE_SIZE * stride];
    pixel.id = as_uint(at[PEL_PLANE_ID * stride]);
    pixel.p = pointAt(at, stride);
    pixel.e = (float3)(at[PEL_PLANE_RED * stride], at[PEL_PLANE_GREEN * stride], at[PEL_PLANE_BLUE * stride]);
    return pixel;
}

// The way to the nearer of two neighbours of the same object.
static inline float3 shorterWay(__global const float* at, long to, uint stride, const Pixel* here) {
    float3 way = (float3)(0.0f);
    float least = FLT_MAX;
    for (int side = -1; side <= 1; side += 2) {
        __global const float* neighbour = at + to * side;
        if (as_uint(neighbour[PEL_PLANE_ID * stride]) != here->id) continue;
        const float3 v = (float)side * (pointAt(neighbour, stride) - here->p);
        if (dot(v, v) < least) least = dot(v, v), way = v;
    }
    return way;
}

// The longest side of a light's texel on the surface.
static inline float texelOnSurface(__global const PelLightMap* map, float3 p, float3 normal) {
    floatw w;
    Vec3w toLight;
    const Vec3w at = vec3((floatw)(p.x), (floatw)(p.y), (floatw)(p.z));
    texelOf(map, at, &w);
    lightAt(map, at, &toLight);
    const floatw cosine = fabs(toLight.x * normal.x + toLight.y * normal.y + toLight.z * normal.z);
    const floatw length = map->texel * w / fmax(cosine, (floatw)(LEAST_COSINE));
#if PEL_WIDTH == 1
    return length;
#else
    return length.s0;
#endif
}

static inline float3 shareOfPixel(__global const float* nodes, const PelProfileTable table, float area) {
    const Vec3w share = shareOfArea(nodes, table, (floatw)(area));
#if PEL_WIDTH == 1
    return (float3)(share.x, share.y, share.z);
#else
    return (float3)(share.x.s0, share.y.s0, share.z.s0);
#endif
}

// Light over mass, `e` where there is none.
static inline float3 meanLight(float3 light, float3 mass, float3 e) {
    return (float3)(mass.x > 0.0f ? light.x / mass.x : e.x, mass.y > 0.0f ? light.y / mass.y : e.y,
                    mass.z > 0.0f ? light.z / mass.z : e.z);
}

// Blocks add up to a mass that is a little off. Where it is nearly a plane's it is taken to be that: so light that is the same
// all round stays what it is. Returns by how much the light is to be multiplied.
static inline float3 planeLike(float3 mass, float3 plane) {
    const float3 off = mass - plane, trust = clamp(2.0f - fabs(off) * (1.0f / NEARLY_PLANE), 0.0f, 1.0f);
    return (mass - off * trust) / fmax(mass, (float3)(FLT_MIN));
}

// A pixel's scattered light. Returns false where it stays as it is.
static inline bool scatterPixel(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                                __global const PelProfileTable* tables, __global const float* nodes,
                                __global const PelLightMap* maps, uint mapCount, __global const float* lights,
                                int x, int y, const Pixel* here, uint* blocks, uint* texels, float3* result) {
    const PelProfileTable table = tables[frame->tableOf[here->id] - 1];
    const uint stride = frame->level[0].stride;
    __global const float* at = pyramid + pyramidRow(&frame->level[0], y) + x;
    const float3 right = shorterWay(at, 1, stride, here),
                 down = shorterWay(at, (long)stride * PEL_PYRAMID_PLANES, stride, here),
                 across = cross(right, down);
    const float longest = sqrt(fmax(dot(right, right), dot(down, down))), shortest = sqrt(here->size);
    Place place;
    place.p = here->p;
    place.id = here->id;
    place.slack = 0.0f;
    place.rho = WINDOW * longest;
    const float3 normal = across * rsqrt(fmax(dot(across, across), FLT_MIN));
    for (uint k = 0; k < mapCount; ++k) {
        const float length = WINDOW * texelOnSurface(maps + k, here->p, normal);
        if (length > place.rho && length < FLT_MAX) place.rho = length;
    }
    if (!(place.rho > 0.0f)) return false;
    const float3 window = shareOfWindow(nodes, table, place.rho), none = (float3)(0.0f);
    const bool isLit = here->e.x + here->e.y + here->e.z > 0.0f;
    float3 sum = none;
    for (uint k = 0; k < mapCount;) {
        Windowed sums;
        clearWindowed(&sums);
        const uint light = maps[k].light;
        const float3 color = vload3(0, maps[k].color);
        for (; k < mapCount && maps[k].light == light; ++k)
            *texels += addMap(&sums, maps + k, lights, nodes, table, &place);
        const float3 far = color * sumOfLanes3(sums.farLight);
        sum += isLit ? far * planeLike(sumOfLanes3(sums.farMass), 1.0f - window) : far;
    }
    Windowed screen;
    clearWindowed(&screen);
    PelProfileTable seen = table;
    seen.reach = fmin(table.reach, 2.0f * place.rho);
    uint levels = 1;
    while (levels < frame->levels && (float)(1u << levels) * shortest < seen.reach) ++levels;
    *blocks += addScreen(&screen, frame, pyramid, nodes, seen, &place, x, y, levels);
    const float3 own = shareOfPixel(nodes, table, here->area);
    const float3 nearMass = own + sumOfLanes3(screen.nearMass),
                 nearLight = own * here->e + sumOfLanes3(screen.nearLight);
    *result = sum + window * meanLight(nearLight, nearMass, here->e);
    return true;
}

__kernel __attribute__((reqd_work_group_size(PEL_DIFFUSION_GROUP, 1, 1))) void scatter_light(
    __global const PelDiffusionFrame* frame, __global const float* pyramid,
    __global const PelProfileTable* tables, __global const float* nodes, __global const uint* parts,
    __global const PelLightMap* maps, uint mapCount, __global const float* lights, __global uchar* out,
    __global uint* counters) {
    const uint count = frame->tilesX * frame->tilesY;
    uint pixels = 0, blocks = 0, texels = 0;
    for (uint tile = get_group_id(0); tile < count; tile += get_num_groups(0)) {
        const uint word = parts[tile], part = get_local_id(0);
        if (!(word >> part & 1)) continue;
        const uint left = tile % frame->tilesX * PEL_DIFFUSION_TILE + part % PART * PART,
                   top = tile / frame->tilesX * PEL_DIFFUSION_TILE + part / PART * PART;
        for (uint y = top; y < min(top + PART, frame->height); ++y)
            for (uint x = left; x < min(left + PART, frame->width); ++x) {
                const Pixel here =
                    pixelAt(pyramid + pyramidRow(&frame->level[0], (int)y) + x, frame->level[0].stride);
                if (!(here.area > 0.0f)) continue;
                float3 s;
                if (!scatterPixel(frame, pyramid, tables, nodes, maps, mapCount, lights, (int)x, (int)y,
                                  &here, &blocks, &texels, &s))
                    continue;
                s = fmax(s, (float3)(0.0f));
                ++pixels;
                // One lane of a vector, which begins at the pixel's place in its row.
                const uint start = vectorStart(x, frame->width);
                const maskw mine = lanesw() + (int)start == (intw)((int)x);
                storeColor(PEL_FORMAT_OUT, imageSpan(out, &frame->out, start, y),
                           vec3((floatw)(s.x), (floatw)(s.y), (floatw)(s.z)), mine);
            }
    }
    if (pixels) atomic_add(&counters[PEL_COUNT_LIGHT_PIXELS], pixels);
    if (texels) atomic_add(&counters[PEL_COUNT_LIGHT_TEXELS], texels);
}
