#include "shading/launch_ranges.h"

#include "core/launch_policy.h"
#include "shared/shade.h"

namespace pel {

uint32_t tileGroup(const Device& device) {
    return uint32_t(launchPolicy(device).group);
}

cl::Range tileRange(const Device& device, uint32_t tiles) {
    const size_t group = tileGroup(device);
    return {{groupsFor(device, tiles) * group, 1, 1}, {group, 1, 1}};
}

uint32_t formatCode(const ImageView& view, uint32_t lanes) {
    if (!view) return 0;
    const bool vectors = view.tightlyPacked() && view.width >= lanes;
    return uint32_t(view.format) | (vectors ? 0 : PEL_FMT_STRIDED);
}

uint32_t mapFormatCode(const ShaderLight& light) {
    uint32_t code = 0;
    for (uint32_t i = 0; i < cascadesOf(light); ++i) code |= formatCode(*shadowCascade(light, i).map, 1);
    return code;
}

PelImageSlot geometricNormalSlot(const ShaderState& state) {
    return state.images[PEL_SLOT_NORMAL_GEOMETRIC] ? PEL_SLOT_NORMAL_GEOMETRIC : PEL_SLOT_NORMAL_SHADING;
}

void lightBufferArguments(cl::Launch& launch, const std::vector<cl::Memory>& buffers) {
    for (size_t i = 0; i < PEL_LIGHT_BUFFERS; ++i) launch.arg(i < buffers.size() ? buffers[i] : cl::Memory());
}

cl::Defines surfaceDefines(const Device& device, const ShaderState& state, uint32_t lanes) {
    const auto code = [&](PelImageSlot slot) { return formatCode(state.images[slot], lanes); };
    return {{"PEL_PASS_GROUP", tileGroup(device)},
            {"PEL_WIDTH", lanes},
            {"PEL_FORMAT_MATERIAL", code(PEL_SLOT_MATERIAL)},
            {"PEL_FORMAT_POSITION", code(PEL_SLOT_POSITION)},
            {"PEL_FORMAT_DEPTH", state.images[PEL_SLOT_POSITION] ? 0 : code(PEL_SLOT_DEPTH)}};
}

}  // namespace pel
