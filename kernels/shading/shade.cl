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
#include "lib/shading/cube_thickness.clh"
#include "lib/shading/deep_scatter.clh"
#include "lib/shading/direct.clh"
#include "lib/shading/ggx.clh"
#include "lib/shading/material_id.clh"
#include "lib/shading/position.clh"
#include "lib/shading/shadow.clh"
#include "lib/shading/specular.clh"
#include "lib/shading/thickness.clh"
#include "lib/shading/transmission.clh"
#include "shading/scene.clh"
#include "shared/shade.h"

#define NEEDS_POSITION HAS(PEL_READ_POSITION)

typedef struct Pixels {
    Vec3w position, toCamera;
    Vec3w ng, n, nb;
    NormalPair pair;
    Vec3w albedo, irradiance;
    floatw curvature, occlusion, thickness, roughness, specular, wetness;
    floatw tapCosine, tapSine;  // of the disk of taps; PEL_BIT_ROTATE_TAPS only
    maskw valid;                // no input that every material reads is NaN or Inf
    uintw invalidBits;          // PEL_BIT_... of features with NaN or Inf in an input
} Pixels;

// The parts for outputs beside radiance (PEL_FORMAT_OUT_...); not computed without such outputs.
typedef struct Parts {
    Vec3w diffuse, deepScatter;  // to be multiplied by albedo
    floatw thickness;
    bool measured;  // thickness is
} Parts;

#include "shading/shade_eye.clh"

// Marks features with NaN or Inf in an input. Inputs of ambient light and of positional lights are read by
// every material.
static inline void markInvalid(Pixels* p, const uint features, maskw finite) {
    if (HAS(features & (PEL_BIT_AMBIENT | PEL_BIT_POSITIONAL)))
        p->valid &= finite;
    else
        p->invalidBits |= selectw((uintw)(features), (uintw)(0), finite);
}

