#include "shading/screen_curvature.h"

#include "core/launch_policy.h"
#include "shading/check_settings.h"
#include "shading/launch_ranges.h"
#include "shading/shading_constants.h"
#include "shared/screen.h"

namespace pel {
void checkScreenCurvature(const PelScreenCurvatureParams& params, const ScreenCurvatureImages& images) {
    if (!std::isfinite(params.scale) || params.scale < 0)
        invalidArgument("PelScreenCurvatureParams.scale is ", params.scale,
                        "; a finite number of at least 0 is needed");
    if (!(params.edge > 0 && params.edge <= 1))
        invalidArgument("PelScreenCurvatureParams.edge is ", params.edge,
                        "; the sine of an angle above 0 and up to 1 is needed, typical is 0.5");
    if (bool(images.positions) == bool(images.depth))
        invalidArgument("either `positions` or `depth` is needed, ",
                        images.depth ? "not both" : "and both are NULL");
    for (float m : params.inverseViewProjection)
        if (images.depth && !std::isfinite(m))
            invalidArgument("PelScreenCurvatureParams.inverseViewProjection holds ", m,
                            "; it must be finite");
    if (images.depth) checkInvertible("PelScreenCurvatureParams", params.inverseViewProjection);
    if (images.curvature.format != PEL_FORMAT_R32F)
        invalidArgument("the curvature image has format ", images.curvature.info().name, "; it needs R32F");
    const std::pair<PelImageSlot, const ImageView*> inputs[] = {{PEL_SLOT_NORMAL_SHADING, &images.normals},
                                                                {PEL_SLOT_POSITION, &images.positions},
                                                                {PEL_SLOT_DEPTH, &images.depth},
                                                                {PEL_SLOT_MATERIAL, &images.ids}};
    for (const auto& [slot, view] : inputs) {
        if (!*view) continue;
        checkImage(slot, *view);
        checkSize(slotName(slot), *view, "curvature image", images.curvature);
        // A pixel reads its neighbours, so not even the same pixel may be overwritten.
        if (sharesBytes(images.curvature, *view))
            invalidArgument("the curvature image overlaps the ", slotName(slot), " image, which is read");
    }
}

void screenCurvature(Device& device, const PelScreenCurvatureParams& params,
                     const ScreenCurvatureImages& images) {
    const uint32_t lanes = device.info().mathWidth;
    const ImageView& where = images.positions ? images.positions : images.depth;
    ScreenCurvatureFrame frame{};
    frame.width = images.curvature.width;
    frame.height = images.curvature.height;
    frame.scale = params.scale;
    frame.edge = params.edge;
    std::copy_n(params.inverseViewProjection, 16, frame.inverseViewProjection);
    frame.normal = describeImage(images.normals);
    frame.position = describeImage(where);
    frame.ids = describeImage(images.ids);
    frame.curvature = describeImage(images.curvature);
    // Copied now: the queue may be busy and is not used for this.
    const cl::Memory memory = device.allocate(sizeof frame, &frame);
    cl::Launch launch(device.programs().get("shading/screen_curvature.cl",
                                            {{"PEL_FORMAT_NORMAL", formatCode(images.normals, lanes)},
                                             {"PEL_FORMAT_POSITION", formatCode(images.positions, lanes)},
                                             {"PEL_FORMAT_DEPTH", formatCode(images.depth, lanes)},
                                             {"PEL_FORMAT_IDS", formatCode(images.ids, lanes)},
                                             {"PEL_FORMAT_CURVATURE", formatCode(images.curvature, lanes)}}),
                      "screen_curvature", memory, images.normals, where, images.ids, images.curvature);
    device.launch(launch, vectorRange(device, frame.width, frame.height));
}

}  // namespace pel
