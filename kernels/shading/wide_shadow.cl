// The shadow image of one light from its shadow map: the share of the light that arrives at each pixel of a
// material, filtered over the material's shadowFilterWidth (lib/shading/wide_filter.clh), or over about a
// texel if that is 0 (lib/shading/sharp_shadow.clh).
//
// Inputs: positions or depth, geometric normals, ids, the shadow maps. Output: R32F, 0 to 1; pixels out of
// the light's reach get 1. Of a light with cascades the finest map that holds a pixel's filter is read; of
// a cube, all faces under it (lib/shading/cube_filter.clh). One work-group: a run of tiles of a light; one
// work-item: PEL_WIDTH pixels, whose filters it runs one after another, PEL_WIDTH texels at a time.
// Variants: pixels: PEL_PIXELS_..., all of them, or first every second one and then those between
// (lib/shading/between.clh). PEL_NORMAL_SLOT: the slot of the geometric normals; PEL_SHADOW_CONTENT: the
// content of texels; PEL_BOUNDS: bounds of the maps' blocks exist, and filters that they decide read no
// texel; PEL_FILTERS_WIDE: some material has a filter width: without, half of this kernel is left out.
#include "lib/image/light_buffers.clh"
#include "lib/shading/between.clh"
#include "lib/shading/cube_filter.clh"
#include "lib/shading/light.clh"
#include "lib/shading/shadow_bounds.clh"
#include "lib/shading/sharp_shadow.clh"
#if PEL_AREA_LIGHTS
#include "lib/shading/soft_shadow.clh"
#endif

// The tangent plane is followed down to this cosine to the light: five times the sideways distance.
#define PEL_FLATTEST_COSINE 0.2f
// With smaller filters texels would appear and disappear.
#define PEL_LEAST_TEXELS 2.0f
// For sharp shadows: the same cosine, and the tolerance along the normal in texels. docs/guide/shading.md,
// "Irradiance per pixel", compares other values.
#define PEL_SHARP_FLATTEST 0.05f
#define PEL_SHARP_TEXELS 0.5f

// Where a point is in a map, and the tangent plane there.
typedef struct Receiver {
    floatw u, v, z, w;
    floatw zPerLength;        // depth per length along the light
    floatw extentU, extentV;  // length that u, v from 0 to 1 span
    floatw texelU, texelV;    // length
    floatw cosine;            // of the normal to the light
    floatw x, y;              // texels from the middle of texel (0, 0)
} Receiver;

static inline Receiver receiverInMap(__global const PelWideShadow* light, Vec3w p, Vec3w n) {
    Receiver r;
    __global const float* m = light->worldToShadow;
    r.w = matrixRow(m, 3, p);
    const floatw inverse = 1.0f / r.w;
    r.u = matrixRow(m, 0, p) * inverse, r.v = matrixRow(m, 1, p) * inverse,
    r.z = matrixRow(m, 2, p) * inverse;
    // Towards the light, of length 1 along the map's axis.
    Vec3w toLight = scale3(loadUniform3(light->forward), (floatw)(-1.0f));
    r.zPerLength = light->zPerLength, r.extentU = light->extent[0], r.extentV = light->extent[1];
    if (light->projection == PEL_MAP_PERSPECTIVE) {
        toLight = sub3(toLight, scale3(loadUniform3(light->right), (r.u - light->centre[0]) * r.extentU));
        toLight = sub3(toLight, scale3(loadUniform3(light->down), (r.v - light->centre[1]) * r.extentV));
        const floatw distance = 1.0f / fma(r.z, (floatw)(light->depthA), (floatw)(light->depthB));
        r.zPerLength = -1.0f / (light->depthA * distance * distance);
        r.extentU *= distance;
        r.extentV *= distance;
    }
    r.texelU = r.extentU / (float)light->map.width, r.texelV = r.extentV / (float)light->map.height;
    r.cosine = dot3(n, toLight);
    r.x = fma(r.u, (floatw)((float)light->map.width), (floatw)(-0.5f));
    r.y = fma(r.v, (floatw)((float)light->map.height), (floatw)(-0.5f));
    return r;
}

