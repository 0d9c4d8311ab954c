// The pixels of an image as floats, decoded as the other kernels decode them: a capture writes them to files
// (host/shading/capture.cpp).
//
// Input: an image. Output: PEL_COMPONENTS floats a pixel, interleaved. One work-item: PEL_WIDTH pixels of a
// row. Variants: PEL_FORMAT (lib/image/image.clh); PEL_READ_AS: 0 numbers, 1 directions, 2 texels of a normal
// map, 3 ids.

#include "lib/diffusion/item.clh"
#include "lib/image/image.clh"
#include "lib/shading/material_id.clh"

#define PEL_IS_UNORM                                           \
    ((PEL_FORMAT & ~PEL_FMT_STRIDED) == PEL_FMT_RGBA8_UNORM || \
     (PEL_FORMAT & ~PEL_FMT_STRIDED) == PEL_FMT_A2B10G10R10_UNORM)

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void image_values(
    __global const PelShadeImage* restrict image, __global uchar* restrict pixels,
    __global float* restrict values) {
    const uint across = (image->width + PEL_WIDTH - 1) / PEL_WIDTH, y = itemOfFolded() / across;
    if (y >= image->height) return;
    const uint x = vectorStart(itemOfFolded() % across * PEL_WIDTH, image->width);
    const Span s = imageSpan(pixels, image, x, y);
    Vec3w v = same3(0.0f);
    floatw fourth = 1.0f;  // of a tangent: the sign of the bitangent
#if PEL_READ_AS == 3
    v.x = convert_floatw(loadId(PEL_FORMAT, s));
#elif PEL_READ_AS == 1
    v = loadNormal(PEL_FORMAT, s);
#elif PEL_COMPONENTS > 2
    v = loadColor(PEL_FORMAT, s);
#else
    v.x = gatherComponent(PEL_FORMAT, s, 0);
    if (PEL_COMPONENTS > 1) v.y = gatherComponent(PEL_FORMAT, s, 1);
#endif
#if PEL_FOURTH
    fourth = gatherComponent(PEL_FORMAT, s, 3);
    if (PEL_READ_AS == 1 && PEL_IS_UNORM) fourth -= 0.5f;
#endif
    if (PEL_READ_AS == 2 && PEL_IS_UNORM) v = vec3(2.0f * v.x - 1.0f, 2.0f * v.y - 1.0f, 2.0f * v.z - 1.0f);
    __global float* to = values + ((size_t)y * image->width + x) * PEL_COMPONENTS;
#define PEL_PUT_(i, suffix)                                                 \
    if ((i) <= s.last) {                                                    \
        to[(i)*PEL_COMPONENTS] = v.x suffix;                                \
        if (PEL_COMPONENTS > 1) to[(i)*PEL_COMPONENTS + 1] = v.y suffix;    \
        if (PEL_COMPONENTS > 2) to[(i)*PEL_COMPONENTS + 2] = v.z suffix;    \
        if (PEL_COMPONENTS > 3) to[(i)*PEL_COMPONENTS + 3] = fourth suffix; \
    }
    PEL_EACH_LANE(PEL_PUT_)
#undef PEL_PUT_
}
