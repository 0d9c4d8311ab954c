#include "diffusion/scatter.h"

#include "api/entry.h"
#include "core/submission.h"
#include "shading/image_slots.h"

using namespace pel;

PelError pelScatterCreate(PelDevice device, PelScatter* scatter) {
    return entry(
        [&] { handOut(scatter, "scatter", [&] { return make<Scatter>(fromHandle<Device>(device)); }); });
}

void pelScatterRetain(PelScatter scatter) {
    retainEntry<Scatter>(scatter);
}
void pelScatterRelease(PelScatter scatter) {
    releaseEntry<Scatter>(scatter);
}

PelError pelScatterSetMaterial(PelScatter scatter, uint32_t id, PelProfile profile, float scale) {
    return entry([&] {
        const Ref<Scatter> object = fromHandle<Scatter>(scatter);
        object->setMaterial(id, profile ? fromHandle<Profile>(profile) : Ref<Profile>(), scale);
    });
}

PelError pelScatterSetControls(PelScatter scatter, uint32_t id, const PelScatterControls* controls) {
    return entry([&] {
        const Ref<Scatter> object = fromHandle<Scatter>(scatter);
        const auto defaults = pelScatterControlsDefaults();
        object->setControls(id, controls ? readStruct(controls, defaults, "PelScatterControls") : defaults);
    });
}

PelError pelScatterSetImage(PelScatter scatter, PelImageSlot slot, const PelImageDesc* image) {
    return entry([&] {
        const Ref<Scatter> object = fromHandle<Scatter>(scatter);
        ImageView view;
        if (image)
            view = makeImageView(image, object->device(),
                                 uint32_t(slot) < PEL_SLOT_COUNT ? slotName(slot) : "further");
        object->setImage(slot, view);
    });
}

PelError pelScatterExecute(PelScatter scatter, const PelScatterParams* params, const PelImageDesc* irradiance,
                           const PelImageDesc* positions, const PelImageDesc* depth, const PelImageDesc* ids,
                           const PelImageDesc* out, const PelSubmit* submit) {
    return entry([&] {
        const Ref<Scatter> object = fromHandle<Scatter>(scatter);
        const auto defaults = pelScatterParamsDefaults();
        const auto full = params ? readStruct(params, defaults, "PelScatterParams") : defaults;
        const auto view = [&](const PelImageDesc* desc, const char* name, bool needed) {
            if (desc) return makeImageView(desc, object->device(), name);
            if (needed) invalidArgument("`", name, "` is needed, not NULL");
            return ImageView();
        };
        const ScatterImages images{view(irradiance, "irradiance", true), view(positions, "positions", false),
                                   view(depth, "depth", false), view(ids, "ids", false),
                                   view(out, "out", true)};
        Submission submission(object->device(), submit);
        object->execute(full, images);
        submission.finish();
    });
}

PelError pelScatterGetStats(PelScatter scatter, PelScatterStats* stats) {
    return entry([&] { writeStruct(stats, fromHandle<Scatter>(scatter)->stats(), "PelScatterStats"); });
}
