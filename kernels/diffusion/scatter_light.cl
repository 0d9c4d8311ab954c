// Irradiance scattered under the surface, with the texels of shadow maps as lit surface (docs/mathematics.md, sections 9 and 10, "Light space").
//
// The sum over the lights' texels, as it stands; near the point that over pixels, divided by its weights, where it knows more. At the
// point itself irradiance is known.
//
// Input: both pyramids, the words of light_classify. Output: pixels of its parts in an image like the irradiance's; others stay. One
// work-group takes tiles, one work-item parts of them, pixel by pixel. Variants: PEL_HIDDEN is 0, PEL_FORMAT_OUT.
#include "lib/diffusion/lit_surface.clh"
#include "lib/diffusion/windowed.clh"
#include "lib/image/image.clh"
#include "lib/shading/material_id.clh"

#define PART 4  // pixels along a side
// Windows: of the pixel's own light, in points of a texel; of what pixels show, in texels. Both are lengths on the surface, of one that lies at no
// smaller a cosine to the light: points lie closer along the slope, and the ring of texels that are points has an end.
#define OWN_WINDOW 2.0f
#define OWN_COSINE 0.4f
#define SHOWN_WINDOW 1.0f
#define SHOWN_COSINE 0.35f
#define LEAST_COSINE 0.1f
// A map tells the place of an edge to a fifth of a texel, pixels to a step over the root of 12: how much more the square of a step counts.
#define STEP_OVER_TEXEL 2.0f
#define MASS_OFF \
    0.1f  // of what pixels show, over that of a plane: nothing is missing; none of it counts from three times that on
#define AGREE \
    0.02f  // of light that falls straight in: triangles of a mesh lean by so much from its smooth normals
#define NEARLY_PLANE 0.03f  // of the mass
#define MOST_PARTS 4.0f     // of a block

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

// A light's texel at a point: its width across the light, and the light's cosine.
typedef struct Texel {
    float width, cosine;
    float3 toLight;
} Texel;

static inline Texel texelAt(__global const PelLightMap* map, float3 p, float3 normal) {
    floatw w;
    Vec3w toLight;
    const Vec3w at = vec3((floatw)(p.x), (floatw)(p.y), (floatw)(p.z));
    texelOf(map, at, &w);
    lightAt(map, at, &toLight);
    Texel texel;
#if PEL_WIDTH == 1
    texel.width = map->texel * w;
    texel.toLight = (float3)(toLight.x, toLight.y, toLight.z);
#else
    texel.width = map->texel * w.s0;
    texel.toLight = (float3)(toLight.x.s0, toLight.y.s0, toLight.z.s0);
#endif
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

// Light over mass, `e` where there is none.
static inline float3 meanLight(float3 light, float3 mass, float3 e) {
    return (float3)(mass.x > 0.0f ? light.x / mass.x : e.x, mass.y > 0.0f ? light.y / mass.y : e.y,
                    mass.z > 0.0f ? light.z / mass.z : e.z);
}

// Blocks add up to a mass that is a little off. Where it is nearly a plane's it is taken to be that. Returns by how much the light is to be
// multiplied.
static inline float asOfPlane(float mass, float plane) {
    if (!(mass > 0.1f * plane)) return 1.0f;
    const float off = mass / plane - 1.0f, trust = clamp(2.0f - fabs(off) * (1.0f / NEARLY_PLANE), 0.0f, 1.0f);
    return (1.0f + off * (1.0f - trust)) / (1.0f + off);
}

// How much what pixels show counts in place of what texels do: where both differ by no more than the normals of a surface and of its triangles
// may, or where pixels are the finer and show all surface there is.
static inline float3 trustInPixels(float3 byPixels, float3 byTexels, float3 mass, float3 window, float cosine,
                                   float texel, float step) {
    const float finer = texel * texel / fma(STEP_OVER_TEXEL * step, step, texel * texel);
    const float3 least = (float3)(FLT_MIN), off = fabs(mass / fmax(window, least) - 1.0f),
                 whole = clamp(1.5f - off * (0.5f / MASS_OFF), 0.0f, 1.0f),
                 apart = fabs(byPixels - byTexels) * cosine / fmax(fmax(byPixels, byTexels), least);
    return fmax(clamp(2.0f - apart * (1.0f / AGREE), 0.0f, 1.0f), finer * whole);
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
    const float3 normal = across * rsqrt(fmax(dot(across, across), FLT_MIN));
    float texel = 0.0f, point = 0.0f, shown = 0.0f;  // the longest on the surface
    float steepest = 1.0f;                           // least cosine
    for (uint k = 0; k < mapCount; ++k) {
        const Texel t = texelAt(maps + k, here->p, normal);
        if (!(t.width > 0.0f && t.width < FLT_MAX)) continue;
        steepest = fmin(steepest, fmax(t.cosine, LEAST_COSINE));
        texel = fmax(texel, t.width / fmax(t.cosine, LEAST_COSINE));
        shown = fmax(shown, t.width / fmax(t.cosine, SHOWN_COSINE));
        point = fmax(point, t.width / fmax(t.cosine, OWN_COSINE));
    }
    LitPlace lit;
    lit.p = here->p;
    lit.id = here->id;
    lit.own = OWN_WINDOW * point * (1.0f / PEL_TEXEL_ACROSS);
    place.rho = lit.shown = fmax(SHOWN_WINDOW * shown, lit.own);
    if (!(lit.own > 0.0f)) return false;
    const float3 none = (float3)(0.0f);
    const float3 ownWindow = shareOfWindow(nodes, table, lit.own),
                 window = shareOfWindow(nodes, table, lit.shown);
    float3 far = none, between = none, asPlane = none;
    for (uint k = 0; k < mapCount;) {
        LitSums sums;
        clearLitSums(&sums);
        const uint number = maps[k].light;
        const float3 color = vload3(0, maps[k].color);
        for (; k < mapCount && maps[k].light == number; ++k) {
            const Texel t = texelAt(maps + k, here->p, normal);
            const float3 along = t.toLight - normal * dot(normal, t.toLight);
            lit.along = along * rsqrt(fmax(dot(along, along), 1e-12f));
            lit.parts = (uint)(fmin(1.0f / fmax(t.cosine, 0.01f), MOST_PARTS) + 0.5f);
            *texels += addLitSurface(&sums, maps + k, lights, nodes, table, &lit);
        }
        far += color * sumOfLanes3(sums.far);
        const float3 light = color * sumOfLanes3(sums.between), mass = sumOfLanes3(sums.mass);
        between += light;
        asPlane += light * (float3)(asOfPlane(mass.x, window.x - ownWindow.x),
                                    asOfPlane(mass.y, window.y - ownWindow.y),
                                    asOfPlane(mass.z, window.z - ownWindow.z));
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
    const float3 byPixels = window * meanLight(nearLight, nearMass, here->e),
                 byTexels = ownWindow * here->e + asPlane;
    const float3 trust = trustInPixels(byPixels, byTexels, nearMass, window, steepest, texel, longest);
    *result = far + ownWindow * here->e + between + trust * (byPixels - byTexels);
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
