// The images of a G-buffer. This list is the only one: names, checks, keys of scene files, programs and the
// arguments of shade.cl are made from it. PelImageSlot in pellucid.h, which documents them, is checked
// against it (host/shading/image_slots.cpp).
#pragma once
#include "shared/features.h"

// Features whose terms read the blurred normal, or the geometric one if there is no blurred one.
#define PEL_BITS_BLURRED_ \
    (PEL_BIT_DIRECT_SCATTER | PEL_BIT_AMBIENT | PEL_BIT_DEEP_SCATTER | PEL_BIT_AMBIENT_SCATTER)
#define PEL_BITS_SPECULAR_ (PEL_BIT_SPECULAR | PEL_BIT_ENVIRONMENT)
#define PEL_BITS_POSITION_ (PEL_BITS_SPECULAR_ | PEL_BIT_THICKNESS_TAPS | PEL_BIT_POSITIONAL | PEL_BIT_EYE)
#define PEL_BITS_ALL_ 0x7fffffff

// clang-format off
// X(name, number, role, content, components, key, words, bits)
//   role        SHADE: read by shade.cl; PASS: read only by passes before it; OUTPUT: written; TARGET:
//               written or added to
//   content     the kind of pixels, which decides the formats that are accepted
//   components the number of channel names in a scene file; of a TARGET, those of its previous content key,
//   words the name in scene files and in messages bits PEL_BIT_... of the features that read the image in
//   shade.cl. Depth is read where there are no
//               positions, and the geometric normal also in place of a missing blurred normal.
#define PEL_EACH_IMAGE(X) \
    X(RADIANCE, 0, TARGET, COLOR_OUTPUT, 3, "radiance", "radiance", PEL_BITS_ALL_) \
    X(MATERIAL, 1, SHADE, ID, 1, "material", "material", PEL_BITS_ALL_) \
    X(POSITION, 2, SHADE, COLOR, 3, "position", "position", PEL_BITS_POSITION_) \
    X(DEPTH, 3, SHADE, SCALAR, 1, "depth", "depth", PEL_BITS_POSITION_) \
    X(NORMAL_GEOMETRIC, 4, SHADE, NORMAL, 3, "normal_geometric", "geometric normal", \
      PEL_BIT_SHADOW_LUT | PEL_BIT_THICKNESS_TAPS | PEL_BIT_TRANSMISSION) \
    X(NORMAL_SHADING, 5, SHADE, NORMAL, 3, "normal_shading", "shading normal", PEL_BITS_ALL_) \
    X(NORMAL_BLURRED, 6, SHADE, NORMAL, 3, "normal_blurred", "blurred normal", PEL_BITS_BLURRED_) \
    X(CURVATURE, 7, SHADE, SCALAR, 1, "curvature", "curvature", PEL_BIT_DIRECT_SCATTER) \
    X(ALBEDO, 8, SHADE, COLOR, 3, "albedo", "albedo", PEL_BITS_ALL_) \
    X(AMBIENT_OCCLUSION, 9, SHADE, SCALAR, 1, "ambient_occlusion", "ambient occlusion", PEL_BIT_AMBIENT) \
    X(THICKNESS, 10, SHADE, SCALAR, 1, "thickness", "thickness", \
      PEL_BIT_DEEP_SCATTER | PEL_BIT_AMBIENT_SCATTER | PEL_BIT_TRANSMISSION) \
    X(ROUGHNESS, 11, SHADE, SCALAR, 1, "roughness", "roughness", PEL_BITS_SPECULAR_) \
    X(SPECULAR, 12, SHADE, SCALAR, 1, "specular", "specular", PEL_BITS_SPECULAR_) \
    X(UV, 13, PASS, UV, 2, "uv", "UV", 0) \
    X(UV_GRADIENT, 14, PASS, GRADIENT, 4, "uv_gradient", "UV gradient", 0) \
    X(TANGENT, 15, PASS, NORMAL, 4, "tangent", "tangent", 0) \
    X(OUT_DIFFUSE, 16, OUTPUT, COLOR_OUTPUT, 0, "diffuse", "diffuse output", PEL_BITS_ALL_) \
    X(OUT_DEEP_SCATTER, 17, OUTPUT, COLOR_OUTPUT, 0, "deep_scatter", "deep scatter output", PEL_BITS_ALL_) \
    X(OUT_SPECULAR, 18, OUTPUT, COLOR_OUTPUT, 0, "specular", "specular output", PEL_BITS_ALL_) \
    X(OUT_THICKNESS, 19, OUTPUT, SCALAR_OUTPUT, 0, "thickness", "thickness output", PEL_BITS_ALL_) \
    X(IRRADIANCE, 20, SHADE, COLOR, 3, "irradiance", "irradiance", PEL_BIT_IRRADIANCE) \
    X(SCATTER_WEIGHT, 21, PASS, SCALAR, 2, "scatter_weight", "scatter weight", 0) \
    X(IRRADIANCE_BACK, 22, PASS, COLOR, 3, "irradiance_back", "back irradiance", 0) \
    X(WETNESS, 23, SHADE, SCALAR, 1, "wetness", "wetness", PEL_BIT_EYE) \
    X(MEAN_CURVATURE, 24, SHADE, SCALAR, 1, "mean_curvature", "mean curvature", \
      PEL_BIT_IRRADIANCE | PEL_BIT_DIRECT_SCATTER) \
    X(SKIN, 25, PASS, UV, 3, "skin", "skin", 0) \
    X(MOTION, 26, PASS, UV, 3, "motion", "motion", 0) \
    X(INDIRECT, 27, SHADE, COLOR, 3, "indirect", "indirect light", PEL_BIT_AMBIENT)
// clang-format on

// PEL_IMAGE_<NAME>, their count, and PEL_READ_<NAME>: the bits.
#define PEL_IMAGE_NUMBER_(name, number, role, content, components, key, words, bits) \
    PEL_IMAGE_##name = number,
#define PEL_IMAGE_BITS_(name, number, role, content, components, key, words, bits) PEL_READ_##name = bits,
#define PEL_IMAGE_ONE_(name, number, role, content, components, key, words, bits) +1
enum { PEL_EACH_IMAGE(PEL_IMAGE_NUMBER_) PEL_IMAGE_SLOTS = 0 PEL_EACH_IMAGE(PEL_IMAGE_ONE_) };
enum { PEL_EACH_IMAGE(PEL_IMAGE_BITS_) PEL_READ_NONE = 0 };
