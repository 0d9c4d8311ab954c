// The wide shadow image of one light from its shadow map (lib/wide_filter.clh): how much of the light arrives at each pixel
// of a material, filtered over the material's shadowFilterWidth.
//
// Inputs: positions or depth, geometric normals, ids, the shadow map. Output: R32F, 0 to 1; pixels that the light does not
// reach get 1. One work-group: a run of tiles; one work-item: PEL_WIDTH pixels, whose filters it runs one after another,
// PEL_WIDTH texels at a time. PEL_NORMAL_SLOT: where the geometric normals are.
#include "lib/light.clh"
#include "lib/tiles.clh"
#include "lib/wide_filter.clh"
#include "shared/shade_passes.h"

// Below this cosine to the light the tangent plane is followed no steeper: five times the sideways distance.
#define PEL_FLATTEST_COSINE 0.2f
// Smaller filters would see texels come and go.
#define PEL_LEAST_TEXELS 2.0f

// PEL_WIDTH filters, one field after another.
typedef struct Filters {
    float x[PEL_WIDTH], y[PEL_WIDTH], z[PEL_WIDTH], dzdx[PEL_WIDTH], dzdy[PEL_WIDTH];
    float radiusX[PEL_WIDTH], radiusY[PEL_WIDTH], cone[PEL_WIDTH], perSoftness[PEL_WIDTH], step[PEL_WIDTH];
} Filters;

// Returns the lanes whose filter can be run; the others are behind the light, or no numbers.
static inline maskw makeFilters(__global const PelWideShadow* light, Vec3w p, Vec3w n, floatw width, Filters* f) {
    __global const float* m = light->worldToShadow;
#define PEL_ROW_(r)                                                                                       \
    fma(p.z, (floatw)(m[4 * (r) + 2]),                                                                    \
        fma(p.y, (floatw)(m[4 * (r) + 1]), fma(p.x, (floatw)(m[4 * (r)]), (floatw)(m[4 * (r) + 3]))))
    const floatw w = PEL_ROW_(3), inverse = 1.0f / w;
    const floatw u = PEL_ROW_(0) * inverse, v = PEL_ROW_(1) * inverse, z = PEL_ROW_(2) * inverse;
#undef PEL_ROW_
    // Towards the light, of length 1 along the map's axis.
    Vec3w toLight = scale3(loadUniform3(light->forward), (floatw)(-1.0f));
    floatw zPerLength = light->zPerLength, extentU = light->extent[0], extentV = light->extent[1];
    if (light->projection == 1) {
        toLight = sub3(toLight, scale3(loadUniform3(light->right), (u - light->centre[0]) * extentU));
        toLight = sub3(toLight, scale3(loadUniform3(light->down), (v - light->centre[1]) * extentV));
        const floatw distance = 1.0f / fma(z, (floatw)(light->depthA), (floatw)(light->depthB));
        zPerLength = -1.0f / (light->depthA * distance * distance);
        extentU *= distance;
        extentV *= distance;
    }
    const floatw texelU = extentU / (float)light->map.width, texelV = extentV / (float)light->map.height;
    const floatw cosine = dot3(n, toLight), tilt = 1.0f / fmax(cosine, (floatw)(PEL_FLATTEST_COSINE));
    // A point that faces away is behind its own body: up to two filter widths of that are not its shadow; the curvature
    // table darkens it.
    const floatw body = 2.0f * width * max0w(-cosine);
    const floatw dzdx = dot3(n, loadUniform3(light->right)) * tilt * texelU * zPerLength;
    const floatw dzdy = dot3(n, loadUniform3(light->down)) * tilt * texelV * zPerLength;
    const floatw radiusX = fmax(0.5f * width / texelU, (floatw)(PEL_LEAST_TEXELS));
    const floatw radiusY = fmax(0.5f * width / texelV, (floatw)(PEL_LEAST_TEXELS));
    const floatw x = fma(u, (floatw)((float)light->map.width), (floatw)(-0.5f));
    const floatw y = fma(v, (floatw)((float)light->map.height), (floatw)(-0.5f));
    const floatw step = fmax(ceil(2.0f * fmax(radiusX, radiusY) / light->maxTexels), (floatw)(1.0f));
    storew(x, 0, f->x);
    storew(y, 0, f->y);
    storew(z - (light->bias + body) * zPerLength, 0, f->z);
    storew(dzdx, 0, f->dzdx);
    storew(dzdy, 0, f->dzdy);
    storew(radiusX, 0, f->radiusX);
    storew(radiusY, 0, f->radiusY);
    storew(light->coneSlope * tilt * 0.5f * width * zPerLength, 0, f->cone);
    storew(1.0f / (light->softness * width * zPerLength), 0, f->perSoftness);
    storew(step, 0, f->step);
    // Far outside of the map, where integers would overflow, everything is lit.
    return (w > 0.0f) & finite3(p) & finite3(n) & (fabs(x) < 1e6f) & (fabs(y) < 1e6f) & (radiusX < 1e6f) & (radiusY < 1e6f) &
           finitew(dzdx) & finitew(dzdy) & finitew(zPerLength);
}

