// The screen-space shading pass: section 6 of the mathematics for every pixel with a material. Materials that
// scatter by another method than the tables, or not at all, take their diffuse light from the irradiance
// image.
//
// Inputs: the images of PelImageSlot and of each light in the caller's layout (shared/shade.h), materials,
// lights, the tables in one buffer, and one of the lists of tiles from classify_tiles.cl. Output: radiance,
// linear RGB. One work-group takes one tile after another from the list; one work-item takes PEL_WIDTH pixels
// of a row at a time. Variants: PEL_FEATURES (shared/features.h) and the format of each image,
// PEL_FORMAT_<SLOT>, 0 without an image; all wide shadows have one format, and all shadow maps have the same
// PEL_SHADOW_CONTENT. Unused buffers are NULL.
#include "lib/image/image.clh"
#include "lib/shading/material_id.clh"
#include "shading/scene.clh"
#include "shading/shade_eye.clh"
#include "shading/shade_light.clh"

// Ambient light at the three normals.
static inline Vec3w ambientOfPixels(const Scene* scene, float3 blend, const Pixels* p) {
    __global const PelShadeFrame* frame = scene->frame;
    if (!HAS(PEL_BIT_AMBIENT_CUBE)) return ambientLight(frame->ambient, blend, p->n, p->nb);
    const Vec3w e = cubeAmbientLight(scene->cube, frame->cubeSize, blend, p->n, p->nb);
    return HAS(PEL_BIT_CUBE_ALONE) ? e : add3(e, ambientLight(frame->ambient, blend, p->n, p->nb));
}

static inline Vec3w albedoAfter(Vec3w albedo, float power) {
    return vec3(pow(max0w(albedo.x), (floatw)(power)), pow(max0w(albedo.y), (floatw)(power)),
                pow(max0w(albedo.z), (floatw)(power)));
}

