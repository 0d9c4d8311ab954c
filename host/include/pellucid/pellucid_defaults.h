/* Defaults for the structures of pellucid.h, which includes this file. Inline, so that structSize is the size
 * that the caller compiled with. */
#ifndef PELLUCID_DEFAULTS_H
#define PELLUCID_DEFAULTS_H
#ifndef PELLUCID_H
#error "include pellucid/pellucid.h, which includes this file"
#endif
#include <string.h>

#include "pellucid_fields.h"

#define PEL_ZEROED_(Type, value)     \
    Type value;                      \
    memset(&value, 0, sizeof value); \
    value.structSize = (uint32_t)sizeof value

/* PelNAME pelNAMEDefaults(void): zeros except for the fields that the statements set in `s`. */
#define PEL_DEFAULTS_(Name, ...)                        \
    static inline Pel##Name pel##Name##Defaults(void) { \
        PEL_ZEROED_(Pel##Name, s);                      \
        __VA_ARGS__                                     \
        return s;                                       \
    }

/* The default of a row of pellucid_fields.h, for the structure `s`. */
#define PEL_DEFAULT_(type, name, value, ...) PEL_DEFAULT_##type##_(name, value)
#define PEL_DEFAULT_FLOAT_(name, value) s.name = value;
#define PEL_DEFAULT_UINT_(name, value) s.name = value;
#define PEL_DEFAULT_FREE_(name, value) s.name = value;
#define PEL_DEFAULT_FREE_UINT_(name, value) s.name = value;
#define PEL_DEFAULT_COLOR_(name, value) s.name[0] = s.name[1] = s.name[2] = value;
#define PEL_DEFAULT_VECTOR_(name, xyz) PEL_DEFAULT_XYZ_(s.name, PEL_UNWRAPPED_ xyz)
#define PEL_DEFAULT_XYZ_(...) PEL_DEFAULT_3_(__VA_ARGS__)
#define PEL_DEFAULT_3_(field, x, y, z) field[0] = x, field[1] = y, field[2] = z;
#define PEL_DEFAULT_MATRIX_(name, identity) s.name[0] = s.name[5] = s.name[10] = s.name[15] = 1;
#define PEL_UNWRAPPED_(...) __VA_ARGS__

/* clang-format off */
PEL_DEFAULTS_(DeviceInfo, )
PEL_DEFAULTS_(DeviceStats, )
PEL_DEFAULTS_(DeviceDesc, s.profiling = 2;)
PEL_DEFAULTS_(ImageDesc, )
PEL_DEFAULTS_(MeshReport, )
PEL_DEFAULTS_(MeshOrientation, )
PEL_DEFAULTS_(MeshTopologyDesc, )
static inline PelCurvatureParams pelCurvatureParamsDefaults(void) {
    PEL_ZEROED_(PelCurvatureParams, s);
    s.estimator = PEL_CURVATURE_QUADRIC;
    s.smoothingPasses = 2;
    s.scale = 1.0f;
    return s;
}
PEL_DEFAULTS_(LiveMeshStats, )
static inline PelScreenCurvatureParams pelScreenCurvatureParamsDefaults(void) {
    PEL_ZEROED_(PelScreenCurvatureParams, s);
    s.scale = 1.0f;
    s.edge = 0.5f;
    s.inverseViewProjection[0] = s.inverseViewProjection[5] = 1.0f;
    s.inverseViewProjection[10] = s.inverseViewProjection[15] = 1.0f;
    return s;
}
/* The tables that a material makes of its profile. Values of 0 follow from the profile. */
static inline PelCurvatureLutDesc pelCurvatureLutDescDefaults(void) {
    PEL_ZEROED_(PelCurvatureLutDesc, s);
    PEL_EACH_CURVATURE_LUT_FIELD(PEL_DEFAULT_)
    s.form = PEL_FORM_SPHERE;
    s.axis = PEL_AXIS_ROOT;
    return s;
}
PEL_DEFAULTS_(ShadowLutDesc,
    PEL_EACH_SHADOW_LUT_FIELD(PEL_DEFAULT_)
    s.axis = PEL_AXIS_ROOT;)
