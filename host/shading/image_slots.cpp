#include "shading/image_slots.h"

#include <iterator>

#include "shared/shade.h"

namespace pel {
namespace {

#define SLOT(name, number, role, content, components, key, words, bits) \
    {words, "PEL_FORMAT_" #name, SlotRole::role, Content::content, unsigned(bits)},
constexpr ImageSlot slots[] = {PEL_EACH_IMAGE(SLOT)};
#undef SLOT

// The public header documents the slots, and C compilers read it by itself, so it must agree with the list.
#define CHECK_SLOT(name, number, role, content, components, key, words, bits) \
    static_assert(PEL_SLOT_##name == number);
PEL_EACH_IMAGE(CHECK_SLOT)
static_assert(int(PEL_IMAGE_SLOTS) == PEL_SLOT_COUNT && std::size(slots) == PEL_SLOT_COUNT);
#undef CHECK_SLOT

}  // namespace

const ImageSlot& imageSlot(int slot) {
    return slots[slot];
}

const char* scatteringName(PelScattering scattering) {
#define KEY(name, number, key) key,
    constexpr const char* names[] = {PEL_EACH_SCATTERING(KEY)};
#undef KEY
    return names[scattering];
}

const char* lightSlotName(PelLightSlot slot) {
    constexpr const char* names[] = {"wide shadow", "shadow map", "cascade 1", "cascade 2", "cascade 3"};
    static_assert(std::size(names) == PEL_LIGHT_SLOT_COUNT);
    return names[slot];
}

}  // namespace pel