// Whether depths around the receiver can be compared: it lies in front of the light and near the map, and all
// values are finite.
static inline maskw comparable(const Receiver* r, Vec3w p, Vec3w n) {
    // Far outside the map, where integers would overflow, everything is lit.
    return (r->w > 0.0f) & finite3(p) & finite3(n) & (fabs(r->x) < 1e6f) & (fabs(r->y) < 1e6f) &
           finitew(r->zPerLength);
}

// Rounding errors of depths, here and in the map, which must not count as shadow.
static inline floatw roundingOfDepth(floatw z) {
    const int format = PEL_FORMAT_SHADOW_MAP & ~PEL_FMT_STRIDED;
    const float least = 4e-7f, ofHalf = PEL_SHADOW_CONTENT == PEL_CONTENT_EXPONENTIAL ? least : 5e-4f;
    const float relative = format < PEL_FMT_R16F ? least : format <= PEL_FMT_RGBA16F ? ofHalf : least;
    const float absolute = format == PEL_FMT_R16_UNORM           ? 8e-6f  // half of a step
                           : format == PEL_FMT_A2B10G10R10_UNORM ? 5e-4f
                           : format == PEL_FMT_R8_UNORM          ? 2e-3f
                           : format == PEL_FMT_RGBA8_UNORM       ? 2e-3f
                                                                 : least;
    return fma(fabs(z), (floatw)(relative), (floatw)(absolute));
}

// Returns the lanes whose filter can be run. The other lanes lie behind the light or are not finite.
static inline maskw makeFilters(__global const PelWideShadow* light, const FilterShape* shape, Vec3w p,
                                Vec3w n, float flattest, Filters* f) {
    const floatw width = shape->width;
    const Receiver r = receiverInMap(light, p, n);
    const floatw zPerLength = r.zPerLength, texelU = r.texelU, texelV = r.texelV, cosine = r.cosine;
    const floatw tilt = 1.0f / fmax(cosine, (floatw)(flattest));
    // A point that faces away is behind its own body. Up to two filter widths of that do not count as shadow;
    // the curvature table darkens it.
    const floatw body = 2.0f * width * max0w(-cosine);
    const floatw dzdx = dot3(n, loadUniform3(light->right)) * tilt * texelU * zPerLength;
    const floatw dzdy = dot3(n, loadUniform3(light->down)) * tilt * texelV * zPerLength;
    const floatw radiusX = fmax(0.5f * width / texelU, (floatw)(PEL_LEAST_TEXELS));
    const floatw radiusY = fmax(0.5f * width / texelV, (floatw)(PEL_LEAST_TEXELS));
    const floatw step = fmax(ceil(2.0f * fmax(radiusX, radiusY) / light->maxTexels), (floatw)(1.0f));
    storew(r.x, 0, f->x);
    storew(r.y, 0, f->y);
    const floatw bias = fmax(shape->bias * fabs(zPerLength), roundingOfDepth(r.z));
    storew(r.z - copysign(bias, zPerLength) - body * zPerLength, 0, f->z);
    storew(dzdx, 0, f->dzdx);
    storew(dzdy, 0, f->dzdy);
    storew(radiusX, 0, f->radiusX);
    storew(radiusY, 0, f->radiusY);
    storew(shape->coneSlope * tilt * 0.5f * width * zPerLength, 0, f->cone);
    if (PEL_SHADOW_CONTENT == PEL_CONTENT_MOMENTS)
        storew(1.0f / (floatw)(zPerLength), 0, f->scale);
    else if (PEL_SHADOW_CONTENT == PEL_CONTENT_EXPONENTIAL)
        storew((floatw)(light->exponent), 0, f->scale);
    else
        storew(1.0f / (shape->softness * width * zPerLength), 0, f->scale);
    storew(step, 0, f->step);
    maskw held = -1;
    if ((PEL_FEATURES & PEL_BIT_SHADOW_CASCADES) && light->cascades)
        held = mapHolds(vec3(r.u, r.v, r.z), 0.5f * width / r.extentU, 0.5f * width / r.extentV);
    return held & comparable(&r, p, n) & (radiusX < 1e6f) & (radiusY < 1e6f) & finitew(dzdx) & finitew(dzdy);
}

