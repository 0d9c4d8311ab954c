// Choices among a few, each once: pellucid.h's enumerations are checked against these lists (host/shading/image_slots.cpp).
// X(name, number, key); keys are those of scene files.
#ifndef PEL_SHARED_CHOICES
#define PEL_SHARED_CHOICES
// clang-format off

// PelLightType
#define PEL_EACH_LIGHT_TYPE(X)         \
    X(DIRECTIONAL, 0, "directional")   \
    X(POINT, 1, "point")               \
    X(SPOT, 2, "spot")
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

#endif
