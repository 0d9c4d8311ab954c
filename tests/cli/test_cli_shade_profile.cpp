// `pellucid shade` with materials that name their profile: files beside the scene, units, the preset, and
// what is said about sizes that can hardly be meant.
#include <nlohmann/json.hpp>

#include "cli_shade.h"
#include "io/file_error.h"

using namespace pellucid;
using shade_files::Shade;

namespace {

class ShadeProfile : public Shade {
  protected:
    // Points of a sphere of that radius, and its curvature.
    void addSphere(float radius) {
        const std::vector<float> normals = gbuffer_.interleaved(shade_files::normalNames);
        std::vector<float> positions, curvature(normals.size() / 3, 1 / radius);
        for (float n : normals) positions.push_back(radius * n);
        gbuffer_.addInterleaved(std::vector<std::string>{"P.X", "P.Y", "P.Z"}, positions);
        gbuffer_.addInterleaved(std::vector<std::string>{"C.V"}, curvature);
        io::writeExr(path("g.exr"), gbuffer_);
        scene_.channels[PEL_SLOT_POSITION] = {"P.X", "P.Y", "P.Z"};
        scene_.channels[PEL_SLOT_CURVATURE] = {"C.V"};
    }
    std::vector<float> shaded(const std::string& scene) {
        const Result result = run(command(scene));
        EXPECT_EQ(result.exitCode, 0) << result.err;
        warnings_ = result.err;
        return io::readImage(path("o.exr")).interleaved(std::vector<std::string>{"R", "G", "B"});
    }
    std::string warnings_;
};

}  // namespace

TEST_F(ShadeProfile, AProfileIsEnough) {
    addSphere(30);
    write("mine.toml",
          "name = \"mine\"\nkind = \"burley\"\nunit = \"mm\"\nsource = \"a test\"\ndistance = [0.8, 0.4, "
          "0.2]\n");
    scene_.materials[0].profile = "mine.toml";
    scene_.materials[0].material.scattering =
        PEL_SCATTERING_PREINTEGRATED;  // rows of equal places have no area on a screen
    io::writeScene(path("s.toml"), scene_);
    const auto scattered = shaded("s.toml");
    EXPECT_EQ(warnings_.find("unit_mm"), std::string::npos) << warnings_;
    scene_.materials[0].profile.clear();
    io::writeScene(path("plain.toml"), scene_);
    const auto plain = shaded("plain.toml");
    double most = 0;
    for (size_t i = 0; i < plain.size(); ++i)
        most = std::max(most, double(std::abs(plain[i] - scattered[i])));
    EXPECT_GT(most, 0.005);
    scene_.materials[0].profile = "granite";
    io::writeScene(path("s.toml"), scene_);
    expectRefused(command("s.toml"), 3, "granite");
}

TEST_F(ShadeProfile, SizesThatCannotBeTheProfilesAreSaid) {
    addSphere(90);
    scene_.materials[0].profile = "skin";
    for (const auto& [unit, likely] : {std::pair{1.0f, true}, {0.1f, false}, {100.0f, false}}) {
        scene_.options.millimetresPerUnit = unit;
        io::writeScene(path("s.toml"), scene_);
        shaded("s.toml");
        EXPECT_EQ(warnings_.find("unit_mm") == std::string::npos, likely) << unit << ": " << warnings_;
    }
}

TEST_F(ShadeProfile, ThePresetIsWhatItsTablesAre) {
    addSphere(30);
    scene_.materials[0].preset = io::ScenePreset::faceworks;
    io::writeScene(path("preset.toml"), scene_);
    const auto preset = shaded("preset.toml");
    scene_.materials[0].preset = io::ScenePreset::none;
    scene_.luts.resize(2);
    scene_.luts[0].info = io::presetInfo(io::LutPreset::faceworks, PEL_LUT_CURVATURE);
    scene_.luts[1].info = io::presetInfo(io::LutPreset::faceworks, PEL_LUT_SHADOW);
    scene_.luts[0].name = scene_.luts[1].name = "t";
    scene_.materials[0].curvatureLut = scene_.materials[0].shadowLut = "t";
    io::writeScene(path("tables.toml"), scene_);
    EXPECT_EQ(shaded("tables.toml"), preset);
}

TEST_F(ShadeProfile, ADistanceIsNoDeviceDepth) {
    std::vector<float> depth(gbuffer_.pixelCount(), 250);
    gbuffer_.addInterleaved(std::vector<std::string>{"D.Z"}, depth);
    io::writeExr(path("g.exr"), gbuffer_);
    scene_.channels[PEL_SLOT_DEPTH] = {"D.Z"};
    io::writeScene(path("s.toml"), scene_);
    shaded("s.toml");
    EXPECT_NE(warnings_.find("depth channel reaches 250"), std::string::npos) << warnings_;
}

