// host/io/scene/scene_file.h: the documentation's example, round trip, a message for each kind of mistake.
#include "io/image/image_file.h"
#include "io/scene/scene_file.h"
#include "io/spelling.h"
#include "io/toml_reader.h"
#include "io_files.h"

using namespace pellucid::io;

namespace {

class SceneFileTest : public FolderTest {
  protected:
    // The documentation's example, with `from` replaced by `to` if given.
    std::string example(const std::string& from = "", const std::string& to = "") const {
        const std::string page = read(PELLUCID_SOURCE_DIR "/docs/guide/scene-file.md");
        const size_t begin = page.find("```toml\n") + 8;
        std::string text = page.substr(begin, page.find("```", begin) - begin);
        if (!from.empty()) {
            const size_t at = text.find(from);
            EXPECT_NE(at, std::string::npos) << from;
            text.replace(at, from.size(), to);
        }
        return text;
    }
    std::string errorOf(const std::string& from, const std::string& to) const {
        const std::string file = write("s.toml", example(from, to));
        return messageOf<FileError>([&] { readScene(file); });
    }
    struct Mistake {
        const char *from, *to, *message;
    };
    void expectErrors(const std::vector<Mistake>& mistakes) const {
        for (const auto& m : mistakes) EXPECT_TRUE(contains(errorOf(m.from, m.to), m.message)) << m.to;
    }
    // The line of the example that starts with `start`, as the error shows it.
    std::string at(const std::string& start) const {
        const std::string text = "\n" + example();
        const size_t place = text.find("\n" + start);
        EXPECT_NE(place, std::string::npos) << start;
        return "s.toml:" +
               std::to_string(1 + std::count(text.begin(), text.begin() + static_cast<long>(place), '\n')) +
               ": ";
    }
};

// Another value that the field of a row of pellucid_fields.h may have.
template <class T>
void change(T& field, float min, float max, float special) {
    if constexpr (std::is_array_v<T>)
        for (auto& f : field) change(f, min, max, special);
    else if constexpr (std::is_integral_v<T>)
        field = T(std::clamp(16.0f, min, max));
    else
        field = std::clamp(field == special ? 0.5f : 1.01f * field + 0.01f, min, max);
}
#define CHANGE(type, name, value, min, max, special, ...) change(s.name, min, max, special);

}  // namespace

TEST_F(SceneFileTest, TheDocumentedExampleIsRead) {
    const SceneFile scene = readScene(write("s.toml", example()));
    EXPECT_EQ(scene.channels[PEL_SLOT_POSITION],
              (std::vector<std::string>{"Position.X", "Position.Y", "Position.Z"}));
    EXPECT_EQ(scene.channels[PEL_SLOT_CURVATURE], (std::vector<std::string>{"Curvature.C"}));
    EXPECT_TRUE(scene.channels[PEL_SLOT_NORMAL_BLURRED].empty());
    EXPECT_EQ(scene.camera.position[2], 600.0f);
    EXPECT_EQ(scene.ambient.sh[1][2], 0.03f);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.lights[0].light.color[2], 0.9f);
    EXPECT_EQ(scene.lights[0].shadowMapFile, path("shadow_map.exr"));
    EXPECT_EQ(scene.lights[0].light.shadowDepthRange, 1000.0f);
    EXPECT_EQ(scene.lights[0].light.worldToShadow[3], 0.5f);
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].material.deepScatterColor[1], 0.08f);
    EXPECT_EQ(scene.materials[0].material.f0, pelMaterialDefaults().f0);
    ASSERT_NE(scene.lut("skin", PEL_LUT_CURVATURE), nullptr);
    EXPECT_EQ(scene.lut("skin", PEL_LUT_CURVATURE)->info.curvature.radiusMax, 100.0f);
    EXPECT_EQ(scene.lut("skin", PEL_LUT_SHADOW)->file, path("shadow_lut.exr"));
    const std::string capital = write("s.toml", example("id = 1", "id = 1\nprofile = \"Mine.TOML\""));
    EXPECT_EQ(readScene(capital).materials.at(0).profile, path("Mine.TOML"));
}

