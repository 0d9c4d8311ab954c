#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "progress.h"

namespace pel::python {

namespace {
// A shader, and a lock that lets calls from other threads wait, and later ones for a call that Ctrl-C left
// behind.
struct Shader {
    std::unique_ptr<std::recursive_mutex> busy = std::make_unique<std::recursive_mutex>();
    pellucid::Shader handle;

    explicit Shader(PelShader shader) : handle(shader) {}
    PelShader get() const { return handle.get(); }
};

template <class Body>
void locked(const Shader& shader, Body&& body) {
    call([&] {
        const std::scoped_lock lock(*shader.busy);
        return body();
    });
}
}  // namespace

void bindShader(py::module_& module) {
    using pellucid::Lut;
    py::class_<Shader, Owner<Shader>>(module, "Shader")
        .def_static("create",
                    [](const Device& d) {
                        PelShader handle = nullptr;
                        call([&] { return pelShaderCreate(d.handle.get(), &handle); });
                        return Shader(handle);
                    })
        .def("set_options",
             [](const Shader& s, const py::object& options) {
                 locked(s, [&, o = structOf<PelShaderOptions>(options)] {
                     return pelShaderSetOptions(s.get(), o);
                 });
             })
        .def("set_image",
             [](const Shader& s, uint32_t slot, const std::optional<ImageView>& image) {
                 const PelImageDesc desc = image ? imageDesc(*image) : pelImageDescDefaults();
                 locked(s, [&] {
                     return pelShaderSetImage(s.get(), PelImageSlot(slot), image ? &desc : nullptr);
                 });
             })
        .def("set_material",
             [](const Shader& s, uint32_t id, const py::object& material, const Lut* curvature,
                const Lut* shadow) {
                 const PelMaterial* m = material.is_none() ? nullptr : structOf<PelMaterial>(material);
                 locked(s, [&] {
                     return pelShaderSetMaterial(s.get(), id, m, curvature ? curvature->get() : nullptr,
                                                 shadow ? shadow->get() : nullptr);
                 });
             })
        .def("set_normal_map",
             [](const Shader& s, uint32_t id, const std::vector<ImageView>& levels) {
                 std::vector<PelImageDesc> all;
                 for (const ImageView& level : levels) all.push_back(imageDesc(level));
                 locked(s,
                        [&] { return pelShaderSetNormalMap(s.get(), id, all.data(), uint32_t(all.size())); });
             })
        .def("set_scattered_texture",
             [](const Shader& s, uint32_t id, const std::optional<ImageView>& texture) {
                 const PelImageDesc desc = texture ? imageDesc(*texture) : pelImageDescDefaults();
                 locked(s,
                        [&] { return pelShaderSetScatteredTexture(s.get(), id, texture ? &desc : nullptr); });
             })
        .def("set_eye",
             [](const Shader& s, uint32_t id, const py::object& eye, const Lut* caustics) {
                 const PelEye* e = eye.is_none() ? nullptr : structOf<PelEye>(eye);
                 locked(s, [&] {
                     return pelShaderSetEye(s.get(), id, e, caustics ? caustics->get() : nullptr);
                 });
             })
        .def("set_iris_texture",
             [](const Shader& s, uint32_t id, const std::optional<ImageView>& texture) {
                 const PelImageDesc desc = texture ? imageDesc(*texture) : pelImageDescDefaults();
                 locked(s, [&] { return pelShaderSetIrisTexture(s.get(), id, texture ? &desc : nullptr); });
             })
        .def("set_reflection_cube",
             [](const Shader& s, const std::optional<ImageView>& faces) {
                 const PelImageDesc desc = faces ? imageDesc(*faces) : pelImageDescDefaults();
                 locked(s, [&] { return pelShaderSetReflectionCube(s.get(), faces ? &desc : nullptr); });
             })
        .def("set_lights",
             [](const Shader& s, const std::vector<py::object>& lights) {
                 std::vector<PelLight> all;
                 for (const py::object& light : lights) all.push_back(*structOf<PelLight>(light));
                 locked(s, [&] { return pelShaderSetLights(s.get(), all.data(), uint32_t(all.size())); });
             })
        .def("set_light_image",
             [](const Shader& s, uint32_t light, uint32_t slot, const std::optional<ImageView>& image) {
                 const PelImageDesc desc = image ? imageDesc(*image) : pelImageDescDefaults();
                 locked(s, [&] {
                     return pelShaderSetLightImage(s.get(), light, PelLightSlot(slot),
                                                   image ? &desc : nullptr);
                 });
             })
        .def("set_ambient",
             [](const Shader& s, const py::object& ambient) {
                 locked(s,
                        [&, a = structOf<PelAmbient>(ambient)] { return pelShaderSetAmbient(s.get(), a); });
             })
        .def("set_ambient_cube",
             [](const Shader& s, const std::optional<ImageView>& faces) {
                 const PelImageDesc desc = faces ? imageDesc(*faces) : pelImageDescDefaults();
                 locked(s, [&] { return pelShaderSetAmbientCube(s.get(), faces ? &desc : nullptr); });
             })
        .def("set_camera",
             [](const Shader& s, const py::object& camera) {
                 locked(s, [&, c = structOf<PelCamera>(camera)] { return pelShaderSetCamera(s.get(), c); });
             })
        .def("commit", [](const Shader& s) { locked(s, [&] { return pelShaderCommit(s.get()); }); })
        .def("execute",
             [](const Shader& s, const Waits& waits) {
                 return submitted(waits, [&](const PelSubmit* submit) {
                     const std::scoped_lock lock(*s.busy);
                     return pelShaderExecute(s.get(), submit);
                 });
             })
        // Blocking, so that the device's progress callback runs.
        .def("execute_told",
             [](const Shader& s) { locked(s, [&] { return pelShaderExecute(s.get(), nullptr); }); })
        .def("material",
             [](const Shader& s, uint32_t id) {
                 PelMaterial material = pelMaterialDefaults();
                 locked(s, [&] { return pelShaderGetMaterial(s.get(), id, &material); });
                 material.profile = nullptr;  // the shader's own
                 return bytesOf(material);
             })
        .def("warnings",
             [](const Shader& s) {
                 const char* text = "";
                 std::string copy;
                 locked(s, [&] {
                     const PelError error = pelShaderGetWarnings(s.get(), &text);
                     copy = text;
                     return error;
                 });
                 return copy;
             })
        .def("stats", [](const Shader& s) {
            PelShaderStats stats = pelShaderStatsDefaults();
            locked(s, [&] { return pelShaderGetStats(s.get(), &stats); });
            return bytesOf(stats);
        });
    module.def("warm_up_programs", [](const Device& d, uint32_t groups,
                                      const std::vector<const Shader*>& shaders, uint32_t threads) {
        uint32_t built = 0;
        call([&] {
            std::vector<PelShader> handles;
            // In one order for all threads, whatever the order of their lists: two would wait for each other
            // otherwise.
            std::map<std::recursive_mutex*, std::unique_lock<std::recursive_mutex>, std::less<>> locks;
            for (const Shader* s : shaders) {
                handles.push_back(s->get());
                locks.try_emplace(s->busy.get(), *s->busy, std::defer_lock);
            }
            for (auto& [mutex, lock] : locks) lock.lock();
            PelWarmUp work = pelWarmUpDefaults();
            work.groups = groups;
            work.shaders = handles.data();
            work.numShaders = uint32_t(handles.size());
            work.threads = threads;
            return pelWarmUpPrograms(d.handle.get(), &work, &built);
        });
        return built;
    });
}

}  // namespace pel::python
