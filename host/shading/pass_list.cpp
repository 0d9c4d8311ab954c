#include "shading/image_slots.h"
#include "shading/pass.h"

namespace pel {
namespace {

// Whether a band would overwrite pixels that passes read around the next one.
bool overwritesSurface(const ShaderState& state) {
    for (const PelImageSlot read : {PEL_SLOT_MATERIAL, PEL_SLOT_POSITION, PEL_SLOT_DEPTH,
                                    PEL_SLOT_NORMAL_GEOMETRIC, PEL_SLOT_NORMAL_SHADING})
        for (int slot = 0; slot < PEL_SLOT_COUNT; ++slot)
            if ((slot == PEL_SLOT_RADIANCE || isOutput(slot)) && state.images[slot] && state.images[read] &&
                sharesBytes(state.images[slot], state.images[read]))
                return true;
    return false;
}

// How many rows of tiles fit into the budget.
void chooseBand(ShaderPlan& plan, const PassScratch& scratch, uint32_t mostRows) {
    const ImageView& frame = plan.state.images[PEL_SLOT_RADIANCE];
    plan.scratch = scratch.pixelBytes > 0;
    plan.haloRows = scratch.haloRows;
    plan.wholeFrame = scratch.wholeFrame || (plan.scratch && overwritesSurface(plan.state));
    // A pass over the whole frame writes all rows of its images, whatever band the others work on.
    plan.bandRows =
        std::max(1u, plan.scratch && !plan.wholeFrame ? std::min(plan.tileRows, mostRows) : plan.tileRows);
    const uint64_t budget = plan.state.options.scratchBudget,
                   rowBytes = uint64_t(frame.width) * scratch.pixelBytes;
    const auto bytes = [&] { return plan.scratchRows() * rowBytes + scratch.guardBytes; };
    if (!budget || bytes() <= budget) return;
    const uint64_t halo = 2 * plan.haloRows,
                   fit = (budget - std::min(budget, scratch.guardBytes)) / rowBytes / PEL_TILE_HEIGHT;
    if (!plan.wholeFrame)
        plan.bandRows = uint32_t(std::clamp<uint64_t>(fit, halo + 1, plan.bandRows + halo) - halo);
    if (bytes() > budget)
        fail(PEL_ERROR_OUT_OF_MEMORY, "PelShaderOptions.scratchBudget is ", budget, " bytes; a frame of ",
             frame.width, " x ", frame.height, " with these passes needs at least ", bytes(), ", for ",
             plan.scratchRows(), " rows of pixels");
}

}  // namespace

uint32_t ShaderPlan::scratchRows() const {
    const uint32_t height = state.images[PEL_SLOT_RADIANCE].height;
    return uint32_t(std::min<uint64_t>(height, (uint64_t(bandRows) + 2 * haloRows) * PEL_TILE_HEIGHT));
}

uint32_t ShaderPlan::listRows() const {
    return std::min(tileRows, bandRows + 2 * haloRows);
}

// Makes the needed passes and drops the others.
PassScratch PassList::choose(const ShaderPlan& plan) {
    PassScratch scratch;
    for (size_t i = 0; i < kinds_.size(); ++i) {
        if (!kinds_[i].needed(plan)) {
            passes_[i].reset();
            continue;
        }
        if (!passes_[i]) passes_[i] = kinds_[i].make();
        const PassScratch one = passes_[i]->scratch(plan);
        scratch.pixelBytes += one.pixelBytes;
        scratch.guardBytes += one.guardBytes;
        scratch.haloRows = std::max(scratch.haloRows, one.haloRows);
        scratch.wholeFrame |= one.wholeFrame;
    }
    return scratch;
}

uint64_t PassList::bytesOfWholeFrame(const ShaderPlan& plan) {
    const PassScratch scratch = choose(plan);
    const ImageView& frame = plan.state.images[PEL_SLOT_RADIANCE];
    return scratch.wholeFrame ? uint64_t(frame.width) * frame.height * scratch.pixelBytes + scratch.guardBytes
                              : 0;
}

void PassList::allocate(const Ref<Device>& device, ShaderPlan& plan, uint32_t mostRows) {
    chooseBand(plan, choose(plan), mostRows);
    for (;;) {
        try {
            return each([&](Pass& pass) { pass.allocate(device, plan); });
        } catch (const Error& e) {  // a smaller band may still fit
            if (e.code() != PEL_ERROR_OUT_OF_MEMORY || !plan.scratch || plan.wholeFrame || plan.bandRows == 1)
                throw;
            plan.bandRows = (plan.bandRows + 1) / 2;
        }
    }
}

size_t PassList::bytes() const {
    size_t bytes = 0;
    each([&](const Pass& pass) { bytes += pass.bytes(); });
    return bytes;
}

}  // namespace pel