TEST_F(SceneFileTest, DirectionsAreMadeUnit) {
    const std::string to = "to_light = [0.6, 0.3, 0.742]", spot = "type = \"directional\"";
    const SceneFile sun = readScene(write("s.toml", example(to, "to_light = [3, 0, 4e3]")));
    EXPECT_FLOAT_EQ(sun.lights[0].light.toLight[0], float(3 / std::hypot(3, 4e3)));
    EXPECT_FLOAT_EQ(sun.lights[0].light.toLight[2], float(4e3 / std::hypot(3, 4e3)));
    const SceneFile lamp = readScene(write(
        "s.toml", example(spot, "type = \"spot\"\nposition = [1, 2, 3]\nspot_direction = [0, -1e-3, 0]")));
    EXPECT_EQ(lamp.lights[0].light.spotDirection[1], -1.0f);
    EXPECT_TRUE(contains(errorOf(to, "to_light = [0, 0.0, 0]"),
                         at("to_light") + "'to_light' in [[light]] is (0, 0, 0)"));
}

// Values that a material takes from its profile are not written.
TEST_F(SceneFileTest, DefaultsOfAMaterialStayDefaults) {
    SceneFile scene = readScene(write("s.toml", example()));
    scene.materials[0] = SceneMaterial();
    scene.materials[0].profile = "marble";
    writeScene(path("out.toml"), scene);
    const SceneFile again = readScene(path("out.toml"));
    EXPECT_EQ(again.materials[0].profile, "marble");
    EXPECT_EQ(again.materials[0].material.normalBlend[0], -1);
    EXPECT_EQ(again.materials[0].material.shadowFilterWidth, 0);
    EXPECT_EQ(again.materials[0].material.diffusionRadius, 0);
    EXPECT_EQ(again.options.millimetresPerUnit, 1);
}

