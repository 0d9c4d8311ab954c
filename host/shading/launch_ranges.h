// How passes over tiles are launched, and what their programs know of an image's layout.
#pragma once
#include "shading/shader_state.h"

namespace pel {

// CPUs run one vector of pixels after another in each work-item; GPUs want a full work-group in a tile.
uint32_t tileGroup(const Device& device);
// Work-items that keep every unit busy to the end; each group takes a run of the tiles.
cl::Range tileRange(const Device& device, uint32_t tiles);

// What a variant of a kernel knows of an image: its format, and whether its pixels are read one by one. Those
// of tight images of at least `lanes` pixels a row are read in vectors. 0: no image.
uint32_t formatCode(const ImageView& view, uint32_t lanes);
// The same of a light's shadow map and its cascades together.
uint32_t mapFormatCode(const ShaderLight& light);

// The geometric normals of a frame: their slot, or the shading normals'.
PelImageSlot geometricNormalSlot(const ShaderState& state);
// What every pass over tiles needs that reads ids and the surface: group, width, and formats of ids,
// positions and depth.
cl::Defines surfaceDefines(const Device& device, const ShaderState& state, uint32_t lanes);

}  // namespace pel
