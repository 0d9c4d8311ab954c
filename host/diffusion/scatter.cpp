#include "diffusion/scatter.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "shading/check_settings.h"
#include "shading/image_slots.h"

namespace pel {
namespace {

void checkParams(const PelScatterParams& params) {
    if (!(params.targetError >= 0) || !std::isfinite(params.targetError))
        invalidArgument("PelScatterParams.targetError is ", params.targetError,
                        "; a finite number of at least 0 is needed, typical is 0.002");
    if (!(params.white > 0) || !std::isfinite(params.white))
        invalidArgument("PelScatterParams.white is ", params.white, "; a finite irradiance above 0 is needed");
    checkFinite("PelScatterParams", "inverseViewProjection", params.inverseViewProjection, 16);
    if (params.accumulate)
        fail(PEL_ERROR_UNSUPPORTED,
             "PelScatterParams.accumulate is set, which this build of the library does not have");
}

void checkImages(const ScatterImages& images) {
    if (bool(images.positions) == bool(images.depth))
        invalidArgument("either `positions` or `depth` is needed, ",
                        images.depth ? "not both" : "and both are NULL");
    checkImage(PEL_SLOT_RADIANCE, images.out);
    const std::pair<PelImageSlot, const ImageView*> inputs[] = {{PEL_SLOT_ALBEDO, &images.irradiance},
                                                                {PEL_SLOT_POSITION, &images.positions},
                                                                {PEL_SLOT_DEPTH, &images.depth},
                                                                {PEL_SLOT_MATERIAL, &images.ids}};
    for (const auto& [slot, view] : inputs) {
        if (!*view) continue;
        checkImage(slot, *view);
        const char* name = slot == PEL_SLOT_ALBEDO ? "irradiance" : slotName(slot);
        if (view->width != images.out.width || view->height != images.out.height)
            invalidArgument("the ", name, " image is ", view->width, " x ", view->height, ", the output ",
                            images.out.width, " x ", images.out.height, "; all must have one size");
        // The irradiance may be written over pixel on pixel.
        const bool same = view->format == images.out.format && view->byteOffset == images.out.byteOffset &&
                          !overlapsElsewhere(images.out, *view);
        if (sharesBytes(images.out, *view) && !(slot == PEL_SLOT_ALBEDO && same))
            invalidArgument(
                "the output overlaps the ", name, " image, which is read",
                slot == PEL_SLOT_ALBEDO ? "; only the same pixels in the same format may be written over" : "");
    }
}

}  // namespace

void Scatter::setMaterial(uint32_t id, const Ref<Profile>& profile, float scale) {
    if (id < 1 || id >= PEL_DIFFUSION_IDS)
        invalidArgument("material ids are 1 to ", PEL_DIFFUSION_IDS - 1, ", not ", id);
    if (!profile) {
        materials_.erase(id);
        controls_.erase(id);
        return;
    }
    if (!(scale >= 0) || !std::isfinite(scale))
        invalidArgument(
            "the scale of material ", id, "'s profile is ", scale,
            "; a finite length of at least 0 is needed, in the unit of positions per unit of the profile");
    if (scale > 0) profileNodes(profile->shape(), scale);  // throws where the lengths are out of range
    if (scale > 0)
        materials_[id] = {profile, scale};
    else
        materials_.erase(id);  // nothing is scattered
}

void Scatter::setControls(uint32_t id, const PelScatterControls& c) {
    if (!materials_.contains(id))
        invalidArgument("material ", id, " is not set: pelScatterSetMaterial comes before its controls");
    if (c.scattering != PEL_SCATTERING_SCREEN && c.scattering != PEL_SCATTERING_SEPARABLE)
        invalidArgument("PelScatterControls.scattering is ", int(c.scattering),
                        "; it must be PEL_SCATTERING_SCREEN or PEL_SCATTERING_SEPARABLE");
    checkScatterControls("PelScatterControls", c.scatterTaps, c.albedoBefore, c.borderColor);
    if (!(c.thinThickness >= 0) || !std::isfinite(c.thinThickness))
        invalidArgument("PelScatterControls.thinThickness is ", c.thinThickness,
                        "; a finite length of at least 0 is needed");
    const PelScatterControls none = pelScatterControlsDefaults();
    if (std::memcmp(&c, &none, sizeof none))
        fail(PEL_ERROR_UNSUPPORTED,
             "PelScatterControls other than the defaults are set, which this build of the library does not "
             "have");
    controls_[id] = c;
}

void Scatter::setImage(PelImageSlot slot, const ImageView& view) {
    if (slot != PEL_SLOT_SCATTER_WEIGHT && slot != PEL_SLOT_IRRADIANCE_BACK && slot != PEL_SLOT_ALBEDO)
        invalidArgument(
            "image slot ", int(slot),
            " is none that a PelScatter keeps: scatter weight, back irradiance or albedo would be");
    if (view) checkImage(slot, view);
    if (view)
        fail(PEL_ERROR_UNSUPPORTED, "the ", slotName(slot),
             " image is set, which this build of the library does not have");
    images_[slot] = view;
}

void Scatter::execute(const PelScatterParams& params, const ScatterImages& images) {
    checkParams(params);
    checkImages(images);
    ScatterView view;
    std::copy_n(params.inverseViewProjection, 16, view.inverseViewProjection);
    view.tolerance = params.targetError * params.white;
    view.everywhere = params.everywhere != 0;
    screen_.prepare(materials_, images, view);
    events_.clear();
    screen_.enqueue(images, events_);
    pixels_ = images.out.width * images.out.height;
    executed_ = true;
}

PelScatterStats Scatter::stats() {
    device_->finish();
    PelScatterStats stats = pelScatterStatsDefaults();
    stats.scratchBytes = screen_.bytes();
    if (!executed_) return stats;
    const ScatterCounts counts = screen_.counts();
    stats.pixelsTotal = pixels_;
    stats.pixelsCovered = counts.pixelsCovered;
    stats.pixelsTapped = counts.pixelsTapped;
    stats.pixelsInvalid = counts.invalid;
    stats.tilesCovered = counts.tilesCovered;
    stats.tilesTapped = counts.tilesTapped;
    stats.taps = counts.taps;
    stats.launches = events_.size();
    for (const cl::Event& event : events_) stats.deviceMilliseconds += eventMilliseconds(event);
    return stats;
}

}  // namespace pel