__kernel __attribute__((reqd_work_group_size(PEL_PASS_GROUP, 1, 1))) void wide_shadow(
    __global const PelShadeFrame* frame, __global const PelShadeMaterial* materials, __global const PelShadeLight* lights,
    __global const uint* list, __global uint* counters, __global uchar* material, __global uchar* normal,
    __global uchar* position, __global uchar* depth, __global const PelWideShadow* wideShadow, uint lightIndex,
    __global uchar* map, __global uchar* out) {
    const TileRun run = tileRun(frame, list);
    uint filtered = 0;
    for (uint i = run.begin; i < run.end; ++i) {
        const uint2 origin = tileOrigin(frame, list, i);
        for (uint pixel = get_local_id(0) * PEL_WIDTH; pixel < PEL_TILE_PIXELS; pixel += PEL_PASS_GROUP * PEL_WIDTH) {
            const uint x = origin.x + pixel % PEL_TILE_WIDTH, y = origin.y + pixel / PEL_TILE_WIDTH;
            if (x >= frame->width || y >= frame->height) continue;
            const uint first = vectorStart(x, frame->width);
            const intw column = lanesw() + (int)first;
            const uintw id = loadIds(frame, material, first, y);
            const maskw active = (column >= (int)x) & (column < (int)frame->width) & hasMaterial(frame, id);
            if (!anyw(active)) continue;
            const Vec3w p = loadPosition(frame, position, depth, first, y);
            const Vec3w n = loadNormal(PEL_FORMAT_NORMAL, imageSpan(normal, &frame->images[PEL_NORMAL_SLOT], first, y));
            // Ids without a material may lie beyond the table.
#define PEL_WIDTH_(k, s) (active s ? materials[id s].shadowFilterWidth : 1.0f)
            const floatw width = PEL_LANES(PEL_WIDTH_);
#undef PEL_WIDTH_
            Filters f;
            const maskw able = makeFilters(wideShadow, p, n, width, &f) & active;
            maskw wanted = able;
            if (!(PEL_FEATURES & PEL_BIT_NO_SKIPPING)) wanted &= sampleLight(&lights[lightIndex], p).strength > 0.0f;
            if (PEL_FEATURES & PEL_BIT_COUNT) filtered += countw(wanted);
            const Span target = imageSpan(out, &wideShadow->out, first, y);
#define PEL_FILTER_(k, s)                                                                                       \
    if (active s) {                                                                                             \
        const WideFilter one = {f.x[k], f.y[k], f.z[k], f.dzdx[k], f.dzdy[k], f.radiusX[k], f.radiusY[k],       \
                                f.cone[k], f.perSoftness[k], (int)f.step[k]};                                   \
        *(__global float*)(target.first + (k) * target.stride) =                                                \
            wanted s ? wideShadowOfPixel(PEL_FORMAT_SHADOW_MAP, map, &wideShadow->map, &one) : 1.0f;            \
    }
            PEL_EACH_LANE(PEL_FILTER_)
#undef PEL_FILTER_
        }
    }
    if ((PEL_FEATURES & PEL_BIT_COUNT) && filtered) atomic_add(&counters[PEL_COUNT_WIDE_SHADOW], filtered);
}
