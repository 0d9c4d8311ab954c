/* Defaults for the structures of pellucid.h, which includes this file. Inline, so that structSize is the size that the
 * caller compiled with. */
#ifndef PELLUCID_DEFAULTS_H
#define PELLUCID_DEFAULTS_H
#include <string.h>

#define PEL_ZEROED_(Type, value)     \
    Type value;                      \
    memset(&value, 0, sizeof value); \
    value.structSize = (uint32_t)sizeof value

/* clang-format off */
static inline PelDeviceInfo pelDeviceInfoDefaults(void) { PEL_ZEROED_(PelDeviceInfo, s); return s; }
static inline PelDeviceStats pelDeviceStatsDefaults(void) { PEL_ZEROED_(PelDeviceStats, s); return s; }
static inline PelImageDesc pelImageDescDefaults(void) { PEL_ZEROED_(PelImageDesc, s); return s; }
static inline PelMeshReport pelMeshReportDefaults(void) { PEL_ZEROED_(PelMeshReport, s); return s; }
static inline PelMeshOrientation pelMeshOrientationDefaults(void) { PEL_ZEROED_(PelMeshOrientation, s); return s; }
static inline PelMeshTopologyDesc pelMeshTopologyDescDefaults(void) { PEL_ZEROED_(PelMeshTopologyDesc, s); return s; }
static inline PelCurvatureParams pelCurvatureParamsDefaults(void) {
    PEL_ZEROED_(PelCurvatureParams, s);
    s.estimator = PEL_CURVATURE_QUADRIC;
    s.smoothingPasses = 2;
    s.scale = 1.0f;
    return s;
}
static inline PelLiveMeshStats pelLiveMeshStatsDefaults(void) { PEL_ZEROED_(PelLiveMeshStats, s); return s; }
static inline PelScreenCurvatureParams pelScreenCurvatureParamsDefaults(void) {
    PEL_ZEROED_(PelScreenCurvatureParams, s);
    s.scale = 1.0f;
    s.edge = 0.5f;
    s.inverseViewProjection[0] = s.inverseViewProjection[5] = 1.0f;
    s.inverseViewProjection[10] = s.inverseViewProjection[15] = 1.0f;
    return s;
}
/* As a material makes them of its profile. What is 0 follows from the profile. */
static inline PelCurvatureLutDesc pelCurvatureLutDescDefaults(void) {
    PEL_ZEROED_(PelCurvatureLutDesc, s);
    s.width = 64;
    s.height = 64;
    s.form = PEL_FORM_SPHERE;
    s.axis = PEL_AXIS_ROOT;
    return s;
}
static inline PelShadowLutDesc pelShadowLutDescDefaults(void) {
    PEL_ZEROED_(PelShadowLutDesc, s);
    s.width = 128;
    s.height = 32;
    s.sharpening = 10.0f;
    s.closedEnds = 1;
    s.axis = PEL_AXIS_ROOT;
    return s;
}
/* As FaceWorks 1.0 makes them, for skin in millimetres: form arc, open ends, linear axes. */
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
/* A description with the lengths of that profile in the place of those that are 0. Radii of curvature from that of an ear's helix to
 * flat surface; penumbrae from light that falls straight in to light at a cosine of a thousandth. Look-ups beyond are clamped. */