// The sharp shadow of the lanes of `left` that this map holds; these are removed from `left`.
static inline floatw sharpInMap(__global const PelWideShadow* light, __global const uchar* map, Vec3w p,
                                Vec3w n, float perExponent, floatw shown, maskw* left) {
    const Receiver r = receiverInMap(light, p, n);
    maskw held = *left & comparable(&r, p, n);
    if ((PEL_FEATURES & PEL_BIT_SHADOW_CASCADES) && light->cascades)
        held &= mapHolds(vec3(r.u, r.v, r.z), 1.5f * r.texelU / r.extentU, 1.5f * r.texelV / r.extentV);
    if (!anyw(held)) return shown;
    *left &= notw(held);
    const floatw tilt = 1.0f / fmax(r.cosine, (floatw)(PEL_SHARP_FLATTEST));
    SharpReceiver s;
    s.x = r.x, s.y = r.y, s.z = r.z;
    s.dzdx = dot3(n, loadUniform3(light->right)) * tilt * r.texelU * r.zPerLength;
    s.dzdy = dot3(n, loadUniform3(light->down)) * tilt * r.texelV * r.zPerLength;
    const floatw least = roundingOfDepth(r.z);
    // A depth before the tangent plane by less than this belongs to the receiver itself: the deviation of a
    // surface and its facets from the plane, inside the footprint, grows with the size of texels.
    const floatw tolerance =
        fmax(PEL_SHARP_TEXELS * fmax(r.texelU, r.texelV) * tilt * fabs(r.zPerLength), least);
    s.perTolerance = copysign(1.0f / tolerance, r.zPerLength);
    return selectw(shown, sharpShadow(PEL_FORMAT_SHADOW_MAP, map, &light->map, &s, perExponent, held), held);
}

#if PEL_AREA_LIGHTS
// Penumbra width of an area light; 0: unknown, or another type of light. `n`: towards the light.
static inline floatw penumbraOfLight(__global const PelWideShadow* light, __global const PelShadeLight* from,
                                     __global uchar* map, Vec3w p, Vec3w n, floatw bias, maskw on) {
    if (!isArea(from) || !(light->maxTexels > 0.0f) || light->projection == PEL_MAP_PARALLEL || !anyw(on))
        return (floatw)(0.0f);
    const floatw radius = areaRadius(from, p);
    if ((PEL_FEATURES & PEL_BIT_SHADOW_CUBE) && light->projection >= PEL_MAP_CUBE) {
        __global const float* m = light->worldToShadow;
        return penumbraInCube(PEL_FORMAT_SHADOW_MAP, firstTexel(map, &light->map), from, radius,
                              cubePosition(m, p), cubeTurned(m, n), bias, on);
    }
    const Receiver r = receiverInMap(light, p, n);
    const floatw tilt = 1.0f / fmax(r.cosine, (floatw)(PEL_SHARP_FLATTEST));
    const floatw dzdx = dot3(n, loadUniform3(light->right)) * tilt * r.texelU * r.zPerLength,
                 dzdy = dot3(n, loadUniform3(light->down)) * tilt * r.texelV * r.zPerLength;
    return penumbraInMap(PEL_FORMAT_SHADOW_MAP, firstTexel(map, &light->map), &light->map, from, radius, r.x,
                         r.y, r.z, dzdx, dzdy, 1.0f / r.texelU, 1.0f / r.texelV,
                         bias + PEL_SHARP_TEXELS * fmax(r.texelU, r.texelV) * tilt,
                         on & comparable(&r, p, n));
}
#endif

