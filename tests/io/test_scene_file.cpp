// host/io/scene/scene_file.h: the example of the documentation, round trip, and one message for each kind of
// mistake.
#include <cstring>
#include <random>

#include "io/file_error.h"
#include "io/image/mip_chain.h"
#include "io/scene/scene_file.h"
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
}

// What a material leaves to its profile is not written, and a profile file lies relative to the scene.
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

TEST_F(SceneFileTest, WrittenIsRead) {
    SceneFile scene = readScene(write("s.toml", example()));
    std::mt19937 random(7);
    std::uniform_real_distribution<float> any(0.0f, 1.0f);
    for (float* f :
         {&scene.camera.position[0], &scene.camera.position[1], &scene.camera.inverseViewProjection[5],
          &scene.lights[0].light.worldToShadow[7], &scene.materials[0].material.roughness,
          &scene.materials[0].material.normalBlend[0], &scene.materials[0].material.normalBlend[1],
          &scene.materials[0].material.normalBlend[2], &scene.ambient.sh[8][2], &scene.ambient.constant[0]}) {
        *f = any(random);
    }
    scene.ambient.sh[3][1] = 1.17549435e-38f;
    scene.lights.push_back(scene.lights[0]);
    scene.lights[1].light.type = PEL_LIGHT_SPOT;
    scene.lights[1].shadowMapFile.clear();
    scene.lights[0].shadowMapChannel = "odd \"name\" \\ here";
    scene.options.blurNormals = 1;
    scene.options.rotateTaps = 1;
    scene.options.everyPixel = 1;
    scene.options.frameIndex = 12;
    scene.channels[PEL_SLOT_SCATTER_WEIGHT] = {"Mask.V"};
    scene.channels[PEL_SLOT_IRRADIANCE_BACK] = {"B.R", "B.G", "B.B"};
    PelMaterial& scattering = scene.materials[0].material;
    scattering.scattering = PEL_SCATTERING_SEPARABLE;
    scattering.scatterTaps = 33;
    scattering.albedoBefore = 0.5f;
    scattering.borderColor[1] = 0.25f;
    scattering.thinThickness = 0.3f;
    scene.materials[0].scatteredTexture = path("lit.exr");
    scene.ambientCube = path("sky.exr");
    scene.outputs[PEL_SLOT_OUT_SPECULAR] = path("parts/shine.exr");
    scene.outputs[PEL_SLOT_OUT_THICKNESS] = path("t.exr");
    scene.materials[0].material.thicknessTaps = 16;
    scene.channels[PEL_SLOT_UV] = {"UV.U", "UV.V"};
    scene.channels[PEL_SLOT_TANGENT] = {"T.X", "T.Y", "T.Z", "T.W"};
    scene.materials[0].normalMap = path("normals.png");
    scene.materials[0].material.uvScale = 12.5f;
    scene.materials[0].material.transmission = 0.25f;
    scene.materials[0].material.curvatureGain = 0.5f;
    scene.materials[0].profile = path("of/mine.toml");
    scene.materials[0].preset = ScenePreset::faceworks;
    scene.options.millimetresPerUnit = 10;
    scene.luts[1].info.shadow.closedEnds = 1;
    scene.luts[1].info.shadow.axis = PEL_AXIS_ROOT;
    scene.lights[0].light.shadowFilterTexels = 48;
    scene.lights[0].light.shadowSoftness = 0.125f;
    PelLight& shadow = scene.lights[0].light;
    shadow.shadowCascades = 3;
    shadow.shadowContent = PEL_SHADOW_CONTENT_MOMENTS;
    shadow.shadowExponent = 40;
    shadow.shadowMinDeviation = 0.5f;
    shadow.shadowBleeding = 0.2f;
    for (int k = 0; k < 2; ++k) {
        for (float& m : shadow.cascadeToShadow[k]) m = any(random);
        shadow.cascadeDepthRange[k] = any(random);
    }
    scene.lights[0].secondChannel = "Z2";
    scene.lights[0].cascades[0] = {path("coarse.exr"), "A.Z", "A.Z2"};
    scene.lights[0].cascades[1].channel = "B.Z";
    scene.luts[1].file.clear();
    scene.luts[1].info.shadow.sharpening = 4.5f;
    scene.eyes.emplace_back();
    scene.eyes[0].material = scene.materials[0].id;
    PelEye& eye = scene.eyes[0].eye;
    eye = pelEyeDefaults();
    for (float* f : {&eye.center[0],    &eye.center[2],       &eye.gaze[1],          &eye.up[0],
                     &eye.scleraRadius, &eye.corneaRadius,    &eye.corneaConic,      &eye.limbusRadius,
                     &eye.limbusWidth,  &eye.limbusDarkening, &eye.chamberDepth,     &eye.corneaIndex,
                     &eye.aqueousIndex, &eye.irisRadius,      &eye.irisConcavity,    &eye.pupilRadius,
                     &eye.texturePupil, &eye.tearRoughness,   &eye.wetLineRoughness, &eye.tearIndex})
        *f = 1.01f * *f + 0.01f;
    eye.irisSeed = 7;
    writeScene(path("out.toml"), scene);
    const SceneFile again = readScene(path("out.toml"));
    // Texts have the shortest digits that identify a float, so equal texts are equal bits.
    EXPECT_EQ(sceneText(again), sceneText(scene));
    EXPECT_EQ(again.channels, scene.channels);
    EXPECT_EQ(again.outputs, scene.outputs);
    const auto same = [](const auto& a, const auto& b) { return std::memcmp(&a, &b, sizeof a) == 0; };
    EXPECT_TRUE(same(again.options, scene.options));
    EXPECT_TRUE(same(again.lights.at(0).light, scene.lights[0].light));
    EXPECT_EQ(again.lights[0].shadowMapChannel, scene.lights[0].shadowMapChannel);
    EXPECT_TRUE(same(again.materials.at(0).material, scene.materials[0].material));
    EXPECT_TRUE(same(again.eyes.at(0).eye, eye));
    EXPECT_TRUE(same(again.luts.at(1).info.shadow, scene.luts[1].info.shadow));
}

