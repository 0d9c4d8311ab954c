// Scenes for Python: the scenes of `pellucid shade`, as an object whose structures Python can change.

#include <algorithm>
#include <filesystem>

#include "files.h"
#include "io/scene/scene_keys.h"
#include "scene/scene_frame.h"

namespace pellucid::python {
namespace {

template <class T>
T structOf(const std::string& bytes) {
    if (bytes.size() != sizeof(T)) throw py::value_error("a structure of another version of the library");
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
}

// A further reference to a device of the other native module.
struct SharedDevice : Device {
    explicit SharedDevice(PelDevice device) : Device(nullptr) {
        pelDeviceRetain(device);
        h_ = device;
    }
};

using Channels = std::map<std::string, std::vector<std::string>>;

void setChannels(io::SceneFile& scene, const Channels& channels) {
    for (const auto& [key, names] : channels)
        if (std::ranges::find(io::slotKeys, key, &io::SlotKey::key) == std::end(io::slotKeys))
            throw py::value_error("channels: there is no image '" + key + "'");
    for (const io::SlotKey& k : io::slotKeys) {
        const auto found = channels.find(std::string(k.key));
        scene.channels[k.slot] = found == channels.end() ? std::vector<std::string>() : found->second;
    }
}

// The shader of a scene on one device, with the images and outputs that were wanted.
struct OnDevice {
    Device device;
    io::LutStore luts;
    std::vector<PelImageSlot> outputs;
    Channels channels;
    std::optional<io::SceneFrame> frame;

    explicit OnDevice(PelDevice shared) : device(SharedDevice(shared)), luts(device) {}
};

class Scene {
  public:
    explicit Scene(const std::string& path) {
        const py::gil_scoped_release free;
        scene_ = io::readScene(path);
    }

    py::dict state() const {
        py::dict channels;
        for (const io::SlotKey& k : io::slotKeys)
            if (!scene_.channels[k.slot].empty())
                channels[py::str(std::string(k.key))] = scene_.channels[k.slot];
        py::list materials, lights;
        for (const io::SceneMaterial& m : scene_.materials)
            materials.append(py::make_tuple(m.id, bytesOf(m.material), m.profile));
        for (const io::SceneLight& l : scene_.lights) lights.append(bytesOf(l.light));
        using namespace py::literals;
        return py::dict("channels"_a = channels, "materials"_a = materials, "lights"_a = lights,
                        "ambient"_a = bytesOf(scene_.ambient), "camera"_a = bytesOf(scene_.camera),
                        "options"_a = bytesOf(io::withOptionsOf(scene_, pelShaderOptionsDefaults())));
    }

    void readGBuffer(const std::string& path) {
        const py::gil_scoped_release free;
        take(io::readImage(path));
    }
    void setGBuffer(const std::map<std::string, Pixels>& channels) {
        io::Image image;
        for (const auto& [name, pixels] : channels) {
            if (pixels.ndim() != 2)
                throw py::value_error("channel " + name + " must have the shape (height, width)");
            const int height = int(pixels.shape(0)), width = int(pixels.shape(1));
            if (!image.channels.empty() && (height != image.height || width != image.width))
                throw py::value_error("channel " + name + " has the shape (" + std::to_string(height) + ", " +
                                      std::to_string(width) + "), others have (" +
                                      std::to_string(image.height) + ", " + std::to_string(image.width) +
                                      ")");
            image.height = height, image.width = width;
            image.channels.push_back(
                {name, io::ChannelType::Float, {pixels.data(), pixels.data() + pixels.size()}});
        }
        if (image.pixelCount() == 0) throw py::value_error("the G-buffer has no pixels: it needs channels");
        image.source = "the G-buffer";
        take(std::move(image));
    }
    bool hasGBuffer() const { return gbuffer_.has_value(); }
    std::string gbufferFile() const { return scene_.gbuffer; }  // that the scene names; may be empty

    // Channels, materials (id, bytes, name of the profile), lights, ambient light, camera, options.
    using Material = std::tuple<uint32_t, std::string, std::string>;
    using State = std::tuple<Channels, std::vector<Material>, std::vector<std::string>, std::string,
                             std::string, std::string>;

