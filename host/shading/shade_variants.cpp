#include "shading/shade_variants.h"

#include <bit>
#include <set>

#include "shading/features.h"
#include "shading/image_slots.h"
#include "shading/launch_ranges.h"
#include "shading/shading_constants.h"
#include "shading/tap_cells.h"

namespace pel {
namespace {

// Slots that no feature reads are left out: fewer variants, and unused inputs cannot matter.
bool slotIsRead(const ShaderState& state, int slot, uint32_t features) {
    uint32_t bits = imageSlot(slot).bits;
    if (slot == PEL_SLOT_DEPTH && state.images[PEL_SLOT_POSITION]) return false;
    if (slot == PEL_SLOT_THICKNESS && state.images[PEL_SLOT_OUT_THICKNESS]) return true;
    // The geometric normal replaces a missing blurred one.
    if (slot == PEL_SLOT_NORMAL_GEOMETRIC && !state.images[PEL_SLOT_NORMAL_BLURRED])
        bits |= PEL_READ_NORMAL_BLURRED;
    return bits == uint32_t(PEL_BITS_ALL_) || features & bits;
}

bool usesCells(const ShaderState& state, uint32_t features) {
    return features & PEL_FEATURE_THICKNESS_TAPS && mayHaveCells(state);
}

}  // namespace

cl::Defines sceneDefines(const Device& device, const ShaderState& state, uint32_t features) {
    if (!(features & PEL_BIT_THICKNESS_TAPS))
        features &= ~uint32_t(PEL_BIT_SHADOW_CUBE | PEL_BIT_SHADOW_CASCADES);
    if (state.options.accumulate) features |= PEL_BIT_ACCUMULATE;
    if (state.options.disableSkipping) features |= PEL_BIT_NO_SKIPPING;
    if (state.options.countPixels) features |= PEL_BIT_COUNT;
    if (state.options.rotateTaps && features & PEL_BIT_THICKNESS_TAPS) features |= PEL_BIT_ROTATE_TAPS;
    if (usesCells(state, features)) features |= PEL_BIT_TAP_CELLS;
    if (features & PEL_BIT_AMBIENT_CUBE && isBlack(state.ambient)) features |= PEL_BIT_CUBE_ALONE;
    uint32_t wide = 0, map = 0, content = 0;
    for (const ShaderLight& light : state.lights) {
        if (light.params.type != PEL_LIGHT_DIRECTIONAL) features |= PEL_BIT_POSITIONAL;
        wide |= formatCode(light.images[PEL_LIGHT_WIDE_SHADOW], device.info().mathWidth);
        if (!light.images[PEL_LIGHT_SHADOW_MAP]) continue;
        map |= mapFormatCode(light);
        content = light.params.shadowContent;
    }
    if (!(features & PEL_BIT_THICKNESS_TAPS)) map = content = 0;
    cl::Defines defines{{"PEL_FEATURES", features},
                        {"PEL_AREA_LIGHTS", int(hasAreaLight(state))},
                        {"PEL_FORMAT_WIDE_SHADOW", wide},
                        {"PEL_FORMAT_SHADOW_MAP", map},
                        {"PEL_SHADOW_CONTENT", content}};
    for (int slot = 0; slot < PEL_SLOT_COUNT; ++slot) {
        if (imageSlot(slot).role == SlotRole::PASS) continue;
        const uint32_t code =
            slotIsRead(state, slot, features) ? formatCode(state.images[slot], device.info().mathWidth) : 0;
        defines[imageSlot(slot).define] = code;
    }
    return defines;
}

cl::ProgramKey shadeKey(const Device& device, const ShaderState& state, uint32_t features) {
    cl::ProgramKey key{{"shading/shade.cl"}, sceneDefines(device, state, features & PEL_BITS_OF_KERNEL)};
    key.defines["PEL_SHADE_GROUP"] = tileGroup(device);
    if (usesCells(state, features)) {
        key.files.push_back("shading/tap_cells.cl");
        key.defines["PEL_CELLS_RUN"] = cellsRun(device);
    }
    return key;
}

std::vector<uint32_t> variantFeatures(const ShaderState& state, uint32_t features) {
    std::vector<uint32_t> variants{features};
    // Tests want every term everywhere.
    if (!state.images[PEL_SLOT_MATERIAL] || state.options.tileLists == PEL_TILES_NO_LIST ||
        state.options.disableSkipping)
        return variants;
    // Tiles without an eye have no code for eyes.
    if (features & PEL_FEATURE_EYE)
        variants.push_back(features & ~uint32_t(PEL_FEATURE_EYE | PEL_FEATURE_REFLECTION_CUBE));
    // Other outputs must not depend on further variants.
    if (state.options.tileLists != PEL_TILES_PER_VARIANT || features & PEL_FEATURE_OUTPUTS) return variants;
    std::set<uint32_t> needed;
    for (const auto& [id, material] : state.materials) needed.insert(materialNeeds(state, material));
    std::vector<uint32_t> partial;
    for (const uint32_t needs : needed) {
        const uint32_t left = (features & ~PEL_BITS_OF_MATERIALS) | needs;
        // Another variant pays if it leaves out a term (docs/guide/shading.md, "Tiles").
        if ((features & ~left) & (PEL_FEATURE_DIRECT_SCATTER | PEL_FEATURE_SPECULAR |
                                  PEL_FEATURE_DEEP_SCATTER | PEL_FEATURE_TRANSMISSION))
            partial.push_back(left);
    }
    std::ranges::stable_sort(partial, std::greater{}, [](uint32_t f) { return std::popcount(f); });
    std::erase(partial, variants.back());
    // Keeps the cheapest ones.
    const size_t most = PEL_TILE_VARIANTS - variants.size();
    if (partial.size() > most) partial.erase(partial.begin(), partial.end() - ptrdiff_t(most));
    variants.insert(variants.end(), partial.begin(), partial.end());
    return variants;
}

void sceneArguments(cl::Launch& launch, const PassWork& work) {
    const ShadingConstants& constants = work.constants;
    launch.args(constants.frameMemory(), constants.materials(), constants.lights(), constants.luts(),
                work.plan.tileLists, work.plan.counters, work.plan.ambientNodes, constants.eyes(),
                work.plan.irises, work.plan.reflectionNodes, work.plan.environmentNodes, work.plan.tapCells);
    for (int slot = 0; slot < PEL_SLOT_COUNT; ++slot)
        if (imageSlot(slot).role != SlotRole::PASS) launch.arg(work.plan.state.images[slot]);
    lightBufferArguments(launch, constants.lightBuffers());
}

}  // namespace pel
