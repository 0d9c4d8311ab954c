#include "mesh/mesh_reach.h"

#include <algorithm>

namespace pel {
namespace {

std::vector<uint32_t> readBack(Device& device, const cl::Memory& memory) {
    if (!memory) return {};
    size_t bytes = 0;
    cl::check(clGetMemObjectInfo(memory.get(), CL_MEM_SIZE, sizeof bytes, &bytes, nullptr),
              "clGetMemObjectInfo");
    std::vector<uint32_t> values(bytes / sizeof(uint32_t));
    device.readAside(memory.get(), values.size() * sizeof(uint32_t), values.data());
    return values;
}

}  // namespace

MeshReacher::MeshReacher(const MeshTopology& topology)
    : slots_(topology.slots()),
      slices_(readBack(topology.device(), topology.slices())),
      rings_(readBack(topology.device(), topology.rings())),
      slotOf_(readBack(topology.device(), topology.slotOf())),
      slotMarks_(slots_),
      sliceMarks_((slots_ + PEL_MESH_LANES - 1) / PEL_MESH_LANES) {}

size_t MeshReacher::bytes() const {
    return (slices_.size() + rings_.size() + slotOf_.size() + slotMarks_.size() + sliceMarks_.size()) *
           sizeof(uint32_t);
}

MeshReach MeshReacher::reach(const std::vector<PelVertexRange>& changed, uint32_t farthest, uint32_t stored) {
    MeshReach result;
    std::vector<uint32_t> front, next, near;  // slots: of this distance, of the next one, all up to `stored`
    ++round_;
    for (const PelVertexRange& range : changed)
        for (uint32_t v = range.first; v - range.first < range.count; ++v) {
            const uint32_t slot = slotOf_.empty() ? v : slotOf_[v];
            if (take(slotMarks_, slot)) front.push_back(slot);
        }
    for (uint32_t distance = 0; distance <= farthest; ++distance) {
        const size_t begin = result.slices.size();
        for (uint32_t slot : front)
            if (take(sliceMarks_, slot / PEL_MESH_LANES)) result.slices.push_back(slot / PEL_MESH_LANES);
        // In memory order within a level.
        std::sort(result.slices.begin() + std::ptrdiff_t(begin), result.slices.end());
        if (result.slices.size() * 4 > sliceMarks_.size() * 3) {
            result.slices.resize(begin);
            break;
        }
        result.upTo.push_back(uint32_t(result.slices.size()));
        if (distance <= stored) near.insert(near.end(), front.begin(), front.end());
        if (distance == farthest) break;
        next.clear();
        for (uint32_t slot : front)
            for (uint32_t row = slices_[slot / PEL_MESH_LANES]; row < slices_[slot / PEL_MESH_LANES + 1];
                 ++row) {
                const uint32_t other =
                    rings_[size_t(row) * PEL_MESH_LANES + slot % PEL_MESH_LANES] & PEL_MESH_SLOT;
                if (take(slotMarks_, other)) next.push_back(other);
            }
        front.swap(next);
    }
    if (result.upTo.size() > stored) {
        std::vector<uint32_t>& place =
            sliceMarks_;  // of each slice in the list; marks are not from a later round
        for (uint32_t i = 0; i < result.upTo[stored]; ++i) place[result.slices[i]] = i;
        result.lanes.resize(result.upTo[stored]);
        for (uint32_t slot : near)
            result.lanes[place[slot / PEL_MESH_LANES]] |= 1u << (slot % PEL_MESH_LANES);
        result.storedSlots = near.size();
        std::fill(sliceMarks_.begin(), sliceMarks_.end(), 0);
    }
    return result;
}

}  // namespace pel
