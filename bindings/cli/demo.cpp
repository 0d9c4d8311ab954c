// pellucid demo: the whole chain on a real mesh: curvature, look-up tables, G-buffer, shading, pictures.

#include "demo.h"
#include "demo/demo_hair.h"
#include "io/atomic_file.h"
#include "mesh_curvature.h"
#include "system/process.h"

namespace pellucid::cli {
namespace {

// The table of stages on stderr, one line at the end of each: its time, and that of kernels in it.
class Stages {
  public:
    explicit Stages(const Run& run) : run_(run) {}
    nlohmann::ordered_json list = nlohmann::ordered_json::array();

    // Says on a terminal what is being done, until its line comes.
    static void begin(const std::string& name) {
        if (pel::system::errorsAreSeen())
            std::fprintf(stderr, "\r\033[K%s ...", name.c_str()), std::fflush(stderr);
    }
    template <class Work>
    void measure(const std::string& name, Work&& work) {
        begin(name);
        const double device = run_.deviceMilliseconds(), wall = milliseconds(work);
        add(name, wall, run_.deviceMilliseconds() - device);
    }
    // A stage that was measured elsewhere; `device` is 0 for work of the host. Milliseconds.
    void add(const std::string& name, double wall, double device = 0) {
        if (pel::system::errorsAreSeen()) std::fputs("\r\033[K", stderr);
        if (list.empty()) std::fprintf(stderr, "%-38s %9s %10s\n", "stage", "wall ms", "device ms");
        std::fprintf(stderr, "%-38s %9.1f", name.c_str(), wall);
        if (device > 0) std::fprintf(stderr, " %10.2f", device);
        std::fputs("\n", stderr);
        list.push_back({{"stage", name}, {"wall_ms", wall}, {"device_ms", device}});
    }