// Every field that a file can hold, at another value than its default, and all names.
TEST_F(SceneFileTest, WrittenIsRead) {
    SceneFile scene = readScene(write("s.toml", example()));
    scene.lights.emplace_back();
    scene.eyes.emplace_back();
    const auto changeLight = [](PelLight& s) {
        PEL_EACH_LIGHT_FIELD(CHANGE)
        PEL_EACH_SHADOW_MAP_FIELD(CHANGE)
        s.shadowCascades = 3;
        s.shadowContent = PEL_SHADOW_CONTENT_MOMENTS;
        for (int k = 0; k < 2; ++k) {
            change(s.cascadeToShadow[k], -1, 1, 0);
            change(s.cascadeDepthRange[k], -1, 1, 0);
        }
    };
    const auto changeSpot = [](PelLight& s) {
        s.type = PEL_LIGHT_SPOT;
        PEL_EACH_POSITIONAL_LIGHT_FIELD(CHANGE)
        PEL_EACH_SPOT_LIGHT_FIELD(CHANGE)
        PEL_EACH_SPHERE_LIGHT_FIELD(CHANGE)
        PEL_EACH_RECTANGLE_LIGHT_FIELD(CHANGE)
        std::copy_n(pelLightDefaults().spotDirection, 3, s.spotDirection);  // made unit
    };
    const auto changeMaterial = [](PelMaterial& s) {
        PEL_EACH_MATERIAL_FIELD(CHANGE)
        s.scattering = PEL_SCATTERING_SEPARABLE;
    };
    const auto changeOptions = [](PelShaderOptions& s) { PEL_EACH_OPTION_FIELD(CHANGE) };
    const auto changeEye = [](PelEye& s) { PEL_EACH_EYE_FIELD(CHANGE) };
    SceneLight& sun = scene.lights[0];
    SceneMaterial& skin = scene.materials[0];
    SceneEye& eye = scene.eyes[0];
    changeLight(sun.light);
    changeSpot(scene.lights[1].light);
    changeMaterial(skin.material);
    changeOptions(scene.options);
    changeEye(eye.eye);
    change(scene.camera.position, -1e9f, 1e9f, 0);
    change(scene.camera.inverseViewProjection, -1, 1, 0);
    change(scene.ambient.constant, 0, 1, 0);
    change(scene.ambient.sh, 0, 1, 0);
    scene.ambient.sh[3][1] = 1.17549435e-38f;
    sun.shadowMapChannel = "odd \"name\" \\ here";
    sun.secondChannel = "Z2";
    sun.cascades[0] = {path("coarse.exr"), "A.Z", "A.Z2"};
    sun.cascades[1].channel = "B.Z";
    skin.scatteredTexture = path("lit.exr");
    skin.normalMap = path("normals.png");
    skin.profile = path("of/mine.toml");
    skin.preset = ScenePreset::faceworks;
    eye.material = skin.id;
    eye.irisTexture = path("iris.exr"), eye.irisProfile = "skin", eye.caustics = path("c.exr");
    scene.channels[PEL_SLOT_SCATTER_WEIGHT] = {"Mask.V"};
    scene.channels[PEL_SLOT_WETNESS] = {"Wet.V"};
    scene.channels[PEL_SLOT_IRRADIANCE_BACK] = {"B.R", "B.G", "B.B"};
    scene.channels[PEL_SLOT_UV] = {"UV.U", "UV.V"};
    scene.channels[PEL_SLOT_TANGENT] = {"T.X", "T.Y", "T.Z", "T.W"};
    scene.ambientCube = path("sky.exr");
    scene.reflectionCube = path("around.exr");
    scene.environment = path("sky.hdr");
    for (int i = 0; i < 9; ++i) scene.environmentAxes[i] = float(i % 4 == 2);
    scene.outputs[PEL_SLOT_OUT_SPECULAR] = path("parts/shine.exr");
    scene.outputs[PEL_SLOT_OUT_THICKNESS] = path("t.exr");
    PelShadowLutDesc& table = scene.luts[1].info.shadow;
    scene.luts[1].file.clear();
    table.closedEnds = 1, table.axis = PEL_AXIS_ROOT, table.sharpening = 4.5f;
    const auto changeScatter = [](PelScatterParams& s) {
        PEL_EACH_SCATTER_PARAM_FIELD(CHANGE)
        s.everywhere = s.halfRate = 1, s.frameIndex = 7;
    };
    changeScatter(scene.scatter.emplace(pelScatterParamsDefaults()));
    skin.scale = 0.3f;
    scene.channels[PEL_SLOT_IRRADIANCE] = {"E.R", "E.G", "E.B"};
    writeScene(path("out.toml"), scene);
    const SceneFile again = readScene(path("out.toml"));
    // Texts have the shortest digits that identify a float, so equal texts are equal bits.
    EXPECT_EQ(sceneText(again), sceneText(scene));
    EXPECT_EQ(again.channels, scene.channels);
    EXPECT_EQ(again.outputs, scene.outputs);
    const SceneMaterial& material = again.materials.at(0);
    EXPECT_EQ(std::tie(material.preset, material.profile, material.normalMap, material.scatteredTexture),
              std::tie(skin.preset, skin.profile, skin.normalMap, skin.scatteredTexture));
    EXPECT_EQ(again.ambientCube, scene.ambientCube);
    EXPECT_EQ(again.reflectionCube, scene.reflectionCube);
    EXPECT_EQ(again.environment, scene.environment);
    EXPECT_EQ(std::to_array(again.environmentAxes), std::to_array(scene.environmentAxes));
    EXPECT_EQ(again.lights.at(0).shadowMapChannel, sun.shadowMapChannel);
    EXPECT_EQ(again.eyes.at(0).irisTexture, eye.irisTexture);
    EXPECT_EQ(again.eyes[0].irisProfile, eye.irisProfile);
    EXPECT_EQ(again.eyes[0].caustics, eye.caustics);
    const auto same = [](const auto& a, const auto& b) { return std::memcmp(&a, &b, sizeof a) == 0; };
    EXPECT_TRUE(same(again.options, scene.options));
    EXPECT_TRUE(same(again.lights[0].light, sun.light));
    EXPECT_TRUE(same(again.lights.at(1).light, scene.lights[1].light));
    EXPECT_TRUE(same(material.material, skin.material));
    EXPECT_TRUE(same(again.eyes[0].eye, eye.eye));
    EXPECT_TRUE(same(again.scatter.value(), *scene.scatter));
    EXPECT_EQ(material.scale, skin.scale);
    EXPECT_TRUE(same(again.luts.at(1).info.shadow, table));
}

