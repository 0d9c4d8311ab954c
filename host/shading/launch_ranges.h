// How passes over tiles are launched, and the defines for an image's layout.
#pragma once
#include "shading/shader_state.h"

namespace pel {

// On CPUs each work-item runs one vector of pixels after another; on GPUs a tile takes a full work-group.
uint32_t tileGroup(const Device& device);
// Enough work-items to keep every compute unit busy to the end; each group takes a run of the tiles.
cl::Range tileRange(const Device& device, uint32_t tiles);

// Sets a kernel's last arguments (kernels/lib/image/light_buffers.clh): PEL_LIGHT_BUFFERS at most.
void lightBufferArguments(cl::Launch& launch, const std::vector<cl::Memory>& buffers);

// The define of a kernel variant for an image: its format, and whether its pixels are read one by one. Packed
// images of at least `lanes` pixels a row are read in vectors. 0: no image.
uint32_t formatCode(const ImageView& view, uint32_t lanes);
// The same of a light's shadow map and its cascades together.
uint32_t mapFormatCode(const ShaderLight& light);

// The slot of the geometric normals of a frame, or that of the shading normals.
PelImageSlot geometricNormalSlot(const ShaderState& state);
// The defines of every pass over tiles that reads ids and the surface: group, width, and formats of ids,
// positions and depth.
cl::Defines surfaceDefines(const Device& device, const ShaderState& state, uint32_t lanes);

}  // namespace pel
