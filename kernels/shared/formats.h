// Formats of images. This list is the only one; PelFormat of pellucid.h is checked against it
// (host/core/image_view.cpp).
#pragma once

// clang-format off
// X(name, number, kind, components, componentBytes, pixelBytes); 0: no image. componentBytes: bytes per read
// of a component; packed formats are read as one word.
#define PEL_EACH_FORMAT(X)                       \
    X(R32F, 1, FLOAT, 1, 4, 4)                   \
    X(RG32F, 2, FLOAT, 2, 4, 8)                  \
    X(RGB32F, 3, FLOAT, 3, 4, 12)                \
    X(RGBA32F, 4, FLOAT, 4, 4, 16)               \
    X(R16F, 5, FLOAT, 1, 2, 2)                   \
    X(RG16F, 6, FLOAT, 2, 2, 4)                  \
    X(RGB16F, 7, FLOAT, 3, 2, 6)                 \
    X(RGBA16F, 8, FLOAT, 4, 2, 8)                \
    X(R8_UNORM, 9, UNORM, 1, 1, 1)               \
    X(RGBA8_UNORM, 10, UNORM, 4, 1, 4)           \
    X(RGBA8_SRGB, 11, SRGB, 4, 1, 4)             \
    X(R16_UNORM, 12, UNORM, 1, 2, 2)             \
    X(OCT16X2_SNORM, 13, OCTAHEDRAL, 2, 4, 4)    \
    X(A2B10G10R10_UNORM, 14, UNORM, 4, 4, 4)     \
    X(R8_UINT, 15, UINT, 1, 1, 1)                \
    X(R16_UINT, 16, UINT, 1, 2, 2)               \
    X(R32_UINT, 17, UINT, 1, 4, 4)               \
    X(PLANAR_RGB32F, 18, PLANAR, 3, 4, 4)
// clang-format on

#define PEL_FORMAT_NUMBER_(name, number, kind, components, componentBytes, pixelBytes) \
    PEL_FMT_##name = number,
enum { PEL_EACH_FORMAT(PEL_FORMAT_NUMBER_) PEL_FMT_NONE = 0 };

// Added to a format whose pixels are not tightly packed, not aligned, or fewer in a row than the math width.
// Such pixels are read one by one, packed ones in vectors.
#define PEL_FMT_STRIDED 32