static inline PelCurvatureLutDesc pelCurvatureLutDescFilled(PelCurvatureLutDesc s, const PelProfileInfo* profile) {
    s.diffusionRadius = pelLengthOr_(s.diffusionRadius, profile->radius);
    s.radiusMin = pelLengthOr_(s.radiusMin, 0.25 * s.diffusionRadius);
    s.radiusMax = pelLengthOr_(s.radiusMax, 1000.0 * s.diffusionRadius);
    return s;
}
static inline PelShadowLutDesc pelShadowLutDescFilled(PelShadowLutDesc s, const PelProfileInfo* profile) {
    s.diffusionRadius = pelLengthOr_(s.diffusionRadius, profile->radius);
    s.widthMin = pelLengthOr_(s.widthMin, (double)pelShadowFilterWidthOf(profile) * s.diffusionRadius / profile->radius);
    s.widthMax = pelLengthOr_(s.widthMax, 1000.0 * s.widthMin);
    return s;
}
static inline PelSpecularLutDesc pelSpecularLutDescDefaults(void) {
    PEL_ZEROED_(PelSpecularLutDesc, s);
    s.width = 512;
    s.height = 512;
    return s;
}
static inline PelEye pelEyeDefaults(void) {
    PEL_ZEROED_(PelEye, s);
    s.gaze[2] = 1.0f;
    s.up[1] = 1.0f;
    s.scleraRadius = 12.0f;
    s.corneaRadius = 7.8f;
    s.corneaConic = -0.26f;
    s.limbusRadius = 6.0f;
    s.limbusWidth = 1.0f;
    s.limbusDarkening = 0.6f;
    s.chamberDepth = 3.05f;
    s.corneaIndex = 1.376f;
    s.aqueousIndex = 1.336f;
    s.pupilRadius = 2.0f;
    s.texturePupil = 0.3f;
    s.irisColor[0] = s.irisColor[1] = s.irisColor[2] = -1.0f;
    s.tearRoughness = 0.03f;
    s.wetLineRoughness = 0.2f;
    s.tearIndex = 1.336f;
    return s;
}
/* The table that belongs to an eye. */
static inline PelEyeLutDesc pelEyeLutDescOf(const PelEye* eye) {
    PEL_ZEROED_(PelEyeLutDesc, s);
    s.width = 64;
    s.height = 64;
    s.depth = 32;
    s.scleraRadius = eye->scleraRadius;
    s.corneaRadius = eye->corneaRadius;
    s.corneaConic = eye->corneaConic;
    s.limbusRadius = eye->limbusRadius;
    s.chamberDepth = eye->chamberDepth;
    s.corneaIndex = eye->corneaIndex;
    s.aqueousIndex = eye->aqueousIndex;
    s.irisRadius = eye->irisRadius;
    s.irisConcavity = eye->irisConcavity;
    s.millimetresPerUnit = 1.0f;
    s.profile = eye->irisProfile;
    return s;
}
static inline PelEyeLutDesc pelEyeLutDescDefaults(void) {
    const PelEye eye = pelEyeDefaults();
    return pelEyeLutDescOf(&eye);
}
static inline PelScatterParams pelScatterParamsDefaults(void) {
    PEL_ZEROED_(PelScatterParams, s);
    s.targetError = 2e-3f;
    s.white = 1.0f;
    return s;
}
static inline PelScatterControls pelScatterControlsDefaults(void) {
    PEL_ZEROED_(PelScatterControls, s);
    s.scattering = PEL_SCATTERING_SCREEN;
    return s;
}
static inline PelTextureScatterDesc pelTextureScatterDescDefaults(void) { PEL_ZEROED_(PelTextureScatterDesc, s); return s; }
static inline PelTextureScatterParams pelTextureScatterParamsDefaults(void) {
    PEL_ZEROED_(PelTextureScatterParams, s);
    s.scale = 1.0f;
    s.gaussians = 6;
    return s;
}
static inline PelTextureScatterStats pelTextureScatterStatsDefaults(void) { PEL_ZEROED_(PelTextureScatterStats, s); return s; }
static inline PelScatterStats pelScatterStatsDefaults(void) { PEL_ZEROED_(PelScatterStats, s); return s; }
static inline PelProfileInfo pelProfileInfoDefaults(void) { PEL_ZEROED_(PelProfileInfo, s); return s; }
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
    s.toLight[2] = 1.0f;
    s.spotDirection[2] = -1.0f;
    s.spotCosInner = 0.9f;
    s.spotCosOuter = 0.8f;
    s.color[0] = s.color[1] = s.color[2] = 1.0f;
    s.worldToShadow[0] = s.worldToShadow[5] = 1.0f;
    s.worldToShadow[10] = s.worldToShadow[15] = 1.0f;
    s.shadowDepthRange = 1.0f;
    s.shadowBias = -1.0f;
    s.shadowSoftness = -1.0f;
    s.shadowConeSlope = -1.0f;
    s.shadowMinDeviation = 0.25f;
    s.shadowBleeding = 0.1f;
    return s;
}
static inline PelMaterial pelMaterialDefaults(void) {
    PEL_ZEROED_(PelMaterial, s);
    s.albedo[0] = s.albedo[1] = s.albedo[2] = 0.5f;
    s.normalBlend[0] = s.normalBlend[1] = s.normalBlend[2] = -1.0f;
    s.transmission = 1.0f;
    s.deepScatterRadius = 6.0f;
    s.deepScatterNormalOffset = 0.2f;
    s.thicknessFilterRadius = 0.02f;
    s.thicknessTaps = 32;
    s.roughness = 0.3f;
    s.f0 = 0.028f;
    s.uvScale = 1.0f;
    s.roughness2 = 0.15f;
    s.lobeMix = 0.15f;
    s.scattering = PEL_SCATTERING_AUTO;
    return s;
}
static inline PelAmbient pelAmbientDefaults(void) { PEL_ZEROED_(PelAmbient, s); return s; }
static inline PelCamera pelCameraDefaults(void) {
    PEL_ZEROED_(PelCamera, s);
    s.inverseViewProjection[0] = s.inverseViewProjection[5] = 1.0f;
    s.inverseViewProjection[10] = s.inverseViewProjection[15] = 1.0f;
    return s;
}
static inline PelShaderStats pelShaderStatsDefaults(void) { PEL_ZEROED_(PelShaderStats, s); return s; }
static inline PelShaderOptions pelShaderOptionsDefaults(void) {
    PEL_ZEROED_(PelShaderOptions, s);
    s.targetError = 2e-3f;
    s.millimetresPerUnit = 1.0f;
    return s;
}
static inline PelSurfaceIntegralDesc pelSurfaceIntegralDescDefaults(void) {
    PEL_ZEROED_(PelSurfaceIntegralDesc, s);
    s.millimetresPerUnit = 1.0f;
    s.tolerance = 1e-3f;
    return s;
}
static inline PelWarmUp pelWarmUpDefaults(void) { PEL_ZEROED_(PelWarmUp, s); return s; }
/* clang-format on */

#undef PEL_ZEROED_
#endif
