// Scattering alone, on the screen and in a texture, and the surface integral.
#include "native.h"

namespace pel::python {

void bindScatter(py::module_& module) {
    using pellucid::Scatter, pellucid::TextureScatter;
    using Optional = std::optional<ImageView>;
    py::class_<Scatter, Owner<Scatter>>(module, "Scatter")
        .def_static("create", maker<Scatter>(pelScatterCreate))
        .def("set_material", function(pelScatterSetMaterial))
        .def("set_controls", function(pelScatterSetControls))
        .def("set_image", function(pelScatterSetImage))
        .def("execute", function(pelScatterExecute))
        .def("warm_up",
             [](const Scatter& s, const Device& d, const py::object& params, const Optional& irradiance,
                const Optional& positions, const Optional& depth, const Optional& ids, const Optional& out) {
                 Argument<const PelImageDesc*> images[]{
                     Argument<const PelImageDesc*>(irradiance), Argument<const PelImageDesc*>(positions),
                     Argument<const PelImageDesc*>(depth), Argument<const PelImageDesc*>(ids),
                     Argument<const PelImageDesc*>(out)};
                 PelScatterWork scatter = pelScatterWorkDefaults();
                 scatter.scatter = s.get();
                 scatter.params = structOf<PelScatterParams>(params);
                 scatter.irradiance = images[0].get(), scatter.positions = images[1].get();
                 scatter.depth = images[2].get(), scatter.ids = images[3].get();
                 scatter.out = images[4].get();
                 PelWarmUp work = pelWarmUpDefaults();
                 work.scatters = &scatter, work.numScatters = 1;
                 uint32_t built = 0;
                 call([&] { return pelWarmUpPrograms(d.get(), &work, &built); });
                 return built;
             })
        .def("stats", structure<pelScatterStatsDefaults>(pelScatterGetStats));

    py::class_<TextureScatter, Owner<TextureScatter>>(module, "TextureScatter")
        .def_static("create",
                    [](const Device& d, uint32_t width, uint32_t height, uint32_t vertices, uintptr_t indices,
                       uint64_t count, uintptr_t uvs) {
                        PelTextureScatterDesc desc = pelTextureScatterDescDefaults();
                        desc.width = width, desc.height = height;
                        desc.numVertices = vertices, desc.numIndices = count;
                        desc.indices = static_cast<const uint32_t*>(pointer(indices));
                        desc.uvs = static_cast<const float*>(pointer(uvs));
                        return wrapped<TextureScatter>(
                            [&](auto* handle) { return pelTextureScatterCreate(d.get(), &desc, handle); });
                    })
        .def("set_positions", function(pelTextureScatterSetPositions))
        .def("draw", function(pelTextureScatterDraw))
        .def("execute", function(pelTextureScatterExecute))
        .def("stats", structure<pelTextureScatterStatsDefaults>(pelTextureScatterGetStats));

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
                   Argument<const PelSubmit*> submit(waits);
                   call([&] { return pelSurfaceIntegral(d.get(), &desc, submit.get()); });
                   return pellucid::Event(submit.done);
               });
}

}  // namespace pel::python
