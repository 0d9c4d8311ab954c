// pellucid import: glTF files made here and samples of Debian's assimp-testmodels, to the picture.
#include "cli/cli_run.h"
#include "gltf/tests/gltf_bytes.h"
#include "io/image/color_map.h"
#include "io/lut/profile_file.h"
#include "io/mesh/mesh_file.h"
#include "io/scene/scene_file.h"

using namespace pellucid;
using namespace nlohmann::literals;
namespace fs = std::filesystem;

namespace {

const fs::path samples = "/usr/share/assimp/models/glTF2";

class Import : public CommandTest {
  protected:
    std::string out(const std::string& name = "") const {
        return path("out") + (name.empty() ? "" : "/" + name);
    }
    static bool draws() { return fs::exists(fs::path(PELLUCID_BINARY_DIR) / "host/libpellucid_sample.a"); }
    Result shaded() const {
        return cli("shade @out/gbuffer.exr --scene @out/scene.toml -o @out/radiance.exr");
    }
    // The mean of R, G and B where there is a material.
    std::vector<double> mean() const {
        const io::Image picture = io::readImage(out("radiance.exr")), g = io::readImage(out("gbuffer.exr"));
        const std::vector<float>& ids = g.channel("Material.I").pixels;
        std::vector<double> sum(4);
        for (size_t i = 0; i < ids.size(); ++i) {
            if (ids[i] == 0) continue;
            for (size_t c = 0; c < 3; ++c) sum[c] += picture.channel(std::string(1, "RGB"[c])).pixels[i];
            ++sum[3];
        }
        for (size_t c = 0; c < 3; ++c) sum[c] /= sum[3];
        return sum;
    }
};

// A ball of 2 cm, of one material, with these members of the root.
std::string ball(const nlohmann::json& material, const nlohmann::json& more = nlohmann::json::object()) {
    constexpr int rings = 24, segments = 48;
    std::vector<float> positions;
    std::vector<uint32_t> indices;
    for (int r = 0; r <= rings; ++r)
        for (int s = 0; s <= segments; ++s) {
            const double a = M_PI * r / rings, b = 2 * M_PI * s / segments;
            for (const double x : {std::sin(a) * std::sin(b), std::cos(a), std::sin(a) * std::cos(b)})
                positions.push_back(float(0.02 * x));
        }
    for (uint32_t r = 0; r < rings; ++r)
        for (uint32_t s = 0; s < segments; ++s) {
            const uint32_t at = r * (segments + 1) + s, below = at + segments + 1;
            for (const uint32_t i : {at, below, at + 1, at + 1, below, below + 1}) indices.push_back(i);
        }
    const std::string p = gltf::bytesOf(positions), i = gltf::bytesOf(indices);
    nlohmann::json scene = nlohmann::json::parse(R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}], "meshes": [{"primitives": [
            {"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}]})");
    scene["materials"] = {material};
    scene["buffers"] = {{{"byteLength", p.size() + i.size()}}};
    scene["bufferViews"] = {{{"buffer", 0}, {"byteLength", p.size()}},
                            {{"buffer", 0}, {"byteOffset", p.size()}, {"byteLength", i.size()}}};
    scene["accessors"] = {
        {{"bufferView", 0}, {"componentType", 5126}, {"count", positions.size() / 3}, {"type", "VEC3"}},
        {{"bufferView", 1}, {"componentType", 5125}, {"count", indices.size()}, {"type", "SCALAR"}}};
    scene.update(more);
    return gltf::glb(scene.dump(), p + i);
}

}  // namespace

TEST_F(Import, ABallOfWaxBecomesAPicture) {
    const std::string wax = ball(R"({"name": "Candle wax", "pbrMetallicRoughness":
            {"baseColorFactor": [0.9, 0.8, 0.7, 1], "metallicFactor": 0, "roughnessFactor": 0.6},
        "extensions": {"KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 1},
            "KHR_materials_volume": {"thicknessFactor": 0.02, "attenuationDistance": 0.0015,
                                     "attenuationColor": [0.4, 0.3, 0.1]},
            "KHR_materials_volume_scatter": {"multiscatterColor": [0.95, 0.8, 0.5]}}})"_json);
    write("wax.glb", wax);
    const nlohmann::json report = reportOf("import @wax.glb -o @out --size 96x96");
    expectReport(report);
    EXPECT_EQ(report["materials"][0]["name"], "Candle wax");
    EXPECT_EQ(report["materials"][0]["taken_for"], "volume");
    EXPECT_EQ(report["materials"][0]["profile"], "Candle_wax.toml");
    const io::MeshData mesh = io::loadMesh(out("mesh.obj"));
    EXPECT_EQ(mesh.triangleCount(), size_t(2 * 24 * 48));
    float largest = 0;
    for (const float x : mesh.positions) largest = std::max(largest, x);
    EXPECT_NEAR(largest, 20, 1e-4);  // mm
    const io::SceneFile scene = io::readScene(out("scene.toml"));
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].profile, out("Candle_wax.toml"));
    const PelProfileInfo info = io::findProfile(out("Candle_wax.toml")).profile.info();
    EXPECT_GT(info.width[0], info.width[2]);
    expectKeptText("out/Candle_wax.toml", "wax_profile.toml");
    if (!draws()) GTEST_SKIP() << "this build has no renderer";
    expectKeptText("out/scene.toml", "wax_scene.toml");
    ASSERT_EQ(shaded().exitCode, 0);
    const std::vector<double> color = mean();
    EXPECT_GT(color[3], 96 * 96 / 3);
    EXPECT_GT(color[0], 0.15);
    EXPECT_GT(color[0], 1.3 * color[2]);
    done("shade @out/gbuffer.exr --scene @out/scene.toml -o @wax.png");
    expectKept("wax.png", "wax.png", "0.0003");
    // The curvature that was measured is that of the ball.
    const io::Image g = io::readImage(out("gbuffer.exr"));
    const float middle = g.channel("Curvature.V").pixels[48 * 96 + 48];
    EXPECT_NEAR(middle, 1 / 20.0, 0.003);
    EXPECT_GT(g.channel("Thickness.V").pixels[48 * 96 + 48], 60);  // mm: no sheet
}