TEST_F(SceneFileTest, MistakesNameKeyAndWhatIsRight) {
    expectErrors({
        {"diffusion_radius = 2.7", "difusion_radius = 2.7",
         "'difusion_radius' in [[material]] is not known; did you mean 'diffusion_radius'?"},
        {"[camera]", "[kamera]", "did you mean 'camera'?"},
        {"projection =", "zzz =", "'zzz' in [light.shadow_map] is not known; known: file, channel"},
        {"diffusion_radius = 2.7", "diffusion_radius = -2.7", "is -2.7; it must be 0, or 1e-06 or more"},
        {"diffusion_radius = 2.7", "diffusion_radius = nan", "must be 0, or 1e-06 or more"},
        {"specular = 1.5", "f0 = 1.5", "is 1.5; it must be from 0 to 1"},
        {"color = [1, 0.95, 0.9]", "color = [1, -0.95, 0.9]", "is -0.95; it must be 0 or more"},
        {"file = \"shadow_lut.exr\"", "sharpening = 0.5", "is 0.5; it must be 1 or more"},
        {"radius_min = 1", "radius_min = 100", "not below radius_max"},
        {"to_light = [0.6, 0.3, 0.742]", "to_light = [0.6, 0.3]", "has 2 values; an array of 3"},
        {"0, 0, 0, 1]", "0, 0, 1]", "has 15 values; an array of 16 numbers would be right (a matrix"},
        {"[0.05, 0.05, 0.06],\n", "", "has 8 rows; 9 arrays of 3"},
        {"[0.05, 0.05, 0.06]", "[0.05, 0.06]", "row 0"},
        {"\"directional\"", "\"sun\"", "'sun'; one of 'directional', 'point', 'spot'"},
        {"id = 1", "id = 300", "from 1 to 255"},
        {"id = 1", "id = 1.0", "floating-point; a whole number"},
        {"curvature = \"Curvature.C\"", "curvature = 7", "one channel name would be right"},
        {"\"Normal.X\", ", "", "has 2 names; an array of 3 channel names"},
        {"[[material]]", "[light.shadow_map.cascade_1]\nfile = \"no.exr\"\n[[material]]",
         "'cascade_1' in [light.shadow_map] is one cascade more than 'cascades' says"},
        {"specular = 1.5", "normal_map_levels = []", "an array of 1 to 16 file names"},
        {"specular = 1.5", "normal_map = \"a\\u0000b\"", "holds a NUL character"},
        {"specular = 1.5", "thickness_taps = 12", "0, 8, 16 or 32"},
        {"[camera]", "[[camera]]", "a table would be right"},
        {"[[material]]", "[material]", "[[material]]"},
        {"version = 2", "version = 3", "of a later pellucid; this one reads version 1 to 2"},
        {"version = 2", "version = 0", "'version' in the scene is 0"},
        {"version = 2", "version = \"1\"", "'version' in the scene is a string"},
        {"file = \"shadow_lut.exr\"", "preset = \"unity\"", "'unity'; one of 'material', 'faceworks'"},
        {"file = \"shadow_lut.exr\"", "file = \"a.exr\"\npreset = \"material\"",
         "'preset' in [[shadow_lut]] cannot stand beside 'file'"},
        {"to_light = [0.6, 0.3, 0.742]", "", "a directional light needs it"},
        {"\"directional\"", "\"point\"", "'position' in [[light]] is missing"},
        {"\"directional\"", "\"sphere\"\nposition = [0, 0, 9]", "'radius' in [[light]] is missing"},
        {"\"directional\"", "\"rectangle\"\nposition = [0, 0, 9]", "'half_width' in [[light]] is missing"},
        {"normal_shading", "normal_blurred", "'normal_shading' in [channels] is missing"},
        {"[camera]", "[scatter]\nwhite = 2\n[camera]", "'irradiance' in [channels] is missing"},
        {"[camera]", "[scatter]\neverywhere = 2\n[camera]", "'everywhere' in [scatter] is 2; it must be"},
        {"diffusion_radius = 2.7", "scale = 1", "'scale' is for scenes with a [scatter] table"},
        {"curvature_lut = \"skin\"", "curvature_lut = \"wax\"",
         "refers to the curvature_lut 'wax'; there is only: skin"},
        {"curvature_lut = \"skin\"", "normal_map = \"n.png\"", "'uv' in [channels] is missing"},
        {"[[curvature_lut]]", "[[material]]\n[[curvature_lut]]", "used twice"},
        {"position = [0, 0, 600]", "position = [0, 0", "s.toml:"},
    });
    EXPECT_TRUE(contains(errorOf("diffusion_radius", "difusion_radius"), at("diffusion_radius")));
    EXPECT_TRUE(
        contains(errorOf("diffusion_radius = 2.7", "diffusion_radius = \"wide\""),
                 at("diffusion_radius") + "'diffusion_radius' in [[material]] is a string; a number"));
    EXPECT_TRUE(contains(errorOf("radius_min = 1", "radius_min = -1"), at("radius_min") + "'radius_min'"));
    EXPECT_TRUE(
        contains(errorOf("[camera]", "[[eye]]\nmaterial = 9\ncenter = [0, 0, 0]\ngaze = [0, 0, 1]\n[camera]"),
                 at("[camera]") + "the eye refers to material 9, which does not exist"));
    EXPECT_TRUE(contains(messageOf<FileError>([&] { readScene(path("none.toml")); }), "No such file"));
}

