// Skin from its composition: albedo, profile, and maps of melanin and blood. Section 15 of the mathematics.
#pragma once
#include "lut/profile.h"

namespace pel {

PelSkin readSkin(const PelSkin* skin);  // NULL: the defaults; throws for a field out of range
PelSkinInfo skinInfo(const PelSkin& skin);
void skinReflectance(const PelSkin& skin, std::span<const float> nanometres, float* reflectance);
Ref<Profile> skinLayersProfile(const PelSkin& skin);
void skinAlbedo(const PelSkin& skin, const float* melanin, const float* blood, size_t count, float* albedo,
                float* radius);
// For maps on a device (kernels/shared/skin_maps.h): nodes of the square root of the albedo and the length
// over that of `skin`, for each of `oxygenations` values; 1: that of `skin` itself.
std::vector<float> skinTable(const PelSkin& skin, int oxygenations);
void skinFromAlbedo(const PelSkin& skin, const float* albedo, size_t count, float* melanin, float* blood,
                    float* difference);

}  // namespace pel
