#include "api/entry.h"
#include "api/scatter_images.h"
#include "core/submission.h"
#include "diffusion/surface_integral.h"
#include "diffusion/texture_scatter.h"
#include "shading/image_slots.h"
#include "shading/screen_curvature.h"

using namespace pel;

PelError pelScatterCreate(PelDevice device, PelScatter* scatter) {
    return create(scatter, "scatter", [&] { return make<Scatter>(fromHandle<Device>(device)); });
}

PEL_COUNTED(Scatter)

PelError pelScatterSetMaterial(PelScatter scatter, uint32_t id, PelProfile profile, float scale) {
    return entry([&] {
        const Ref<Scatter> object = fromHandle<Scatter>(scatter);
        object->setMaterial(id, profile ? fromHandle<Profile>(profile) : Ref<Profile>(), scale);
    });
}

PelError pelScatterSetControls(PelScatter scatter, uint32_t id, const PelScatterControls* controls) {
    return entry([&] {
        const Ref<Scatter> object = fromHandle<Scatter>(scatter);
        object->setControls(id, readStructOr(controls, pelScatterControlsDefaults()));
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
        const auto full = readStructOr(params, pelScatterParamsDefaults());
        const ScatterImages images = scatterImages(object->device(), irradiance, positions, depth, ids, out);
        submitted(object->device(), submit, [&](bool) { object->execute(full, images); });
    });
}

PelError pelScatterGetStats(PelScatter scatter, PelScatterStats* stats) {
    return entry([&] { writeStruct(stats, fromHandle<Scatter>(scatter)->stats()); });
}

PelError pelTextureScatterCreate(PelDevice device, const PelTextureScatterDesc* desc,
                                 PelTextureScatter* scatter) {
    return create(scatter, "scatter", [&] {
        return TextureScatter::create(fromHandle<Device>(device),
                                      readStruct(desc, pelTextureScatterDescDefaults()));
    });
}

PEL_COUNTED(TextureScatter)

PelError pelTextureScatterSetPositions(PelTextureScatter scatter, const PelVertexView* positions,
                                       const PelSubmit* submit) {
    return entry([&] {
        const Ref<TextureScatter> object = fromHandle<TextureScatter>(scatter);
        const VertexView view = checkedView(positions, "positions", object->device(), object->vertices(), 3,
                                            "the texture's mesh");
        submitted(object->device(), submit, [&](bool) { object->setPositions(view); });
    });
}

PelError pelTextureScatterDraw(PelTextureScatter scatter, const PelVertexView* values, uint32_t unit,
                               const PelImageDesc* out, const PelSubmit* submit) {
    return entry([&] {
        const Ref<TextureScatter> object = fromHandle<TextureScatter>(scatter);
        const VertexView view =
            checkedView(values, "values", object->device(), object->vertices(), 3, "the texture's mesh");
        const ImageView image = viewOf(out, object->device(), "out");
        submitted(object->device(), submit, [&](bool) { object->draw(view, unit != 0, image); });
    });
}

PelError pelTextureScatterExecute(PelTextureScatter scatter, const PelTextureScatterParams* params,
                                  const PelImageDesc* irradiance, const PelImageDesc* albedo,
                                  const PelImageDesc* out, const PelSubmit* submit) {
    return entry([&] {
        const Ref<TextureScatter> object = fromHandle<TextureScatter>(scatter);
        const auto full = readStructOr(params, pelTextureScatterParamsDefaults());
        const Ref<Profile> profile = full.profile ? fromHandle<Profile>(full.profile) : Profile::skin();
        const ImageView from = viewOf(irradiance, object->device(), "irradiance"),
                        colors = viewOf(albedo, object->device(), "albedo", false),
                        to = viewOf(out, object->device(), "out");
        submitted(object->device(), submit, [&](bool) { object->execute(full, profile, from, colors, to); });
    });
}

PelError pelTextureScatterGetStats(PelTextureScatter scatter, PelTextureScatterStats* stats) {
    return entry([&] { writeStruct(stats, fromHandle<TextureScatter>(scatter)->stats()); });
}

PelError pelSurfaceIntegral(PelDevice device, const PelSurfaceIntegralDesc* desc, const PelSubmit* submit) {
    return entry([&] {
        const Ref<Device> on = fromHandle<Device>(device);
        const auto full = readStruct(desc, pelSurfaceIntegralDescDefaults());
        checkSurfaceIntegral(full);
        const uint32_t count = full.points.count;
        const VertexView points = checkedView(&full.points, "points", *on, count, 3, "the call");
        const VertexView result = checkedView(&full.result, "result", *on, count, 3, "`points`");
        submitted(*on, submit, [&](bool blocking) { surfaceIntegral(*on, full, points, result, blocking); });
    });
}

PelError pelScreenCurvature(PelDevice device, const PelScreenCurvatureParams* params,
                            const PelImageDesc* normals, const PelImageDesc* positions,
                            const PelImageDesc* depth, const PelImageDesc* ids, const PelImageDesc* curvature,
                            const PelSubmit* submit) {
    return entry([&] {
        const Ref<Device> on = fromHandle<Device>(device);
        const auto full = readStructOr(params, pelScreenCurvatureParamsDefaults());
        const auto view = [&](const PelImageDesc* desc, const char* name, bool needed) {
            return viewOf(desc, *on, name, needed);
        };
        const ScreenCurvatureImages images{view(normals, "normals", true),
                                           view(positions, "positions", false), view(depth, "depth", false),
                                           view(ids, "ids", false), view(curvature, "curvature", true)};
        checkScreenCurvature(full, images);
        submitted(*on, submit, [&](bool) { screenCurvature(*on, full, images); });
    });
}