/* The tables of FaceWorks 1.0, for skin in millimetres: form arc, open ends, linear axes. */
static inline PelCurvatureLutDesc pelCurvatureLutDescFaceWorks(void) {
    PEL_ZEROED_(PelCurvatureLutDesc, s);
    s.width = 512;
    s.height = 512;
    s.form = PEL_FORM_ARC;
    s.axis = PEL_AXIS_LINEAR;
    s.radiusMin = 1.0f;
    s.radiusMax = 100.0f;
    return s;
}
static inline PelShadowLutDesc pelShadowLutDescFaceWorks(void) {
    PEL_ZEROED_(PelShadowLutDesc, s);
    s.width = 512;
    s.height = 512;
    s.widthMin = 8.0f;
    s.widthMax = 100.0f;
    s.sharpening = 10.0f;
    s.axis = PEL_AXIS_LINEAR;
    return s;
}
/* Width of the shadow filter that follows from a profile, mm: docs/guide/shading.md, "Materials". */
static inline float pelShadowFilterWidthOf(const PelProfileInfo* profile) {
    float widest = profile->width[0];
    if (profile->width[1] > widest) widest = profile->width[1];
    if (profile->width[2] > widest) widest = profile->width[2];
    return 1.3f * widest;
}
static inline float pelLengthOr_(float length, double otherwise) {
    if (length != 0) return length;
    if (otherwise > 3.402823466e38) otherwise = 3.402823466e38;
    return otherwise < 1.401298464e-45 ? 1.401298464e-45f : (float)otherwise;
}
/* The description with lengths of 0 replaced by those that follow from the profile. Radii of curvature reach
 * from an ear's helix to a flat surface, penumbrae from normal incidence to a cosine of a thousandth.
 * Look-ups beyond are clamped. */
static inline PelCurvatureLutDesc pelCurvatureLutDescFilled(PelCurvatureLutDesc s,
                                                            const PelProfileInfo* profile) {
    s.diffusionRadius = pelLengthOr_(s.diffusionRadius, profile->radius);
    s.radiusMin = pelLengthOr_(s.radiusMin, 0.25 * s.diffusionRadius);
    s.radiusMax = pelLengthOr_(s.radiusMax, 1000.0 * s.diffusionRadius);
    return s;
}
static inline PelShadowLutDesc pelShadowLutDescFilled(PelShadowLutDesc s, const PelProfileInfo* profile) {
    s.diffusionRadius = pelLengthOr_(s.diffusionRadius, profile->radius);
    s.widthMin = pelLengthOr_(
        s.widthMin, (double)pelShadowFilterWidthOf(profile) * s.diffusionRadius / profile->radius);
    s.widthMax = pelLengthOr_(s.widthMax, 1000.0 * s.widthMin);
    return s;
}
PEL_DEFAULTS_(SpecularLutDesc, PEL_EACH_SPECULAR_LUT_FIELD(PEL_DEFAULT_))
PEL_DEFAULTS_(Skin, PEL_EACH_SKIN_FIELD(PEL_DEFAULT_))
PEL_DEFAULTS_(SkinInfo, )
PEL_DEFAULTS_(Eye, PEL_EACH_EYE_FIELD(PEL_DEFAULT_))
PEL_DEFAULTS_(EyeLutDesc, PEL_EACH_EYE_LUT_FIELD(PEL_DEFAULT_))
/* The table that belongs to an eye. */
static inline PelEyeLutDesc pelEyeLutDescOf(const PelEye* eye) {
    PelEyeLutDesc s = pelEyeLutDescDefaults();
#define PEL_COPY_(type, name, ...) s.name = eye->name;
    PEL_EACH_EYE_SHAPE_FIELD(PEL_COPY_)
#undef PEL_COPY_
    s.profile = eye->irisProfile;
    return s;
}
PEL_DEFAULTS_(ScatterParams, PEL_EACH_SCATTER_PARAM_FIELD(PEL_DEFAULT_))
static inline PelScatterControls pelScatterControlsDefaults(void) {
    PEL_ZEROED_(PelScatterControls, s);
    PEL_EACH_SCATTER_CONTROL_FIELD(PEL_DEFAULT_)
    s.scattering = PEL_SCATTERING_SCREEN;
    return s;
}
PEL_DEFAULTS_(TextureScatterDesc, )
PEL_DEFAULTS_(TextureScatterParams,
    s.scale = 1.0f;
    s.gaussians = 6;)