TEST_F(SceneFileTest, UnknownKeysSuggestTheNearest) {
    const std::string message = errorOf("diffusion_radius = 2.7", "difusion_radius = 2.7");
    EXPECT_TRUE(contains(message, at("diffusion_radius")));
    EXPECT_TRUE(contains(message,
                         "'difusion_radius' in [[material]] is not known; did you mean 'diffusion_radius'?"));
    EXPECT_TRUE(contains(errorOf("[camera]", "[kamera]"), "did you mean 'camera'?"));
    EXPECT_TRUE(contains(errorOf("projection =", "zzz ="),
                         "'zzz' in [light.shadow_map] is not known; known: file, channel"));
}

TEST_F(SceneFileTest, WrongTypesAndValuesNameLineKeyAndWhatIsRight) {
    EXPECT_TRUE(
        contains(errorOf("diffusion_radius = 2.7", "diffusion_radius = \"wide\""),
                 at("diffusion_radius") + "'diffusion_radius' in [[material]] is a string; a number"));
    EXPECT_TRUE(contains(errorOf("diffusion_radius = 2.7", "diffusion_radius = -2.7"),
                         "is -2.7; it must be 0, or 1e-06 or more"));
    EXPECT_TRUE(
        contains(errorOf("diffusion_radius = 2.7", "diffusion_radius = nan"), "must be 0, or 1e-06 or more"));
    EXPECT_TRUE(contains(errorOf("specular = 1.5", "f0 = 1.5"), "is 1.5; it must be from 0 to 1"));
    EXPECT_TRUE(contains(errorOf("color = [1, 0.95, 0.9]", "color = [1, -0.95, 0.9]"),
                         "is -0.95; it must be 0 or more"));
    EXPECT_TRUE(
        contains(errorOf("file = \"shadow_lut.exr\"", "sharpening = 0.5"), "is 0.5; it must be 1 or more"));
    EXPECT_TRUE(contains(errorOf("radius_min = 1", "radius_min = -1"), at("radius_min") + "'radius_min'"));
    EXPECT_TRUE(contains(errorOf("radius_min = 1", "radius_min = 100"), "not below radius_max"));
    EXPECT_TRUE(contains(errorOf("to_light = [0.6, 0.3, 0.742]", "to_light = [0.6, 0.3]"),
                         "has 2 values; an array of 3"));
    EXPECT_TRUE(contains(errorOf("0, 0, 0, 1]", "0, 0, 1]"),
                         "has 15 values; an array of 16 numbers would be right (a matrix"));
    EXPECT_TRUE(contains(errorOf("[0.05, 0.05, 0.06],\n", ""), "has 8 rows; 9 arrays of 3"));
    EXPECT_TRUE(contains(errorOf("[0.05, 0.05, 0.06]", "[0.05, 0.06]"), "row 0"));
    EXPECT_TRUE(
        contains(errorOf("\"directional\"", "\"sun\""), "'sun'; one of 'directional', 'point', 'spot'"));
    EXPECT_TRUE(contains(errorOf("id = 1", "id = 300"), "from 1 to 255"));
    EXPECT_TRUE(contains(errorOf("id = 1", "id = 1.0"), "floating-point; a whole number"));
    EXPECT_TRUE(
        contains(errorOf("curvature = \"Curvature.C\"", "curvature = 7"), "one channel name would be right"));
    EXPECT_TRUE(contains(errorOf("\"Normal.X\", ", ""), "has 2 names; an array of 3 channel names"));
    EXPECT_TRUE(contains(errorOf("specular = 1.5", "thickness_taps = 12"), "0, 8, 16 or 32"));
    EXPECT_TRUE(contains(errorOf("[camera]", "[[camera]]"), "a table would be right"));
    EXPECT_TRUE(contains(errorOf("[[material]]", "[material]"), "[[material]]"));
}

