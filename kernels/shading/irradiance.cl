// Irradiance / pi at each pixel, before it scatters: all lights with sharp shadows, and the ambient light
// (section 6 of the mathematics without a profile); without specular light and albedo.
//
// Inputs: shading normals, positions or depth if a light has a position, ambient occlusion, indirect light,
// thickness of the body, shadows per pixel and light, ids. Output: planes of RGB, NaN where an input is.
// Pixels of materials that use the tables (PEL_SCATTER_PREINTEGRATED) are not changed. One work-group: a run
// of tiles; one work-item: PEL_WIDTH pixels of a row at a time. Variants: as shade.cl.
#define IMAGES_RESTRICT restrict
#include "lib/image/planes.clh"
#include "lib/shading/kept_by_slab.clh"
#include "lib/shading/tiles.clh"
#include "shading/scene.clh"

// Three floats of each pixel's material, 0 outside `wanted`; `field`: of the first material.
static inline Vec3w ofMaterials(__global const float* field, uintw id, maskw wanted) {
    const uint stride = sizeof(PelShadeMaterial) / sizeof(float);
#define PEL_RED_(k, s) (wanted s ? field[id s * stride] : 0.0f)
#define PEL_GREEN_(k, s) (wanted s ? field[id s * stride + 1] : 0.0f)
#define PEL_BLUE_(k, s) (wanted s ? field[id s * stride + 2] : 0.0f)
    return vec3(PEL_LANES(PEL_RED_), PEL_LANES(PEL_GREEN_), PEL_LANES(PEL_BLUE_));
#undef PEL_RED_
#undef PEL_GREEN_
#undef PEL_BLUE_
}

// Irradiance at PEL_WIDTH pixels from (x, y) on. Where no light arrives its shadow does not matter.
static inline Vec3w arrivingLight(const Scene* scene, __global const PelShadeMaterial* materials, uintw id,
                                  maskw wanted, uint x, uint y) {
    __global const PelShadeFrame* frame = scene->frame;
    const Vec3w n = loadNormal(PEL_FORMAT_NORMAL_SHADING, SPAN(NORMAL_SHADING));
    Vec3w p = n;
    if (HAS(PEL_BIT_POSITIONAL)) p = loadPosition(frame, scene->images.POSITION, scene->images.DEPTH, x, y);
    maskw valid = finite3(n) & finite3(p);
    Vec3w e = same3(0.0f);
    if (HAS(PEL_BIT_AMBIENT)) {
        e = ambientAlong(scene, n);
        if (PEL_FORMAT_AMBIENT_OCCLUSION)
            e = scale3(e, loadScalar(PEL_FORMAT_AMBIENT_OCCLUSION, SPAN(AMBIENT_OCCLUSION)));
        if (PEL_FORMAT_INDIRECT) {
            const Vec3w indirect = loadColor(PEL_FORMAT_INDIRECT, SPAN(INDIRECT));
            valid &= finite3(indirect);
            e = add3(e, indirect);
        }
    }
#if PEL_THIN
    // Sheets also receive light on their other side, with the shadow of this side.
    const Vec3w through = ofMaterials(materials->through, id, wanted);
    if (HAS(PEL_BIT_AMBIENT)) {
        Vec3w behind = mul3(through, ambientAlong(scene, scale3(n, (floatw)(-1.0f))));
        if (PEL_FORMAT_AMBIENT_OCCLUSION)
            behind = scale3(behind, loadScalar(PEL_FORMAT_AMBIENT_OCCLUSION, SPAN(AMBIENT_OCCLUSION)));
        e = add3(e, behind);
    }
#endif
    for (uint i = 0; i < frame->lights; ++i) {
        __global const PelShadeLight* light = &scene->lights[i];
        const LightSample sample = sampleLight(light, p);
        const floatw w = loadWideShadow(scene, light, x, y);
        valid &= finitew(w);
        const Vec3w color = loadUniform3(light->color);
        const floatw cosine = dot3(n, sample.direction), arrives = sample.strength * satw(w);
        e = add3(e, scale3(color, arrives * lambertOf(light, sample.sin2, p, n, cosine)));
#if PEL_THIN
        const Vec3w back = scale3(n, (floatw)(-1.0f));
        e = add3(e, scale3(mul3(color, through), arrives * lambertOf(light, sample.sin2, p, back, -cosine)));
#endif
    }
#if PEL_FORMAT_THICKNESS
    floatw thickness = loadScalar(PEL_FORMAT_THICKNESS, SPAN(THICKNESS));
#if PEL_THIN
    // The reflectance of a sheet is its albedo, whatever its thickness.
    thickness = selectw(thickness, (floatw)(0.0f), through.x + through.y + through.z > 0.0f);
#endif
    const Vec3w path = ofMaterials(materials->gain, id, wanted),
                s = ofMaterials(materials->absorption, id, wanted);
    e = mul3(e, vec3(keptBySlab(thickness, path.x, s.x), keptBySlab(thickness, path.y, s.y),
                     keptBySlab(thickness, path.z, s.z)));
#endif
    const floatw none = NAN;
    return select3(vec3(none, none, none), e, valid);
}

// The pixels of a tile that fall to one of PEL_PASS_GROUP items. Returns how many were lit, if counted.
static PEL_OUT_OF_LINE uint lightTile(const Scene* restrict scene, __global const PelShadeMaterial* materials,
                                      __global float* out, uint plane, uint2 origin, uint item) {
    __global const PelShadeFrame* frame = scene->frame;
    uint lit = 0;
    for (uint pixel = item * PEL_WIDTH; pixel < PEL_TILE_PIXELS; pixel += PEL_PASS_GROUP * PEL_WIDTH) {
        const uint x = origin.x + pixel % PEL_TILE_WIDTH, y = origin.y + pixel / PEL_TILE_WIDTH;
        if (x >= frame->width || y >= frame->height) continue;
        const uint first = vectorStart(x, frame->width);
        const intw column = lanesw() + (int)first;
        const uintw id = loadIds(frame, scene->images.MATERIAL, first, y);
        const maskw active = (column >= (int)x) & (column < (int)frame->width) & hasMaterial(frame, id);
        if (!anyw(active)) continue;
#define PEL_SCATTERS_(k, s) \
    (active s && materials[id s].scattering != PEL_SCATTER_PREINTEGRATED ? 1.0f : 0.0f)
        const maskw wanted = PEL_LANES(PEL_SCATTERS_) > 0.0f;
#undef PEL_SCATTERS_
        if (!anyw(wanted)) continue;
        storePlanes(out, plane, scratchIndex(frame, first, y),
                    arrivingLight(scene, materials, id, wanted, first, y), wanted);
        if (HAS(PEL_BIT_COUNT)) lit += countw(wanted);
    }
    return lit;
}

__kernel __attribute__((reqd_work_group_size(PEL_PASS_GROUP, 1, 1))) void make_irradiance(
    SCENE_ARGUMENTS __global float* restrict out, uint plane) {
    const Scene scene = SCENE_VALUE;
    const TileRun run = tileRun(frame, list);
    uint lit = 0;
    for (uint i = run.begin; i < run.end; ++i)
        lit += lightTile(&scene, materials, out, plane, tileOrigin(frame, list, i), get_local_id(0));
    if (HAS(PEL_BIT_COUNT) && lit) atomic_add(&counters[PEL_COUNT_IRRADIANCE], lit);
}