// Settings of the materials of these ids; ids without a material may lie beyond the table.
static inline FilterShape filterShape(__global const PelWideShadow* light,
                                      __global const PelShadeMaterial* materials, uintw id, maskw active) {
#define FIELD(field) PEL_LANES(OF_##field)
#define OF_shadowFilterWidth(k, s) (active s ? materials[id s].shadowFilterWidth : 1.0f)
#define OF_shadowBias(k, s) (active s ? materials[id s].shadowBias : 0.0f)
#define OF_shadowSoftness(k, s) (active s ? materials[id s].shadowSoftness : 1.0f)
#define OF_shadowConeSlope(k, s) (active s ? materials[id s].shadowConeSlope : 0.0f)
    FilterShape shape;
    shape.width = FIELD(shadowFilterWidth);
    shape.bias = light->bias, shape.softness = light->softness, shape.coneSlope = light->coneSlope;
    if (light->bias < 0.0f) shape.bias = FIELD(shadowBias);
    if (light->softness < 0.0f) shape.softness = FIELD(shadowSoftness);
    if (light->coneSlope < 0.0f) shape.coneSlope = FIELD(shadowConeSlope);
    return shape;
#undef FIELD
}

// The pixels of `active` whose material takes sharp shadows. These are not interpolated.
static inline maskw takesSharp(__global const PelShadeMaterial* materials, uintw id, maskw active) {
#define PEL_WIDE_(k, s) (active s ? materials[id s].shadowFilterWidth : 1.0f)
    const floatw width = PEL_LANES(PEL_WIDE_);
#undef PEL_WIDE_
    return width == 0.0f;
}

// Positions and geometric normals of PEL_WIDTH pixels from (x, y) on, every one or every second of the row.
static inline void loadSurface(__global const PelShadeFrame* frame, __global uchar* normal,
                               __global uchar* position, __global uchar* depth, uint x, uint y, uint apart,
                               Vec3w* p, Vec3w* n) {
    *p = loadPosition(frame, position, depth, x, y);
    *n = loadNormal(PEL_FORMAT_NORMAL, imageSpan(normal, &frame->images[PEL_NORMAL_SLOT], x, y));
    if (PEL_WIDTH == 1 || apart == 1) return;
    const uint end = x + PEL_WIDTH - 1;
    *p = everySecond3(*p, loadPosition(frame, position, depth, end, y));
    *n = everySecond3(
        *n, loadNormal(PEL_FORMAT_NORMAL, imageSpan(normal, &frame->images[PEL_NORMAL_SLOT], end, y)));
}

