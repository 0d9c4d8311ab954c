#include "core/image_substitutes.h"

#include <algorithm>

namespace pel {
namespace {

// Wide enough that passes interpolate between pixels, and for several levels of pyramids.
constexpr uint32_t mostPixels = 64;

constexpr uint64_t alignment = 64;  // bytes, of the first pixel

// Keeps the proportions of six faces.
void makeSmall(ImageView& view) {
    const uint32_t edge = std::min(view.width, view.height), most = std::min(edge, mostPixels);
    for (uint32_t* side : {&view.width, &view.height})
        *side = *side == 6 * edge ? 6 * most : std::min(*side, mostPixels);
    view.rowStride = view.width * view.pixelStride;
    view.planeStride = view.height * view.rowStride;
}

}  // namespace

void ImageSubstitutes::add(ImageView& view) {
    if (view) views_.push_back(&view);
}

void ImageSubstitutes::place(const Ref<Device>& device) {
    std::map<const Buffer*, std::vector<ImageView*>> ofBuffer;
    for (ImageView* view : views_) ofBuffer[view->buffer.get()].push_back(view);
    views_.clear();
    for (const auto& [buffer, views] : ofBuffer) {
        uint64_t end = 0;
        for (ImageView* view : views) {
            makeSmall(*view);
            view->byteOffset = (end + alignment - 1) / alignment * alignment;
            end = view->byteEnd();
        }
        const Ref<Buffer> zeros = Buffer::create(device, end, nullptr);
        for (ImageView* view : views) view->buffer = zeros;
    }
}

}  // namespace pel