    py::dict shade(uintptr_t device, const State& state, const std::vector<std::string>& outputs) {
        const io::SceneFile scene = changed(state);
        std::vector<PelImageSlot> wanted;
        std::vector<std::string> names;
        for (const io::OutputKey& k : io::outputKeys)
            if (std::ranges::find(outputs, k.key) != outputs.end())
                wanted.push_back(k.slot), names.emplace_back(k.key);

        std::vector<float> radiance;
        std::vector<std::vector<float>> parts;
        PelShaderStats stats;
        std::vector<std::string> warnings;
        {
            const py::gil_scoped_release free;
            io::SceneFrame& frame =
                frameFor(reinterpret_cast<PelDevice>(device), scene, std::get<Channels>(state), wanted);
            frame.shade();
            radiance = frame.radiance();
            for (const PelImageSlot slot : wanted) parts.push_back(frame.output(slot));
            stats = frame.stats();
            std::istringstream lines(frame.warnings());
            for (std::string line; std::getline(lines, line);) warnings.push_back(line);
            for (const std::string& sentence : io::unlikely(*gbuffer_, scene)) warnings.push_back(sentence);
        }
        py::dict others;
        for (size_t i = 0; i < wanted.size(); ++i)
            others[py::str(names[i])] = image(parts[i], wanted[i] == PEL_SLOT_OUT_THICKNESS ? 1 : 3);
        using namespace py::literals;
        return py::dict("radiance"_a = image(radiance, 3), "outputs"_a = others, "stats"_a = bytesOf(stats),
                        "warnings"_a = warnings);
    }

    // Files are named relative to the folder that the scene is written to.
    void save(const std::string& path, const State& state) const {
        io::SceneFile scene = changed(state);
        for (const io::SceneMaterial& m : scene.materials)
            if (m.material.profile)
                throw py::value_error(
                    "material " + std::to_string(m.id) +
                    " has a profile object, which a scene file cannot hold: set Scene.profiles[" +
                    std::to_string(m.id) + "] to the name or the file of a profile");
        const PelShaderOptions& o = scene.options;
        if (o.regionX || o.regionY || o.regionWidth || o.regionHeight)
            throw py::value_error("a scene file cannot hold the region of options: set it after loading");
        if (o.invalidColor[0] != 0 || o.invalidColor[1] != 0 || o.invalidColor[2] != 0)
            throw py::value_error(
                "options.invalid_color is set, which a scene file cannot hold: set it after loading");
        namespace fs = std::filesystem;
        const fs::path folder = fs::absolute(path).parent_path();
        for (std::string* file : io::filesOf(scene))
            if (!io::extensionOf(*file).empty() && fs::exists(*file))  // names of the library have none
                *file = fs::absolute(*file).lexically_relative(folder).string();
        io::writeScene(path, scene);
    }

