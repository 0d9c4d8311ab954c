#include "progress.h"

namespace pel::python {

void bindMesh(py::module_& module) {
    using pellucid::MeshTopology;
    py::class_<MeshTopology>(module, "MeshTopology")
        .def_static("create", [](const Device& d, uint32_t numVertices, uintptr_t indices, uint64_t numIndices, uint32_t weld,
                                 float tolerance, uintptr_t positions, uint32_t positionStride, const py::object& report) {
            PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
            desc.numVertices = numVertices;
            desc.indices = static_cast<const uint32_t*>(pointer(indices));
            desc.numIndices = numIndices;
            desc.weld = PelWeld(weld);
            desc.weldTolerance = tolerance;
            desc.positions = static_cast<const float*>(pointer(positions));
            desc.positionStride = positionStride;
            PelMeshReport* found = structOf<PelMeshReport>(report);
            PelMeshTopology handle = nullptr;
            call([&] { return pelMeshTopologyCreate(d.handle.get(), &desc, &handle, found); });
            return MeshTopology(handle);
        })
        .def("curvature", [](const MeshTopology& t, const py::object& params, const VertexView& positions,
                             const VertexView& normals, const VertexView& curvature, const py::object& report,
                             const Waits& waits) {
            const PelVertexView p = vertexView(positions), n = vertexView(normals), c = vertexView(curvature);
            const auto* settings = structOf<PelCurvatureParams>(params);
            PelMeshReport* found = report.is_none() ? nullptr : structOf<PelMeshReport>(report);
            Submit submit(waits);
            call([&] { return pelMeshCurvature(t.get(), settings, &p, &n, &c, found, submit.get()); });
            return submit.done();
        })
        .def("uv_scale", [](const MeshTopology& t, const VertexView& positions, const VertexView& uvs) {
            const PelVertexView p = vertexView(positions), u = vertexView(uvs);
            float scale = 0;
            call([&] { return pelMeshUvScale(t.get(), &p, &u, &scale); });
            return scale;
        });
}

}  // namespace pel::python
