// Images that passes make.
#pragma once
#include "core/image_view.h"

namespace pel {

// The memory of an image; none for none.
const cl::Memory& memoryOf(const ImageView& view);

// `buffer` with this many bytes; 0: none. An old one of another size goes before the new one comes.
void resize(Ref<Buffer>& buffer, const Ref<Device>& device, size_t bytes);

// An image as wide as the frame inside scratch memory.
ImageView scratchImage(const Ref<Buffer>& buffer, const ImageView& frame, PelFormat format, uint64_t offset = 0);

// Rewrites the place of a PelShadeImage at `at` in `memory`: where the image would begin if it had the rows
// before `row` too.
void moveImage(Device& device, cl_mem memory, size_t at, const ImageView& view, uint32_t row);

}  // namespace pel
