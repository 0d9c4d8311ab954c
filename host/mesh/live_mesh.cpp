// Which rows an update works on. Distances are in edges. A changed vertex reaches: its own gathered row
// (0); normals that are made, and smoothing weights (1; one more at creases, two more for area weights);
// estimates (`estimateReach_`); and one more for each smoothing pass, the first of which reaches as far as
// weights do. The estimates of all other rows are kept. Values between passes are not kept, so pass p of P
// also works on rows up to P - p edges further away, which later passes read. Work is done in whole slices of
// rows.
#include "mesh/live_mesh.h"

#include <algorithm>

namespace pel {
namespace {

bool sameRanges(const std::vector<PelVertexRange>& a, const std::vector<PelVertexRange>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const auto& x, const auto& y) { return x.first == y.first && x.count == y.count; });
}

bool sameView(const VertexView& a, const VertexView& b) {
    return a.memory.get() == b.memory.get() && a.layout.offset == b.layout.offset &&
           a.layout.stride == b.layout.stride;
}

}  // namespace

void checkRanges(const PelVertexRange* changed, uint32_t numChanged, uint32_t vertices) {
    for (uint32_t i = 0; changed && i < numChanged; ++i)
        if (changed[i].first > vertices || changed[i].count > vertices - changed[i].first)
            invalidArgument("range ", i, " of `changed` is ", changed[i].count, " vertices from ",
                            changed[i].first, " on; the mesh has ", vertices);
}

LiveMesh::LiveMesh(Ref<MeshTopology> topology, const PelCurvatureParams& params)
    : Object(kind), topology_(std::move(topology)), params_(params) {}

void LiveMesh::find(const std::vector<PelVertexRange>& changed) {
    if (listed_ && sameRanges(changed, changed_)) return;
    if (!reacher_) reacher_ = std::make_unique<MeshReacher>(*topology_);
    listed_ = false;
    reach_ = reacher_->reach(changed, storedReach_ + (passes_ > 0 ? passes_ - 1 : 0), storedReach_);
    changed_ = changed;
    // Copied now: the queue may be busy and is not used for this.
    const auto upload = [&](const std::vector<uint32_t>& values) {
        stats_.bytesUploaded += values.size() * sizeof(uint32_t);
        return topology_->device().upload(values);
    };
    list_ = upload(reach_.slices);
    lanes_ = upload(reach_.lanes);
    listed_ = true;
}

Rows LiveMesh::rowsUpTo(uint32_t distance, Rows::Work& work) const {
    if (!listed_ || distance >= reach_.upTo.size()) return {{}, 0, &work};
    return {list_, reach_.upTo[distance], &work};
}

