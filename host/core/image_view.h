// A checked view of an image in a buffer: what a PelImageDesc says, with its defaults filled in.
#pragma once
#include "core/buffer.h"

namespace pel {

// The kinds of shared/formats.h.
enum class FormatKind { NONE, FLOAT, UNORM, SRGB, OCTAHEDRAL, UINT, PLANAR };

struct FormatInfo {
    const char* name;
    FormatKind kind;
    uint32_t components;
    uint32_t componentBytes;
    uint32_t pixelBytes;
    bool planar;
};
// nullptr for PEL_FORMAT_UNDEFINED and numbers that are no format.
const FormatInfo* formatInfo(PelFormat format);

struct ImageView {
    Ref<Buffer> buffer;
    PelFormat format = PEL_FORMAT_UNDEFINED;
    uint32_t width = 0, height = 0;
    uint64_t byteOffset = 0, pixelStride = 0, rowStride = 0, planeStride = 0;

    explicit operator bool() const { return bool(buffer); }
    const FormatInfo& info() const { return *formatInfo(format); }
    // The bytes from the first to behind the last.
    uint64_t byteEnd() const;
    bool tightlyPacked() const { return pixelStride == info().pixelBytes; }
};

// Checks format, alignment, strides and that everything lies inside the buffer, which must be of `device`;
// `what` names the image in messages.
ImageView makeImageView(const PelImageDesc& desc, Device& device, const char* what);

// Whether a byte of a pixel of `a` is one of `b` too. Buffers over the same host memory, or parts of one cl_mem, are noticed.
bool sharesBytes(const ImageView& a, const ImageView& b);

// Whether writing `a` pixel by pixel could change pixels of `b` that are read later: they overlap, and not
// pixel on pixel in one cl_mem.
bool overlapsElsewhere(const ImageView& a, const ImageView& b);

}  // namespace pel
