#include "shading/ambient_cube.h"

#include <algorithm>

#include "shading/shader.h"

namespace pel {
namespace {

constexpr size_t group = 16;

uint32_t edgeOf(const ImageView& faces) {
    return std::min(faces.width, faces.height);
}

}  // namespace

void AmbientCube::prepare(Device& device, const ImageView& faces) {
    if (!faces) {
        program_ = cl::Program();
        nodes_ = cl::Memory();
        bytes_ = 0;
        return;
    }
    program_ = device.programs().get("shading/ambient_cube.cl", {{"PEL_GROUP", text(group)},
                                                         {"PEL_WIDTH", "1"},
                                                         {"PEL_FORMAT_CUBE", text(formatCode(faces, 1))}});
    const size_t across = edgeOf(faces) + size_t(2), bytes = 18 * across * across * sizeof(float);
    if (bytes == bytes_) return;
    bytes_ = 0;
    nodes_ = cl::Memory();
    nodes_ = device.allocate(bytes);
    bytes_ = bytes;
}

void AmbientCube::enqueue(Device& device, const ImageView& faces, std::vector<cl::Event>& events) const {
    if (!program_) return;
    const cl_uint size = edgeOf(faces);
    // From a face to the next, in bytes.
    const uint64_t step = faces.height > faces.width ? size * faces.rowStride : size * faces.pixelStride;
    cl::Launch launch(program_, "ambient_cube");
    launch.arg(faces.buffer->memory()).arg(cl_ulong(faces.byteOffset)).arg(cl_ulong(step)).arg(cl_ulong(faces.rowStride));
    launch.arg(cl_ulong(faces.planeStride)).arg(cl_uint(faces.pixelStride)).arg(size).arg(nodes_);
    events.push_back(device.launch(launch, {{size + size_t(2), 6 * (size + size_t(2)), 1}, {group, 1, 1}}));
}

}  // namespace pel
