#include "diffusion/scatter.h"

#include "core/image_substitutes.h"
#include "diffusion/scatter_material.h"
#include "shading/capture.h"
#include "shading/check_settings.h"
#include "shading/material.h"

namespace pel {
namespace {

constexpr PelImageSlot keptSlots[] = {PEL_SLOT_SCATTER_WEIGHT, PEL_SLOT_ALBEDO, PEL_SLOT_IRRADIANCE_BACK,
                                      PEL_SLOT_NORMAL_GEOMETRIC, PEL_SLOT_MEAN_CURVATURE};

void checkParams(const PelScatterParams& params) {
    if (!(params.targetError >= 0) || !std::isfinite(params.targetError))
        invalidArgument("PelScatterParams.targetError is ", params.targetError,
                        "; a finite number of at least 0 is needed, typical is 0.002");
    if (!(params.white > 0) || !std::isfinite(params.white))
        invalidArgument("PelScatterParams.white is ", params.white,
                        "; a finite irradiance above 0 is needed");
    checkFinite("PelScatterParams", "inverseViewProjection", params.inverseViewProjection, 16);
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
        checkSize(name, *view, "output", images.out);
        // The irradiance may be overwritten pixel on pixel.
        const bool same = view->format == images.out.format && view->byteOffset == images.out.byteOffset &&
                          !overlapsElsewhere(images.out, *view);
        if (sharesBytes(images.out, *view) && !(slot == PEL_SLOT_ALBEDO && same))
            invalidArgument("the output overlaps the ", name, " image, which is read",
                            slot == PEL_SLOT_ALBEDO
                                ? "; only the same pixels in the same format may be written over"
                                : "");
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
    controls_[id] = c;
}

void Scatter::setImage(PelImageSlot slot, const ImageView& view) {
    if (std::ranges::find(keptSlots, slot) == std::end(keptSlots))
        invalidArgument(
            "image slot ", int(slot),
            " is not a slot of a PelScatter; these are scatter weight, back irradiance, albedo, geometric "
            "normals and mean curvature");
    if (view) checkImage(slot, view);
    images_[slot] = view;
}

// The methods of the materials, and the steps before and after them.
Scatter::Plan Scatter::planOf(const PelScatterParams& params, const ScatterImages& images) const {
    Plan plan;
    plan.weight = image(PEL_SLOT_SCATTER_WEIGHT);
    const ImageView albedo = image(PEL_SLOT_ALBEDO), back = image(PEL_SLOT_IRRADIANCE_BACK);
    plan.finishes = params.accumulate || albedo;
    plan.other.after = albedo ? 1.0f : 0.0f;
    plan.curvature = image(PEL_SLOT_MEAN_CURVATURE);
    const bool curved = plan.curvature || image(PEL_SLOT_NORMAL_GEOMETRIC);
    for (const auto& [id, material] : materials_) {
        ScreenScatter::Material curving = material;
        for (int k = 0; curved && k < 3; ++k) {
            const double path = meanFreePath(*material.profile, k) * material.scale;
            curving.gain[size_t(k)] = float(path);
            if (path > 0) plan.windows[id] = std::max(plan.windows[id], float(windowOfPath * path));
        }
        const PelScatterControls c = controlsOf(id);
        plan.sources.set(id);
        const bool lines = c.scattering == PEL_SCATTERING_SEPARABLE;
        // Sums over blocks do not support borders.
        const bool perPixel = c.borderColor[0] > 0 || c.borderColor[1] > 0 || c.borderColor[2] > 0;
        const uint32_t wanted = c.scatterTaps || lines || !perPixel ? c.scatterTaps : diskTapsForBlocks;
        const bool taps = lines || wanted > 0;
        if (taps)
            (lines ? plan.lines : plan.disk)[id] = {material.profile, material.scale,
                                                    scatterTapsOf(c.scattering, wanted),
                                                    std::to_array(c.borderColor)};
        else
            plan.screen[id] = curving;
        if (c.thinThickness > 0 && !back)
            invalidArgument("material ", id, " has a thinThickness of ", c.thinThickness,
                            ", but there is no back irradiance image for the light that comes through");
        if (c.albedoBefore > 0 && !albedo)
            invalidArgument("material ", id, " has an albedoBefore of ", c.albedoBefore,
                            ", but there is no albedo image");
        PelBlendMaterial blend{};
        blend.before = c.albedoBefore;
        blend.after = albedo ? 1 - c.albedoBefore : 0.0f;
        std::ranges::copy(throughSheet(*material.profile, material.scale, c.thinThickness), blend.through);
        blend.weighs = !taps && plan.weight;
        std::ranges::copy(curving.gain, blend.gain);
        describeGain(*material.profile, blend.gainSlope, blend.gainSaturation);
        plan.blend[id] = blend;
        plan.prepares |= c.albedoBefore > 0 || c.thinThickness > 0;
        plan.finishes |= blend.weighs != 0 || curving.gain[0] > 0;
    }
    plan.measures = !plan.curvature && !plan.windows.empty();
    if (plan.windows.empty()) plan.curvature = {};
    for (PelImageSlot slot : keptSlots) {
        const ImageView view = image(slot);
        if (!view) continue;
        checkSize(slotName(slot), view, "output", images.out);
        if (sharesBytes(images.out, view))
            invalidArgument("the output overlaps the ", slotName(slot), " image, which is read");
    }
    if (params.accumulate && sharesBytes(images.out, images.irradiance))
        invalidArgument(
            "PelScatterParams.accumulate is set, so the output must not be the irradiance image, "
            "which is read while the result is added");
    return plan;
}

ImageView Scatter::image(PelImageSlot slot) const {
    const auto found = images_.find(slot);
    return found == images_.end() ? ImageView() : found->second;
}

// A scratch image.
ImageView Scatter::scratch(size_t index, const ImageView& like) {
    resize(scratch_[index], device_, size_t(like.width) * like.height * 3 * sizeof(float));
    return scratchImage(scratch_[index], like, PEL_FORMAT_PLANAR_RGB32F);
}

void Scatter::execute(const PelScatterParams& params, const ScatterImages& images) {
    std::vector<ImageView> read{images.irradiance, images.positions, images.depth, images.ids, images.out};
    for (const auto& [slot, view] : images_) read.push_back(view);
    copyTextures(read, false);
    run(params, images, nullptr);
    copyTextures({images.out}, true);
}

// The input as images and materials of a shader.
void Scatter::capture(const PelScatterParams& params, const ScatterImages& images) {
    const char* const folder = captureFolder(captureAsked_);
    if (!folder) return;
    ShaderState state;
    for (const auto& [slot, view] : images_) state.images[slot] = view;
    state.images[PEL_SLOT_IRRADIANCE] = images.irradiance;
    state.images[PEL_SLOT_POSITION] = images.positions;
    state.images[PEL_SLOT_DEPTH] = images.depth;
    state.images[PEL_SLOT_MATERIAL] = images.ids;
    if (params.accumulate) state.images[PEL_SLOT_RADIANCE] = images.out;
    std::copy_n(params.inverseViewProjection, 16, state.camera.inverseViewProjection);
    ScatterInput scatter{params, {}};
    for (const auto& [id, material] : materials_) {
        ShaderMaterial& to = state.materials[id];
        to.given = pelMaterialDefaults();
        to.profile = material.profile;
        scatter.scales[id] = float(material.scale);
        const PelScatterControls c = controlsOf(id);
        to.given.scattering = c.scattering;
        to.given.scatterTaps = c.scatterTaps;
        to.given.albedoBefore = c.albedoBefore;
        std::ranges::copy(c.borderColor, to.given.borderColor);
        to.given.thinThickness = c.thinThickness;
    }
    captureFrame(*device_, state, folder, &scatter);
}

PelScatterControls Scatter::controlsOf(uint32_t id) const {
    const auto found = controls_.find(id);
    return found == controls_.end() ? pelScatterControlsDefaults() : found->second;
}

void Scatter::run(const PelScatterParams& params, const ScatterImages& images,
                  std::vector<cl::ProgramKey>* keys) {
    checkParams(params);
    checkImages(images);
    if (images.depth) checkInvertible("PelScatterParams", params.inverseViewProjection);
    const Plan plan = planOf(params, images);
    if (!keys) capture(params, images);
    constexpr static float unknown[3] = {};
    const ScatterView view{params.inverseViewProjection, unknown, params.targetError * params.white,
                           params.everywhere != 0};
    events_.clear();
    counts_ = {};
    pixels_ = images.out.width * images.out.height;
    executed_ = true;
    // Runs a method on images, or collects the names of its programs.
    const auto step = [&](auto& method, const auto& on, const auto& work) {
        if (!keys) return work();
        for (cl::ProgramKey& key : method.programs(on)) keys->push_back(std::move(key));
    };
    ScatterImages now = images;
    now.takeRadii(plan.weight);
    ImageView curvature = plan.curvature;
    if (plan.measures) {
        resize(measured_, device_, size_t(images.out.width) * images.out.height * sizeof(float));
        curvature = scratchImage(measured_, images.out, PEL_FORMAT_R32F);
        curvature_.setImages(
            {image(PEL_SLOT_NORMAL_GEOMETRIC), images.positions, images.depth, images.ids, curvature});
        const cl::ProgramKey key = curvature_.program(*device_);
        if (keys) {
            keys->push_back(key);
        } else {
            curvature_.send(*device_, images.out.height, params.inverseViewProjection, plan.windows);
            curvature_.enqueue(*device_, device_->programs().get(key), events_, 0, images.out.height, 0);
        }
    }
    if (!plan.screen.empty()) now.curvature = curvature;
    if (plan.prepares) {
        const BlendImages blend{images.irradiance,
                                {},
                                images.ids,
                                image(PEL_SLOT_IRRADIANCE_BACK),
                                {},
                                image(PEL_SLOT_ALBEDO),
                                scratch(0, images.out)};
        step(before_, blend, [&] {
            before_.prepare(plan.blend, plan.other, blend, false);
            before_.enqueuePreparation(blend, events_);
        });
        now.irradiance = blend.out;
    }
    const ImageView arriving = now.irradiance;
    // Each method reads the result of the one before; the last one writes the output.
    int left = int(!plan.disk.empty()) + int(!plan.lines.empty()) + int(!plan.screen.empty());
    size_t next = 1;
    const auto target = [&] {
        now.out = --left == 0 && !plan.finishes ? images.out : scratch(next, images.out);
        next = 3 - next;
    };
    const auto gather = [&](GatherScatter& method,
                            const std::map<uint32_t, GatherScatter::Material>& materials,
                            PelScattering scattering) {
        if (materials.empty()) return;
        target();
        const GatherImages all{now, plan.weight, params.halfRate != 0};
        step(method, all, [&] {
            method.prepare(materials, plan.sources, all, view, params.frameIndex);
            method.enqueue(all, events_);
        });
        counts_.push_back({scattering, [&method] { return method.counts(); }});
        now.irradiance = now.out;
    };
    gather(disk_, plan.disk, PEL_SCATTERING_SCREEN);
    gather(lines_, plan.lines, PEL_SCATTERING_SEPARABLE);
    if (!plan.screen.empty() || counts_.empty()) {  // also where nothing scatters: the picture is copied
        if (plan.screen.empty()) left = 1;
        target();
        step(screen_, now, [&] {
            screen_.prepare(plan.screen, now, view);
            screen_.enqueue(now, events_);
        });
        counts_.push_back({PEL_SCATTERING_SCREEN, [this] { return screen_.counts(); }});
        now.irradiance = now.out;
    }
    if (!plan.finishes) return;
    const BlendImages blend{arriving,    now.irradiance,         images.ids, {},
                            plan.weight, image(PEL_SLOT_ALBEDO), images.out, curvature};
    step(after_, blend, [&] {
        after_.prepare(plan.blend, plan.other, blend, params.accumulate != 0);
        after_.enqueueFinish(blend, events_);
    });
}

void Scatter::addBuildJobs(const PelScatterParams& params, const ScatterImages& images,
                           BuildJobs& jobs) const {
    const Ref<Scatter> copy = make<Scatter>(device_);
    copy->materials_ = materials_;
    copy->controls_ = controls_;
    copy->captureAsked_ = true;
    copy->images_ = images_;
    ScatterImages all = images;
    ImageSubstitutes substitutes;
    for (auto& [slot, view] : copy->images_) substitutes.add(view);
    for (ImageView* view : {&all.irradiance, &all.positions, &all.depth, &all.ids, &all.out})
        substitutes.add(*view);
    substitutes.place(device_);
    std::vector<cl::ProgramKey> keys;
    copy->run(params, all, &keys);
    addProgramJobs(device_, std::move(keys), jobs);
    jobs.push_back([copy, params, all] {
        copy->execute(params, all);
        copy->device_->finish();
    });
}

PelScatterStats Scatter::stats() {
    device_->finish();
    PelScatterStats stats = pelScatterStatsDefaults();
    stats.scratchBytes = screen_.bytes() + disk_.bytes() + lines_.bytes();
    for (const Ref<Buffer>& buffer : scratch_) stats.scratchBytes += buffer ? buffer->bytes() : 0;
    stats.scratchBytes += measured_ ? measured_->bytes() : 0;
    if (!executed_) return stats;
    stats.pixelsTotal = pixels_;
    for (const auto& [scattering, read] : counts_) {
        const ScatterCounts counts = read();
        stats.pixelsCovered += counts.pixelsCovered;
        stats.pixelsTapped += counts.pixelsTapped;
        stats.pixelsInvalid += counts.invalid;
        stats.tilesCovered += counts.tilesCovered;
        stats.tilesTapped += counts.tilesTapped;
        stats.tilesByScattering[scattering] += counts.tilesTapped;
        stats.taps += counts.taps;
    }
    stats.launches = uint32_t(events_.size());
    for (const cl::Event& event : events_) stats.deviceMilliseconds += eventMilliseconds(event);
    return stats;
}

}  // namespace pel
