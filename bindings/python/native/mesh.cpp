#include <optional>
#include <string_view>

#include "progress.h"

namespace pel::python {

namespace {

void bindLiveMesh(py::module_& module) {
    using pellucid::LiveMesh;
    py::class_<LiveMesh, Owner<LiveMesh>>(module, "LiveMesh")
        .def_static("create",
                    [](const pellucid::MeshTopology& t, const py::object& params) {
                        PelLiveMesh made = nullptr;
                        call([&, p = structOf<PelCurvatureParams>(params)] {
                            return pelLiveMeshCreate(t.get(), p, &made);
                        });
                        return LiveMesh(made);
                    })
        .def(
            "update",
            [](const LiveMesh& live, const VertexView& positions, const std::optional<VertexView>& normals,
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
                return submitted(waits, [&](const PelSubmit* submit) {
                    return pelLiveMeshUpdate(live.get(), &p, normals ? &n : nullptr, &c,
                                             changed ? ranges.data() : nullptr,
                                             changed ? uint32_t(ranges.size() - 1) : 0, submit);
                });
            })
        .def("stats", [](const LiveMesh& live) {
            PelLiveMeshStats stats = pelLiveMeshStatsDefaults();
            call([&] { return pelLiveMeshGetStats(live.get(), &stats); });
            return bytesOf(stats);
        });
}

void bindScreen(py::module_& module) {
    module.def("screen_curvature", [](const Device& d, const py::object& params, const ImageView& normals,
                                      const std::optional<ImageView>& positions,
                                      const std::optional<ImageView>& depth,
                                      const std::optional<ImageView>& ids, const ImageView& curvature,
                                      const Waits& waits) {
        const auto desc = [](const std::optional<ImageView>& v) {
            return v ? imageDesc(*v) : pelImageDescDefaults();
        };
        const PelImageDesc n = imageDesc(normals), p = desc(positions), z = desc(depth), i = desc(ids);
        const PelImageDesc c = imageDesc(curvature);
        return submitted(waits, [&, s = structOf<PelScreenCurvatureParams>(params)](const PelSubmit* submit) {
            return pelScreenCurvature(d.handle.get(), s, &n, positions ? &p : nullptr, depth ? &z : nullptr,
                                      ids ? &i : nullptr, &c, submit);
        });
    });
}

void bindSurfaceIntegral(py::module_& module) {
    module.def("surface_integral",
               [](const Device& d, uintptr_t positions, uint32_t vertices, uintptr_t indices, uint64_t count,
                  uintptr_t irradiance, uint32_t at, const pellucid::Profile* profile, float radius,
                  float unit, const std::array<float, 3>& cut, float tolerance, const VertexView& points,
                  const VertexView& result, const Waits& waits) {
                   PelSurfaceIntegralDesc desc = pelSurfaceIntegralDescDefaults();
                   desc.numVertices = vertices;
                   desc.positions = static_cast<const float*>(pointer(positions));
                   desc.indices = static_cast<const uint32_t*>(pointer(indices));
                   desc.numIndices = count;
                   desc.irradiance = static_cast<const float*>(pointer(irradiance));
                   desc.irradianceAt = PelIrradianceAt(at);
                   desc.profile = profile ? profile->get() : nullptr;
                   desc.diffusionRadius = radius;
                   desc.millimetresPerUnit = unit;
                   std::copy(cut.begin(), cut.end(), desc.cut);
                   desc.tolerance = tolerance;
                   desc.points = vertexView(points);
                   desc.result = vertexView(result);
                   return submitted(waits, [&](const PelSubmit* submit) {
                       return pelSurfaceIntegral(d.handle.get(), &desc, submit);
                   });
               });
}

// `create(handle, report)`; the report is Python's memory.
template <class Create>
pellucid::MeshTopology topologyFrom(const py::object& report, Create create) {
    PelMeshTopology made = nullptr;
    call([&, found = structOf<PelMeshReport>(report)] { return create(&made, found); });
    return pellucid::MeshTopology(made);
}

PelMeshTopologyDesc topologyDesc(uint32_t numVertices, uintptr_t indices, uint64_t numIndices, uint32_t weld,
                                 float tolerance, uintptr_t positions, uint32_t positionStride) {
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

void bindOrient(py::module_& module) {
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
}

}  // namespace

void bindMesh(py::module_& module) {
    bindLiveMesh(module);
    bindOrient(module);
    bindScreen(module);
    bindSurfaceIntegral(module);
    using pellucid::MeshTopology;
    py::class_<MeshTopology, Owner<MeshTopology>>(module, "MeshTopology")
        .def_static(
            "create",
            [](const Device& d, uint32_t numVertices, uintptr_t indices, uint64_t numIndices, uint32_t weld,
               float tolerance, uintptr_t positions, uint32_t positionStride, const py::object& report) {
                const PelMeshTopologyDesc desc = topologyDesc(numVertices, indices, numIndices, weld,
                                                              tolerance, positions, positionStride);
                return topologyFrom(report, [&](PelMeshTopology* made, PelMeshReport* found) {
                    return pelMeshTopologyCreate(d.handle.get(), &desc, made, found);
                });
            })
        .def_static("load",
                    [](const Device& d, const py::bytes& bytes, const py::object& report) {
                        const std::string_view data = bytes;
                        return topologyFrom(report, [&](PelMeshTopology* made, PelMeshReport* found) {
                            return pelMeshTopologyLoad(d.handle.get(), data.data(), data.size(), made, found);
                        });
                    })
        .def("save",
             [](const MeshTopology& t) {
                 std::string bytes;
                 call([&] {
                     size_t size = 0;
                     const PelError error = pelMeshTopologySave(t.get(), nullptr, &size);
                     bytes.resize(size);
                     return error ? error : pelMeshTopologySave(t.get(), bytes.data(), &size);
                 });
                 return py::bytes(bytes);
             })
        .def("normals",
             [](const MeshTopology& t, const VertexView& positions, const VertexView& normals,
                const Waits& waits) {
                 return submitted(waits, [&](const PelSubmit* submit) {
                     const PelVertexView p = vertexView(positions), n = vertexView(normals);
                     return pelMeshNormals(t.get(), &p, &n, submit);
                 });
             })
        .def("curvature",
             [](const MeshTopology& t, const py::object& params, const VertexView& positions,
                const std::optional<VertexView>& normals, const VertexView& curvature,
                const py::object& report, const Waits& waits) {
                 const PelVertexView p = vertexView(positions), c = vertexView(curvature);
                 const PelVertexView n = normals ? vertexView(*normals) : PelVertexView{};
                 PelMeshReport* found = report.is_none() ? nullptr : structOf<PelMeshReport>(report);
                 return submitted(
                     waits, [&, settings = structOf<PelCurvatureParams>(params)](const PelSubmit* submit) {
                         return pelMeshCurvature(t.get(), settings, &p, normals ? &n : nullptr, &c, found,
                                                 submit);
                     });
             })
        .def("uv_scale", [](const MeshTopology& t, const VertexView& positions, const VertexView& uvs) {
            const PelVertexView p = vertexView(positions), u = vertexView(uvs);
            float scale = 0;
            call([&] { return pelMeshUvScale(t.get(), &p, &u, &scale); });
            return scale;
        });
}

}  // namespace pel::python
