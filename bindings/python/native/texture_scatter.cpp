#include "progress.h"

namespace pel::python {

void bindTextureScatter(py::module_& module) {
    using pellucid::TextureScatter;
    py::class_<TextureScatter, Owner<TextureScatter>>(module, "TextureScatter")
        .def_static("create",
                    [](const Device& d, uint32_t width, uint32_t height, uint32_t vertices, uintptr_t indices,
                       uint64_t count, uintptr_t uvs) {
                        PelTextureScatterDesc desc = pelTextureScatterDescDefaults();
                        desc.width = width, desc.height = height;
                        desc.numVertices = vertices, desc.numIndices = count;
                        desc.indices = static_cast<const uint32_t*>(pointer(indices));
                        desc.uvs = static_cast<const float*>(pointer(uvs));
                        PelTextureScatter handle = nullptr;
                        call([&] { return pelTextureScatterCreate(d.handle.get(), &desc, &handle); });
                        return TextureScatter(handle);
                    })
        .def("set_positions",
             [](const TextureScatter& s, const VertexView& positions, const Waits& waits) {
                 const PelVertexView p = vertexView(positions);
                 return submitted(waits, [&](const PelSubmit* submit) {
                     return pelTextureScatterSetPositions(s.get(), &p, submit);
                 });
             })
        .def("draw",
             [](const TextureScatter& s, const VertexView& values, bool unit, const ImageView& out,
                const Waits& waits) {
                 const PelVertexView v = vertexView(values);
                 const PelImageDesc o = imageDesc(out);
                 return submitted(waits, [&](const PelSubmit* submit) {
                     return pelTextureScatterDraw(s.get(), &v, unit, &o, submit);
                 });
             })
        .def("execute",
             [](const TextureScatter& s, const py::object& params,
                const std::optional<pellucid::Profile>& profile, const ImageView& irradiance,
                const std::optional<ImageView>& albedo, const ImageView& out, const Waits& waits) {
                 auto settings = *structOf<PelTextureScatterParams>(params);
                 settings.profile = profile ? profile->get() : nullptr;
                 const PelImageDesc e = imageDesc(irradiance), o = imageDesc(out),
                                    a = albedo ? imageDesc(*albedo) : pelImageDescDefaults();
                 return submitted(waits, [&](const PelSubmit* submit) {
                     return pelTextureScatterExecute(s.get(), &settings, &e, albedo ? &a : nullptr, &o,
                                                     submit);
                 });
             })
        .def("stats", [](const TextureScatter& s) {
            PelTextureScatterStats stats = pelTextureScatterStatsDefaults();
            call([&] { return pelTextureScatterGetStats(s.get(), &stats); });
            return bytesOf(stats);
        });
}

}  // namespace pel::python