TEST_F(Import, LightsCamerasAndProfilesOfOnesOwn) {
    const std::string file = ball(R"({"name": "Head", "pbrMetallicRoughness": {"metallicFactor": 0}})"_json,
                                  R"({"cameras": [{"type": "perspective",
                        "perspective": {"yfov": 0.5, "znear": 0.01, "aspectRatio": 1.5}}],
            "extensions": {"KHR_lights_punctual": {"lights": [
                {"type": "directional", "intensity": 3.1415927}, {"type": "spot", "intensity": 0.02},
                {"type": "point", "intensity": 0.001}]}},
            "nodes": [{"mesh": 0, "children": [1, 2, 3, 4]}, {"camera": 0, "translation": [0, 0, 0.12]},
                {"extensions": {"KHR_lights_punctual": {"light": 0}}},
                {"extensions": {"KHR_lights_punctual": {"light": 1}}, "translation": [0, 0, 0.1]},
                {"extensions": {"KHR_lights_punctual": {"light": 2}}, "translation": [0.1, 0, 0.1]}]})"_json);
    write("head.glb", file);
    const nlohmann::json report =
        reportOf("import @head.glb -o @out --profile Head=skin --profile jade --lights 1");
    write("named.glb", ball(R"({"name": "a\u001b[1m\nb"})"_json));
    EXPECT_TRUE(contains(done("import @named.glb -o @named --size 8x8").out, "material 1: a\\x1b[1m\\x0ab,"));
    EXPECT_TRUE(
        contains(cli("import @named.glb -o @named --profile nope=skin").err, "there are a\\x1b[1m\\x0ab"));
    EXPECT_TRUE(contains(done("import @named.glb -o @named --size 8x8 --lights 2").err,
                         "the scene has no lights, so their factor is without effect"));
    EXPECT_EQ(report["materials"][0]["profile"], "skin");
    EXPECT_EQ(report["lights"], 3);
    if (draws()) {
        expectKeptText("out/scene.toml", "head_scene.toml");
        ASSERT_EQ(shaded().exitCode, 0);
        EXPECT_GT(mean()[0], 0.2);
        const io::Image g = io::readImage(out("gbuffer.exr"));
        EXPECT_EQ(g.width, 1024);
        EXPECT_EQ(g.height, 682);
    }
    refused("import @head.glb -o @out --profile Neck=skin", 2, "there are Head");
    refused("import @head.glb -o @out --profile granite", 3, "granite");
    refused("import @head.glb -o @out --camera 7", 2, "the scene has 1");
}

