// Checks of settings. Each throws PEL_ERROR_INVALID_ARGUMENT with the value and what would be right.
#pragma once
#include "shading/image_slots.h"
#include "shading/shader_state.h"

namespace pel {

// NAME.FIELD[i] of a structure.
void checkFinite(const char* structure, const char* field, const float* values, size_t count);
void checkImage(PelImageSlot slot, const ImageView& view);
// An input of an operation on plain images, of which `of` is the output.
void checkSize(const char* name, const ImageView& view, const char* outName, const ImageView& of);
void checkLightImage(PelLightSlot slot, const ImageView& view, const char* what);
void checkNormalMap(const std::vector<ImageView>& levels);
void checkMaterial(const PelMaterial& material);
void checkScatterControls(const char* structure, uint32_t taps, float albedoBefore,
                          const float (&borderColor)[3]);
void checkScatteredTexture(const ImageView& texture);
void checkIrisTexture(const ImageView& texture);
void checkLight(const PelLight& light, uint32_t index);
// A light's shadow map at commit: its form, its images and the fields that they need.
void checkLightMap(const ShaderLight& light, uint32_t index);
void checkAmbient(const PelAmbient& ambient);
// Of six faces; `what` names it.
void checkCube(const ImageView& faces, const char* what);
void checkEnvironment(const ImageView& image);
void checkAxes(const std::array<float, 9>& axes);  // of it
void checkCamera(const PelCamera& camera);
// Positions follow from depth by it.
void checkInvertible(const char* structure, const float (&inverseViewProjection)[16]);
void checkOptions(const PelShaderOptions& options);

}  // namespace pel