// Scenes of version 1 begin with FaceWorks' tables, later ones with those that a material makes; a preset
// says which whatever the version.
TEST_F(SceneFileTest, TablesBeginAsTheVersionOrThePresetSays) {
    const auto tables = [&](const std::string& head, const std::string& keys) {
        return readScene(
            write("s.toml", head + "[channels]\nnormal_shading = [\"x\", \"y\", \"z\"]\n[[curvature_lut]]\n" +
                                "name = \"a\"\n" + keys + "[[shadow_lut]]\nname = \"a\"\n" + keys));
    };
    struct Begin {
        PelCurvatureForm form;
        PelLutAxis axis;
        uint32_t width, closedEnds;
        float radiusMin, widthMin;
    };
    constexpr Begin faceworks{PEL_FORM_ARC, PEL_AXIS_LINEAR, 512, 0, 1, 8},
        material{PEL_FORM_SPHERE, PEL_AXIS_ROOT, 64, 1, 0, 0};
    const auto expect = [](const Begin& begin, const SceneFile& scene) {
        const PelCurvatureLutDesc c = scene.lut("a", PEL_LUT_CURVATURE)->info.curvature;
        const PelShadowLutDesc s = scene.lut("a", PEL_LUT_SHADOW)->info.shadow;
        EXPECT_EQ(c.form, begin.form);
        EXPECT_EQ(c.width, begin.width);
        EXPECT_EQ(c.radiusMin, begin.radiusMin);
        EXPECT_EQ(c.axis, begin.axis);
        EXPECT_EQ(s.closedEnds, begin.closedEnds);
        EXPECT_EQ(s.widthMin, begin.widthMin);
        EXPECT_EQ(s.axis, begin.axis);
    };
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

TEST_F(SceneFileTest, WhatIsMissingIsNamed) {
    EXPECT_TRUE(contains(errorOf("version = 2", "version = 3"),
                         "of a later pellucid; this one reads version 1 to 2"));
    EXPECT_TRUE(contains(errorOf("version = 2", "version = 0"), "'version' in the scene is 0"));
    EXPECT_TRUE(contains(errorOf("version = 2", "version = \"1\""), "'version' in the scene is a string"));
    EXPECT_TRUE(contains(errorOf("file = \"shadow_lut.exr\"", "preset = \"unity\""),
                         "'unity'; one of 'material', 'faceworks'"));
    EXPECT_TRUE(contains(errorOf("file = \"shadow_lut.exr\"", "file = \"a.exr\"\npreset = \"material\""),
                         "'preset' in [[shadow_lut]] cannot stand beside 'file'"));
    EXPECT_TRUE(contains(errorOf("to_light = [0.6, 0.3, 0.742]", ""), "a directional light needs it"));
    EXPECT_TRUE(contains(errorOf("\"directional\"", "\"point\""), "'position' in [[light]] is missing"));
    EXPECT_TRUE(
        contains(errorOf("normal_shading", "normal_blurred"), "'normal_shading' in [channels] is missing"));
    EXPECT_TRUE(contains(errorOf("curvature_lut = \"skin\"", "curvature_lut = \"wax\""),
                         "asks for the curvature_lut 'wax'; there is only: skin"));
    EXPECT_TRUE(contains(errorOf("[[curvature_lut]]", "[[material]]\n[[curvature_lut]]"), "used twice"));
    EXPECT_TRUE(contains(errorOf("position = [0, 0, 600]", "position = [0, 0"), "s.toml:"));
    EXPECT_TRUE(contains(messageOf<FileError>([&] { readScene(path("none.toml")); }), "No such file"));
}

TEST_F(SceneFileTest, EveryKeyIsDocumented) {
    // A key that this file's writer knows stands in backquotes in the page.
    SceneFile scene = readScene(write("s.toml", example()));
    for (auto& names : scene.channels) names.assign(3, "x");
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

TEST_F(SceneFileTest, NormalMapsNeedTheirChannels) {
    const std::string error = errorOf("curvature_lut = \"skin\"", "normal_map = \"n.png\"");
    EXPECT_NE(error.find("'uv' in [channels] is missing"), std::string::npos) << error;
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
