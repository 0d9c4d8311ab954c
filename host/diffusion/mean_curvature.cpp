#include "diffusion/mean_curvature.h"

#include "core/launch_policy.h"
#include "shading/launch_ranges.h"
#include "shading/shading_constants.h"

namespace pel {

cl::ProgramKey MeanCurvature::program(const Device& device) const {
    const auto code = [&](const ImageView& view) { return formatCode(view, device.info().mathWidth); };
    return {{"diffusion/mean_curvature.cl"},
            {{"PEL_FORMAT_NORMAL", code(images_.normals)},
             {"PEL_FORMAT_POSITION", code(images_.positions)},
             {"PEL_FORMAT_DEPTH", code(images_.depth)},
             {"PEL_FORMAT_MATERIAL", code(images_.ids)},
             {"PEL_FORMAT_OUT", code(images_.out)}}};
}

size_t MeanCurvature::send(Device& device, uint32_t height, const float (&inverseViewProjection)[16],
                           const std::map<uint32_t, float>& windows) {
    PelMeanCurvature frame{};
    frame.width = images_.out.width, frame.height = height;
    std::copy_n(inverseViewProjection, 16, frame.inverseViewProjection);
    frame.normal = describeImage(images_.normals);
    frame.position = describeImage(images_.positions ? images_.positions : images_.depth);
    frame.ids = describeImage(images_.ids);
    frame.out = describeImage(images_.out);
    for (const auto& [id, window] : windows) frame.window[id] = window;
    constants_.update(device, frame);
    return sizeof frame;
}

void MeanCurvature::enqueue(Device& device, const cl::Program& program, std::vector<cl::Event>& events,
                            uint32_t row, uint32_t rows, uint32_t outRow) const {
    device.launch(events, program, "mean_curvature", vectorRange(device, images_.out.width, rows), constants_,
                  images_.normals, images_.positions ? images_.positions : images_.depth, images_.ids,
                  images_.out, cl_uint(row), cl_uint(rows), cl_uint(outRow));
}

}  // namespace pel
