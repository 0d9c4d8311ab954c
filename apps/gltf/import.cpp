// pellucid import: a glTF scene as a mesh, a scene file and, with the sample renderer, a G-buffer.

#include "cli/mesh_curvature.h"
#include "gltf/import_view.h"
#include "io/atomic_file.h"
#include "io/shortest.h"

namespace pellucid::cli {
namespace {

struct ImportArguments {
    Run::Options run;
    std::string file, output, size, camera = "first";
    std::vector<std::string> profiles;
    double unitMm = 1000;
    std::optional<double> lights;
    uint32_t smoothing = 2;
};

int cameraOf(const ImportArguments& a, size_t count) {
    if (a.camera == "none" || (a.camera == "first" && count == 0)) return -1;
    if (a.camera == "first") return 0;
    size_t index = 0;
    const char* end = a.camera.data() + a.camera.size();
    const auto read = std::from_chars(a.camera.data(), end, index);
    if (read.ec != std::errc() || read.ptr != end || index >= count)
        throw UsageError(io::concat("--camera ", a.camera, ": the scene has ", count,
                                    "; a number from 0 on, first or none would be right"));
    return int(index);
}

void reportMaterials(Run& run, const ImportArguments& a, const io::ImportedGltf& imported) {
    run.report["materials"] = nlohmann::json::array();
    for (size_t i = 0; i < imported.looks.size(); ++i) {
        const io::GltfLook& look = imported.looks[i];
        const std::string &name = imported.gltf.materials[i].name, &profile = look.material.profile;
        run.report["materials"].push_back(
            {{"id", i + 1}, {"name", name}, {"taken_for", look.how}, {"profile", profile}});
        if (!a.run.json)
            std::printf("material %zu: %s, %s%s\n", i + 1, io::printable(name).c_str(), look.how.c_str(),
                        profile.empty() ? "" : (" " + profile).c_str());
    }
}

void runImport(const ImportArguments& a) {
    try {
        io::requireExtension(a.file, {"glb", "gltf"});
    } catch (const io::FileError& e) {
        throw UsageError(e.what());
    }
    Run run(a.run);
    io::ImportedGltf imported = [&] {
        try {
            return io::importGltf(a.file, {a.profiles, a.unitMm, a.lights});
        } catch (const std::invalid_argument& e) {
            throw UsageError(std::string("--") + e.what());
        }
    }();
    const io::GltfScene& gltf = imported.gltf;
    const io::MeshData& mesh = gltf.mesh;
    const int camera = cameraOf(a, gltf.cameras.size());
    uint32_t width = 1024, height = 1024;
    if (!a.size.empty())
        parseSize(a.size, {&width, &height});
    else if (camera >= 0 && gltf.cameras[size_t(camera)].aspect > 0)
        height = uint32_t(std::clamp(1024 / gltf.cameras[size_t(camera)].aspect, 1.0, 8192.0));
    checkFolder(a.output, "scene.toml");
    for (const std::string& warning : mesh.warnings) run.warn(warning);
    reportMaterials(run, a, imported);
    if (!imported.lampAdded && !a.lights && imported.lightFactor != 1)
        run.note("lights times " + io::shortest(imported.lightFactor) +
                 ", so that the picture is well exposed; --lights 1 takes lux and candela as they are");
    if (imported.lampAdded) run.note("no lights in " + a.file + ": a lamp and a little sky were added");
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.smoothingPasses = a.smoothing;
    const MeshCurvature curvature = meshCurvature(run, mesh, params, {PEL_WELD_EXACT, 0});
    reportMesh(run, curvature.report);
#ifdef PELLUCID_SAMPLE
    drawImport(run, a.output, imported, {curvature.values, width, height, camera});
    run.report["gbuffer"] = "gbuffer.exr";
#else
    run.note(
        "this build has no renderer: draw a G-buffer of mesh.obj with the channels that scene.toml names");
#endif
    io::writeImported(a.output, imported);
    run.report["light_factor"] = imported.lightFactor;
    run.report["lights"] = imported.scene.lights.size();
    run.report["cameras"] = gltf.cameras.size();
    run.report["output"] = a.output;
    run.finish();
}

}  // namespace

void addImport(CLI::App& app) {
    auto [command, a] = subcommand<ImportArguments>(
        app, "import", "Take over a glTF scene: mesh, materials, lights, G-buffer", runImport);
    option(command, "scene", a.file, "glTF 2.0: .glb or .gltf", required);
    option(command, "-o,--output", a.output,
           "folder for scene.toml, mesh.obj, gbuffer.exr; created if missing", required);
    option(command, "--profile", a.profiles,
           "PROFILE of all materials, or MATERIAL=PROFILE of one, instead of the file's; several times",
           Word{profileWord}, oneEach);
    option(command, "--unit-mm", a.unitMm, "millimetres per unit; glTF's unit is the metre",
           inRange(1e-6, 1e9), shown);
    option(command, "--size", a.size, "pixels of the G-buffer, WxH (default: 1024 wide, the camera's shape)",
           Word{"SIZE"});
    option(command, "--camera", a.camera,
           "number of the camera among the perspective ones, from 0 on, in the order of the scene's nodes; "
           "first, or none to frame everything",
           Word{"CAMERA"}, shown);
    option(command, "--lights", a.lights,
           "factor of the lights' brightness in lux and candela (default: chosen by how bright the scene "
           "becomes)",
           inRange(1e-9, 1e9));
    option(command, "--smooth", a.smoothing, "smoothing passes of the curvature", inRange(0, 1000), shown);
    addRunOptions(command, a.run);
}

}  // namespace pellucid::cli