// Pixels of one material, `active`. Always inlined, as shadePixels.
static inline __attribute__((always_inline)) Vec3w shadeMaterial(const Scene* scene,
                                                                 __global const PelShadeMaterial* material,
                                                                 Pixels* p, uint x, uint y, maskw active,
                                                                 Parts* parts, Vec3w* specularPart,
                                                                 Counts* counts) {
    __global const PelShadeFrame* frame = scene->frame;
    // Whether diffuse light is read from the irradiance image, which holds all lights and the ambient light,
    // already scattered.
    const bool scattered = HAS(PEL_BIT_IRRADIANCE) && material->scattering != PEL_SCATTER_PREINTEGRATED;
    countMethod(counts, PEL_COUNT_SCATTERING, material->named, active);
    if (material->named == PEL_SCATTER_AUTO)
        countMethod(counts, PEL_COUNT_CHOICE, material->scattering, active);
    // Only inputs that its own material reads can make a pixel invalid, so other materials of the tile do not
    // matter.
    p->valid &= ((p->invalidBits & material->needs) == 0) | notw(active);
    Vec3w diffuse = same3(0.0f), specular = diffuse;
    parts->diffuse = parts->deepScatter = diffuse;
    Vec3w before = diffuse;  // light that includes the albedo
    parts->thickness = 0.0f;
    parts->measured = PEL_FORMAT_THICKNESS != 0;
    if (PEL_FORMAT_THICKNESS && PEL_FORMAT_OUT_THICKNESS) parts->thickness = p->thickness;
    if (scattered) {
        const Vec3w irradiance = withGain(material, p, p->irradiance);
        if (material->albedoAfter == 1.0f)
            diffuse = irradiance;
        else  // it includes a part of the albedo
            before =
                mul3(irradiance, albedoAfter(PEL_FORMAT_ALBEDO ? p->albedo : loadUniform3(material->albedo),
                                             material->albedoAfter));
        if (PEL_FORMAT_OUT_DIFFUSE) parts->diffuse = diffuse;
    } else if (HAS(PEL_BIT_AMBIENT)) {
        diffuse = ambientOfPixels(scene, vload3(0, material->normalBlend), p);
        if (PEL_FORMAT_AMBIENT_OCCLUSION) diffuse = scale3(diffuse, p->occlusion);
        if (PEL_FORMAT_INDIRECT) diffuse = add3(diffuse, p->indirect);
        diffuse = withGain(material, p, diffuse);
        if (PEL_FORMAT_OUT_DIFFUSE) parts->diffuse = diffuse;
    }
    if (HAS(PEL_BIT_AMBIENT_SCATTER) && (material->needs & PEL_BIT_AMBIENT_SCATTER)) {
        const floatw through =
            material->deepScatterAmbient *
            transmittance(p->thickness, material->deepScatterFalloff, material->thicknessCutoff);
        if (!SKIPPING || anyw(active & (through > 0.0f))) {
            const Vec3w e = ambientAlong(scene, scale3(p->nb, (floatw)(-1.0f)));
            Vec3w deep = scale3(mul3(loadUniform3(material->deepScatterColor), e), through);
            // NaN in a cube must not affect pixels through which no light comes.
            if (HAS(PEL_BIT_AMBIENT_CUBE)) deep = select3(same3(0.0f), deep, through > 0.0f);
            diffuse = add3(diffuse, deep);
            if (PEL_FORMAT_OUT_DEEP_SCATTER) parts->deepScatter = deep;
        }
    }
    if (HAS(PEL_BIT_ENVIRONMENT) && material->specular != 0.0f)
        specular = environmentGloss(scene, material, p);
    const bool isEye = HAS(PEL_BIT_EYE) && material->eye;
    __global const PelShadeEye* eye = &scene->eyes[isEye ? material->eye - 1 : 0];
    EyeLight inEye;
    maskw outside = active;  // pixels that show the material itself
    if (isEye) {
        inEye = beginEye(scene, eye, p, active & p->valid, counts);
        outside &= inEye.view.cornea < 1.0f;
    }
    const bool readsShadow =
        !scattered || (material->needs & (PEL_BIT_SPECULAR | PEL_BIT_DEEP_SCATTER | PEL_BIT_EYE));
    const bool lit = !SKIPPING || readsShadow || PEL_FORMAT_OUT_THICKNESS;
    for (uint i = 0; lit && i < frame->lights; ++i) {
        __global const PelShadeLight* light = &scene->lights[i];
        const floatw w = loadWideShadow(scene, light, x, y);
        if (readsShadow) p->valid &= finitew(w) | notw(active);
        addLight(scene, material, light, p, w, outside & p->valid, scattered, &diffuse, &specular, parts,
                 counts);
        if (isEye) addToEye(scene, material, eye, light, p, w, active & p->valid, &inEye, counts);
    }
    const Vec3w albedo = PEL_FORMAT_ALBEDO ? p->albedo : loadUniform3(material->albedo);
    if (PEL_FORMAT_OUT_DIFFUSE) parts->diffuse = add3(mul3(parts->diffuse, albedo), before);
    if (PEL_FORMAT_OUT_DEEP_SCATTER) parts->deepScatter = mul3(parts->deepScatter, albedo);
    *specularPart = specular;
    const Vec3w radiance = add3(mul3(albedo, diffuse), specular),
                whole = HAS(PEL_BIT_IRRADIANCE) ? add3(radiance, before) : radiance;
    if (!isEye) return whole;
    const floatw sclera = 1.0f - inEye.view.cornea;
    const Vec3w iris = irisRadiance(scene, eye, p, x, y, active & p->valid, &inEye);
    *specularPart = add3(scale3(specular, sclera), inEye.reflected);
    if (PEL_FORMAT_OUT_DIFFUSE) parts->diffuse = add3(scale3(parts->diffuse, sclera), iris);
    if (PEL_FORMAT_OUT_DEEP_SCATTER) parts->deepScatter = scale3(parts->deepScatter, sclera);
    return add3(add3(scale3(whole, sclera), iris), inEye.reflected);
}