TEST_F(SceneFileTest, WordsAreSuggestedUpToSomeEdits) {
    const std::vector<std::string> known{"skin", "roughness", "radius"};
    const std::pair<const char*, const char*> words[] = {
        {"skin", "skin"},  {"ksin", "skin"}, {"skins", "skin"},        {"kin", "skin"},
        {"skxxn", "skin"}, {"sxxxn", ""},    {"oughnss", "roughness"}, {"", ""}};
    for (const auto& [given, suggested] : words) EXPECT_EQ(nearestWord(given, known), suggested) << given;
}

// Scenes of version 1 begin with FaceWorks' tables, later ones with those that a material makes; a preset
// says which whatever the version.
TEST_F(SceneFileTest, TablesBeginAsTheVersionOrThePresetSays) {
    const auto tables = [&](const std::string& head, const std::string& keys) {
        return readScene(
            write("s.toml", head + "[channels]\nnormal_shading = [\"x\", \"y\", \"z\"]\n[[curvature_lut]]\n" +
                                "name = \"a\"\n" + keys + "[[shadow_lut]]\nname = \"a\"\n" + keys));
    };
    const auto expect = [](LutPreset preset, const SceneFile& scene) {
        const PelCurvatureLutDesc c = scene.lut("a", PEL_LUT_CURVATURE)->info.curvature,
                                  ofPreset = presetInfo(preset, PEL_LUT_CURVATURE).curvature;
        const PelShadowLutDesc s = scene.lut("a", PEL_LUT_SHADOW)->info.shadow;
        EXPECT_EQ(c.form, ofPreset.form);
        EXPECT_EQ(c.axis, ofPreset.axis);
        EXPECT_EQ(c.width, ofPreset.width);
        EXPECT_EQ(c.radiusMin, ofPreset.radiusMin);
        const PelShadowLutDesc shadow = presetInfo(preset, PEL_LUT_SHADOW).shadow;
        EXPECT_EQ(s.closedEnds, shadow.closedEnds);
        EXPECT_EQ(s.widthMin, shadow.widthMin);
        EXPECT_EQ(s.axis, shadow.axis);
    };
    const LutPreset faceworks = LutPreset::faceworks, material = LutPreset::material;
    expect(faceworks, tables("", ""));
    expect(faceworks, tables("version = 1\n", ""));
    expect(material, tables("version = 2\n", ""));
    expect(faceworks, tables("version = 2\n", "preset = \"faceworks\"\n"));
    expect(material, tables("version = 1\n", "preset = \"material\"\n"));
    // A scene that was written reads back as it was, whatever its version.
    SceneFile scene = tables("", "");
    writeScene(path("w.toml"), scene);
    expect(faceworks, readScene(path("w.toml")));
}

