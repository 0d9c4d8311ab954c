#include <optional>
#include <string_view>

#include "progress.h"

namespace pel::python {

namespace {

void bindLiveMesh(py::module_& module) {
    using pellucid::LiveMesh;
    py::class_<LiveMesh, Owner<LiveMesh>>(module, "LiveMesh")
        .def_static("create", [](const pellucid::MeshTopology& t, const py::object& params) {
            PelLiveMesh handle = nullptr;
            call([&, p = structOf<PelCurvatureParams>(params)] { return pelLiveMeshCreate(t.get(), p, &handle); });
            return LiveMesh(handle);
        })
        .def("update", [](const LiveMesh& live, const VertexView& positions, const std::optional<VertexView>& normals,
                          const VertexView& curvature,
                          const std::optional<std::vector<std::pair<uint32_t, uint32_t>>>& changed, const Waits& waits) {
            const PelVertexView p = vertexView(positions), c = vertexView(curvature);
            const PelVertexView n = normals ? vertexView(*normals) : PelVertexView{};
            std::vector<PelVertexRange> ranges(1);
            if (changed) {
                ranges.clear();
                for (const auto& [first, count] : *changed) ranges.push_back({first, count});
                ranges.push_back({0, 0});  // so that there is a pointer to no ranges
            }
            Submit submit(waits);
            call([&] {
                return pelLiveMeshUpdate(live.get(), &p, normals ? &n : nullptr, &c, changed ? ranges.data() : nullptr,
                                         changed ? uint32_t(changed->size()) : 0, submit.get());
            });
            return submit.done();
        })
        .def("stats", [](const LiveMesh& live) {
            PelLiveMeshStats stats = pelLiveMeshStatsDefaults();
            call([&] { return pelLiveMeshGetStats(live.get(), &stats); });
            return bytesOf(stats);
        });
}

void bindScreen(py::module_& module) {
    module.def("screen_curvature", [](const Device& d, const py::object& params, const ImageView& normals,
                                      const std::optional<ImageView>& positions, const std::optional<ImageView>& depth,
                                      const std::optional<ImageView>& ids, const ImageView& curvature, const Waits& waits) {
        const auto desc = [](const std::optional<ImageView>& v) { return v ? imageDesc(*v) : pelImageDescDefaults(); };
        const PelImageDesc n = imageDesc(normals), p = desc(positions), z = desc(depth), i = desc(ids);
        const PelImageDesc c = imageDesc(curvature);
        const auto* settings = structOf<PelScreenCurvatureParams>(params);
        Submit submit(waits);
        call([&] {
            return pelScreenCurvature(d.handle.get(), settings, &n, positions ? &p : nullptr, depth ? &z : nullptr,
                                      ids ? &i : nullptr, &c, submit.get());
        });
        return submit.done();
    });
}

}  // namespace

void bindMesh(py::module_& module) {
    bindLiveMesh(module);
    bindScreen(module);
    using pellucid::MeshTopology;
    py::class_<MeshTopology, Owner<MeshTopology>>(module, "MeshTopology")
        .def_static(
            "create",
            [](const Device& d, uint32_t numVertices, uintptr_t indices, uint64_t numIndices, uint32_t weld,
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
        .def_static("load",
                    [](const Device& d, const py::bytes& bytes, const py::object& report) {
                        const std::string_view data = bytes;
                        PelMeshReport* found = structOf<PelMeshReport>(report);
                        PelMeshTopology handle = nullptr;
                        call([&] {
                            return pelMeshTopologyLoad(d.handle.get(), data.data(), data.size(), &handle,
                                                       found);
                        });
                        return MeshTopology(handle);
                    })
        .def("save",
             [](const MeshTopology& t) {
                 size_t size = 0;
                 call([&] { return pelMeshTopologySave(t.get(), nullptr, &size); });
                 std::string bytes(size, '\0');
                 call([&] { return pelMeshTopologySave(t.get(), bytes.data(), &size); });
                 return py::bytes(bytes);
             })
        .def("normals",
             [](const MeshTopology& t, const VertexView& positions, const VertexView& normals,
                const Waits& waits) {
                 const PelVertexView p = vertexView(positions), n = vertexView(normals);
                 Submit submit(waits);
                 call([&] { return pelMeshNormals(t.get(), &p, &n, submit.get()); });
                 return submit.done();
             })
        .def("curvature",
             [](const MeshTopology& t, const py::object& params, const VertexView& positions,
                const std::optional<VertexView>& normals, const VertexView& curvature,
                const py::object& report, const Waits& waits) {
                 const PelVertexView p = vertexView(positions), c = vertexView(curvature);
                 const PelVertexView n = normals ? vertexView(*normals) : PelVertexView{};
                 const auto* settings = structOf<PelCurvatureParams>(params);
                 PelMeshReport* found = report.is_none() ? nullptr : structOf<PelMeshReport>(report);
                 Submit submit(waits);
                 call([&] {
                     return pelMeshCurvature(t.get(), settings, &p, normals ? &n : nullptr, &c, found,
                                             submit.get());
                 });
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
