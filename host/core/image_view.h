// A checked view of an image in a buffer: a PelImageDesc with its defaults filled in.
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
// nullptr for PEL_FORMAT_UNDEFINED and for numbers that are not formats.
const FormatInfo* formatInfo(PelFormat format);

struct ImageView {
    Ref<Buffer> buffer;
    PelFormat format = PEL_FORMAT_UNDEFINED;
    uint32_t width = 0, height = 0;
    uint64_t byteOffset = 0, pixelStride = 0, rowStride = 0, planeStride = 0;

    explicit operator bool() const { return bool(buffer); }
    const FormatInfo& info() const { return *formatInfo(format); }
    const cl::Memory& memory() const;  // none for an empty view
    // Bytes from the first to one past the last.
    uint64_t byteEnd() const;
    bool tightlyPacked() const { return pixelStride == info().pixelBytes; }
};

// Checks the caller's structure, format, alignment and strides, that all pixels are inside the buffer, and
// that the buffer is of `device`. `what` names the image in every message.
ImageView makeImageView(const PelImageDesc* given, Device& device, const char* what);

// Enqueues the copies from the textures of these images, each once; `back`: to the textures.
void copyTextures(const std::vector<ImageView>& images, bool back);

// Whether `a` and `b` share a byte of a pixel, also by host memory or as parts of one cl_mem.
bool sharesBytes(const ImageView& a, const ImageView& b);

// Whether writing `a` could change pixels of `b` before they are read: an overlap other than pixel on pixel.
bool overlapsElsewhere(const ImageView& a, const ImageView& b);

}  // namespace pel
