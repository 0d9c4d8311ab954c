#include "fuzz/readers.h"

#include "batch/batch_manifest.h"
#include "io/lut/profile_file.h"
#include "io/scene/scene_file.h"
#include "measure/report.h"

namespace fuzz {
namespace {

using namespace pellucid;

const std::string tomlWords =
    R"([[ ]] [ ] { } """ ''' = . , inf nan 1e400 -1 9223372036854775807 0x7f \u0000 true 2020-01-01 a.b.c ")";

Reader text(const std::string& name, std::vector<std::string> seeds,
            std::function<void(const std::string&)> read, const std::vector<std::string>& more) {
    Reader r{name, std::move(seeds), std::move(read), {}, wordsOf(tomlWords)};
    r.words.emplace_back("\n");
    r.words.insert(r.words.end(), more.begin(), more.end());
    return r;
}

io::SceneFile scene() {
    io::SceneFile s;
    s.channels[PEL_SLOT_NORMAL_SHADING] = {"N.X", "N.Y", "N.Z"};
    s.channels[PEL_SLOT_DEPTH] = {"Z"};
    s.outputs[PEL_SLOT_OUT_DIFFUSE] = "../d.exr";
    s.lights.resize(2);
    s.lights[0].shadowMapFile = "map.exr";
    s.materials.resize(1);
    s.materials[0].curvatureLut = "skin";
    s.eyes.resize(1);
    s.eyes[0].irisTexture = "iris.png";
    s.eyes[0].irisProfile = "skin";
    s.options.targetError = 0.5f;
    s.luts.resize(1);
    s.luts[0].name = "skin";
    return s;
}

}  // namespace

std::vector<Reader> readers() {
    const Folder folder;
    const Device device("");
    std::vector<Reader> all;
    addMeshes(all, folder);
    addImages(all, folder);
    all.push_back(table(folder, device));
    const std::string head = "name = \"a\"\nsource = \"s\"\nkind = ";
    const std::vector<std::string> profiles{
        head + "\"skin\"\n",
        head +
            "\"dipole\"\nunit = \"mm\"\nabsorption = [0.0021, 0.0041, 0.0071]\n"
            "reduced_scattering = [2.19, 2.62, 3.00]\neta = 1.5\n",
        head +
            "\"burley\"\nunit = \"cm\"\nmean_free_path = [1.3, 0.95, 0.67]\n"
            "albedo = [0.44, 0.22, 0.13]\nfit = \"searchlight\"\n",
        head + "\"burley\"\nunit = \"um\"\ndistance = [300, 100, 50]\n",
        head +
            "\"table\"\nunit = \"mm\"\n[[sample]]\ndistance = 0\nvalue = [1, 1, 1]\n"
            "[[sample]]\ndistance = 2\nvalue = [0, 0, 0]\n"};
    all.push_back(text(
        "profile", profiles, [](const std::string& t) { io::parseProfile("p.toml", t); },
        {"variance", "weight", "albedo", "mean_free_path", "eta", "table", "[[gaussian]]", "[[sample]]"}));
    io::writeScene(folder / "s.toml", scene());
    all.push_back(text("scene", {bytesOf(folder / "s.toml")},
                       [](const std::string& t) {
                           // A scene that can be read can be written, and read again.
                           io::parseScene("s.toml", io::sceneText(io::parseScene("s.toml", t)));
                       },
                       {"[[light]]", "[[material]]", "[channels]", "[outputs]", "shadow_map", "cascade_1",
                        "thickness_taps", "version = 2", "[[eye]]", "iris_radius", "limbus_radius",
                        "iris_texture", "caustics", "target_error"}));
    all.push_back(
        text("manifest",
             {"[[lut]]\nkind = \"shadow\"\nsize = 256\n[[grid]]\nkind = \"curvature\"\nprofile = [\"skin\", "
              "\"own.toml\"]\ndiffusion_radius = [1.0, 2.7]\nform = [\"arc\", \"sphere\"]\naxis = "
              "\"root\"\nsize = [32, 64]\nencoding = \"half\"\nradius_min = 1.0\n"},
             [own = profiles[1]](const std::string& t) {
                 io::parseManifest("m.toml", t, {{"own.toml", own}});
             },
             {"[[lut]]", "[[grid]]", "size", "profile", "encoding", "16384", "specular"}));
    all.push_back(topology(device));
    all.push_back(gltfScenes(folder));
    all.push_back(
        {"report",
         {R"({"host":{"pellucid":"0","date":"","cpu":"c"},"devices":[{"name":"a","platform":"p",)"
          R"("copy_bytes_per_second":1e10,"operations_per_second":1e11,"operations":[{"name":"o",)"
          R"("group":"tables","items":100,"samples":9,"median_ms":1.5,"mad_ms":0.1,"error_max":1e-6},)"
          R"({"name":"q","group":"tables","items":1,"failed":"x"}]}]})"},
         [](const std::string& t) {
             const auto report = bench::parseReport(t);
             if (report.is_discarded()) return;
             bench::describeComparison(bench::compareReports(report, report));
         },
         {},
         {"null", "{}", "[]", "1e999", "-0", "\"\"", "\\u0000", ","}});
    return all;
}

bool promised(const std::exception& error) {
    return dynamic_cast<const io::FileError*>(&error) || dynamic_cast<const Error*>(&error) ||
           dynamic_cast<const nlohmann::json::exception*>(&error);
}

}  // namespace fuzz