// A square that fills the picture: each pixel's albedo is the factor times the texture between its texels,
// which repeats. Images that cannot be read are left out, those after them are not.
TEST_F(Import, TexturesMultiplyTheAlbedo) {
    if (!draws()) GTEST_SKIP() << "this build has no renderer";
    constexpr int width = 3, height = 2, size = 12;
    std::vector<uint8_t> colors(3 * width * height), greys(width * height);
    for (size_t i = 0; i < colors.size(); ++i) colors[i] = uint8_t(40 + 12 * i);
    for (size_t i = 0; i < greys.size(); ++i) greys[i] = uint8_t(50 + 40 * i);
    io::writeImage8(path("colors.png"), width, height, 3, colors);
    io::writeImage8(path("greys.png"), width, height, 1, greys);
    write("none.png", "GIF89a");
    write("bad.png", read(path("colors.png")).substr(0, 60));
    for (const bool grey : {false, true}) {
        const std::string file = gltf::square(
            R"(,"material":0)", R"([{"mesh":0,"children":[1]},{"camera":0,"translation":[0.5,0.5,1]}])",
            io::concat(
                R"(,"cameras":[{"type":"perspective","perspective":{"yfov":0.92729522,"znear":0.1}}],)",
                R"("images":[{"uri":"none.png"},{"uri":"bad.png"},{"uri":")", grey ? "greys" : "colors",
                R"(.png"}],"textures":[{"source":0},{"source":2}],"materials":[{"pbrMetallicRoughness":)",
                R"({"metallicFactor":0,"baseColorFactor":[1,0.5,0.25,1],"baseColorTexture":{"index":1}}}])"));
        write("square.glb", file);
        reportOf("import @square.glb -o @out --size 12x12");
        const std::string obj = read(out("mesh.obj"));
        EXPECT_TRUE(contains(obj, "\nvt 0 1\nvt 1 1\nvt 1 0\nvt 0 0\n")) << obj;
        const io::Image g = io::readImage(out("gbuffer.exr"));
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                for (int c = 0; c < 3; ++c) {
                    const double u = (x + 0.5) / size * width - 0.5,
                                 v = (1 - (y + 0.5) / size) * height - 0.5;
                    double expected = 0;
                    for (int k = 0; k < 4; ++k) {
                        const double tx = std::floor(u) + k % 2, ty = std::floor(v) + k / 2;
                        const int texel = int(ty + height) % height * width + int(tx + width) % width;
                        expected += (1 - std::abs(u - tx)) * (1 - std::abs(v - ty)) *
                                    io::decodeSrgb(grey ? greys[size_t(texel)] / 255.0f
                                                        : colors[size_t(3 * texel + c)] / 255.0f);
                    }
                    ASSERT_NEAR(g.channel(std::string("Albedo.") + "RGB"[c]).pixels[size_t(y * size + x)],
                                expected / (1 << c), 1e-4)
                        << x << " " << y << " " << c << " " << grey;
                }
    }
}

