// Facts about each image slot, from the list in shared/image_slots.h.
#pragma once
#include <pellucid/pellucid.h>

#include "shared/image_slots.h"

namespace pel {

// The shading kernel reads TARGET and SHADE, only other passes read PASS; the kernel writes TARGET and
// OUTPUT.
enum class SlotRole { TARGET, SHADE, PASS, OUTPUT };
// The content of pixels, which decides the formats that they may have.
enum class Content { SCALAR, ID, COLOR, NORMAL, UV, GRADIENT, COLOR_OUTPUT, SCALAR_OUTPUT };

struct ImageSlot {
    const char* words;   // in messages: "shading normal"
    const char* define;  // of its format, in kernels
    SlotRole role;
    Content content;
    unsigned bits;  // PEL_BIT_... of the features by which the shading kernel reads it
};
const ImageSlot& imageSlot(int slot);

inline const char* slotName(int slot) {
    return imageSlot(slot).words;
}
inline bool isOutput(int slot) {
    return imageSlot(slot).role == SlotRole::OUTPUT;
}
const char* lightSlotName(PelLightSlot slot);
const char* scatteringName(PelScattering scattering);  // "screen"

}  // namespace pel
