// What the list of image slots (shared/image_slots.h) says of each.
#pragma once
#include <pellucid/pellucid.h>

#include "shared/image_slots.h"

namespace pel {

// TARGET and SHADE are read by the shading kernel, PASS by other passes alone; TARGET and OUTPUT are written
// by it.
enum class SlotRole { TARGET, SHADE, PASS, OUTPUT };
// What pixels hold, and so which formats they may have.
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