  private:
    const Run& run_;
};

// The OBJ file of the head that the demo shows when no mesh is named.
std::string standardHead() {
    const char* named = std::getenv("PELLUCID_DEMO_MESH");
    if (named && *named) return named;
    if (const std::string head = installed("heads/head_female.obj"); !head.empty()) return head;
    throw UsageError(
        "no mesh given, and the head that comes with pellucid is not in its share/pellucid/heads; name an "
        "OFF, OBJ, PLY or STL file");
}

// What the head is made of in the last row of the sheet, with tints for an albedo of skin, chosen by eye.
constexpr struct {
    const char* profile;
    float tint[3];
} demoMaterials[] = {{"skin-pale", {1.1f, 1.15f, 1.15f}}, {"skin-dark", {0.45f, 0.4f, 0.38f}},
                     {"marble", {1.05f, 1.4f, 1.6f}},     {"jade", {0.35f, 1.2f, 0.75f}},
                     {"paraffin", {1.15f, 1.35f, 1.1f}},  {"cream", {1.2f, 1.5f, 1.5f}}};
constexpr float headHeight = 240;  // mm, chin to crown of an adult with some neck

struct Arguments {
    Run::Options run;
    std::string mesh, output = "out/demo", size = "1280x720", up = "auto";
    uint32_t smoothing = 2;
    std::optional<int> subdivide;
    float height = headHeight;
    bool orient = false;
};

// Most OBJ files have y up, most scans in the other formats z.
bool yIsUp(const Arguments& a) {
    return a.up == "y" || (a.up == "auto" && std::filesystem::path(a.mesh).extension() == ".obj");
}

// Somebody's mesh: all of it is skin.
DemoHead loadMeshAsHead(Run& run, const Arguments& a) {
    DemoHead head;
    io::MeshLoadOptions load;
    load.orient = a.orient;
    head.mesh = io::loadMesh(a.mesh, load);
    io::MeshData& mesh = head.mesh;
    for (const std::string& warning : mesh.warnings) run.warn(warning);
    const bool y = yIsUp(a);
    head.pose = sample::poseWithUp(y ? 'y' : 'z');
    io::scaleToHeight(mesh, a.height, y ? 1 : 2);
    const int levels = a.subdivide.value_or(1);
    if (levels > 0) {
        try {
            io::loopSubdivide(mesh, levels);
        } catch (const io::FileError& e) {
            if (a.subdivide) throw;  // --subdivide was given
            run.warn(std::string("shown without subdivision: ") + e.what());
        }
    }
    if (mesh.normals.empty()) io::computeNormals(mesh);
    return head;
}

DemoHead loadHead(Run& run, const Arguments& a) {
    return demo::hasHeadParts(a.mesh) ? demo::loadDemoHead(a.mesh, a.subdivide.value_or(2))
                                      : loadMeshAsHead(run, a);
}

// A portrait with key, fill and rim light, and one with the key light behind an ear.
std::vector<DemoViewRequest> requests(const Arguments& a) {
    DemoViewRequest key, back;
    parseSize(a.size, key.width, key.height);
    key.name = "key";
    key.framing.azimuth = 25;
    key.lights = {{"Key", 54, 22, {0.92f, 0.845f, 0.76f}, true, 0.05},
                  {"Rim", -132, 25, {0.22f, 0.25f, 0.30f}}};
    key.skyScale = 0.16f;
    back = key;
    back.name = "backlit";
    back.lights = {{"Key", 174, 8, {2.8f, 2.64f, 2.43f}, false, 0.05},
                   {"Rim", -118, 20, {0.5f, 0.56f, 0.64f}}};
    back.skyScale = 0.2f;
    return {key, back};
}

// Shades a variant of a view's scene as a stage, uploads and kernels that are missing included.
std::vector<float> shadeAs(Run& run, Stages& stages, io::LutStore& luts, const DemoView& view,
                           const char* name, const io::SceneFile& scene) {
    std::vector<float> radiance;
    stages.measure(view.name + ": shade, " + name, [&] {
        io::SceneFrame frame(run.device(), view.gbuffer, scene, luts, view.images);
        frame.shade();
        radiance = frame.radiance();
    });
    return radiance;
}

// What each view is shaded as: Lambert, by tables, on the screen.
std::array<io::SceneFile, 3> scenesOf(const DemoView& view) {
    return {withoutScattering(view.scene), byTables(view.scene), view.scene};
}

// The pictures of a view rendered at twice the size, or none of a view that is large already.
std::vector<io::Picture> finePictures(Run& run, io::LutStore& luts, const sample::Scene& scene,
                                      const DemoHead& head, DemoViewRequest request) {
    constexpr uint64_t most = uint64_t(4096) * 2304;  // pixels; a G-buffer of them takes 1 GB
    request.width *= 2, request.height *= 2, request.rays /= 2;
    if (uint64_t(request.width) * request.height > most) return {};
    Stages::begin(request.name + ": pictures with smooth edges");
    const DemoView view = renderDemoView(scene, head, request);
    std::vector<io::Picture> pictures;
    for (const io::SceneFile& shown : scenesOf(view)) {
        io::SceneFrame frame(run.device(), view.gbuffer, shown, luts, view.images);
        frame.shade();
        pictures.push_back(developed(view, frame.radiance()));
    }
    return pictures;
}

// One view: G-buffer, shadings, files.
ShadedView shadeView(Run& run, Stages& stages, io::LutStore& luts, const sample::Scene& scene,
                     const DemoHead& head, const DemoViewRequest& request, const Arguments& a) {
    Stages::begin(request.name + ": G-buffer and shadow maps (sample host)");
    DemoView view = renderDemoView(scene, head, request);
    stages.add(view.name + ": G-buffer (sample host)", view.gbufferMilliseconds);
    stages.add(view.name + ": shadow maps (sample host)", view.shadowMapMilliseconds);

    const std::array<io::SceneFile, 3> scenes = scenesOf(view);
    stages.measure(view.name + ": kernels", [&] {
        for (const io::SceneFile& each : scenes) io::buildPrograms(run.device(), each, luts, view.images);
    });
    ShadedView shaded;
    shaded.lambert = shadeAs(run, stages, luts, view, "Lambert", scenes[0]);
    shaded.tables = shadeAs(run, stages, luts, view, "by tables", scenes[1]);
    shaded.complete = shadeAs(run, stages, luts, view, "on the screen", scenes[2]);
    stages.measure(view.name + ": pictures at twice the size",
                   [&] { shaded.fine = finePictures(run, luts, scene, head, request); });
    const std::string& folder = a.output;
    const auto path = [&](const std::string& suffix) { return folder + "/" + view.name + suffix; };
    io::writeExr(path("_gbuffer.exr"), view.gbuffer, io::ExrCompression::Rle);
    for (const auto& [file, image] : view.images)
        io::writeExr(folder + "/" + file, image, io::ExrCompression::Rle);
    io::writeScene(path(".toml"), view.scene);
    io::writeRadiance(path(".exr"), view.gbuffer.width, view.gbuffer.height, shaded.complete);
    shaded.view = std::move(view);
    run.report["pictures"].push_back(writePicture(folder, shaded));
    run.note("picture: " + run.report["pictures"].back().get<std::string>());
    return shaded;
}

void run(Arguments a) {
    if (a.mesh.empty()) a.mesh = standardHead();
    const std::vector<DemoViewRequest> wanted = requests(a);  // refuses a wrong size before any work
    Run run(a.run);
    Stages stages(run);
    run.note(std::string("device: ") + run.device().info().name);

    DemoHead head;
    stages.measure("load, subdivide, normals", [&] { head = loadHead(run, a); });
    checkFolder(a.output, "demo.png");  // not made for a mesh that is refused
    const io::MeshData& mesh = head.mesh;
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.smoothingPasses = a.smoothing;
    MeshCurvature curvature;
    stages.measure("curvature", [&] { curvature = meshCurvature(run, mesh, params); });
    reportMesh(run, curvature.report);

    io::LutStore luts(run.device());
    const io::SceneFile standard = standardLuts();
    Lut curvatureLut, shadowLut;
    const auto makeTable = [&](const char* title, const io::SceneLut& table, Lut& lut) {
        stages.measure(title, [&] { lut = luts.get(standard, table.name, table.info.kind); });
    };
    makeTable("curvature LUT", standard.luts[0], curvatureLut);
    makeTable("shadow LUT", standard.luts[1], shadowLut);

    const sample::Scene scene(sample::MeshView{mesh.positions, mesh.normals, mesh.uvs, curvature.values,
                                               mesh.triangles, head.materials});
    head.strands = demo::strandsOf(scene, head);
    std::vector<ShadedView> views;
    for (const DemoViewRequest& request : wanted)
        views.push_back(shadeView(run, stages, luts, scene, head, request, a));
    std::vector<io::Tile> materials;
    for (const auto& m : demoMaterials) {
        const DemoView made = madeOf(views.front().view, m.profile, m.tint);
        materials.push_back(
            {m.profile, developed(made, shadeAs(run, stages, luts, made, m.profile, made.scene))});
    }

    nlohmann::ordered_json& files = run.report["pictures"];
    files.push_back(writeSheet(a.output, views, materials, curvatureLut, shadowLut));
    const DemoView& backlit = views.back().view;
    // By tables, for thickness and transmission are parts of theirs alone.
    io::SceneFrame parts(
        run.device(), backlit.gbuffer, byTables(backlit.scene), luts, backlit.images,
        pelShaderOptionsDefaults(),
        {PEL_SLOT_OUT_DIFFUSE, PEL_SLOT_OUT_DEEP_SCATTER, PEL_SLOT_OUT_SPECULAR, PEL_SLOT_OUT_THICKNESS});
    parts.shade();
    files.push_back(writeParts(a.output, backlit, parts));
    run.report["output"] = a.output;
    run.report["stages"] = stages.list;
    run.finish();
}

}  // namespace

void addDemo(CLI::App& app) {
    auto [command, a] = subcommand<Arguments>(
        app, "demo", "The whole chain on a mesh: curvature, tables, G-buffer, shading, pictures", run);
    option(command, "mesh", a.mesh,
           "OFF, OBJ, PLY or STL file (default: a head that comes with pellucid, or $PELLUCID_DEMO_MESH)");
    option(command, "-o,--output", a.output, "folder for the pictures", shown);
    option(command, "--orient", a.orient,
           "of a mesh: turns triangles that face another way than their neighbours");
    option(command, "--size", a.size, "pixels, WxH", Word{"SIZE"}, shown);
    option(command, "--height", a.height, "mm that the mesh is scaled to, along its up axis", isPositive(),
           shown);
    option(command, "--up", a.up,
           "the mesh's up axis: z (it looks to -y), y (it looks to +z), or auto: y for OBJ files",
           isOneOf({"auto", "y", "z"}), shown);
    option(command, "--subdivide", a.subdivide,
           "levels of subdivision (default: 2 for the heads that come with pellucid, 1 for other meshes that "
           "allow it)",
           inRange(0, 4));
    option(command, "--smooth", a.smoothing, "smoothing passes of the curvature", inRange(0, 1000), shown);
    addRunOptions(command, a.run);
}

}  // namespace pellucid::cli
