// The features of a variant of the shading kernel: bits of PEL_FEATURES, a compile-time constant, as are the
// formats of images (shared/formats.h). Values of the scene are arguments.
#pragma once

// clang-format off
// PelFeature of the public header, each once: X(name, bit, kernel, material, key). kernel: 1 if the feature
// makes another variant of the shading kernel, 0 if it is a pass before it. material: 1 if materials request
// it, 0 if it applies to the whole frame.
#define PEL_EACH_FEATURE(X)                          \
    X(DIRECT_SCATTER, 0, 1, 1, "direct_scatter")     \
    X(SHADOW, 1, 1, 0, "shadow")                     \
    X(SHADOW_LUT, 2, 1, 1, "shadow_lut")             \
    X(AMBIENT, 3, 1, 0, "ambient")                   \
    X(DEEP_SCATTER, 4, 1, 1, "deep_scatter")         \
    X(THICKNESS_TAPS, 5, 1, 1, "thickness_taps")     \
    X(SPECULAR, 6, 1, 1, "specular")                 \
    X(BLUR_NORMALS, 7, 0, 0, "blur_normals")         \
    X(NORMAL_MAP, 8, 0, 0, "normal_map")             \
    X(FILTER_SHADOW, 9, 0, 0, "filter_shadow")       \
    X(GGX, 10, 1, 1, "ggx")                          \
    X(AMBIENT_SCATTER, 11, 1, 1, "ambient_scatter")  \
    X(OUTPUTS, 12, 0, 0, "outputs")                  \
    X(AMBIENT_CUBE, 13, 1, 0, "ambient_cube")        \
    X(IRRADIANCE, 14, 1, 1, "irradiance")            \
    X(MAKE_IRRADIANCE, 15, 0, 0, "make_irradiance")  \
    X(TRANSMISSION, 23, 1, 1, "transmission")        \
    X(SHADOW_CUBE, 24, 1, 0, "shadow_cube")          \
    X(SHADOW_CASCADES, 25, 1, 0, "shadow_cascades")  \
    X(SHADOW_EXPONENTIAL, 26, 0, 0, "shadow_exponential") \
    X(SHADOW_MOMENTS, 27, 0, 0, "shadow_moments")    \
    X(EYE, 28, 1, 1, "eye")                          \
    X(REFLECTION_CUBE, 29, 1, 1, "reflection_cube") \
    X(ENVIRONMENT, 30, 1, 1, "environment")

// Bits of PEL_FEATURES.
#define PEL_FEATURE_BIT_(name, bit, kernel, material, key) PEL_BIT_##name = 1 << bit,
#define PEL_FEATURE_KERNEL_(name, bit, kernel, material, key) | kernel << bit
#define PEL_FEATURE_MATERIAL_(name, bit, kernel, material, key) | material << bit
enum {
    PEL_EACH_FEATURE(PEL_FEATURE_BIT_)
    // Options of the kernel.
    PEL_BIT_POSITIONAL = 0x10000,   // a point or spot light
    PEL_BIT_ACCUMULATE = 0x20000,   // add to the output
    PEL_BIT_NO_SKIPPING = 0x40000,  // evaluate every term of every pixel
    // count pixels per feature; shaded and invalid pixels are always counted
    PEL_BIT_COUNT = 0x80000,
    PEL_BIT_CUBE_ALONE = 0x100000,  // the cube map is the only ambient light
    PEL_BIT_ROTATE_TAPS = 0x200000, // the disk of thickness taps is rotated per pixel
    PEL_BIT_TAP_CELLS = 0x400000,   // some thickness is read from an occluder-depth grid
    // Sets of features.
    PEL_BITS_OF_KERNEL = 0 PEL_EACH_FEATURE(PEL_FEATURE_KERNEL_),
    PEL_BITS_OF_MATERIALS = 0 PEL_EACH_FEATURE(PEL_FEATURE_MATERIAL_)
};
// clang-format on
