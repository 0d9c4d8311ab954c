// What a variant of the shading kernel is made of, beside the formats of images (shared/formats.h): feature bits
// (PEL_FEATURES), a compile-time number. Numbers of the scene are arguments.
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
#define PEL_BIT_IRRADIANCE 0x4000
#define PEL_BIT_TRANSMISSION 0x800000
#define PEL_BIT_SHADOW_CUBE 0x1000000
#define PEL_BIT_SHADOW_CASCADES 0x2000000
// How the kernel goes about it.
#define PEL_BIT_POSITIONAL 0x10000   // a point or spot light
#define PEL_BIT_ACCUMULATE 0x20000   // add to the output
#define PEL_BIT_NO_SKIPPING 0x40000  // evaluate every term of every pixel
#define PEL_BIT_COUNT \
    0x80000  // count pixels per feature; those of a material, and invalid ones, are counted without it
#define PEL_BIT_CUBE_ALONE 0x100000   // ambient light has no other part than the cube map
#define PEL_BIT_ROTATE_TAPS 0x200000  // thickness taps are turned from pixel to pixel

#endif
