// What a variant of the shading kernel is made of, one list for host and device: feature bits (PEL_FEATURES),
// and image formats (PEL_FORMAT_<SLOT>), both compile-time numbers. Numbers of the scene are arguments.
#ifndef PEL_SHARED_FEATURES
#define PEL_SHARED_FEATURES

// Bits of PEL_FEATURES. The low ones are PelFeature of the public header.
#define PEL_BIT_DIRECT_SCATTER 0x1
#define PEL_BIT_SHADOW 0x2
#define PEL_BIT_SHADOW_LUT 0x4
#define PEL_BIT_AMBIENT 0x8
#define PEL_BIT_DEEP_SCATTER 0x10
#define PEL_BIT_THICKNESS_TAPS 0x20
#define PEL_BIT_SPECULAR 0x40
#define PEL_BIT_GGX 0x400
#define PEL_BIT_AMBIENT_SCATTER 0x800
#define PEL_BIT_AMBIENT_CUBE 0x2000
#define PEL_BIT_SHADOW_CUBE 0x1000000
#define PEL_BIT_SHADOW_CASCADES 0x2000000
// How the kernel goes about it.
#define PEL_BIT_POSITIONAL 0x10000  // a point or spot light
#define PEL_BIT_ACCUMULATE 0x20000  // add to the output
#define PEL_BIT_NO_SKIPPING 0x40000 // evaluate every term of every pixel
#define PEL_BIT_COUNT 0x80000       // count pixels per feature
#define PEL_BIT_CUBE_ALONE 0x100000  // ambient light has no other part than the cube map
#define PEL_BIT_ROTATE_TAPS 0x200000 // thickness taps are turned from pixel to pixel

// Formats: PelFormat's numbers; 0 is an image that is not there.
#define PEL_FMT_R32F 1
#define PEL_FMT_RG32F 2
#define PEL_FMT_RGB32F 3
#define PEL_FMT_RGBA32F 4
#define PEL_FMT_R16F 5
#define PEL_FMT_RG16F 6
#define PEL_FMT_RGB16F 7
#define PEL_FMT_RGBA16F 8
#define PEL_FMT_R8_UNORM 9
#define PEL_FMT_RGBA8_UNORM 10
#define PEL_FMT_RGBA8_SRGB 11
#define PEL_FMT_R16_UNORM 12
#define PEL_FMT_OCT16X2_SNORM 13
#define PEL_FMT_A2B10G10R10_UNORM 14
#define PEL_FMT_R8_UINT 15
#define PEL_FMT_R16_UINT 16
#define PEL_FMT_R32_UINT 17
#define PEL_FMT_PLANAR_RGB32F 18
// Added to a format whose pixels are not tightly packed, not aligned, or fewer in a row than the math width:
// such pixels are read one by one, tight ones in vectors.
#define PEL_FMT_STRIDED 32

#endif
