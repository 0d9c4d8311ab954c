#include "core/image_view.h"

#include "core/handle_table.h"
#include "core/struct_size.h"
#include "shared/formats.h"

namespace pel {
namespace {

#define FORMAT(name, number, kind, components, componentBytes, pixelBytes) \
    {#name, FormatKind::kind, components, componentBytes, pixelBytes, FormatKind::kind == FormatKind::PLANAR},
constexpr FormatInfo formats[] = {{"undefined", FormatKind::NONE, 0, 0, 0, false}, PEL_EACH_FORMAT(FORMAT)};
#undef FORMAT

#define CHECK(name, number, kind, components, componentBytes, pixelBytes) \
    static_assert(PEL_FORMAT_##name == number);
PEL_EACH_FORMAT(CHECK)
#undef CHECK

}  // namespace

const FormatInfo* formatInfo(PelFormat format) {
    const auto index = size_t(format);
    return index > 0 && index < std::size(formats) ? &formats[index] : nullptr;
}

const cl::Memory& ImageView::memory() const {
    static const cl::Memory none;
    return buffer ? buffer->memory() : none;
}

uint64_t ImageView::byteEnd() const {
    const uint64_t planes = info().planar ? (info().components - 1) * planeStride : 0;
    return byteOffset + planes + (height - 1) * rowStride + (width - 1) * pixelStride + info().pixelBytes;
}

ImageView makeImageView(const PelImageDesc* given, Device& device, const char* what) {
    const PelImageDesc desc =
        about([&] { return readStruct(given, pelImageDescDefaults()); }, "the ", what, " image");
    const FormatInfo* format = formatInfo(desc.format);
    if (!format)
        invalidArgument("the ", what, " image has format ", int(desc.format),
                        ", which is not a value of PelFormat");
    if (desc.width == 0 || desc.height == 0 || desc.width > 16384 || desc.height > 16384)
        invalidArgument("the ", what, " image is ", desc.width, " x ", desc.height,
                        "; both must be between 1 and 16384");
    ImageView view;
    view.buffer =
        about([&] { return fromHandle<Buffer>(desc.buffer); }, "the buffer of the ", what, " image");
    if (&view.buffer->device() != &device)
        invalidArgument("the buffer of the ", what, " image belongs to another PelDevice than the shader");
    view.format = desc.format;
    view.width = desc.width;
    view.height = desc.height;
    view.byteOffset = desc.byteOffset;
    view.pixelStride = desc.pixelStride ? desc.pixelStride : format->pixelBytes;
    if (view.pixelStride > 1u << 16)
        invalidArgument("the ", what, " image's pixelStride is ", view.pixelStride,
                        "; 65536 bytes is the most");
    view.rowStride = desc.rowStride ? desc.rowStride : view.width * view.pixelStride;
    view.planeStride = desc.planeStride ? desc.planeStride : view.height * view.rowStride;
    const struct {
        const char* name;
        uint64_t value;
    } aligned[] = {{"byteOffset", view.byteOffset},
                   {"pixelStride", view.pixelStride},
                   {"rowStride", view.rowStride},
                   {"planeStride", format->planar ? view.planeStride : 0}};
    for (const auto& [name, value] : aligned)
        if (value % format->componentBytes)
            invalidArgument("the ", what, " image's ", name, " is ", value, "; format ", format->name,
                            " needs a multiple of ", format->componentBytes);
    if (view.pixelStride < format->pixelBytes)
        invalidArgument("the ", what, " image's pixelStride is ", view.pixelStride, ", less than the ",
                        format->pixelBytes, " bytes of a pixel of ", format->name);
    if (view.rowStride > UINT32_MAX || view.planeStride > uint64_t(1) << 40)
        invalidArgument("the ", what, " image's rowStride is ", view.rowStride, " and planeStride ",
                        view.planeStride, "; they must be below 4 GiB and 1 TiB");
    if (view.height > 1 && view.rowStride < (view.width - 1) * view.pixelStride + format->pixelBytes)
        invalidArgument("the ", what, " image's rowStride is ", view.rowStride, ", less than the ",
                        (view.width - 1) * view.pixelStride + format->pixelBytes, " bytes of its row");
    if (view.byteOffset > view.buffer->bytes() || view.byteEnd() > view.buffer->bytes())
        invalidArgument("the ", what, " image (", view.width, " x ", view.height, " ", format->name,
                        " from byte ", view.byteOffset, " on) ends at byte ", view.byteEnd(),
                        " of a buffer of ", view.buffer->bytes());
    return view;
}

// Whether the byte ranges of the two images overlap, from first to last pixel.
static bool overlaps(const ImageView& a, const ImageView& b) {
    const Buffer::Place &inA = a.buffer->place(), &inB = b.buffer->place();
    return inA.whole == inB.whole && inA.offset + a.byteEnd() > inB.offset + b.byteOffset &&
           inB.offset + b.byteEnd() > inA.offset + a.byteOffset;
}

// Whether pixels of both have the same addresses: interleaved components, or the same image.
static bool pixelOnPixel(const ImageView& a, const ImageView& b) {
    // Writes through one cl_mem need not be visible through another one over the same memory.
    if (a.buffer->memory().get() != b.buffer->memory().get()) return false;
    if (a.pixelStride != b.pixelStride || a.rowStride != b.rowStride || a.info().planar != b.info().planar)
        return false;
    if (a.info().planar) return a.byteOffset == b.byteOffset && a.planeStride == b.planeStride;
    return std::max(a.byteOffset + a.info().pixelBytes, b.byteOffset + b.info().pixelBytes) -
               std::min(a.byteOffset, b.byteOffset) <=
           a.pixelStride;
}

void copyTextures(const std::vector<ImageView>& images, bool back) {
    std::vector<const Buffer*> copied;
    for (const ImageView& view : images) {
        const Buffer* const buffer = view.buffer.get();
        if (!buffer || !buffer->ofTexture() || std::ranges::count(copied, buffer)) continue;
        buffer->copyTexture(back);
        copied.push_back(buffer);
    }
}

bool sharesBytes(const ImageView& a, const ImageView& b) {
    if (!overlaps(a, b)) return false;
    return !pixelOnPixel(a, b) || a.info().planar ||
           (a.byteOffset + a.info().pixelBytes > b.byteOffset &&
            b.byteOffset + b.info().pixelBytes > a.byteOffset);
}

bool overlapsElsewhere(const ImageView& a, const ImageView& b) {
    return overlaps(a, b) && !pixelOnPixel(a, b);
}

}  // namespace pel
