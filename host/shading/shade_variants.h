// The variants of the shading kernel: smaller ones for tiles whose materials need fewer features.
#pragma once
#include "shading/pass.h"

namespace pel {

// The features of each variant: those of the whole shader first, then fewer and fewer.
std::vector<uint32_t> variantFeatures(const ShaderState& state, uint32_t features);
// The defines of kernels with a Scene (shading/scene.clh): features, and the formats of the images that these
// features read.
cl::Defines sceneDefines(const Device& device, const ShaderState& state, uint32_t features);
// The program of a variant. Shaders with equal meaning have equal keys.
cl::ProgramKey shadeKey(const Device& device, const ShaderState& state, uint32_t features);

// The first arguments of kernels with a Scene: SCENE_ARGUMENTS of shading/scene.clh.
void sceneArguments(cl::Launch& launch, const PassWork& work);

}  // namespace pel
