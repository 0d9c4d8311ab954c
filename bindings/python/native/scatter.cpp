#include "progress.h"

namespace pel::python {

void bindScatter(py::module_& module) {
    using pellucid::Scatter;
    py::class_<Scatter, Owner<Scatter>>(module, "Scatter")
        .def_static("create",
                    [](const Device& d) {
                        PelScatter handle = nullptr;
                        call([&] { return pelScatterCreate(d.handle.get(), &handle); });
                        return Scatter(handle);
                    })
        .def("set_material",
             [](const Scatter& s, uint32_t id, const std::optional<pellucid::Profile>& profile, float scale) {
                 call([&] {
                     return pelScatterSetMaterial(s.get(), id, profile ? profile->get() : nullptr, scale);
                 });
             })
        .def("set_controls",
             [](const Scatter& s, uint32_t id, const py::object& controls) {
                 call([&, c = structOf<PelScatterControls>(controls)] {
                     return pelScatterSetControls(s.get(), id, c);
                 });
             })
        .def("set_image",
             [](const Scatter& s, uint32_t slot, const std::optional<ImageView>& image) {
                 const PelImageDesc desc = image ? imageDesc(*image) : pelImageDescDefaults();
                 call([&] {
                     return pelScatterSetImage(s.get(), PelImageSlot(slot), image ? &desc : nullptr);
                 });
             })
        .def("execute",
             [](const Scatter& s, const py::object& params, const ImageView& irradiance,
                const std::optional<ImageView>& positions, const std::optional<ImageView>& depth,
                const std::optional<ImageView>& ids, const ImageView& out, const Waits& waits) {
                 const auto desc = [](const std::optional<ImageView>& v) {
                     return v ? imageDesc(*v) : pelImageDescDefaults();
                 };
                 const PelImageDesc e = imageDesc(irradiance), p = desc(positions), z = desc(depth),
                                    i = desc(ids), o = imageDesc(out);
                 const auto settings = *structOf<PelScatterParams>(params);
                 return submitted(waits, [&](const PelSubmit* submit) {
                     return pelScatterExecute(s.get(), &settings, &e, positions ? &p : nullptr,
                                              depth ? &z : nullptr, ids ? &i : nullptr, &o, submit);
                 });
             })
        .def("stats", [](const Scatter& s) {
            PelScatterStats stats = pelScatterStatsDefaults();
            call([&] { return pelScatterGetStats(s.get(), &stats); });
            return bytesOf(stats);
        });
}

}  // namespace pel::python
