// glTF scenes for Python, as arrays and structures: what `pellucid import` makes. Profiles from files.
#include <filesystem>

#include "files.h"
#include "gltf/gltf_import.h"
#include "io/lut/profile_file.h"

namespace pellucid::python {
namespace {

// Primitives of different materials share no vertices.
std::vector<uint32_t> idsOfVertices(const io::GltfScene& gltf) {
    std::vector<uint32_t> ids(gltf.mesh.vertexCount(), 0);
    for (size_t i = 0; i < gltf.mesh.triangles.size(); ++i)
        ids[gltf.mesh.triangles[i]] = gltf.materialOf[i / 3] + 1;
    return ids;
}

class Gltf {
  public:
    Gltf(const std::string& path, const std::vector<std::string>& profiles, double unitMm,
         std::optional<double> lights) {
        const py::gil_scoped_release free;
        io::requireExtension(path, {"glb", "gltf"});
        made_ = io::importGltf(path, {profiles, unitMm, lights});
    }

    // For each material: name, class, structure, profile or None, picture or None.
    py::dict parts() const {
        const io::MeshData& mesh = made_.gltf.mesh;
        py::list materials, lights, cameras;
        for (size_t i = 0; i < made_.looks.size(); ++i) {
            const io::GltfLook& look = made_.looks[i];
            const io::GltfMaterial& material = made_.gltf.materials[i];
            const std::string& named = look.material.profile;
            std::optional<Profile> profile;
            if (!look.profileText.empty())
                profile = io::parseProfile(named, look.profileText).profile;
            else if (!named.empty())
                profile = io::findProfile(named).profile;
            py::object picture = py::none();
            if (material.baseColorImage >= 0 &&
                !made_.gltf.images[size_t(material.baseColorImage)].bytes.empty())
                picture = py::bytes(made_.gltf.images[size_t(material.baseColorImage)].bytes);
            materials.append(
                py::make_tuple(material.name, look.how, bytesOf(look.material.material), profile, picture));
        }
        for (const io::SceneLight& light : made_.scene.lights) lights.append(bytesOf(light.light));
        const auto tuple = [](const io::Triple& v) { return py::make_tuple(v.x, v.y, v.z); };
        for (const io::GltfCamera& c : made_.gltf.cameras)
            cameras.append(
                py::make_tuple(tuple(c.position), tuple(c.forward), tuple(c.up), c.verticalFov, c.aspect));
        using namespace py::literals;
        py::dict of = toDict(mesh);
        of["ids"] = array(idsOfVertices(made_.gltf), {py::ssize_t(mesh.vertexCount())});
        return py::dict("mesh"_a = of, "materials"_a = materials, "lights"_a = lights,
                        "ambient"_a = bytesOf(made_.scene.ambient), "cameras"_a = cameras);
    }
    void save(const std::string& folder) const {
        const py::gil_scoped_release free;
        std::error_code error;
        std::filesystem::create_directories(folder, error);
        if (error) throw io::FileError(folder, "cannot be created: " + error.message());
        io::writeImported(folder, made_);
    }

  private:
    io::ImportedGltf made_;
};

}  // namespace

void bindGltf(py::module_& module) {
    py::class_<Profile>(module, "Profile", py::module_local()).def("address", [](const Profile& p) {
        return reinterpret_cast<uintptr_t>(p.get());
    });
    module.def("load_profile",
               [](const std::string& nameOrPath) { return io::findProfile(nameOrPath).profile; });
    py::class_<Gltf>(module, "Gltf")
        .def(py::init<const std::string&, const std::vector<std::string>&, double, std::optional<double>>())
        .def("parts", &Gltf::parts)
        .def("save", &Gltf::save);
}

}  // namespace pellucid::python
