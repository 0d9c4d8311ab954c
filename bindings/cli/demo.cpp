// pellucid demo: the whole chain on a real mesh: curvature, look-up tables, G-buffer, shading, pictures.

#include "demo.h"
#include "demo/demo_hair.h"
#include "io/atomic_file.h"
#include "mesh_curvature.h"
#include "sample/occlusion.h"
#include "system/process.h"

namespace pellucid::cli {
namespace {

// The table of stages on stderr, one line at the end of each: its time, and that of kernels in it.
class Stages {
  public:
    explicit Stages(const Run& run) : run_(run) {}
    nlohmann::ordered_json list = nlohmann::ordered_json::array();

    // Returns milliseconds. On a terminal it shows the current stage until the stage's line is printed.
    template <class Work>
    void measure(const std::string& name, Work&& work) {
        const bool seen = pel::system::errorsAreSeen();
        if (seen) std::fprintf(stderr, "\r\033[K%s ...", name.c_str()), std::fflush(stderr);
        const double before = run_.deviceMilliseconds(), wall = milliseconds(work),
                     device = run_.deviceMilliseconds() - before;
        if (seen) std::fputs("\r\033[K", stderr);
        if (list.empty()) std::fprintf(stderr, "%-41s %9s %10s\n", "stage", "wall ms", "device ms");
        std::fprintf(stderr, "%-41s %9.1f", name.c_str(), wall);
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

// The materials of the head in the last row of the sheet, with tints of the skin's albedo, chosen by eye.
constexpr struct {
    const char* profile;
    float tint[3];
} demoMaterials[] = {{"skin-pale", {1.1f, 1.15f, 1.15f}}, {"skin-dark", {0.45f, 0.4f, 0.38f}},
                     {"marble", {1.05f, 1.4f, 1.6f}},     {"jade", {0.35f, 1.2f, 0.75f}},
                     {"paraffin", {1.15f, 1.35f, 1.1f}},  {"cream", {1.2f, 1.5f, 1.5f}}};
constexpr float headHeight = 240;  // mm, chin to crown of an adult with some neck

struct DemoArguments {
    Run::Options run;
    std::string mesh, output = "out/demo", size = "1280x720", up = "auto";
    uint32_t smoothing = 2;
    std::optional<int> subdivide;
    float height = headHeight;
    bool orient = false;
};

// A mesh of the user: all of it is skin.
DemoHead loadMeshAsHead(Run& run, const DemoArguments& a) {
    DemoHead head;
    io::MeshLoadOptions load;
    load.orient = a.orient;
    head.mesh = io::loadMesh(a.mesh, load);
    io::MeshData& mesh = head.mesh;
    for (const std::string& warning : mesh.warnings) run.warn(warning);
    // Most OBJ files have y up, most scans in the other formats z.
    const bool y = a.up == "y" || (a.up == "auto" && io::extensionOf(a.mesh) == "obj");
    head.pose = sample::poseWithUp(y ? 'y' : 'z');
    io::scaleToHeight(mesh, a.height, y ? 1 : 2);
    try {
        io::loopSubdivide(mesh, a.subdivide.value_or(1));
    } catch (const io::FileError& e) {
        if (a.subdivide) throw;  // --subdivide was given
        run.warn(std::string("shown without subdivision: ") + e.what());
    }
    if (mesh.normals.empty()) io::computeNormals(mesh);
    return head;
}

DemoHead loadHead(Run& run, const DemoArguments& a) {
    return demo::hasHeadParts(a.mesh) ? demo::loadDemoHead(a.mesh, a.subdivide.value_or(2))
                                      : loadMeshAsHead(run, a);
}

// A portrait with key, fill and rim light, and one with the key light behind an ear.
std::vector<DemoViewRequest> requests(const DemoArguments& a) {
    DemoViewRequest key, back;
    parseSize(a.size, {&key.width, &key.height});
    key.name = "key";
    key.framing.azimuth = 25;
    key.lights = {{"Key", 54, 22, {0.92f, 0.845f, 0.76f}, true},
                  {"Rim", -132, 25, {0.22f, 0.25f, 0.30f}, true, 0.1}};
    key.skyScale = 0.16f;
    back = key;
    back.name = "backlit";
    back.lights = {{"Key", 179, 8, {2.8f, 2.64f, 2.43f}, false},
                   {"Rim", -118, 20, {0.5f, 0.56f, 0.64f}, true, 0.1}};
    back.skyScale = 0.2f;
    return {key, back};
}

// Shades a variant of a view's scene as a stage, including uploads and the compilation of missing kernels.
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

// One view: G-buffer, shadings, files.
ShadedView shadeView(Run& run, Stages& stages, io::LutStore& luts, const DemoBody& body,
                     const DemoSurface& surface, const DemoViewRequest& request, const std::string& folder) {
    DemoView view;
    ShadedView shaded;
    stages.measure(request.name + ": light and shadow maps (sample host)", [&] {
        shaded.light = renderDemoLight(body, surface, request);
        view = renderDemoView(body, surface, shaded.light, request);
    });
    const std::array<io::SceneFile, 3> scenes = scenesOf(view);
    stages.measure(view.name + ": kernels", [&] {
        for (const io::SceneFile& each : scenes) io::buildPrograms(run.device(), each, luts, view.images);
    });
    for (size_t i = 0; i < std::size(demoVariants); ++i)
        shaded.radiance[i] = shadeAs(run, stages, luts, view, demoVariants[i], scenes[i]);
    const auto path = [&](const std::string& suffix) { return folder + "/" + view.name + suffix; };
    io::writeExr(path("_gbuffer.exr"), view.gbuffer, io::ExrCompression::Rle);
    for (const auto& [file, image] : view.images)
        io::writeExr(folder + "/" + file, image, io::ExrCompression::Rle);
    io::writeScene(path(".toml"), view.scene);
    io::writeRadiance(path(".exr"), view.gbuffer.width, view.gbuffer.height, shaded.radiance[DEMO_COMPLETE]);
    shaded.view = std::move(view);
    return shaded;
}

// Adds pictures rendered at twice the size, except for views that are large already.
void addFinePictures(Run& run, Stages& stages, io::LutStore& luts, const DemoBody& body,
                     const DemoSurface& coarse, std::vector<DemoViewRequest> requests,
                     std::vector<ShadedView>& views) {
    constexpr uint64_t most = uint64_t(4096) * 2304;  // pixels; a G-buffer of them takes 1 GB
    for (DemoViewRequest& r : requests) r.width *= 2, r.height *= 2;
    if (uint64_t(requests[0].width) * requests[0].height > most) return;
    stages.measure("pictures at twice the size", [&] {
        const DemoSurface surface = renderDemoSurface(body, requests[0], &coarse);
        for (size_t i = 0; i < views.size(); ++i) {
            DemoView view{requests[i].name, views[i].view.scene, views[i].view.images};
            DemoLightImages light = std::move(views[i].light);
            const auto enlarge = [&](sample::Image& image) {
                image = sample::enlarged(image, coarse.gbuffer, surface.gbuffer);
            };
            std::ranges::for_each(light.shadows, enlarge);
            enlarge(light.indirect);
            addPixels(view, body, surface, light, requests[i]);
            for (const io::SceneFile& shown : scenesOf(view)) {
                io::SceneFrame frame(run.device(), view.gbuffer, shown, luts, view.images);
                frame.shade();
                views[i].fine.push_back(developed(view, frame.radiance()));
            }
        }
    });
}

void runDemo(DemoArguments a) {
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
    const sample::Scene hair(demo::curvesOf(head.strands));
    const DemoBody body{head, scene, hair};
    DemoSurface surface;  // all views have one camera
    stages.measure("G-buffer (sample host)", [&] { surface = renderDemoSurface(body, wanted[0]); });
    std::vector<ShadedView> views;
    for (const DemoViewRequest& request : wanted)
        views.push_back(shadeView(run, stages, luts, body, surface, request, a.output));
    addFinePictures(run, stages, luts, body, surface, wanted, views);
    for (const ShadedView& view : views) {
        run.report["pictures"].push_back(writePicture(a.output, view));
        run.note("picture: " + run.report["pictures"].back().get<std::string>());
    }
    DemoView bust;
    stages.measure("a bust for other materials (sample host)", [&] {
        const DemoHead plain = demo::bustOf(head);
        const sample::Scene noHair{sample::Curves{}};
        const DemoBody bald{plain, scene, noHair};
        DemoViewRequest request = wanted[0];
        request.rays /= 2;  // nothing is as fine as hair
        surface = renderDemoSurface(bald, request);
        const DemoView& key = views.front().view;
        bust = {key.name, key.scene, key.images};  // the shadow maps are those of the same mesh
        bust.scene.eyes.clear();
        bust.scene.materials.resize(1);
        bust.scene.channels[PEL_SLOT_WETNESS].clear();
        addPixels(bust, bald, surface, renderDemoLight(bald, surface, request), request);
    });
    std::vector<io::Tile> materials;
    for (const auto& m : demoMaterials) {
        const bool skin = std::string_view(m.profile).starts_with("skin");
        const DemoView made = madeOf(skin ? views.front().view : bust, m.profile, m.tint);
        materials.push_back(
            {m.profile, developed(made, shadeAs(run, stages, luts, made, m.profile, made.scene))});
    }

    nlohmann::ordered_json& files = run.report["pictures"];
    files.push_back(writeSheet(a.output, views, materials, curvatureLut, shadowLut));
    const DemoView& backlit = views.back().view;
    // By tables, because only they give thickness and transmission as separate parts.
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
    auto [command, a] = subcommand<DemoArguments>(
        app, "demo", "The whole chain on a mesh: curvature, tables, G-buffer, shading, pictures", runDemo);
    option(command, "mesh", a.mesh,
           "OFF, OBJ, PLY or STL file (default: a head that comes with pellucid, or $PELLUCID_DEMO_MESH)");
    option(command, "-o,--output", a.output, "folder for the pictures", shown);
    option(command, "--orient", a.orient,
           "of a mesh: flips triangles whose orientation differs from their neighbours'");
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
