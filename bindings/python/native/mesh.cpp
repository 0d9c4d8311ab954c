#include <string_view>

#include "native.h"

namespace pel::python {

static PelMeshTopologyDesc topologyDesc(uint32_t numVertices, uintptr_t indices, uint64_t numIndices,
                                        uint32_t weld, float tolerance, uintptr_t positions,
                                        uint32_t positionStride) {
    PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
    desc.numVertices = numVertices;
    desc.indices = static_cast<const uint32_t*>(pointer(indices));
    desc.numIndices = numIndices;
    desc.weld = PelWeld(weld);
    desc.weldTolerance = tolerance;
    desc.positions = static_cast<const float*>(pointer(positions));
    desc.positionStride = positionStride;
    return desc;
}

void bindMesh(py::module_& module) {
    using pellucid::MeshTopology, pellucid::LiveMesh;
    py::class_<MeshTopology, Owner<MeshTopology>>(module, "MeshTopology")
        .def_static(
            "create",
            [](const Device& d, uint32_t numVertices, uintptr_t indices, uint64_t numIndices, uint32_t weld,
               float tolerance, uintptr_t positions, uint32_t positionStride, const py::object& report) {
                const PelMeshTopologyDesc desc = topologyDesc(numVertices, indices, numIndices, weld,
                                                              tolerance, positions, positionStride);
                return wrapped<MeshTopology>([&, found = structOf<PelMeshReport>(report)](auto* handle) {
                    return pelMeshTopologyCreate(d.get(), &desc, handle, found);
                });
            })
        .def_static(
            "load",
            [](const Device& d, const py::bytes& bytes, const py::object& report) {
                const std::string_view data = bytes;
                return wrapped<MeshTopology>([&, found = structOf<PelMeshReport>(report)](auto* handle) {
                    return pelMeshTopologyLoad(d.get(), data.data(), data.size(), handle, found);
                });
            })
        .def("save",
             [](const MeshTopology& t) {
                 std::vector<char> bytes;
                 callThrowing([&] { bytes = t.save(); });
                 return py::bytes(bytes.data(), bytes.size());
             })
        .def("normals", function(pelMeshNormals))
        .def("curvature", function(pelMeshCurvature))
        .def("uv_scale", value<float>(pelMeshUvScale));

    py::class_<LiveMesh, Owner<LiveMesh>>(module, "LiveMesh")
        .def_static("create", maker<LiveMesh>(pelLiveMeshCreate))
        .def("update", function(pelLiveMeshUpdate))
        .def("stats", structure<pelLiveMeshStatsDefaults>(pelLiveMeshGetStats));

    module.def("orient_mesh", [](uint32_t numVertices, uintptr_t indices, uint64_t numIndices, uint32_t weld,
                                 float tolerance, uintptr_t positions, uint32_t positionStride,
                                 uintptr_t normals, uint32_t normalStride, const py::object& found) {
        const PelMeshTopologyDesc desc =
            topologyDesc(numVertices, indices, numIndices, weld, tolerance, positions, positionStride);
        PelMeshOrientation* counts = structOf<PelMeshOrientation>(found);
        call([&] {
            return pelMeshOrient(&desc, static_cast<const float*>(pointer(normals)), normalStride,
                                 static_cast<uint32_t*>(pointer(indices)), counts);
        });
    });
    module.def("screen_curvature", function(pelScreenCurvature));
}

}  // namespace pel::python
