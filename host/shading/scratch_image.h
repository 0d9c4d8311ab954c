// Images that passes make.
#pragma once
#include "core/image_view.h"

namespace pel {

// The memory of an image; none for an empty one.
const cl::Memory& memoryOf(const ImageView& view);

// Gives `buffer` this many bytes; 0: none. An old one of another size is released before the new one is made.
void resize(Ref<Buffer>& buffer, const Ref<Device>& device, size_t bytes);

// An image as wide as the frame inside scratch memory.
ImageView scratchImage(const Ref<Buffer>& buffer, const ImageView& frame, PelFormat format,
                       uint64_t offset = 0);

// Rewrites the start of a PelShadeImage at `at` in `memory`: to where the image would begin if it also had
// the rows before `row`.
void moveImage(Device& device, cl_mem memory, size_t at, const ImageView& view, uint32_t row);

}  // namespace pel