PEL_DEFAULTS_(TextureScatterStats, )
PEL_DEFAULTS_(ScatterStats, )
PEL_DEFAULTS_(ProfileInfo, )
static inline PelLutInfo pelLutInfoDefaults(void) {
    PEL_ZEROED_(PelLutInfo, s);
    s.curvature = pelCurvatureLutDescFaceWorks();
    s.shadow = pelShadowLutDescFaceWorks();
    s.specular = pelSpecularLutDescDefaults();
    s.eye = pelEyeLutDescDefaults();
    memcpy(s.profile, "skin", 5);
    return s;
}
static inline PelLight pelLightDefaults(void) {
    PEL_ZEROED_(PelLight, s);
    PEL_EACH_LIGHT_FIELD(PEL_DEFAULT_)
    PEL_EACH_DIRECTIONAL_LIGHT_FIELD(PEL_DEFAULT_)
    PEL_EACH_POSITIONAL_LIGHT_FIELD(PEL_DEFAULT_)
    PEL_EACH_SPOT_LIGHT_FIELD(PEL_DEFAULT_)
    PEL_EACH_SPHERE_LIGHT_FIELD(PEL_DEFAULT_)
    PEL_EACH_RECTANGLE_LIGHT_FIELD(PEL_DEFAULT_)
    PEL_EACH_SHADOW_MAP_FIELD(PEL_DEFAULT_)
    return s;
}
PEL_DEFAULTS_(Material,
    PEL_EACH_MATERIAL_FIELD(PEL_DEFAULT_)
    s.scattering = PEL_SCATTERING_AUTO;)
PEL_DEFAULTS_(Ambient, )
static inline PelCamera pelCameraDefaults(void) {
    PEL_ZEROED_(PelCamera, s);
    s.inverseViewProjection[0] = s.inverseViewProjection[5] = 1.0f;
    s.inverseViewProjection[10] = s.inverseViewProjection[15] = 1.0f;
    return s;
}
PEL_DEFAULTS_(ShaderStats, )
PEL_DEFAULTS_(PassStats, )
PEL_DEFAULTS_(PassMemory, )
PEL_DEFAULTS_(ShaderOptions, PEL_EACH_OPTION_FIELD(PEL_DEFAULT_))
PEL_DEFAULTS_(SurfaceIntegralDesc,
    s.millimetresPerUnit = 1.0f;
    s.tolerance = 1e-3f;)
PEL_DEFAULTS_(WarmUp, )
PEL_DEFAULTS_(ScatterWork, )
/* clang-format on */

#undef PEL_ZEROED_
#undef PEL_DEFAULTS_
#undef PEL_DEFAULT_
#undef PEL_DEFAULT_FLOAT_
#undef PEL_DEFAULT_UINT_
#undef PEL_DEFAULT_FREE_
#undef PEL_DEFAULT_FREE_UINT_
#undef PEL_DEFAULT_COLOR_
#undef PEL_DEFAULT_VECTOR_
#undef PEL_DEFAULT_XYZ_
#undef PEL_DEFAULT_3_
#undef PEL_DEFAULT_MATRIX_
#undef PEL_UNWRAPPED_
#endif
