#include "progress.h"

namespace pel::python {

void bindShader(py::module_& module) {
    using pellucid::Lut;
    using pellucid::Shader;
    py::class_<Shader>(module, "Shader")
        .def_static("create", [](const Device& d) {
            PelShader handle = nullptr;
            call([&] { return pelShaderCreate(d.handle.get(), &handle); });
            return Shader(handle);
        })
        .def("set_options", [](const Shader& s, const py::object& options) {
            call([&, o = structOf<PelShaderOptions>(options)] { return pelShaderSetOptions(s.get(), o); });
        })
        .def("set_image", [](const Shader& s, uint32_t slot, const std::optional<ImageView>& image) {
            const PelImageDesc desc = image ? imageDesc(*image) : pelImageDescDefaults();
            call([&] { return pelShaderSetImage(s.get(), PelImageSlot(slot), image ? &desc : nullptr); });
        })
        .def("set_material", [](const Shader& s, uint32_t id, const py::object& material, const Lut* curvature,
                                const Lut* shadow) {
            const PelMaterial* m = material.is_none() ? nullptr : structOf<PelMaterial>(material);
            call([&] {
                return pelShaderSetMaterial(s.get(), id, m, curvature ? curvature->get() : nullptr,
                                            shadow ? shadow->get() : nullptr);
            });
        })
        .def("set_normal_map", [](const Shader& s, uint32_t id, const std::vector<ImageView>& levels) {
            std::vector<PelImageDesc> all;
            for (const ImageView& level : levels) all.push_back(imageDesc(level));
            call([&] { return pelShaderSetNormalMap(s.get(), id, all.data(), uint32_t(all.size())); });
        })
        .def("set_lights", [](const Shader& s, const std::vector<py::object>& lights) {
            std::vector<PelLight> all;
            for (const py::object& light : lights) all.push_back(*structOf<PelLight>(light));
            call([&] { return pelShaderSetLights(s.get(), all.data(), uint32_t(all.size())); });
        })
        .def("set_light_image", [](const Shader& s, uint32_t light, uint32_t slot, const std::optional<ImageView>& image) {
            const PelImageDesc desc = image ? imageDesc(*image) : pelImageDescDefaults();
            call([&] { return pelShaderSetLightImage(s.get(), light, PelLightSlot(slot), image ? &desc : nullptr); });
        })
        .def("set_ambient", [](const Shader& s, const py::object& ambient) {
            call([&, a = structOf<PelAmbient>(ambient)] { return pelShaderSetAmbient(s.get(), a); });
        })
        .def("set_camera", [](const Shader& s, const py::object& camera) {
            call([&, c = structOf<PelCamera>(camera)] { return pelShaderSetCamera(s.get(), c); });
        })
        .def("commit", [](const Shader& s) { call([&] { return pelShaderCommit(s.get()); }); })
        .def("execute", [](const Shader& s, const Waits& waits) {
            Submit submit(waits);
            call([&] { return pelShaderExecute(s.get(), submit.get()); });
            return submit.done();
        })
        .def("stats", [](const Shader& s) {
            PelShaderStats stats = pelShaderStatsDefaults();
            call([&] { return pelShaderGetStats(s.get(), &stats); });
            return bytesOf(stats);
        });
}

}  // namespace pel::python
