// The analysis of a mesh's indices, made once and kept on the device; and the scratch memory of the passes
// over it.
#pragma once
#include <cstring>
#include <functional>
#include <span>

#include "core/buffer.h"
#include "core/sized_memory.h"
#include "shared/mesh.h"

namespace pel {

// Throws if a count or an index is wrong.
void checkTopologyDesc(const PelMeshTopologyDesc& desc);

// The largest and the median smoothing rate of a mesh, 1/length^2; 0: not measured yet.
struct DiffusionRates {
    float most = 0, middle = 0;
};

class MeshTopology final : public Object {
  public:
    static constexpr Kind kind = Kind::meshTopology;
    // `progress` gets a fraction in [0, 1].
    static Ref<MeshTopology> create(Ref<Device> device, const PelMeshTopologyDesc& desc,
                                    PelMeshReport& report, const std::function<void(double)>& progress);

    // The whole analysis as bytes in this machine's order. load() checks all of it.
    std::vector<char> save() const;
    static Ref<MeshTopology> load(Ref<Device> device, const void* bytes, size_t size);

    Device& device() const { return *device_; }
    uint32_t vertices() const { return report_.vertices; }
    uint32_t slots() const { return report_.uniquePositions; }
    uint32_t triangles() const { return report_.triangles; }
    // Whether slots differ from the caller's vertices. slotOf, memberOffsets and members then map them to
    // each other.
    bool mapped() const { return bool(slotOf_); }
    const PelMeshReport& report() const { return report_; }

    // Device arrays; empty if they have no elements. Those of the mapping are empty unless mapped().
    const cl::Memory& indices() const { return indices_; }  // the caller's, three vertices per triangle
    const cl::Memory& slotOf() const { return slotOf_; }
    const cl::Memory& memberOffsets() const { return memberOffsets_; }
    const cl::Memory& members() const { return members_; }
    const cl::Memory& slices() const { return slices_; }
    const cl::Memory& rings() const { return rings_; }
    const cl::Memory& runs() const { return runs_; }  // also empty if there are few

    // Memory between the passes of one call, at least `bytes` long, kept for the next call. The queue is in
    // order, so calls may share it if each enqueues its passes together: hold lock() meanwhile.
    enum Scratch {
        scratchRows,
        scratchFrom,
        scratchTo,
        scratchReduce,
        scratchWeights,
        scratchRates,
        scratchFactors,
        scratchSum,
        scratchNormals,
        scratchCount
    };
    std::unique_lock<std::mutex> lock() { return std::unique_lock(mutex_); }
    const cl::Memory& scratch(Scratch which, size_t bytes) { return scratch_[which].grow(*device_, bytes); }

    // Entries of the rings, including fillers; and of the slices.
    size_t ringEntries() const { return ringEntries_; }
    size_t sliceEntries() const { return (size_t(slots()) + PEL_MESH_LANES - 1) / PEL_MESH_LANES + 1; }
    // As measured last, by weights. Guarded by lock().
    DiffusionRates diffusionRates[2];
    // Starts, points and rounds of the two-rings (shared/mesh.h), made or queued; empty: not yet. Guarded
    // by lock().
    struct TwoRings {
        cl::Memory starts, points, rounds;
    } twoRings;

    explicit MeshTopology(Ref<Device> device) : Object(kind), device_(std::move(device)) {}

  private:
    ~MeshTopology() override = default;
    using Words = std::span<const uint32_t>;
    cl::Memory upload(Words values);
    void uploadLists(Words slotOf, Words memberOffsets, Words members, Words slices, Words rings);

    Ref<Device> device_;
    PelMeshReport report_ = pelMeshReportDefaults();
    size_t ringEntries_ = 0;
    cl::Memory indices_, slotOf_, memberOffsets_, members_, slices_, rings_, runs_;
    std::mutex mutex_;
    SizedMemory scratch_[scratchCount];
};

// Three floats per vertex in the caller's memory, `stride` bytes apart; 0: tightly packed.
class VertexFloats {
  public:
    VertexFloats(const float* begin, uint32_t stride)
        : begin(reinterpret_cast<const char*>(begin)), stride_(stride ? stride : 3 * sizeof(float)) {}
    std::array<float, 3> operator[](uint32_t vertex) const {
        std::array<float, 3> v;
        std::memcpy(v.data(), begin + vertex * stride_, sizeof v);
        return v;
    }
    const char* const begin;

  private:
    size_t stride_;
};

// Welding: which of the caller's vertices are at one place, and become one vertex of the topology.
struct MeshWeld {
    std::vector<uint32_t> slotOf;  // per vertex; empty when slots are the vertices in their order
    // Vertices of each slot, ascending; empty in the same case.
    std::vector<uint32_t> memberOffsets;  // slots + 1
    std::vector<uint32_t> members;        // vertices
    uint32_t slots = 0;
};

// Gives slot s the number numbers[s].
void renumberSlots(MeshWeld& weld, std::vector<uint32_t> numbers);

// Exact: equal coordinates (-0 equals 0). Tolerance: a vertex joins the first earlier vertex within the
// tolerance that did not itself join another; chains do not grow. NaN and Inf join nothing. `progress` gets a
// fraction in [0, 1] and may throw.
MeshWeld weldVertices(const PelMeshTopologyDesc& desc, const std::function<void(double)>& progress);

// desc's indices, with triangles reversed as pelMeshOrient says. `normals`: xyz per vertex, normalStride
// bytes apart, or NULL.
std::vector<uint32_t> orientTriangles(const PelMeshTopologyDesc& desc, const float* normals,
                                      uint32_t normalStride, PelMeshOrientation& found);

}  // namespace pel