// Each camera is drawn, or left out with a warning; what is written can be shaded.
TEST_F(Import, CamerasFarAwayAndBentOutOfShape) {
    for (const char* place :
         {R"("translation":[0,0,1e12])", R"("translation":[-1e12,0,0])",
          R"("translation":[0,0,5],"scale":[0,0,0])", R"("matrix":[1,0,0,0, 0,0,1,0, 0,0,1,0, 0,0,3,1])",
          R"("translation":[0.5,0.5,99000])"}) {
        const std::string nodes = std::string(R"([{"mesh":0,"children":[1]},{"camera":0,)") + place + "}]";
        const std::string file = gltf::square(
            "", nodes, R"(,"cameras":[{"type":"perspective","perspective":{"yfov":0.5,"znear":0.1}}])");
        SCOPED_TRACE(place);
        write("far.glb", file);
        done("import @far.glb -o @out --size 32x32");
        EXPECT_NO_THROW(io::readScene(out("scene.toml")));
        if (draws()) {
            EXPECT_EQ(shaded().exitCode, 0);
        }
    }
}

TEST_F(Import, RefusesWhatIsWrong) {
    write("a.glb", "glTF");
    write("a.obj", "v 0 0 0");
    write("b.gltf", gltf::squareJson("", R"([{"mesh":0}])", "", R"(,"uri":"none.bin")"));
    refused("import @none.glb -o @out", 3, "none.glb");
    refused("import @a.glb -o @out", 3, "a.glb: ends within the header");
    refused("import @a.obj -o @out", 2, "a.obj");
    refused("import @b.gltf -o @out", 3, "none.bin");
}

// The files of assimp's tests: good files become pictures, bad ones give a message; nothing crashes.
TEST_F(Import, SamplesOfOtherPeople) {
    if (!fs::exists(samples)) GTEST_SKIP() << "Debian's assimp-testmodels is not installed";
    const std::map<std::string, std::vector<std::string>> bad = {
        // what the message says
        {"BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb", {"not finite"}},
        {"IncorrectVertexArrays/Cube.gltf", {"accessors", "meshes"}},
        {"IndexOutOfRange/IndexOutOfRange.gltf", {"index"}},
        {"IndexOutOfRange/AllIndicesOutOfRange.gltf", {"index"}},
        {"MissingBin/BoxTextured.gltf", {"BoxTextured0.bin"}},
        {"RecursiveNodes/RecursiveNodes.gltf", {"nodes["}},
        {"TestNoRootNode/SceneWithoutNodes.gltf", {"no triangles"}},
        {"draco/2CylinderEngine.gltf", {"KHR_draco_mesh_compression"}}};
    size_t good = 0, refused = 0;
    for (const auto& entry : fs::recursive_directory_iterator(samples)) {
        const std::string extension = entry.path().extension().string();
        if (extension != ".gltf" && extension != ".glb") continue;
        const std::string name = fs::relative(entry.path(), samples).string();
        fs::remove_all(out());
        const Result result = cli("import '" + entry.path().string() + "' -o @out --size 48x48");
        const auto known = bad.find(name);
        if (result.exitCode == 3) {
            ++refused;
            EXPECT_TRUE(contains(result.err, entry.path().filename().string())) << name << "\n" << result.err;
            bool said = known == bad.end();
            if (known != bad.end())
                for (const std::string& word : known->second) said |= contains(result.err, word);
            EXPECT_TRUE(said) << name << ": " << result.err;
            EXPECT_FALSE(fs::exists(out("scene.toml"))) << name;
            continue;
        }
        ASSERT_EQ(result.exitCode, 0) << name << "\n" << result.err;
        EXPECT_EQ(known, bad.end()) << name << " was taken";
        ++good;
        EXPECT_NO_THROW(io::readScene(out("scene.toml"))) << name;
        EXPECT_NO_THROW(io::loadMesh(out("mesh.obj"))) << name;
        if (draws() && good % 6 == 1) {
            EXPECT_EQ(shaded().exitCode, 0) << name;
        }
    }
    EXPECT_GT(good, 12u);
    EXPECT_GE(refused, bad.size());
}