// Distances below 1, as a scene in metres has them, would be places that are much too near or too far apart;
// so would the right depth of a scene whose unit is wrong.
TEST_F(ShadeProfile, DepthThatGivesNoLikelySizeIsSaid) {
    scene_.materials[0].profile = "skin";
    scene_.channels[PEL_SLOT_DEPTH] = {"D.Z"};
    // A camera at the origin that looks along z, with 90 degrees of view: near plane at 0.1 m, far plane at
    // 100 m.
    const float near = 0.1f, far = 100;
    std::fill(scene_.camera.inverseViewProjection, scene_.camera.inverseViewProjection + 16, 0.0f);
    float* m = scene_.camera.inverseViewProjection;
    m[0] = m[5] = 1;                                         // x, y of a point at distance 1
    m[11] = 1;                                               // z
    m[14] = -(far - near) / (far * near), m[15] = 1 / near;  // 1 / distance
    const auto with = [&](float value, float unit) {
        io::Image gbuffer = gbuffer_;
        gbuffer.addInterleaved(std::vector<std::string>{"D.Z"},
                               std::vector<float>(gbuffer.pixelCount(), value));
        io::writeExr(path("g.exr"), gbuffer);
        scene_.options.millimetresPerUnit = unit;
        io::writeScene(path("s.toml"), scene_);
        shaded("s.toml");
        return warnings_;
    };
    const float distance = 0.15f, device = far / (far - near) * (1 - near / distance);
    EXPECT_EQ(with(device, 1000).find("unit_mm"), std::string::npos) << warnings_;
    EXPECT_NE(with(device, 1).find("unit_mm"), std::string::npos);
    EXPECT_NE(with(0.99999f, 1000).find("a distance along the view"), std::string::npos) << warnings_;
    EXPECT_NE(with(-250, 1).find("depth channel reaches -250"), std::string::npos) << warnings_;
}

// Every control of scattering that a scene file can name.
TEST_F(ShadeProfile, MethodsAndTheirControls) {
    std::vector<float> back, positions;
    for (int i = 0; i < shade_files::width * shade_files::height; ++i)
        back.insert(back.end(), {0.3f, 0.3f, 0.3f});
    std::vector<float> light, weights, uvs;
    for (int i = 0; i < shade_files::width * shade_files::height; ++i) {
        light.insert(light.end(), 3, i % shade_files::width < 7 ? 1.0f : 0.0f);
        weights.push_back(0);
        positions.insert(positions.end(),
                         {0.5f * float(i % shade_files::width), 0.5f * float(i / shade_files::width), 0});
        uvs.insert(uvs.end(), {float(i % shade_files::width) / shade_files::width, 0.5f});
    }
    gbuffer_.addInterleaved(std::vector<std::string>{"P.X", "P.Y", "P.Z"}, positions);
    scene_.channels[PEL_SLOT_POSITION] = {"P.X", "P.Y", "P.Z"};
    gbuffer_.addInterleaved(std::vector<std::string>{"E.R", "E.G", "E.B"}, light);
    gbuffer_.addInterleaved(std::vector<std::string>{"B.R", "B.G", "B.B"}, back);
    gbuffer_.addInterleaved(std::vector<std::string>{"W.V"}, weights);
    gbuffer_.addInterleaved(std::vector<std::string>{"UV.U", "UV.V"}, uvs);
    io::writeExr(path("g.exr"), gbuffer_);
    scene_.channels[PEL_SLOT_IRRADIANCE] = {"E.R", "E.G", "E.B"};
    scene_.materials[0].profile = "skin";
    PelMaterial& m = scene_.materials[0].material;
    const auto result = [&] {
        io::writeScene(path("s.toml"), scene_);
        return shaded("s.toml");
    };
    m.scattering = PEL_SCATTERING_NONE;
    const auto plain = result();
    std::vector<std::vector<float>> all{plain};
    const auto differs = [&](const char* what) {
        all.push_back(result());
        for (size_t k = 0; k + 1 < all.size(); ++k) EXPECT_NE(all[k], all.back()) << what;
    };
    m.scattering = PEL_SCATTERING_SEPARABLE;
    differs("separable");
    m.scatterTaps = 9;
    differs("taps");
    m.scattering = PEL_SCATTERING_SCREEN;
    differs("disk");
    scene_.options.frameIndex = 7;
    differs("frame");
    m.thinThickness = 0.2f;
    scene_.channels[PEL_SLOT_IRRADIANCE_BACK] = {"B.R", "B.G", "B.B"};
    differs("sheet");
    m.thinThickness = 0;
    scene_.channels[PEL_SLOT_SCATTER_WEIGHT] = {"W.V"};
    EXPECT_EQ(result(), plain);  // nothing of it is taken
    scene_.channels[PEL_SLOT_SCATTER_WEIGHT].clear();
    scene_.channels[PEL_SLOT_UV] = {"UV.U", "UV.V"};
    io::Image texture;
    texture.width = 4, texture.height = 2;
    texture.addInterleaved(std::vector<std::string>{"R", "G", "B"}, std::vector<float>(24, 0.75f));
    io::writeExr(path("lit.exr"), texture);
    m.scattering = PEL_SCATTERING_TEXTURE;
    m.scatterTaps = 0;
    scene_.materials[0].scatteredTexture = "lit.exr";
    const auto sampled = result();
    EXPECT_NEAR(sampled[3 * 5], 0.75 * 0.5, 1e-3);  // times the albedo
    scene_.materials[0].scatteredTexture = "no.exr";
    io::writeScene(path("s.toml"), scene_);
    expectRefused(command("s.toml"), 3, "no.exr");
}
