// pellucid import: a glTF scene as a mesh, a scene file and, where the build has the sample renderer, a G-buffer.
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>

#include "import_view.h"
#include "io/atomic_file.h"
#include "io/file_error.h"
#include "io/input_file.h"
#include "io/lut/profile_file.h"
#include "mesh_curvature.h"

namespace pellucid::cli {
namespace {

struct Arguments {
    Run::Options run;
    std::string file, output, size, camera = "first";
    std::vector<std::string> profiles;
    double unitMm = 1000, lights = 1;
    uint32_t smoothing = 2;
};

std::string number(float value) {
    char digits[32];
    return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

// OBJ with a part per material; texture coordinates the other way up than glTF's.
void writeObj(const std::string& folder, const io::MeshData& mesh, const std::vector<uint32_t>& materialOf,
              const std::vector<std::string>& names, const std::vector<io::GltfLook>& looks) {
    std::string obj = "mtllib mesh.mtl\n", mtl;
    const auto line = [&](const char* word, const float* values, size_t count) {
        obj += word;
        for (size_t i = 0; i < count; ++i) (obj += ' ') += number(values[i]);
        obj += '\n';
    };
    for (size_t v = 0; v < mesh.vertexCount(); ++v) line("v", &mesh.positions[3 * v], 3);
    for (size_t v = 0; v < mesh.uvs.size() / 2; ++v) {
        const float uv[2] = {mesh.uvs[2 * v], 1 - mesh.uvs[2 * v + 1]};
        line("vt", uv, 2);
    }
    for (size_t v = 0; v < mesh.vertexCount(); ++v) line("vn", &mesh.normals[3 * v], 3);
    for (uint32_t m = 0; m < names.size(); ++m) {
        obj += "g " + names[m] + "\nusemtl " + names[m] + "\n";
        for (size_t t = 0; t < mesh.triangleCount(); ++t) {
            if (materialOf[t] != m) continue;
            obj += 'f';
            for (size_t k = 0; k < 3; ++k) {
                const std::string at = std::to_string(mesh.triangles[3 * t + k] + 1);
                obj += " " + at + "/" + (mesh.uvs.empty() ? "" : at) + "/" + at;
            }
            obj += '\n';
        }
        mtl += "newmtl " + names[m] + "\nKd";
        for (const double c : looks[m].albedo) mtl += " " + number(float(c));
        mtl += "\n";
    }
    io::writeWholeFile(folder + "/mesh.obj", obj);
    io::writeWholeFile(folder + "/mesh.mtl", mtl);
}

// MATERIAL=PROFILE words, or a PROFILE for all.
std::map<std::string, std::string> profilesOf(const Arguments& a, const std::vector<io::GltfMaterial>& materials) {
    std::map<std::string, std::string> chosen;
    std::string known;
    for (const io::GltfMaterial& m : materials) known += (known.empty() ? "" : ", ") + m.name;
    for (const std::string& word : a.profiles) {
        const size_t at = word.rfind('=');
        const std::string profile = at == std::string::npos ? word : word.substr(at + 1);
        io::findProfile(profile);  // or an error that lists them
        bool found = at == std::string::npos;
        for (const io::GltfMaterial& m : materials)
            if (at == std::string::npos || m.name == word.substr(0, at))
                chosen[m.name] = profile, found = true;
        if (!found) throw UsageError("--profile " + word + ": there is no such material; there are " + known);
    }
    return chosen;
}

int cameraOf(const Arguments& a, size_t count) {
    if (a.camera == "none" || (a.camera == "first" && count == 0)) return -1;
    if (a.camera == "first") return 0;
    size_t index = 0;
    const char* end = a.camera.data() + a.camera.size();
    const auto read = std::from_chars(a.camera.data(), end, index);
    if (read.ec != std::errc() || read.ptr != end || index >= count)
        throw UsageError("--camera " + a.camera + ": the scene has " + std::to_string(count) +
                         "; a number from 0 on, first or none would be right");
    return int(index);
}

// A lamp and a little sky for scenes that have no light.
void addLamp(io::SceneFile& scene) {
    io::SceneLight lamp;
    lamp.light = directionalLight({0.5f, 0.6f, 0.62f}, {1, 1, 1});
    scene.lights.push_back(lamp);
    for (float& c : scene.ambient.constant) c = 0.08f;
}

void run(const Arguments& a) {
    try {
        io::requireExtension(a.file, {"glb", "gltf"});
    } catch (const io::FileError& e) {
        throw UsageError(e.what());
    }
    Run run(a.run);
    io::GltfScene gltf = io::readGltf(a.file);
    io::MeshData& mesh = gltf.mesh;
    if (gltf.materials.size() > 255)
        throw InputError(a.file + ": has " + std::to_string(gltf.materials.size()) +
                         " materials; 255 are possible");
    const auto profiles = profilesOf(a, gltf.materials);
    const int camera = cameraOf(a, gltf.cameras.size());
    uint32_t width = 1024, height = 1024;
    if (!a.size.empty())
        parseSize(a.size, width, height);
    else if (camera >= 0 && gltf.cameras[size_t(camera)].aspect > 0)
        height = uint32_t(std::clamp(1024 / gltf.cameras[size_t(camera)].aspect, 1.0, 8192.0));
    try {
        std::filesystem::create_directories(a.output);
        io::checkWritable(a.output + "/scene.toml");
    } catch (const std::exception& e) {
        throw UsageError("-o " + a.output + ": " + e.what());
    }
    for (const std::string& warning : mesh.warnings) run.warn(warning);
    for (float& p : mesh.positions) p = float(p * a.unitMm);
    const std::vector<std::string> names = io::plainNames(gltf.materials);

    io::SceneFile scene;
    std::vector<io::GltfLook> looks;
    run.report["materials"] = nlohmann::json::array();
    for (size_t i = 0; i < names.size(); ++i) {
        const auto given = profiles.find(gltf.materials[i].name);
        std::string profile = given == profiles.end() ? "" : given->second;
        if (io::extensionOf(profile) == "toml") profile = std::filesystem::absolute(profile).string();
        looks.push_back(io::lookOf(gltf.materials[i], names[i], uint32_t(i + 1), profile));
        const io::GltfLook& look = looks.back();
        scene.materials.push_back(look.material);
        run.report["materials"].push_back({{"id", i + 1},
                                           {"name", gltf.materials[i].name},
                                           {"taken_for", look.how},
                                           {"profile", look.material.profile}});
        if (!a.run.json)
            std::printf("material %zu: %s, %s%s\n", i + 1, gltf.materials[i].name.c_str(), look.how.c_str(),
                        look.material.profile.empty() ? "" : (" " + look.material.profile).c_str());
    }
    if (gltf.lights.size() > 64)
        run.warn("the scene has " + std::to_string(gltf.lights.size()) + " lights; the first 64 are taken");
    for (size_t i = 0; i < std::min<size_t>(gltf.lights.size(), 64); ++i)
        scene.lights.push_back(io::sceneLight(gltf.lights[i], a.unitMm, a.lights));
    if (scene.lights.empty()) {
        addLamp(scene);
        run.note("no lights in " + a.file + ": a lamp and a little sky were added");
    }
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.smoothingPasses = a.smoothing;
    const MeshCurvature curvature = meshCurvature(run, mesh, params, {PEL_WELD_EXACT, 0});
    reportMesh(run, curvature.report);
    if (canDraw()) {
        ImportView view{mesh,     {},    curvature.values, gltf.materials, looks, gltf.images, gltf.cameras,
                        a.unitMm, width, height,           camera};
        for (const uint32_t m : gltf.materialOf) view.ids.push_back(m + 1);
        drawImport(run, a.output, view, scene);
        run.report["gbuffer"] = "gbuffer.exr";
    } else {
        scene.channels[PEL_SLOT_NORMAL_SHADING] = {"Normal.X", "Normal.Y", "Normal.Z"};
        scene.channels[PEL_SLOT_POSITION] = {"Position.X", "Position.Y", "Position.Z"};
        scene.channels[PEL_SLOT_CURVATURE] = {"Curvature.V"};
        scene.channels[PEL_SLOT_MATERIAL] = {"Material.I"};
        run.note(
            "this build has no renderer: draw a G-buffer of mesh.obj with the channels that scene.toml "
            "names");
    }
    for (size_t i = 0; i < looks.size(); ++i)
        if (!looks[i].profileText.empty())
            io::writeWholeFile(a.output + "/" + names[i] + ".toml", looks[i].profileText);
    writeObj(a.output, mesh, gltf.materialOf, names, looks);
    io::writeScene(a.output + "/scene.toml", scene);
    run.report["lights"] = scene.lights.size();
    run.report["cameras"] = gltf.cameras.size();
    run.report["output"] = a.output;
    run.finish();
}

}  // namespace

void addImport(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("import", "Take over a glTF scene: mesh, materials, lights, G-buffer");
    auto a = std::make_shared<Arguments>();
    command->add_option("scene", a->file, "glTF 2.0: .glb or .gltf")->required();
    command
        ->add_option("-o,--output", a->output, "folder for scene.toml, mesh.obj, gbuffer.exr; made if need be")
        ->required();
    command
        ->add_option("--profile", a->profiles,
                     "PROFILE of all materials, or MATERIAL=PROFILE of one, in place of what the file says")
        ->allow_extra_args(false);
    command->add_option("--unit-mm", a->unitMm, "millimetres per unit; glTF's unit is the metre")
        ->check(CLI::Range(1e-6, 1e9))
        ->capture_default_str();
    command->add_option("--size", a->size,
                        "pixels of the G-buffer, WxH (default: 1024 wide, the camera's shape)");
    command
        ->add_option("--camera", a->camera,
                     "number of the camera, from 0 on; first, or none to frame everything")
        ->capture_default_str();
    command
        ->add_option("--lights", a->lights,
                     "factor of the lights' brightness: lux and candela count as they are")
        ->check(CLI::Range(1e-9, 1e9))
        ->capture_default_str();
    command->add_option("--smooth", a->smoothing, "smoothing passes of the curvature")
        ->check(CLI::Range(0, 1000))
        ->capture_default_str();
    addRunOptions(*command, a->run);
    command->callback([a] { run(*a); });
}

}  // namespace pellucid::cli
