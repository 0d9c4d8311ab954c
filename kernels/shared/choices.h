// The enumerations of pellucid.h, which is checked against these lists (host/core/choices.cpp).
// X(name, number, key); keys are those of files and of the command.
#pragma once
// clang-format off

// PelLightType
#define PEL_EACH_LIGHT_TYPE(X)         \
    X(DIRECTIONAL, 0, "directional")   \
    X(POINT, 1, "point")               \
    X(SPOT, 2, "spot")                 \
    X(SPHERE, 3, "sphere")             \
    X(RECTANGLE, 4, "rectangle")
// PelShadowProjection
#define PEL_EACH_SHADOW_PROJECTION(X)  \
    X(PARALLEL, 0, "parallel")         \
    X(PERSPECTIVE, 1, "perspective")   \
    X(CUBE, 2, "cube")                 \
    X(CUBE_RADIAL, 3, "cube-radial")
// PelShadowContent: what texels of shadow maps hold, for all maps of a program (PEL_SHADOW_CONTENT)
#define PEL_EACH_SHADOW_CONTENT(X)     \
    X(DEPTH, 0, "depth")               \
    X(MOMENTS, 1, "moments")           \
    X(EXPONENTIAL, 2, "exponential")
// PelSpecularModel
#define PEL_EACH_SPECULAR_MODEL(X)     \
    X(KSK, 0, "ksk")                   \
    X(GGX, 1, "ggx")
// PelScattering
#define PEL_EACH_SCATTERING(X)         \
    X(NONE, 0, "none")                 \
    X(PREINTEGRATED, 1, "preintegrated") \
    X(SEPARABLE, 2, "separable")       \
    X(SCREEN, 3, "screen")             \
    X(LIGHT, 4, "light")               \
    X(TEXTURE, 5, "texture")           \
    X(AUTO, 6, "auto")
// PelLutKind
#define PEL_EACH_LUT_KIND(X)           \
    X(CURVATURE, 0, "curvature")       \
    X(SHADOW, 1, "shadow")             \
    X(SPECULAR, 2, "specular")         \
    X(EYE, 3, "eye")
// PelCurvatureForm
#define PEL_EACH_CURVATURE_FORM(X)     \
    X(ARC, 0, "arc")                   \
    X(RING, 1, "ring")                 \
    X(HALF_RING, 2, "half-ring")       \
    X(SPHERE, 3, "sphere")             \
    X(PENNER_RING, 4, "penner-ring")
// PelLutAxis
#define PEL_EACH_LUT_AXIS(X)           \
    X(LINEAR, 0, "linear")             \
    X(ROOT, 1, "root")
// PelLutEncoding
#define PEL_EACH_LUT_ENCODING(X)       \
    X(FLOAT, 0, "float")               \
    X(HALF, 1, "half")                 \
    X(FACEWORKS8, 2, "faceworks8")
// PelProfileKind
#define PEL_EACH_PROFILE_KIND(X)       \
    X(SKIN, 0, "skin")                 \
    X(GAUSSIANS, 1, "gaussians")       \
    X(BURLEY, 2, "burley")             \
    X(DIPOLE, 3, "dipole")             \
    X(TABLE, 4, "table")           \
    X(SKIN_LAYERS, 5, "skin-layers")
// PelCurvatureEstimator
#define PEL_EACH_ESTIMATOR(X)          \
    X(EDGE, 0, "edge")                 \
    X(TENSOR, 1, "tensor")             \
    X(QUADRIC, 2, "quadric")
// PelCurvatureQuantity: those of one number, then the others
#define PEL_EACH_QUANTITY(X)           \
    X(ABSOLUTE, 0, "absolute")         \
    X(ABSOLUTE_MAX, 1, "absolute-max") \
    X(CURVEDNESS, 2, "curvedness")     \
    X(MEAN, 3, "mean")                 \
    X(GAUSSIAN, 4, "gaussian")         \
    X(FIRST, 5, "first")               \
    X(SECOND, 6, "second")
#define PEL_EACH_QUANTITY_OF_SEVERAL(X) \
    X(PRINCIPAL, 7, "principal")       \
    X(FRAME, 8, "frame")
// PelSmoothingWeights
#define PEL_EACH_SMOOTHING_WEIGHTS(X)  \
    X(COTANGENT, 0, "cotangent")       \
    X(AREA, 1, "area")
// clang-format on

#define PEL_NUMBER_TYPE_(name, number, key) PEL_TYPE_##name = number,
#define PEL_NUMBER_MAP_(name, number, key) PEL_MAP_##name = number,
#define PEL_NUMBER_CONTENT_(name, number, key) PEL_CONTENT_##name = number,
#define PEL_NUMBER_MODEL_(name, number, key) PEL_MODEL_##name = number,
#define PEL_NUMBER_SCATTER_(name, number, key) PEL_SCATTER_##name = number,
enum { PEL_EACH_LIGHT_TYPE(PEL_NUMBER_TYPE_) PEL_TYPES };
enum { PEL_EACH_SHADOW_PROJECTION(PEL_NUMBER_MAP_) PEL_MAPS };
enum { PEL_EACH_SHADOW_CONTENT(PEL_NUMBER_CONTENT_) PEL_CONTENTS };
enum { PEL_EACH_SPECULAR_MODEL(PEL_NUMBER_MODEL_) PEL_MODELS };
enum { PEL_EACH_SCATTERING(PEL_NUMBER_SCATTER_) PEL_SCATTERS };