  private:
    // Materials that are not in the file have no profile or texture files.
    io::SceneFile changed(const State& state) const {
        const auto& [channels, materials, lights, ambient, camera, options] = state;
        io::SceneFile scene = scene_;
        setChannels(scene, channels);
        scene.materials.clear();
        for (const auto& [id, bytes, profile] : materials) {
            const auto known = std::ranges::find(scene_.materials, id, &io::SceneMaterial::id);
            io::SceneMaterial& m =
                scene.materials.emplace_back(known == scene_.materials.end() ? io::SceneMaterial() : *known);
            m.id = id;
            m.material = structOf<PelMaterial>(bytes);
            m.profile = m.material.profile ? "" : profile;
        }
        std::erase_if(scene.eyes, [&](const io::SceneEye& e) {
            return std::ranges::find(scene.materials, e.material, &io::SceneMaterial::id) ==
                   scene.materials.end();
        });
        scene.lights.resize(lights.size());
        for (size_t i = 0; i < lights.size(); ++i) scene.lights[i].light = structOf<PelLight>(lights[i]);
        scene.ambient = structOf<PelAmbient>(ambient);
        scene.camera = structOf<PelCamera>(camera);
        scene.options = structOf<PelShaderOptions>(options);
        return scene;
    }
    void take(io::Image image) {
        onDevice_.reset();
        gbuffer_ = std::move(image);
    }
    // Kept from call to call, so that only changed settings are set again.
    io::SceneFrame& frameFor(PelDevice device, const io::SceneFile& scene, const Channels& channels,
                             const std::vector<PelImageSlot>& outputs) {
        if (!onDevice_ || onDevice_->device.get() != device) onDevice_.emplace(device);
        OnDevice& on = *onDevice_;
        try {
            if (on.frame && on.outputs == outputs && on.channels == channels) {
                on.frame->update(scene, on.luts, scene.options);
            } else {
                on.frame.reset();
                on.outputs = outputs, on.channels = channels;
                on.frame.emplace(io::prepareFrame(on.device, scene, on.luts, scene.options, outputs));
                on.frame->show(*gbuffer_, scene);
            }
        } catch (...) {
            on.frame.reset();
            throw;
        }
        return *on.frame;
    }
    py::array_t<float> image(const std::vector<float>& values, int components) const {
        std::vector<py::ssize_t> shape{gbuffer_->height, gbuffer_->width};
        if (components > 1) shape.push_back(components);
        return array(values, shape);
    }

    io::SceneFile scene_;
    std::optional<io::Image> gbuffer_;
    std::optional<OnDevice> onDevice_;
};

// A scene made by a program: materials with their profile and scattered texture, lights with their shadow
// map, eyes with the texture and the profile of their iris, surroundings, by names of files. Complete or not
// at all.
void writeScene(const std::string& path, const Channels& channels,
                const std::vector<std::tuple<uint32_t, std::string, std::string, std::string>>& materials,
                const std::vector<std::tuple<std::string, std::string>>& lights,
                const std::vector<std::tuple<uint32_t, std::string, std::string, std::string>>& eyes,
                const std::string& ambient, const std::string& camera, const std::string& options,
                const std::string& environment, const std::vector<float>& axes) {
    io::SceneFile scene;
    setChannels(scene, channels);
    for (const auto& [id, bytes, profile, texture] : materials) {
        io::SceneMaterial& m = scene.materials.emplace_back();
        m.id = id, m.material = structOf<PelMaterial>(bytes), m.profile = profile;
        m.scatteredTexture = texture;
    }
    for (const auto& [bytes, file] : lights) {
        io::SceneLight& l = scene.lights.emplace_back();
        l.light = structOf<PelLight>(bytes), l.shadowMapFile = file;
    }
    for (const auto& [id, bytes, texture, profile] : eyes) {
        io::SceneEye& e = scene.eyes.emplace_back();
        e.material = id, e.eye = structOf<PelEye>(bytes), e.irisTexture = texture, e.irisProfile = profile;
    }
    scene.ambient = structOf<PelAmbient>(ambient);
    scene.camera = structOf<PelCamera>(camera);
    scene.options = structOf<PelShaderOptions>(options);
    scene.environment = environment;
    if (axes.size() == std::size(scene.environmentAxes)) std::ranges::copy(axes, scene.environmentAxes);
    io::writeScene(path, scene);
}

}  // namespace

void bindScene(py::module_& module) {
    py::class_<Scene>(module, "Scene")
        .def(py::init<const std::string&>())
        .def("state", &Scene::state)
        .def("read_gbuffer", &Scene::readGBuffer)
        .def("set_gbuffer", &Scene::setGBuffer)
        .def("has_gbuffer", &Scene::hasGBuffer)
        .def("gbuffer_file", &Scene::gbufferFile)
        .def("shade", &Scene::shade)
        .def("save", &Scene::save);
    module.def("write_scene", &writeScene);
    py::register_exception_translator([](std::exception_ptr pending) {
        try {
            if (pending) std::rethrow_exception(pending);
        } catch (const Error& e) {
            const py::object type = py::module_::import("pellucid._errors").attr("PellucidError");
            const py::object value = type(int(e.code()), std::string(e.what()));
            PyErr_SetObject(type.ptr(), value.ptr());
        }
    });
}

}  // namespace pellucid::python
