#include "mesh/mesh_passes.h"

#include <cmath>

namespace pel {
namespace {

// Mathematics, section 5: triangles below this share of the mesh's largest edge or UV edge are skipped.
constexpr float smallestPart = 1e-6f;

}  // namespace

float meshUvScale(MeshTopology& topology, const VertexView& positions, const VertexView& uvs) {
    if (topology.triangles() == 0) invalidArgument("the UV scale of a mesh without triangles was asked for");
    Device& device = topology.device();
    const cl::Range range{{PEL_UV_SCALE_ITEMS, 1, 1}, {PEL_MESH_GROUP, 1, 1}};
    const cl::Program program = device.programs().get("mesh/uv_scale.cl", {});
    const auto lock = topology.lock();
    const cl::Memory& memory =
        topology.scratch(MeshTopology::scratchReduce, PEL_UV_SCALE_ITEMS * sizeof(UvScaleShare));

    cl::Launch largest(program, "uv_scale_largest", topology.triangles(), topology.indices(), positions, uvs,
                       memory);
    device.launch(largest, range);
    std::vector<std::array<float, 2>> maxima(PEL_UV_SCALE_ITEMS);
    device.read(memory.get(), 0, maxima.size() * sizeof maxima[0], maxima.data(), true);
    float length2 = 0, uv2 = 0;
    for (const auto& m : maxima) {
        length2 = std::max(length2, m[0]);
        uv2 = std::max(uv2, m[1]);
    }
    if (!(length2 > 0 && uv2 > 0))
        invalidArgument("no triangle has both an extent and a UV extent: of ", topology.triangles(),
                        " triangles the longest edge is ", std::sqrt(length2), " and the longest UV edge ",
                        std::sqrt(uv2));

    cl::Launch sum(program, "uv_scale_sum", topology.triangles(), topology.indices(), positions, uvs,
                   length2 * smallestPart * smallestPart, uv2 * smallestPart * smallestPart, memory);
    device.launch(sum, range);
    std::vector<UvScaleShare> shares(PEL_UV_SCALE_ITEMS);
    device.read(memory.get(), 0, shares.size() * sizeof shares[0], shares.data(), true);
    double log2Sum = 0;
    uint64_t triangles = 0;
    for (const UvScaleShare& share : shares) {
        log2Sum += double(share.exponents) + double(share.mantissas);
        triangles += share.triangles;
    }
    if (triangles == 0)
        invalidArgument("no triangle has both an edge and a UV edge of at least ", smallestPart,
                        " of the mesh's largest");
    // The partial sums hold logarithms of squares.
    return float(std::exp2(0.5 * log2Sum / double(triangles)));
}

}  // namespace pel
