// The variants of the shading kernel: for tiles whose materials need less than all together.
#pragma once
#include "shading/shader_plan.h"

namespace pel {

// The features that each variant has: of the whole shader first, then fewer and fewer.
std::vector<uint32_t> variantFeatures(const ShaderState& state, uint32_t features);
// What kernels with a Scene (shading/scene.clh) are built with: features and the formats of the images
// that they read by these.
cl::Defines sceneDefines(const Device& device, const ShaderState& state, uint32_t features);
// What makes the program of a variant and its classification: shaders that mean the same have equal keys.
cl::ProgramKey shadeKey(const Device& device, const ShaderState& state, uint32_t features);

// Work-items of the classification of tiles.
cl::Range classifyRange(const Device& device, size_t tiles);

}  // namespace pel