TEST_F(SceneFileTest, EveryKeyIsDocumented) {
    // A key that this file's writer knows stands in backquotes in the page.
    SceneFile scene = readScene(write("s.toml", example()));
    for (auto& names : scene.channels) names.assign(3, "x");
    scene.scatter = pelScatterParamsDefaults();
    scene.materials[0].scale = 1;
    scene.luts[1].file.clear();
    const std::string page = read(PELLUCID_SOURCE_DIR "/docs/guide/scene-file.md");
    std::istringstream lines(sceneText(scene));
    size_t keys = 0;
    for (std::string line; std::getline(lines, line);) {
        const size_t equals = line.find(" = ");
        if (equals == std::string::npos || line[0] == '#') continue;
        ++keys;
        EXPECT_TRUE(page.find("`" + line.substr(0, equals) + "`") != std::string::npos) << line;
    }
    EXPECT_GT(keys, 50u);
}

TEST(MipChain, MeansOfWhatATexelCovers) {
    std::vector<float> rgb;
    for (int i = 0; i < 5 * 4; ++i) rgb.insert(rgb.end(), {float(i), 1, float(i % 2)});
    const MipChain chain = mipChain(5, 4, rgb);
    ASSERT_EQ(chain.levels.size(), 3u);
    EXPECT_EQ(chain.levels[1].width, 2);
    EXPECT_EQ(chain.levels[2].width, 1);
    EXPECT_EQ(chain.levels[2].height, 1);
    const auto red = [&](int level, int texel) {
        return chain.texels[chain.levels[level].byteOffset / 4 + 3 * texel];
    };
    EXPECT_EQ(red(1, 0), (0 + 1 + 5 + 6) / 4.0f);
    EXPECT_EQ(red(1, 1), (2 + 3 + 4 + 7 + 8 + 9) / 6.0f) << "an odd side's last texel covers three";
    EXPECT_EQ(chain.texels.size(), 3u * (20 + 4 + 1));
}

TEST(TomlReader, OneTextIsAListOfOne) {
    const auto file = parseToml("t.toml", "one = \"a\"\nsome = [\"a\", \"b\"]\n");
    TomlReader reader("t.toml", *file, "the file");
    std::vector<std::string> one, some{"c"}, other{"c"};
    reader.list("one", one);
    reader.list("some", some);
    reader.list("other", other);
    EXPECT_EQ(one, (std::vector<std::string>{"a"}));
    EXPECT_EQ(some, (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(other, (std::vector<std::string>{"c"}));
}
