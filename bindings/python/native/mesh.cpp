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
                        const auto made = std::make_shared<PelLiveMesh>();
                        callInterruptibly([made, t, p = *structOf<PelCurvatureParams>(params)] {
                            return pelLiveMeshCreate(t.get(), &p, made.get());
                        });
                        return LiveMesh(*made);
                    })
        .def("update",
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
                 return submitInterruptibly(
                     waits, [=, given = bool(normals), listed = bool(changed)](const PelSubmit* submit) {
                         return pelLiveMeshUpdate(live.get(), &p, given ? &n : nullptr, &c,
                                                  listed ? ranges.data() : nullptr,
                                                  listed ? uint32_t(ranges.size() - 1) : 0, submit);
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
                                      const std::optional<ImageView>& depth, const std::optional<ImageView>& ids,
                                      const ImageView& curvature, const Waits& waits) {
        const auto desc = [](const std::optional<ImageView>& v) {
            return v ? imageDesc(*v) : pelImageDescDefaults();
        };
        const PelImageDesc n = imageDesc(normals), p = desc(positions), z = desc(depth), i = desc(ids);
        const PelImageDesc c = imageDesc(curvature);
        const auto settings = *structOf<PelScreenCurvatureParams>(params);
        // Buffers of images that the call's arguments hold.
        const auto held = std::make_tuple(normals, positions, depth, ids, curvature);
        const bool hasP = bool(positions), hasZ = bool(depth), hasI = bool(ids);
        return submitInterruptibly(waits, [=, device = d.handle](const PelSubmit* submit) {
            (void)held;
            return pelScreenCurvature(device.get(), &settings, &n, hasP ? &p : nullptr, hasZ ? &z : nullptr,
                                      hasI ? &i : nullptr, &c, submit);
        });
    });
}

void bindSurfaceIntegral(py::module_& module) {
    module.def("surface_integral",
               [](const Device& d, uintptr_t positions, uint32_t vertices, uintptr_t indices, uint64_t count,
                  uintptr_t irradiance, uint64_t lights, uint32_t at, const pellucid::Profile* profile,
                  float radius, float unit, const std::array<float, 3>& cut, float tolerance,
                  const VertexView& points, const VertexView& result, const Waits& waits) {
                   // Copies: a call that was left behind goes on reading them.
                   struct Mesh {
                       std::vector<float> positions, irradiance;
                       std::vector<uint32_t> indices;
                       pellucid::Profile profile;
                   };
                   const auto mesh = std::make_shared<Mesh>();
                   const auto floats = [](uintptr_t from, uint64_t n) {
                       return std::vector<float>(static_cast<const float*>(pointer(from)),
                                                 static_cast<const float*>(pointer(from)) + n);
                   };
                   mesh->positions = floats(positions, 3 * uint64_t(vertices));
                   mesh->irradiance = floats(irradiance, 3 * lights);
                   mesh->indices.assign(static_cast<const uint32_t*>(pointer(indices)),
                                        static_cast<const uint32_t*>(pointer(indices)) + count);
                   if (profile) mesh->profile = *profile;
                   PelSurfaceIntegralDesc desc = pelSurfaceIntegralDescDefaults();
                   desc.numVertices = vertices;
                   desc.positions = mesh->positions.data();
                   desc.indices = mesh->indices.data();
                   desc.numIndices = count;
                   desc.irradiance = mesh->irradiance.data();
                   desc.irradianceAt = PelIrradianceAt(at);
                   desc.profile = mesh->profile.get();
                   desc.diffusionRadius = radius;
                   desc.millimetresPerUnit = unit;
                   std::copy(cut.begin(), cut.end(), desc.cut);
                   desc.tolerance = tolerance;
                   return submitInterruptibly(waits, [=, device = d.handle](const PelSubmit* submit) {
                       PelSurfaceIntegralDesc full = desc;
                       full.points = vertexView(points);
                       full.result = vertexView(result);
                       (void)mesh;
                       return pelSurfaceIntegral(device.get(), &full, submit);
                   });
               });
}

// A topology, and the report in Python's memory once it is made.
pellucid::MeshTopology topologyFrom(const py::object& report,
                                    std::function<PelError(PelMeshTopology*, PelMeshReport*)> create) {
    struct Made {
        PelMeshTopology handle = nullptr;
        PelMeshReport report;
        ~Made() {
            if (handle) pelMeshTopologyRelease(handle);
        }
    };
    const auto made = std::make_shared<Made>();
    made->report = *structOf<PelMeshReport>(report);
    callInterruptibly([made, create = std::move(create)] { return create(&made->handle, &made->report); });
    *structOf<PelMeshReport>(report) = made->report;
    return pellucid::MeshTopology(std::exchange(made->handle, nullptr));
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
                const PelMeshTopologyDesc desc =
                    topologyDesc(numVertices, indices, numIndices, weld, tolerance, positions, positionStride);
                return topologyFrom(report,
                                    [desc, device = d.handle](PelMeshTopology* made, PelMeshReport* found) {
                                        return pelMeshTopologyCreate(device.get(), &desc, made, found);
                                    });
            })
        .def_static("load",
                    [](const Device& d, const py::bytes& bytes, const py::object& report) {
                        const std::string_view data = bytes;
                        return topologyFrom(
                            report, [data, device = d.handle](PelMeshTopology* made, PelMeshReport* found) {
                                return pelMeshTopologyLoad(device.get(), data.data(), data.size(), made, found);
                            });
                    })
        .def("save",
             [](const MeshTopology& t) {
                 const auto bytes = std::make_shared<std::string>();
                 callInterruptibly([t, bytes] {
                     size_t size = 0;
                     const PelError error = pelMeshTopologySave(t.get(), nullptr, &size);
                     bytes->resize(size);
                     return error ? error : pelMeshTopologySave(t.get(), bytes->data(), &size);
                 });
                 return py::bytes(*bytes);
             })
        .def("normals",
             [](const MeshTopology& t, const VertexView& positions, const VertexView& normals, const Waits& waits) {
                 return submitInterruptibly(waits, [=](const PelSubmit* submit) {
                     const PelVertexView p = vertexView(positions), n = vertexView(normals);
                     return pelMeshNormals(t.get(), &p, &n, submit);
                 });
             })
        .def("curvature",
             [](const MeshTopology& t, const py::object& params, const VertexView& positions,
                const std::optional<VertexView>& normals, const VertexView& curvature,
                const py::object& report, const Waits& waits) {
                 const auto settings = *structOf<PelCurvatureParams>(params);
                 const auto found = std::make_shared<PelMeshReport>();
                 const bool reports = !report.is_none();
                 if (reports) *found = *structOf<PelMeshReport>(report);
                 const pellucid::Event done = submitInterruptibly(waits, [=](const PelSubmit* submit) {
                     const PelVertexView p = vertexView(positions), c = vertexView(curvature);
                     const PelVertexView n = normals ? vertexView(*normals) : PelVertexView{};
                     return pelMeshCurvature(t.get(), &settings, &p, normals ? &n : nullptr, &c,
                                             reports ? found.get() : nullptr, submit);
                 });
                 if (reports) *structOf<PelMeshReport>(report) = *found;
                 return done;
             })
        .def("uv_scale", [](const MeshTopology& t, const VertexView& positions, const VertexView& uvs) {
            const auto scale = std::make_shared<float>();
            callInterruptibly([=] {
                const PelVertexView p = vertexView(positions), u = vertexView(uvs);
                return pelMeshUvScale(t.get(), &p, &u, scale.get());
            });
            return *scale;
        });
}

}  // namespace pel::python
