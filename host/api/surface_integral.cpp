#include "diffusion/surface_integral.h"

#include "api/entry.h"
#include "core/submission.h"

using namespace pel;

PelError pelSurfaceIntegral(PelDevice device, const PelSurfaceIntegralDesc* desc, const PelSubmit* submit) {
    return entry([&] {
        const Ref<Device> on = fromHandle<Device>(device);
        const auto full = readStruct(desc, pelSurfaceIntegralDescDefaults(), "PelSurfaceIntegralDesc");
        checkSurfaceIntegral(full);
        const uint32_t count = full.points.count;
        const VertexView points = checkedView(&full.points, "points", *on, count, 3, "the call");
        const VertexView result = checkedView(&full.result, "result", *on, count, 3, "`points`");
        Submission submission(*on, submit);
        surfaceIntegral(*on, full, points, result, submission.blocking());
        submission.finish();
    });
}