// A light's shadow at the pixels of a tile that fall to one of PEL_PASS_GROUP items. Returns how many had
// their shadow filtered, and how many filters read the map.
static PEL_OUT_OF_LINE uint2 shadowTile(__global const PelShadeFrame* frame,
                                        __global const PelShadeMaterial* materials,
                                        __global const PelShadeLight* lights, __global const uint* list,
                                        __global uchar* material, __global uchar* normal,
                                        __global uchar* position, __global uchar* depth,
                                        __global const PelWideShadow* wideShadow,
                                        __global const float* bounds, __global uchar* out, uint pixels,
                                        uint2 origin, uint item PEL_LIGHT_BUFFER_ARGUMENTS) {
    __global const PelShadeLight* from = &lights[wideShadow->light];
    const WideContent content = {wideShadow->perExponent, wideShadow->minDeviation * wideShadow->minDeviation,
                                 wideShadow->bleeding};
    const uint maps = (PEL_FEATURES & PEL_BIT_SHADOW_CASCADES) ? max(wideShadow->cascades, 1u) : 1;
    // Filters over the penumbra of an area light are wide, so the tangent plane is extended further.
    const float flattest = isArea(from) ? PEL_SHARP_FLATTEST : PEL_FLATTEST_COSINE;
#if PEL_FILTERS_WIDE
    const BetweenImages images = {frame, material, position, depth};
#endif
    const uint apart = pixels == PEL_PIXELS_SECOND ? 2 : 1,
               end = apart == 2 ? PEL_TILE_WIDTH : PEL_TILE_PIXELS;
    uint filtered = 0, texels = 0;
    for (uint pixel = item * PEL_WIDTH * apart; pixel < end; pixel += PEL_PASS_GROUP * PEL_WIDTH * apart) {
        const uint x = origin.x + pixel % PEL_TILE_WIDTH, y = origin.y + pixel / PEL_TILE_WIDTH;
        if (x >= frame->width || y >= frame->height) continue;
        const uint first = apart == 2 ? everySecondStart(x, frame->width) : vectorStart(x, frame->width);
        const intw column = lanesw() * (int)apart + (int)first;
        uintw id = loadIds(frame, material, first, y);
        if (PEL_WIDTH > 1 && apart == 2)
            id = (uintw)PEL_EVERY_SECOND(id, loadIds(frame, material, first + PEL_WIDTH - 1, y));
        maskw active = (column >= (int)x) & (column < (int)frame->width) & hasMaterial(frame, id);
        if (!anyw(active)) continue;
        Vec3w p, n;
        loadSurface(frame, normal, position, depth, first, y, apart, &p, &n);
        const Span target = imageSpan(out, &wideShadow->out, first, y);
        floatw between = 1.0f;
        maskw known = 0;
#if PEL_FILTERS_WIDE
        if (pixels == PEL_PIXELS_BETWEEN) {
            // Computed pixels keep their value.
            active &= ((column & 1) != 0) | (int)(y & 1 ? -1 : 0);
            known = valueBetween(&images, (__global const float*)target.first, id, p, first, y,
                                 active & notw(takesSharp(materials, id, active)), &between);
        }
#endif
#if PEL_THIN
        // A sheet that is lit from its other side has the same tangent plane there.
#define PEL_SHEET_(k, s) (active s && materials[id s].through[0] > 0.0f ? 1.0f : 0.0f)
        const maskw sheet = PEL_LANES(PEL_SHEET_) > 0.0f;
#undef PEL_SHEET_
        const floatw facing = dot3(n, sampleLight(from, p).direction);
        n = scale3(n, selectw((floatw)(1.0f), (floatw)(-1.0f), sheet & (facing < 0.0f)));
#endif
        FilterShape shape = filterShape(wideShadow, materials, id, active);
        maskw left = active & notw(known);
        const LightSample sample = sampleLight(from, p);
        // Other pixels interpolate between these, so skipping must not change them.
        if (!(PEL_FEATURES & PEL_BIT_NO_SKIPPING) || apart == 2) left &= sample.strength > 0.0f;
#if PEL_AREA_LIGHTS
        // If only the light's centre is below the horizon, its map does not show the occluders of the rest:
        // no shadow. If all of it is, shading normals may still face it: shadow.
        if (isArea(from))
            left &= (dot3(n, sub3(loadUniform3(from->position), p)) > 0.0f) |
                    notw(facesLight(from, sample, p, n));
        const floatw penumbra =
            penumbraOfLight(wideShadow, from, PEL_LIGHT_BUFFER_OF(from->mapBuffer), p, n, shape.bias, left);
        shape.width = sqrt(fma(shape.width, shape.width, penumbra * penumbra));
#endif
        maskw sharp = left & (shape.width == 0.0f);
        float shown[PEL_WIDTH];
        storew(selectw((floatw)(1.0f), between, known), 0, shown);
        if (!(wideShadow->maxTexels > 0.0f)) left = sharp;  // this light has only sharp shadows
        if ((PEL_FEATURES & PEL_BIT_SHADOW_CUBE) && wideShadow->projection >= PEL_MAP_CUBE) {
            CubeFilters f;
            __global const uchar* map = firstTexel(PEL_LIGHT_BUFFER_OF(from->mapBuffer), &wideShadow->map);
            __global const float* m = wideShadow->worldToShadow;
            // In cubes the sharp shadow is the smallest disk, two texels in radius.
            const Vec3w q = cubePosition(m, p);
            shape.width =
                selectw(shape.width, sqrt(dot3(q, q)) * (8.0f / (float)wideShadow->map.width), sharp);
            left &= makeCubeFilters(wideShadow, &shape, q, cubeTurned(m, n), flattest, &f);
            if (PEL_FEATURES & PEL_BIT_COUNT) filtered += countw(left), texels += countw(left);
            int wanted[PEL_WIDTH];
            storew(left, 0, wanted);
            // unrolled, a compiler would copy the whole filter for each lane
            for (int k = 0; k < PEL_WIDTH; ++k)
                if (wanted[k])
                    shown[k] = wideShadowInCube(PEL_FORMAT_SHADOW_MAP, map, wideShadow, &f, k, &content);
        } else {
            left &= notw(sharp);
            for (uint cascade = 0; cascade < maps && anyw(left | sharp); ++cascade) {
                Filters f;
                __global const PelWideShadow* light = wideShadow + cascade;
                __global uchar* map =
                    PEL_LIGHT_BUFFER_OF(from->cascades ? from->cascade[cascade].mapBuffer : from->mapBuffer);
                if (anyw(sharp)) {
                    const maskw before = sharp;
                    storew(sharpInMap(light, firstTexel(map, &light->map), p, n, content.perExponent,
                                      loadw(0, shown), &sharp),
                           0, shown);
                    if (PEL_FEATURES & PEL_BIT_COUNT)
                        filtered += countw(before & notw(sharp)), texels += countw(before & notw(sharp));
                    if (!anyw(left)) continue;
                }
#if PEL_FILTERS_WIDE
                const maskw held = makeFilters(light, &shape, p, n, flattest, &f) & left;
                if (PEL_FEATURES & PEL_BIT_COUNT) filtered += countw(held);
                left &= notw(held);
                float decided[PEL_WIDTH];
                storew((floatw)(-1.0f), 0, decided);
                if (PEL_BOUNDS && boundsPay(frame, list, &light->map))
                    uniformShadows(bounds + light->bounds, &light->map, &f, held, decided);
                int wanted[PEL_WIDTH];
                storew(held, 0, wanted);
                for (int k = 0; k < PEL_WIDTH; ++k) {
                    if (!wanted[k]) continue;
                    shown[k] = decided[k];
                    if (shown[k] >= 0.0f) continue;
                    const WideFilter one = {f.x[k],     f.y[k],        f.z[k],       f.dzdx[k],
                                            f.dzdy[k],  f.radiusX[k],  f.radiusY[k], f.cone[k],
                                            f.scale[k], (int)f.step[k]};
                    ++texels;
                    shown[k] = wideShadowOfPixel(PEL_FORMAT_SHADOW_MAP, map, &light->map, &one, &content);
                }
#endif
            }
        }
#define PEL_STORE_(k, s) \
    if (active s) *(__global float*)(target.first + (k)*apart * target.stride) = shown[k];
        PEL_EACH_LANE(PEL_STORE_)
#undef PEL_STORE_
    }
    return (uint2)(filtered, texels);
}

