#include "api/entry.h"
#include "core/submission.h"
#include "shading/screen_curvature.h"

using namespace pel;

PelError pelScreenCurvature(PelDevice device, const PelScreenCurvatureParams* params,
                            const PelImageDesc* normals, const PelImageDesc* positions,
                            const PelImageDesc* depth, const PelImageDesc* ids, const PelImageDesc* curvature,
                            const PelSubmit* submit) {
    return entry([&] {
        const Ref<Device> on = fromHandle<Device>(device);
        const auto defaults = pelScreenCurvatureParamsDefaults();
        const auto full = params ? readStruct(params, defaults, "PelScreenCurvatureParams") : defaults;
        const auto view = [&](const PelImageDesc* desc, const char* name, bool needed) {
            if (desc) return makeImageView(desc, *on, name);
            if (needed) invalidArgument("`", name, "` is needed, not NULL");
            return ImageView();
        };
        const ScreenCurvatureImages images{view(normals, "normals", true),
                                           view(positions, "positions", false), view(depth, "depth", false),
                                           view(ids, "ids", false), view(curvature, "curvature", true)};
        checkScreenCurvature(full, images);
        Submission submission(*on, submit);
        screenCurvature(*on, full, images);
        submission.finish();
    });
}