void LiveMesh::update(const VertexView& positions, const VertexView& normals, const VertexView& curvature,
                      const PelVertexRange* changed, uint32_t numChanged, bool blocks) {
    MeshTopology& topology = *topology_;
    const std::unique_lock guard(mutex_);
    stats_.launches = stats_.rowsEstimated = stats_.rowsSmoothed = stats_.rowsStored = stats_.bytesUploaded =
        0;
    if (topology.vertices() == 0) return;
    std::vector<PelVertexRange> ranges;
    for (uint32_t i = 0; changed && i < numChanged; ++i)
        if (changed[i].count > 0) ranges.push_back(changed[i]);
    // A mesh without a rate had nothing to smooth, so none of its weights are kept.
    const bool unmeasured = params_.smoothingRadius > 0 && params_.smoothingStages == 0 && !(rates_.most > 0);
    const bool all = !changed || fresh_ || unmeasured || madeNormals_ != !normals.memory;
    const bool elsewhere = !sameView(curvature, target_);
    if (!all && !elsewhere && ranges.empty()) return;

    const auto lock = topology.lock();
    const uint32_t planes = planesOf(params_.quantity), planeStride = planeStrideOf(topology);
    const size_t planeBytes = planeStride * sizeof(float);
    fresh_ = true;  // until everything is enqueued
    madeNormals_ = !normals.memory;
    target_ = curvature;
    // Quadric: up to the three-ring. Otherwise the ring; normals that are made depend on the neighbours'
    // rings.
    estimateReach_ = params_.estimator == PEL_CURVATURE_QUADRIC ? 3 : madeNormals_ ? 2 : 1;

    const Scratch scratch = [&](MeshTopology::Scratch which, size_t bytes) -> const cl::Memory& {
        return scratch_[which].grow(topology.device(), bytes);
    };
    const cl::Memory estimated = estimated_.grow(topology.device(), planeBytes * planes);
    SlotPlanes values{std::min(planes, 2u), planeStride, estimated, {}, {}, {}};
    if (params_.smoothingPasses > 0 || params_.smoothingRadius > 0) {
        values.to = scratch(MeshTopology::scratchFrom, planeBytes * values.planes);
        values.spare = scratch(MeshTopology::scratchTo, planeBytes * values.planes);
    }
    Rows::Work other, estimates, smoothing, storing;
    if (all)
        listed_ = false;
    else
        find(ranges);  // passes_ and storedReach_ are known from the first update
    const SlotData data =
        gatherBySlot(topology, positions, normals, scratch, rowsUpTo(0, other), rowsUpTo(1, other));
    // A part is smoothed as the whole was, by which its other rows are kept.
    DiffusionRates& measured = topology.diffusionRates[params_.smoothingWeights];
    const Diffusion diffusion =
        planDiffusion(topology, data, params_, scratch, all ? measured : rates_, all && blocks);
    if (all) rates_ = measured;
    passes_ = params_.smoothingPasses + diffusion.passes();
    estimateCurvature(topology, params_, data, estimated, rowsUpTo(estimateReach_, estimates));
    const uint32_t weightReach = diffusion.passes() > 0 ? diffusion.weightReach(madeNormals_) : 0;
    storedReach_ =
        std::max(estimateReach_ + passes_, weightReach > 0 ? weightReach + diffusion.passes() - 1 : 0);
    // Another target holds nothing yet: smoothing and storing start again from the estimates.
    const uint32_t farthest = elsewhere ? UINT32_MAX / 2 : storedReach_;
    const auto rowsOfPass = [&](uint32_t pass) { return rowsUpTo(farthest + passes_ - 1 - pass, smoothing); };
    smoothUniform(topology, passDefines(topology, params_, data.stride), params_.smoothingPasses, values,
                  rowsOfPass);
    if (diffusion.passes() > 0)
        smoothToRadius(topology, data, diffusion, values, scratch, rowsUpTo(weightReach, other),
                       [&](uint32_t stage) { return rowsOfPass(params_.smoothingPasses + stage); });
    const Rows stored = rowsUpTo(farthest, storing);
    if (stored.list) {
        cl::Defines defines = passDefines(topology, params_, data.stride);
        defines["PEL_MESH_LISTED"] = "1";
        cl::Launch store(topology.device().programs().get("mesh/curvature.cl", defines),
                         "curvature_store_listed");
        rowArguments(topology, store, stored);
        store.args(lanes_, topology.memberOffsets(), topology.members(), planeStride, values.from, estimated,
                   params_.scale, curvature);
        launchRows(topology, store, stored, 1);
        storing.rows = reach_.storedSlots;
    } else {
        storeQuantity(topology, params_, data.stride, values.from, estimated, curvature, &storing);
    }
    stats_.launches = other.launches + estimates.launches + smoothing.launches + storing.launches;
    stats_.rowsEstimated = estimates.rows;
    stats_.rowsSmoothed = smoothing.rows;
    stats_.rowsStored = storing.rows;
    fresh_ = false;
}

PelLiveMeshStats LiveMesh::stats() {
    const std::unique_lock guard(mutex_);
    PelLiveMeshStats stats = stats_;
    stats.rowsTotal = topology_->slots();
    for (const SizedMemory& memory : scratch_) stats.deviceBytes += memory.bytes();
    stats.deviceBytes += estimated_.bytes() + (reach_.slices.size() + reach_.lanes.size()) * sizeof(uint32_t);
    stats.hostBytes = reacher_ ? reacher_->bytes() : 0;
    return stats;
}

static std::vector<uint32_t> readBack(Device& device, const cl::Memory& memory, size_t count) {
    if (!memory) return {};
    std::vector<uint32_t> values(count);
    device.readOnSideQueue(memory.get(), values.size() * sizeof(uint32_t), values.data());
    return values;
}

MeshReacher::MeshReacher(const MeshTopology& topology)
    : slots_(topology.slots()),
      slices_(readBack(topology.device(), topology.slices(), topology.sliceEntries())),
      rings_(readBack(topology.device(), topology.rings(), topology.ringEntries())),
      slotOf_(readBack(topology.device(), topology.slotOf(), topology.vertices())),
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