__kernel PEL_WORK_GROUP(PEL_PASS_GROUP) void wide_shadow(
    __global const PelShadeFrame* restrict frame, __global const PelShadeMaterial* restrict materials,
    __global const PelShadeLight* restrict lights, __global const uint* restrict list,
    __global uint* counters, __global uchar* restrict material, __global uchar* restrict normal,
    __global uchar* restrict position, __global uchar* restrict depth,
    __global const PelWideShadow* restrict wideShadows, uint firstLight,
    __global const float* restrict bounds, __global uchar* restrict out,
    uint pixels PEL_LIGHT_BUFFER_ARGUMENTS) {
    const TileRun run = tileRun(frame, list);
    __global const PelWideShadow* wideShadow = wideShadows + (firstLight + get_global_id(2)) * PEL_CASCADES;
    uint2 counts = 0;
    for (uint i = run.begin; i < run.end; ++i)
        counts +=
            shadowTile(frame, materials, lights, list, material, normal, position, depth, wideShadow, bounds,
                       out, pixels, tileOrigin(frame, list, i), get_local_id(0) PEL_LIGHT_BUFFER_VALUES);
    if ((PEL_FEATURES & PEL_BIT_COUNT) && counts.x) {
        atomic_add(&counters[PEL_COUNT_WIDE_SHADOW], counts.x);
        if (counts.y) atomic_add(&counters[PEL_COUNT_SHADOW_TEXELS], counts.y);
    }
}