// Writes one part beside radiance.
#define STORE_PART(slot, part) \
    if (PEL_FORMAT_##slot)     \
        storeColor(PEL_FORMAT_##slot, SPAN(slot), select3(invalid, part, valid& finite3(part)), active);

// PEL_WIDTH pixels from (x, y) on; those of `active` are wanted. Always inlined: a call would put Scene into
// private memory, which GPUs place in global memory.
static inline __attribute__((always_inline)) void shadePixels(const Scene* scene, uint x, uint y, uintw id,
                                                              maskw active, Counts* counts) {
    __global const PelShadeFrame* frame = scene->frame;
    Pixels p = loadPixels(scene, x, y);
    Vec3w result = same3(0.0f), specular = result;
    Parts parts = {result, result, (floatw)(0.0f), false};
    if (PEL_FORMAT_MATERIAL) {
        // Nearly always one round: neighbours share their material.
        maskw left = active;
        while (anyw(left)) {
            const uint current = greatestId(id, left);
            const maskw mask = left & (id == current);
            Parts some;
            Vec3w someSpecular;
            const Vec3w color = shadeMaterial(scene, &scene->materials[current], &p, x, y, mask, &some,
                                              &someSpecular, counts);
            result = select3(result, color, mask);
            if (PEL_FORMAT_OUT_DIFFUSE) parts.diffuse = select3(parts.diffuse, some.diffuse, mask);
            if (PEL_FORMAT_OUT_DEEP_SCATTER)
                parts.deepScatter = select3(parts.deepScatter, some.deepScatter, mask);
            if (PEL_FORMAT_OUT_SPECULAR) specular = select3(specular, someSpecular, mask);
            if (PEL_FORMAT_OUT_THICKNESS) parts.thickness = selectw(parts.thickness, some.thickness, mask);
            left &= notw(mask);
        }
    } else {
        result = shadeMaterial(scene, &scene->materials[1], &p, x, y, active, &parts, &specular, counts);
    }
    const Span target = SPAN(RADIANCE);
    const maskw valid = p.valid & finite3(result);
    maskw shown = valid;
    const Vec3w invalid = loadUniform3(frame->invalidColor);
    result = select3(invalid, result, valid);
    if (HAS(PEL_BIT_ACCUMULATE)) {
        result = add3(result, loadColorOf(PEL_FORMAT_RADIANCE, target, active));
        shown &= finite3(result);  // the previous content may be NaN or Inf
        result = select3(invalid, result, finite3(result));
    }
    count(counts, PEL_COUNT_SHADED, active);
    count(counts, PEL_COUNT_INVALID, active & notw(shown));
    storeColor(PEL_FORMAT_RADIANCE, target, result, active);
    STORE_PART(OUT_DIFFUSE, parts.diffuse)
    STORE_PART(OUT_DEEP_SCATTER, parts.deepScatter)
    STORE_PART(OUT_SPECULAR, specular)
    if (PEL_FORMAT_OUT_THICKNESS)
        storeScalar(PEL_FORMAT_OUT_THICKNESS, SPAN(OUT_THICKNESS),
                    selectw((floatw)(0.0f), parts.thickness, valid & finitew(parts.thickness)), active);
}

// Shades the pixels of a tile that fall to one of PEL_SHADE_GROUP items.
static PEL_OUT_OF_LINE void shadeTile(const Scene* restrict scene, uint tileX, uint tileY, uint item,
                                      Counts* restrict counts) {
    __global const PelShadeFrame* frame = scene->frame;
    for (uint pixel = item * PEL_WIDTH; pixel < PEL_TILE_PIXELS; pixel += PEL_SHADE_GROUP * PEL_WIDTH) {
        const uint x = tileX + pixel % PEL_TILE_WIDTH, y = tileY + pixel / PEL_TILE_WIDTH;
        if (x >= frame->width || y >= frame->height) continue;
        // At the right edge vectors begin earlier; lanes before x belong to the previous tile or vector.
        const uint first = vectorStart(x, frame->width);
        const intw column = lanesw() + (int)first;
        maskw active = (column >= (int)x) & (column < (int)frame->width);
        uintw id = 1;
        if (PEL_FORMAT_MATERIAL) {
            id = loadId(PEL_FORMAT_MATERIAL,
                        imageSpan(scene->images.MATERIAL, &frame->images[PEL_IMAGE_MATERIAL], first, y));
            active &= hasMaterial(frame, id);
        }
        if (anyw(active)) shadePixels(scene, first, y, id, active, counts);
    }
}

__kernel __attribute__((reqd_work_group_size(PEL_SHADE_GROUP, 1, 1))) void shade(SCENE_ARGUMENTS uint part,
                                                                                 uint parts, uint which) {
    Scene scene = SCENE_VALUE;
    Counts counts = {{0}};
    const bool listed = PEL_FORMAT_MATERIAL && which != PEL_EVERY_TILE;
    const uint tiles = listed ? list[PEL_TILE_COUNT(which)] : frame->tiles;
    const size_t listStart = PEL_TILE_LIST(frame, which);
    // Each group takes a run of the list: neighbours in it share pages, and often cache lines, of the images.
    // A launch takes one part of `parts` of a long frame, so that the host can stop between them.
    const uint groups = get_num_groups(0) * parts, group = get_num_groups(0) * part + get_group_id(0);
    const uint end = (uint)((ulong)tiles * (group + 1) / groups);
    for (uint i = (uint)((ulong)tiles * group / groups); i < end; ++i) {
        const uint tile = listed ? list[listStart + i] : frame->firstTile + i;
        const uint tileX = tile % frame->tilesX * PEL_TILE_WIDTH,
                   tileY = tile / frame->tilesX * PEL_TILE_HEIGHT;
        const uint next = listed && i + 1 < end ? list[listStart + i + 1] : tile + 1;
        scene.aheadColumns = (int)(next % frame->tilesX * PEL_TILE_WIDTH - tileX);
        scene.aheadRows = (int)(next / frame->tilesX * PEL_TILE_HEIGHT - tileY);
        shadeTile(&scene, tileX, tileY, get_local_id(0), &counts);
    }
    addCounts(&counts, counters);
}
