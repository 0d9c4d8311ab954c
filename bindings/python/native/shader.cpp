#include <pellucid/pellucid_conventions.h>
#include <map>
#include <mutex>

#include "native.h"

namespace pel::python {

// A shader, and a lock that serialises its calls, including a call that goes on after Ctrl-C.
struct Shader {
    std::unique_ptr<std::recursive_mutex> busy = std::make_unique<std::recursive_mutex>();
    pellucid::Shader handle;

    explicit Shader(PelShader shader) : handle(shader) {}
    PelShader get() const { return handle.get(); }
};

// Locked where the call begins, without the GIL.
template <>
struct Argument<PelShader> {
    using Python = const Shader*;
    explicit Argument(Python given) : shader(given) {}
    PelShader get() {
        lock = std::unique_lock(*shader->busy);
        return shader->get();
    }
    Python shader;
    std::unique_lock<std::recursive_mutex> lock{};
};

// A function that returns the bytes of each structure of an array.
template <auto defaults, class T>
auto structures(PelError (*get)(PelShader, T*, uint32_t*)) {
    return [get](const Shader& s) {
        std::vector<T> values(24, defaults());
        uint32_t count = uint32_t(values.size());
        Argument<PelShader> shader(&s);
        call([&] { return get(shader.get(), values.data(), &count); });
        py::list all;
        for (uint32_t i = 0; i < count; ++i) all.append(bytesOf(values[i]));
        return all;
    };
}

// Fills a structure from a matrix; false if the matrix is not suitable.
template <auto set>
auto ofMatrix() {
    return []<class T>(PelError (*)(const float*, PelConvention, T*)) {
        return [](uintptr_t matrix, uint32_t depth, bool yDown, bool bottomFirst, const py::object& target) {
            const PelConvention convention{PelClipDepth(depth), yDown, bottomFirst, 0};
            return !set(static_cast<const float*>(pointer(matrix)), convention, structOf<T>(target));
        };
    }(set);
}

void bindShader(py::module_& module) {
    py::class_<Shader, Owner<Shader>>(module, "Shader")
        .def_static("create", maker<Shader>(pelShaderCreate))
        .def("set_name", named<Shader>())
        .def("set_options", function(pelShaderSetOptions))
        .def("set_image", function(pelShaderSetImage))
        .def("set_material", function(pelShaderSetMaterial))
        .def("set_normal_map",
             [](const Shader& s, uint32_t id, const std::vector<ImageView>& levels) {
                 std::vector<PelImageDesc> all;
                 for (const ImageView& level : levels) all.push_back(imageDesc(level));
                 Argument<PelShader> shader(&s);
                 call([&] {
                     return pelShaderSetNormalMap(shader.get(), id, all.data(), uint32_t(all.size()));
                 });
             })
        .def("set_scattered_texture", function(pelShaderSetScatteredTexture))
        .def("set_eye", function(pelShaderSetEye))
        .def("set_iris_texture", function(pelShaderSetIrisTexture))
        .def("set_reflection_cube", function(pelShaderSetReflectionCube))
        .def("set_environment", function(pelShaderSetEnvironment))
        .def("set_lights", function(pelShaderSetLights))
        .def("set_light_image", function(pelShaderSetLightImage))
        .def("set_ambient", function(pelShaderSetAmbient))
        .def("set_ambient_cube", function(pelShaderSetAmbientCube))
        .def("set_camera", function(pelShaderSetCamera))
        .def("commit", function(pelShaderCommit))
        .def("execute", function(pelShaderExecute))
        // So that the device's progress callback runs.
        .def("execute_blocking",
             [](const Shader& s) {
                 Argument<PelShader> shader(&s);
                 call([&] { return pelShaderExecute(shader.get(), nullptr); });
             })
        .def("material", structure<pelMaterialDefaults>(pelShaderGetMaterial))
        .def("warnings", value<const char*>(pelShaderGetWarnings))
        .def("stats", structure<pelShaderStatsDefaults>(pelShaderGetStats))
        .def("passes", structures<pelPassStatsDefaults>(pelShaderGetPasses))
        .def("memory", structures<pelPassMemoryDefaults>(pelShaderGetMemory));
    module.def("camera_of", ofMatrix<pelCameraFromViewProjection>());
    module.def("light_of", ofMatrix<pelLightFromViewProjection>());
    module.def("warm_up_programs", [](const Device& d, uint32_t groups,
                                      const std::vector<const Shader*>& shaders, uint32_t threads) {
        uint32_t built = 0;
        call([&] {
            std::vector<PelShader> handles;
            // Locks in one global order, whatever the order of the list, to avoid deadlocks.
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
            return pelWarmUpPrograms(d.get(), &work, &built);
        });
        return built;
    });
}

}  // namespace pel::python