static inline Pixels loadPixels(const Scene* scene, uint x, uint y) {
    __global const PelShadeFrame* frame = scene->frame;
    Pixels p;
    p.n = loadNormal(PEL_FORMAT_NORMAL_SHADING, SPAN(NORMAL_SHADING));
    p.valid = finite3(p.n);
    p.invalidBits = 0;
    p.ng = p.n;
    if (PEL_FORMAT_NORMAL_GEOMETRIC) {
        p.ng = loadNormal(PEL_FORMAT_NORMAL_GEOMETRIC, SPAN(NORMAL_GEOMETRIC));
        markInvalid(&p, PEL_READ_NORMAL_GEOMETRIC | (PEL_FORMAT_NORMAL_BLURRED ? 0 : PEL_READ_NORMAL_BLURRED),
                    finite3(p.ng));
    }
    p.nb = p.ng;
    if (PEL_FORMAT_NORMAL_BLURRED) {
        p.nb = loadNormal(PEL_FORMAT_NORMAL_BLURRED, SPAN(NORMAL_BLURRED));
        markInvalid(&p, PEL_READ_NORMAL_BLURRED, finite3(p.nb));
    }
    p.pair = normalPair(p.n, p.nb);
    if (NEEDS_POSITION) {
        if (PEL_FORMAT_POSITION)
            p.position = loadColor(PEL_FORMAT_POSITION, SPAN(POSITION));
        else
            p.position = positionFromDepth(frame->inverseViewProjection, frame->width, frame->height, x, y,
                                           loadScalar(PEL_FORMAT_DEPTH, SPAN(DEPTH)));
        markInvalid(&p, PEL_READ_POSITION, finite3(p.position));
        p.toCamera = normalize3(sub3(loadUniform3(frame->cameraPosition), p.position));
    }
    if (HAS(PEL_BIT_ROTATE_TAPS)) tapRotation(x, y, &p.tapCosine, &p.tapSine);
    if (PEL_FORMAT_ALBEDO) {
        p.albedo = loadColor(PEL_FORMAT_ALBEDO, SPAN(ALBEDO));
        p.valid &= finite3(p.albedo);
    }
    if (HAS(PEL_READ_IRRADIANCE)) {
        p.irradiance = loadColor(PEL_FORMAT_IRRADIANCE, SPAN(IRRADIANCE));
        markInvalid(&p, PEL_READ_IRRADIANCE, finite3(p.irradiance));
    }
#define LOAD_SCALAR(slot, name)                             \
    if (HAS(PEL_READ_##slot) && PEL_FORMAT_##slot) {        \
        p.name = loadScalar(PEL_FORMAT_##slot, SPAN(slot)); \
        markInvalid(&p, PEL_READ_##slot, finitew(p.name));  \
    }
    LOAD_SCALAR(CURVATURE, curvature)
    LOAD_SCALAR(AMBIENT_OCCLUSION, occlusion)
    LOAD_SCALAR(THICKNESS, thickness)
    LOAD_SCALAR(ROUGHNESS, roughness)
    LOAD_SCALAR(SPECULAR, specular)
#undef LOAD_SCALAR
    if (HAS(PEL_BIT_EYE) && PEL_FORMAT_WETNESS)
        p.wetness = satw(loadScalar(PEL_FORMAT_WETNESS, SPAN(WETNESS)));
    return p;
}

// Thickness along a light with cascades, from the finest map that holds the point with its taps; 0 outside
// all maps.
static inline floatw measureInCascades(const Scene* scene, __global const PelShadeMaterial* material,
                                       __global const PelShadeLight* light, const Pixels* p, Vec3w inside,
                                       float cutoff, maskw needed) {
    floatw thickness = 0.0f;
    maskw left = needed;
    for (uint i = 0; i < light->cascades && anyw(left); ++i) {
        __global const PelShadeCascade* cascade = &light->cascade[i];
        const Vec3w uvz = shadowCoordinates(cascade->worldToShadow, inside);
        const float radiusU = material->thicknessFilterRadius * cascade->tapScale[0];
        const float radiusV = material->thicknessFilterRadius * cascade->tapScale[1];
        const maskw held = left & mapHolds(uvz, radiusU, radiusV);
        if (!anyw(held)) continue;
        __global const uchar* map = firstTexel(scene->lightImages[cascade->mapBuffer], &cascade->map);
        const floatw some = thicknessOfMap(PEL_FORMAT_SHADOW_MAP, map, &cascade->map, light,
                                           cascade->depthRange, uvz, radiusU, radiusV, material->thicknessTaps,
                                           HAS(PEL_BIT_ROTATE_TAPS), p->tapCosine, p->tapSine, cutoff, held);
        thickness = selectw(thickness, some, held);
        left &= notw(held);
    }
    return thickness;
}

// Length of the light's path inside the body, for the pixels of `needed`.
static inline floatw measureThickness(const Scene* scene, __global const PelShadeMaterial* material,
                                      __global const PelShadeLight* light, const Pixels* p, maskw needed,
                                      bool beyondCutoff) {
    const Vec3w inside = sub3(p->position, scale3(p->ng, (floatw)(material->deepScatterNormalOffset)));
    const float cutoff = beyondCutoff ? INFINITY : material->thicknessCutoff;
    if (HAS(PEL_BIT_SHADOW_CUBE) && light->projection >= PEL_MAP_CUBE)
        return cubeThickness(
            PEL_FORMAT_SHADOW_MAP, firstTexel(scene->lightImages[light->mapBuffer], &light->map), light,
            cubePosition(light->worldToShadow, inside), material->thicknessFilterRadius,
            material->thicknessTaps, HAS(PEL_BIT_ROTATE_TAPS), p->tapCosine, p->tapSine, cutoff, needed);
    if (HAS(PEL_BIT_SHADOW_CASCADES) && light->cascades)
        return measureInCascades(scene, material, light, p, inside, cutoff, needed);
    return thicknessTaps(PEL_FORMAT_SHADOW_MAP, firstTexel(scene->lightImages[light->mapBuffer], &light->map),
                         light, shadowCoordinates(light->worldToShadow, inside),
                         material->thicknessFilterRadius, material->thicknessTaps, HAS(PEL_BIT_ROTATE_TAPS),
                         p->tapCosine, p->tapSine, cutoff, needed);
}

// The same for transmission, whose position is not moved: the greatest thickness near each pixel of `needed`.
static inline floatw measureGreatest(const Scene* scene, __global const PelShadeLight* light, const Pixels* p,
                                     maskw needed) {
    if (HAS(PEL_BIT_SHADOW_CUBE) && light->projection >= PEL_MAP_CUBE)
        return greatestInCube(PEL_FORMAT_SHADOW_MAP,
                              firstTexel(scene->lightImages[light->mapBuffer], &light->map), light,
                              cubePosition(light->worldToShadow, p->position));
    if (HAS(PEL_BIT_SHADOW_CASCADES) && light->cascades) {
        floatw thickness = INFINITY;  // outside of all nothing comes through
        maskw left = needed;
        for (uint i = 0; i < light->cascades && anyw(left); ++i) {
            __global const PelShadeCascade* cascade = &light->cascade[i];
            const Vec3w uvz = shadowCoordinates(cascade->worldToShadow, p->position);
            const maskw held = left & mapHolds(uvz, PEL_TRANSMISSION_TEXELS / (float)cascade->map.width,
                                               PEL_TRANSMISSION_TEXELS / (float)cascade->map.height);
            if (!anyw(held)) continue;
            __global const uchar* map = firstTexel(scene->lightImages[cascade->mapBuffer], &cascade->map);
            thickness = selectw(
                thickness,
                greatestInMap(PEL_FORMAT_SHADOW_MAP, map, &cascade->map, light, cascade->depthRange, uvz), held);
            left &= notw(held);
        }
        return thickness;
    }
    return greatestInMap(PEL_FORMAT_SHADOW_MAP, firstTexel(scene->lightImages[light->mapBuffer], &light->map),
                         &light->map, light, light->depthRange,
                         shadowCoordinates(light->worldToShadow, p->position));
}

// Ambient light at the three normals.
static inline Vec3w ambientOfPixels(const Scene* scene, float3 blend, const Pixels* p) {
    __global const PelShadeFrame* frame = scene->frame;
    if (!HAS(PEL_BIT_AMBIENT_CUBE)) return ambientLight(frame->ambient, blend, p->n, p->nb);
    const Vec3w e = cubeAmbientLight(scene->cube, frame->cubeSize, blend, p->n, p->nb);
    return HAS(PEL_BIT_CUBE_ALONE) ? e : add3(e, ambientLight(frame->ambient, blend, p->n, p->nb));
}

// The contribution of one light to pixels of one material. Diffuse light and deep scatter are multiplied by
// albedo later.
static inline void addLight(const Scene* scene, __global const PelShadeMaterial* material,
                            __global const PelShadeLight* light, const Pixels* p, floatw w, maskw active,
                            bool scattered, Vec3w* diffuse, Vec3w* specular, Parts* parts, Counts* counts) {
    const LightSample sample = sampleLight(light, p->position);
    const maskw reached = active & (sample.strength > 0.0f);
    const bool wantsThickness = PEL_FORMAT_OUT_THICKNESS && !parts->measured;
    if (SKIPPING && !(wantsThickness || anyw(reached))) return;
    const Vec3w l = sample.direction;
    const floatw nl = dot3(p->n, l), bl = dot3(p->nb, l);
    const Vec3w color = scale3(loadUniform3(light->color), sample.strength);

    Vec3w direct;
    if (scattered) {
        direct.x = direct.y = direct.z = 0.0f;
    } else if (HAS(PEL_BIT_DIRECT_SCATTER) && material->curvature.layout.width) {
        direct = directScatter(scene->luts, material->curvature, vload3(0, material->normalBlend), p->pair,
                               nl, bl, p->curvature);
        if (material->gain[0] != 0.0f) {
            // Fitted on balls of more than ten mean free paths; it is meaningless beyond one.
            const Vec3w gain = loadUniform3(material->gain);
#define PEL_GAIN_(c) fmin(max0w(fma(gain.c, p->curvature, (floatw)(1.0f))), (floatw)(2.38f))
            direct = mul3(direct, vec3(PEL_GAIN_(x), PEL_GAIN_(y), PEL_GAIN_(z)));
#undef PEL_GAIN_
        }
    } else {
        direct.x = direct.y = direct.z = satw(nl);
    }
    if (HAS(PEL_BIT_SHADOW) && !scattered) {
        if (HAS(PEL_BIT_SHADOW_LUT) && material->shadow.layout.width && light->wideBuffer < PEL_LIGHT_BUFFERS) {
            // Where no light arrives the shadow does not matter.
            const maskw lit = reached & ((direct.x > 0.0f) | (direct.y > 0.0f) | (direct.z > 0.0f));
            const maskw penumbra = lit & inPenumbra(material->shadow, w);
            const floatw gl = dot3(p->ng, l);
            count(counts, PEL_COUNT_SHADOW_LUT, penumbra);
            if (!SKIPPING || anyw(penumbra))
                direct = mul3(
                    direct, shadowScatter(scene->luts, material->shadow, material->penumbraPerCosine, w, gl));
            else if (anyw(lit))
                direct = mul3(
                    direct, shadowOutside(scene->luts, material->shadow, material->penumbraPerCosine, w, gl));
        } else {
            direct = scale3(direct, satw(w));
        }
    }

    Vec3w sum = direct;
    if (HAS(PEL_BIT_TRANSMISSION) && material->transmission.layout.width) {
        const bool taps = !PEL_FORMAT_THICKNESS && HAS(PEL_BIT_THICKNESS_TAPS) && material->thicknessTaps &&
                          light->mapBuffer < PEL_LIGHT_BUFFERS;
        const floatw behind = max0w(-dot3(p->ng, l));
        const maskw needed = !SKIPPING || wantsThickness ? (maskw)(-1) : reached & (behind > 0.0f);
        if ((taps || PEL_FORMAT_THICKNESS) && anyw(needed)) {
            const floatw thickness =
                PEL_FORMAT_THICKNESS ? p->thickness : measureGreatest(scene, light, p, needed);
            if (wantsThickness) {
                parts->thickness = thickness;
                parts->measured = true;
            }
            if (taps) count(counts, PEL_COUNT_THICKNESS, needed & active);
            const Vec3w through = scale3(
                throughSlab(scene->luts, material->transmission, material->transmissionPerLength, thickness),
                behind * material->transmissionShare);
            // The table's dark side is light that came round or through as well, so the larger of the two is
            // used, never the sum.
            sum = vec3(fmax(direct.x, through.x), fmax(direct.y, through.y), fmax(direct.z, through.z));
            if (PEL_FORMAT_OUT_DEEP_SCATTER)
                parts->deepScatter = add3(parts->deepScatter, mul3(sub3(sum, direct), color));
        }
    }
    if (PEL_FORMAT_OUT_DIFFUSE) parts->diffuse = add3(parts->diffuse, mul3(direct, color));
    if (HAS(PEL_BIT_DEEP_SCATTER)) {
        const floatw back = backLight(bl);
        const bool taps = !PEL_FORMAT_THICKNESS && HAS(PEL_BIT_THICKNESS_TAPS) && material->thicknessTaps &&
                          light->mapBuffer < PEL_LIGHT_BUFFERS;
        const bool colored = material->deepScatterColor[0] != 0.0f || material->deepScatterColor[1] != 0.0f ||
                             material->deepScatterColor[2] != 0.0f;
        if (colored && (taps || PEL_FORMAT_THICKNESS)) {
            const maskw needed = !SKIPPING || wantsThickness ? (maskw)(-1) : reached & (back > 0.0f);
            if (anyw(needed)) {
                floatw thickness = p->thickness;
                if (!PEL_FORMAT_THICKNESS)
                    thickness = measureThickness(scene, material, light, p, needed, wantsThickness);
                if (wantsThickness) {
                    parts->thickness = thickness;
                    parts->measured = true;
                }
                if (taps) count(counts, PEL_COUNT_THICKNESS, needed & active);
                const floatw through =
                    back * transmittance(thickness, material->deepScatterFalloff, material->thicknessCutoff);
                const Vec3w deep = scale3(loadUniform3(material->deepScatterColor), through);
                if (PEL_FORMAT_OUT_DEEP_SCATTER)
                    parts->deepScatter = add3(parts->deepScatter, mul3(deep, color));
                sum = add3(sum, deep);
            }
        }
    }
    *diffuse = add3(*diffuse, mul3(sum, color));

    if (HAS(PEL_BIT_SPECULAR) && material->specular != 0.0f) {
        floatw shadow = 1.0f;
        if (HAS(PEL_BIT_SHADOW)) shadow = sharpenedShadow(material->specularSharpening, w);
        const maskw needed = reached & (nl > 0.0f) & (shadow > 0.0f);
        count(counts, PEL_COUNT_SPECULAR, needed);
        if (!SKIPPING || anyw(needed)) {
            floatw intensity = material->specular;
            floatw roughness = material->roughness;
            if (PEL_FORMAT_SPECULAR) intensity *= p->specular;
            if (PEL_FORMAT_ROUGHNESS) roughness *= p->roughness;
            floatw s;
            if (HAS(PEL_BIT_GGX) && material->specularModel == PEL_MODEL_GGX) {
                floatw roughness2 = material->roughness2;
                if (PEL_FORMAT_ROUGHNESS) roughness2 *= p->roughness;
                s = specularGgx(p->n, l, p->toCamera, nl, roughness, roughness2, material->lobeMix, material->f0);
            } else {
                s = specularKsk(p->n, l, p->toCamera, nl, roughness, material->f0);
            }
            s = shadow * intensity * s;
            *specular = add3(*specular, scale3(color, s));
        }
    }
}

static inline Vec3w albedoAfter(Vec3w albedo, float power) {
    return vec3(pow(max0w(albedo.x), (floatw)(power)), pow(max0w(albedo.y), (floatw)(power)),
                pow(max0w(albedo.z), (floatw)(power)));
}

// Pixels of one material, `active`.
static inline Vec3w shadeMaterial(const Scene* scene, __global const PelShadeMaterial* material, Pixels* p,
                                  uint x, uint y, maskw active, Parts* parts, Vec3w* specularPart,
                                  Counts* counts) {
    __global const PelShadeFrame* frame = scene->frame;
    // Whether its diffuse light is the irradiance image: that of the lights and of the ambient light, already
    // scattered.
    const bool scattered = HAS(PEL_BIT_IRRADIANCE) && material->scattering != PEL_SCATTER_PREINTEGRATED;
    if (HAS(PEL_BIT_COUNT)) {
        counts->of[PEL_COUNT_SCATTERING + material->named] += countw(active);
        if (material->named == PEL_SCATTER_AUTO)
            counts->of[PEL_COUNT_CHOICE + material->scattering] += countw(active);
    }
    // Only inputs that its own material reads can make a pixel invalid, so other materials of the tile do not matter.
    p->valid &= ((p->invalidBits & material->needs) == 0) | notw(active);
    Vec3w diffuse = vec3((floatw)(0.0f), (floatw)(0.0f), (floatw)(0.0f)), specular = diffuse;
    parts->diffuse = parts->deepScatter = diffuse;
    Vec3w before = diffuse;  // light that albedo is in
    parts->thickness = 0.0f;
    parts->measured = PEL_FORMAT_THICKNESS != 0;
    if (PEL_FORMAT_THICKNESS && PEL_FORMAT_OUT_THICKNESS) parts->thickness = p->thickness;
    if (scattered) {
        if (material->albedoAfter == 1.0f)
            diffuse = p->irradiance;
        else  // a part of the albedo is in it
            before =
                mul3(p->irradiance, albedoAfter(PEL_FORMAT_ALBEDO ? p->albedo : loadUniform3(material->albedo),
                                                material->albedoAfter));
        if (PEL_FORMAT_OUT_DIFFUSE) parts->diffuse = diffuse;
    } else if (HAS(PEL_BIT_AMBIENT)) {
        diffuse = ambientOfPixels(scene, vload3(0, material->normalBlend), p);
        if (PEL_FORMAT_AMBIENT_OCCLUSION) diffuse = scale3(diffuse, p->occlusion);
        if (PEL_FORMAT_OUT_DIFFUSE) parts->diffuse = diffuse;
    }
    if (HAS(PEL_BIT_AMBIENT_SCATTER) && (material->needs & PEL_BIT_AMBIENT_SCATTER)) {
        const floatw through =
            material->deepScatterAmbient *
            transmittance(p->thickness, material->deepScatterFalloff, material->thicknessCutoff);
        if (!SKIPPING || anyw(active & (through > 0.0f))) {
            const Vec3w e = ambientAlong(scene, scale3(p->nb, (floatw)(-1.0f)));
            Vec3w deep = scale3(mul3(loadUniform3(material->deepScatterColor), e), through);
            // A cube may hold NaN, which must not matter where no light comes through.
            if (HAS(PEL_BIT_AMBIENT_CUBE))
                deep = select3(vec3((floatw)(0.0f), (floatw)(0.0f), (floatw)(0.0f)), deep, through > 0.0f);
            diffuse = add3(diffuse, deep);
            if (PEL_FORMAT_OUT_DEEP_SCATTER) parts->deepScatter = deep;
        }
    }
    const bool isEye = HAS(PEL_BIT_EYE) && material->eye;
    __global const PelShadeEye* eye = &scene->eyes[isEye ? material->eye - 1 : 0];
    EyeLight inEye;
    maskw outside = active;  // where the material itself is seen
    if (isEye) {
        inEye = beginEye(scene, eye, p, active & p->valid, counts);
        outside &= inEye.view.cornea < 1.0f;
    }
    const bool lit = !SKIPPING || !scattered || PEL_FORMAT_OUT_THICKNESS ||
                     (material->needs & (PEL_BIT_SPECULAR | PEL_BIT_DEEP_SCATTER | PEL_BIT_EYE));
    for (uint i = 0; lit && i < frame->lights; ++i) {
        __global const PelShadeLight* light = &scene->lights[i];
        const floatw w = loadWideShadow(scene, light, x, y);
        p->valid &= finitew(w);
        addLight(scene, material, light, p, w, outside & p->valid, scattered, &diffuse, &specular, parts, counts);
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
    const Vec3w iris = irisRadiance(scene, eye, &inEye);
    *specularPart = add3(scale3(specular, sclera), inEye.reflected);
    if (PEL_FORMAT_OUT_DIFFUSE) parts->diffuse = add3(scale3(parts->diffuse, sclera), iris);
    if (PEL_FORMAT_OUT_DEEP_SCATTER) parts->deepScatter = scale3(parts->deepScatter, sclera);
    return add3(add3(scale3(whole, sclera), iris), inEye.reflected);
}

// Writes one part beside radiance.
#define STORE_PART(slot, part) \
    if (PEL_FORMAT_##slot)     \
        storeColor(PEL_FORMAT_##slot, SPAN(slot), select3(invalid, part, valid& finite3(part)), active);

// PEL_WIDTH pixels from (x, y) on; those of `active` are wanted.
static inline void shadePixels(const Scene* scene, uint x, uint y, uintw id, maskw active, Counts* counts) {
    __global const PelShadeFrame* frame = scene->frame;
    Pixels p = loadPixels(scene, x, y);
    Vec3w result = vec3((floatw)(0.0f), (floatw)(0.0f), (floatw)(0.0f)), specular = result;
    Parts parts = {result, result, (floatw)(0.0f), false};
    if (PEL_FORMAT_MATERIAL) {
        // Nearly always one round: neighbours share their material.
        maskw left = active;
        while (anyw(left)) {
            const uint current = greatestId(id, left);
            const maskw mask = left & (id == current);
            Parts some;
            Vec3w someSpecular;
            const Vec3w color =
                shadeMaterial(scene, &scene->materials[current], &p, x, y, mask, &some, &someSpecular, counts);
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

__kernel __attribute__((reqd_work_group_size(PEL_SHADE_GROUP, 1, 1))) void shade(SCENE_ARGUMENTS uint part,
                                                                                 uint parts, uint which) {
    const Scene scene = SCENE_VALUE;
    Counts counts = {{0}};
    const bool listed = PEL_FORMAT_MATERIAL && which != PEL_EVERY_TILE;
    const uint tiles = listed ? list[which] : frame->tiles;
    const size_t listStart = PEL_TILE_LISTS + (size_t)which * frame->listTiles;
    // Each group takes a run of the list: neighbours in it share pages, and often cache lines, of the images.
    // A launch takes one part of `parts` of a long frame, so that the host can stop between them.
    const uint groups = get_num_groups(0) * parts, group = get_num_groups(0) * part + get_group_id(0);
    const uint end = (uint)((ulong)tiles * (group + 1) / groups);
    for (uint i = (uint)((ulong)tiles * group / groups); i < end; ++i) {
        const uint tile = listed ? list[listStart + i] : frame->firstTile + i;
        const uint tileX = tile % frame->tilesX * PEL_TILE_WIDTH, tileY = tile / frame->tilesX * PEL_TILE_HEIGHT;
        for (uint pixel = get_local_id(0) * PEL_WIDTH; pixel < PEL_TILE_PIXELS;
             pixel += PEL_SHADE_GROUP * PEL_WIDTH) {
            const uint x = tileX + pixel % PEL_TILE_WIDTH, y = tileY + pixel / PEL_TILE_WIDTH;
            if (x >= frame->width || y >= frame->height) continue;
            // At the right edge vectors begin earlier; lanes before x belong to the previous tile or vector.
            const uint first = vectorStart(x, frame->width);
            const intw column = lanesw() + (int)first;
            maskw active = (column >= (int)x) & (column < (int)frame->width);
            uintw id = 1;
            if (PEL_FORMAT_MATERIAL) {
                id = loadId(PEL_FORMAT_MATERIAL,
                            imageSpan(MATERIAL, &frame->images[PEL_IMAGE_MATERIAL], first, y));
                active &= hasMaterial(frame, id);
            }
            if (anyw(active)) shadePixels(&scene, first, y, id, active, &counts);
        }
    }
    for (uint i = 0; i < PEL_COUNTERS; ++i)
        if (isCounted(i) && counts.of[i]) atomic_add(&counters[i], counts.of[i]);
}
