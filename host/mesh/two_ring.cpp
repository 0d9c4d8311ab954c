#include "mesh/two_ring.h"

#include <algorithm>

#include "cl/error.h"
#include "mesh/mesh_passes.h"

namespace pel {
namespace {

// The first row of each slice, from the numbers of points of its slots.
std::vector<uint32_t> startsOf(const std::vector<uint32_t>& counts) {
    std::vector<uint32_t> starts{0};
    for (auto slice = counts.begin(); slice != counts.end(); slice += PEL_POINT_LANES) {
        const uint32_t rows = *std::max_element(slice, slice + PEL_POINT_LANES);
        if (starts.back() > UINT32_MAX - rows)
            fail(PEL_ERROR_UNSUPPORTED, "the two-rings of this mesh exceed ", UINT32_MAX, " rows: split it");
        starts.push_back(starts.back() + rows);
    }
    return starts;
}

}  // namespace

const MeshTopology::TwoRings& twoRings(MeshTopology& topology, const cl::Program& program) {
    MeshTopology::TwoRings& made = topology.twoRings;
    if (made.points) return made;
    Device& device = topology.device();
    const size_t padded =
        (size_t(topology.slots()) + PEL_POINT_LANES - 1) / PEL_POINT_LANES * PEL_POINT_LANES;
    std::vector<uint32_t> counts(padded);
    const cl::Queue queue = device.anotherQueue();
    const cl::Memory links = device.allocate(std::max<size_t>(topology.ringEntries(), 1) * sizeof(uint32_t)),
                     rounds = device.allocate(padded * sizeof(uint32_t)),
                     counted = device.allocate(padded * sizeof(uint32_t));
    const auto run = [&](uint32_t stage, const cl::Memory& starts, const cl::Memory& points) {
        cl::Launch launch(program, "two_ring");
        launch.arg(stage).arg(topology.slots()).arg(topology.slices()).arg(topology.rings());
        launch.arg(links).arg(rounds).arg(counted).arg(starts).arg(points);
        device.launch(launch, over(padded), queue.get());
    };
    run(PEL_TWO_RING_LINK, {}, {});
    run(PEL_TWO_RING_COUNT, {}, {});
    cl::check(clFinish(queue.get()), "clFinish");
    device.readAside(counted.get(), counts.size() * sizeof(uint32_t), counts.data());
    const std::vector<uint32_t> starts = startsOf(counts);
    const size_t entries = std::max<size_t>(size_t(starts.back()) * PEL_POINT_LANES, 1);
    const cl::Memory begin = device.allocate(starts.size() * sizeof(uint32_t)),
                     points = device.allocate(entries * sizeof(uint32_t));
    device.writeAside(begin.get(), starts.size() * sizeof(uint32_t), starts.data());
    run(PEL_TWO_RING_LIST, begin, points);
    cl::check(clFinish(queue.get()), "clFinish");
    made = {begin, points, rounds};
    return made;
}

}  // namespace pel
