#include "shading/image_slots.h"

#include <iterator>

#include "shared/choices.h"
#include "shared/shade.h"

namespace pel {
namespace {

#define SLOT(name, number, role, content, components, key, words, bits) \
    {words, "PEL_FORMAT_" #name, SlotRole::role, Content::content, unsigned(bits)},
constexpr ImageSlot slots[] = {PEL_EACH_IMAGE(SLOT)};
#undef SLOT

// The public header documents slots and choices, and C compilers read it by itself, so it must agree with the
// lists.
#define CHECK_SLOT(name, number, role, content, components, key, words, bits) \
    static_assert(PEL_SLOT_##name == number);
PEL_EACH_IMAGE(CHECK_SLOT)
static_assert(int(PEL_IMAGE_SLOTS) == PEL_SLOT_COUNT && std::size(slots) == PEL_SLOT_COUNT);
#undef CHECK_SLOT
#define CHECK_TYPE(name, number, key) static_assert(PEL_LIGHT_##name == number);
#define CHECK_PROJECTION(name, number, key) static_assert(PEL_SHADOW_##name == number);
#define CHECK_CONTENT(name, number, key) static_assert(PEL_SHADOW_CONTENT_##name == number);
#define CHECK_MODEL(name, number, key) static_assert(PEL_SPECULAR_##name == number);
PEL_EACH_LIGHT_TYPE(CHECK_TYPE)
PEL_EACH_SHADOW_PROJECTION(CHECK_PROJECTION)
PEL_EACH_SHADOW_CONTENT(CHECK_CONTENT)
PEL_EACH_SPECULAR_MODEL(CHECK_MODEL)
#define CHECK_SCATTERING(name, number, key) static_assert(PEL_SCATTERING_##name == number);
PEL_EACH_SCATTERING(CHECK_SCATTERING)

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
