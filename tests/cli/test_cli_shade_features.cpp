// `pellucid shade`: features of scene files other than plain light: tables, profiles and their units,
// scattering, parts of the picture, cubes, eyes.
#include "cli_shade.h"

using namespace pellucid;
using namespace shade_files;

namespace {

const auto ones = [](int, int, size_t) { return 1; };

class ShadeFeatures : public Shade {
  protected:
    // Adds channels to the G-buffer and names them in the scene.
    template <class Value>
    void add(PelImageSlot slot, const Names& names, const Value& value) {
        addChannels(gbuffer_, names, value);
        scene_.channels[slot] = names;
    }
    // A G-buffer of this size without channels.
    void begin(int across, int down) {
        gbuffer_ = {};
        gbuffer_.width = across, gbuffer_.height = down;
        scene_.channels = {};
    }
    // Points of a sphere of that radius with the normals of the G-buffer, and its curvature.
    void addSphere(float radius) {
        const std::vector<float> normals = gbuffer_.interleaved(normalNames);
        add(PEL_SLOT_POSITION, positionNames,
            [&](int x, int y, size_t c) { return radius * normals[size_t(3 * (y * width + x)) + c]; });
        add(PEL_SLOT_CURVATURE, {"C.V"}, [&](int, int, size_t) { return 1 / radius; });
    }
    // A plane with pixels of half a millimetre, half of it lit.
    void addPlane() {
        add(PEL_SLOT_POSITION, positionNames, [](int x, int y, size_t c) {
            return c == 0 ? 0.5 * x : c == 1 ? 0.5 * y : 0;
        });
        add(PEL_SLOT_IRRADIANCE, {"E.R", "E.G", "E.B"}, [](int x, int, size_t) { return x < 7; });
    }
    // The front of a ball in the middle of a square picture, seen from +z.
    static auto ball(int side, float pixel, float radius) {
        return [=](int x, int y, size_t c) {
            const float p[2] = {pixel * (float(x) - 0.5f * float(side - 1)),
                                pixel * (0.5f * float(side - 1) - float(y))};
            return c < 2 ? p[c] : std::sqrt(std::max(radius * radius - p[0] * p[0] - p[1] * p[1], 0.01f));
        };
    }
};

double farthest(const std::vector<float>& a, const std::vector<float>& b) {
    double most = 0;
    for (size_t i = 0; i < a.size(); ++i) most = std::max<double>(most, std::abs(a[i] - b[i]));
    return most;
}

}  // namespace

TEST_F(ShadeFeatures, TablesOfMaterialsAndProfileFiles) {
    // The same profile as a file and as an EXR made from it; another material looks otherwise.
    write("own.toml",
          "name = \"own\"\nsource = \"a test\"\nkind = \"table\"\nunit = \"mm\"\n[[sample]]\ndistance = 0\n"
          "value = [3, 2, 1]\n[[sample]]\ndistance = 4\nvalue = [0.1, 0.1, 0]\n");
    add(PEL_SLOT_CURVATURE, {"C.X"}, [](int, int, size_t) { return 0.3; });
    scene_.materials[0].curvatureLut = "t";
    done("lut curvature --profile @own.toml --size 64x16 -o @t.exr");
    io::SceneLut lut;
    lut.name = "t";
    lut.info.curvature.axis = PEL_AXIS_ROOT;
    lut.info.curvature.width = 64;
    lut.info.curvature.height = 16;
    lut.info.curvature.diffusionRadius = 0;
    const auto with = [&](const std::string& profile, const std::string& file) {
        lut.profile = profile, lut.file = file;
        scene_.luts = {lut};
    };
    with("own.toml", "");
    const auto own = shaded();
    with("", "t.exr");
    EXPECT_EQ(own, shaded());
    with("marble", "");
    EXPECT_NE(own, shaded());
    with("granite", "");  // no such material
    refuses("granite");
}

TEST_F(ShadeFeatures, CurvatureFromThePictureItself) {
    // A ball of radius 4 seen from the front: the curvature measured on the screen is 0.25 everywhere.
    begin(24, 24);
    const float radius = 4;
    const auto place = ball(24, 0.2f, radius);
    // Of a normal map: turns without the surface doing so.
    add(PEL_SLOT_NORMAL_SHADING, {"N.X", "N.Y", "N.Z"}, [&](int x, int y, size_t c) {
        return place(x, y, c) / radius + (c ? 0 : x % 2 ? 0.1f : -0.1f);
    });
    add(PEL_SLOT_NORMAL_GEOMETRIC, {"G.X", "G.Y", "G.Z"},
        [&](int x, int y, size_t c) { return place(x, y, c) / radius; });
    add(PEL_SLOT_POSITION, positionNames, place);
    add(PEL_SLOT_ALBEDO, {"Col.R", "Col.G", "Col.B"}, [](int, int, size_t) { return 0.5; });
    add(PEL_SLOT_MATERIAL, {"Id.X"}, ones);
    addChannels(gbuffer_, {"Known.X"}, [&](int, int, size_t) { return 1 / radius; });
    addChannels(gbuffer_, {"Twice.X"}, [&](int, int, size_t) { return 2 / radius; });
    scene_.camera.position[2] = 50;
    const float sideways[3] = {0.96f, 0, 0.28f};
    std::copy(sideways, sideways + 3, scene_.lights[0].light.toLight);
    scene_.materials[0].curvatureLut = "skin";
    scene_.luts.resize(1);
    scene_.luts[0].name = "skin";
    scene_.luts[0].info.curvature.width = scene_.luts[0].info.curvature.height = 64;
    const auto of = [&](const char* curvature) {
        scene_.channels[PEL_SLOT_CURVATURE] = {curvature};
        return shaded();
    };
    const std::vector<float> known = of("Known.X");
    EXPECT_GT(farthest(of("Twice.X"), known), 10 * tolerance::screenShaded) << "curvature must matter";
    EXPECT_LE(farthest(of("screen"), known), tolerance::screenShaded);
    scene_.channels[PEL_SLOT_POSITION].clear();
    refuses("[channels] curvature");
}

TEST_F(ShadeFeatures, PartsOfThePictureAddUpToIt) {
    // A wall 3 thick, given per pixel; light from the front and from behind.
    add(PEL_SLOT_THICKNESS, {"Wall.V"}, [](int, int, size_t) { return 3; });
    add(PEL_SLOT_POSITION, positionNames, [](int x, int y, size_t c) { return c == 0 ? x : c == 1 ? y : 0; });
    scene_.camera.position[2] = 50;
    scene_.lights.push_back(scene_.lights[0]);
    scene_.lights[1].light.toLight[2] = -1;
    std::fill_n(scene_.materials[0].material.deepScatterColor, 3, 0.5f);
    scene_.materials[0].material.specular = 1;
    scene_.outputs[PEL_SLOT_OUT_THICKNESS] = "own name.exr";  // beside the scene
    const std::vector<float> sum = shaded("--outputs all --stats");
    const auto report = said_.json();
    ASSERT_EQ(report.at("outputs").size(), 5u);
    for (const auto& file : report.at("outputs"))
        EXPECT_TRUE(std::filesystem::exists(file.get<std::string>())) << file;
    std::vector<float> parts(sum.size());
    for (const char* file : {"o_diffuse.exr", "o_deep_scatter.exr", "o_specular.exr"}) {
        const std::vector<float> part = io::readImage(path(file)).interleaved(colorNames);
        for (size_t c = 0; c < 3; ++c) {
            float most = 0;
            for (size_t i = c; i < part.size(); i += 3) parts[i] += part[i], most = std::max(most, part[i]);
            EXPECT_GT(most, 0.001f) << file;
        }
    }
    EXPECT_LE(farthest(sum, parts), 1e-6);
    const auto thickness = channel("o_thickness.exr", "Thickness.V");
    for (size_t i = 0; i < thickness.size(); ++i) EXPECT_EQ(thickness[i], i % width < 2 ? 0.0f : 3.0f);
    EXPECT_EQ(thickness, channel("own name.exr", "Thickness.V"));

    for (const auto& [file, message] : {std::pair{"o.exr", "written twice"}, {"o.png", ".exr"}}) {
        scene_.outputs[PEL_SLOT_OUT_THICKNESS] = file;
        refuses(message);
    }
}

TEST_F(ShadeFeatures, AnAmbientCubeIsReadFromAFile) {
    // Faces of one texel: +x is red, +z is blue, the others black; no lights.
    const auto cube = [&](int height) {
        const auto color = [](int, int face, size_t c) {
            return (face == 0 && c == 0) || (face == 4 && c == 2);
        };
        io::writeExr(path("cube.exr"), imageOf(1, height, colorNames, color));
    };
    cube(6);
    scene_.ambientCube = "cube.exr";
    scene_.lights.clear();
    scene_.materials[0].material.deepScatterAmbient = 0.5f;
    const std::vector<float> pixels = shaded("--stats --outputs thickness");
    EXPECT_EQ(said_.json().at("stats").at("features"),
              nlohmann::json({"ambient", "outputs", "ambient_cube"}));
    EXPECT_TRUE(contains(said_.err, "deep_scatter_ambient of material 1 does nothing"));
    EXPECT_TRUE(contains(said_.err, "thickness output is 0 everywhere"));
    for (size_t i = 2; i < size_t(width); ++i) {
        // From the middle of a face, 1, to the edge, where two faces meet, 1/2: linear in the tangent.
        const double angle = 0.2 * double(i), tangent = std::tan(angle);
        const double red = angle > M_PI / 4 ? 1 - 0.5 * std::abs(1 / tangent) : 0.5 * tangent;
        EXPECT_NEAR(pixels[3 * i], 0.5 * red, 1e-5) << i;
        EXPECT_NEAR(pixels[3 * i + 1], 0, 1e-6);
    }
    cube(5);
    refuses("six square faces");
}

TEST_F(ShadeFeatures, AnEnvironmentIsReadFromAFile) {
    const auto sky = [](int, int y, size_t) { return y < 2 ? 1.0 : 0.0; };  // the upper half is lit
    io::writeExr(path("sky.exr"), imageOf(8, 4, colorNames, sky));
    scene_.environment = "sky.exr";
    scene_.lights.clear();
    const std::vector<float> above = shaded("--stats");
    EXPECT_TRUE(contains(said_.json().at("stats").at("features").dump(), "ambient_cube"));
    // The image's y axis is the world's -y: the lower half.
    const float turned[9] = {1, 0, 0, 0, -1, 0, 0, 0, -1};
    std::ranges::copy(turned, scene_.environmentAxes);
    const std::vector<float> below = shaded();
    for (size_t i = 0; i < above.size(); ++i)
        EXPECT_NEAR(above[i] + below[i], i / 3 % size_t(width) < 2 ? 0 : 0.5 / double(1 << i % 3), 2e-3) << i;
    scene_.environmentAxes[0] = 2;
    refuses("unit vectors at right angles");
    scene_.environmentAxes[0] = 1;
    io::writeExr(path("sky.exr"), imageOf(8, 5, colorNames, sky));
    refuses("equirectangular");
}

// A shelf in the left half of a cube's lowest face shades the left half of a floor; a cube of another shape
// is named.
TEST_F(ShadeFeatures, ACubeShadowMapFromTheSceneFile) {
    begin(width, height);
    const auto place = [](int x, int y, size_t c) { return c == 0 ? 4 * x - 22 : c == 1 ? 2 * y : 0; };
    add(PEL_SLOT_POSITION, positionNames, place);
    add(PEL_SLOT_NORMAL_SHADING, normalNames, [](int, int, size_t c) { return c == 2; });
    const auto map = [&](int height) {
        // Of -z, u is -x.
        const auto depth = [](int x, int y, size_t) { return y >= 5 * 32 && x >= 16 ? 0.2 : 1; };
        io::writeExr(path("cube.exr"), imageOf(32, height, {"Z"}, depth));
    };
    map(6 * 32);
    io::SceneLight& l = scene_.lights[0];
    l.light.type = PEL_LIGHT_POINT;
    l.light.position[2] = 50;
    l.light.worldToShadow[11] = -50;
    l.light.shadowProjection = PEL_SHADOW_CUBE_RADIAL;
    l.light.shadowDepthRange = 100;
    l.light.shadowFilterTexels = 24;
    for (float& c : l.light.color) c = 2500;
    scene_.materials[0].material.shadowFilterWidth = 4;
    l.shadowMapFile = path("cube.exr");
    const std::vector<float> out = shaded("--stats");
    EXPECT_TRUE(contains(said_.out, "shadow_cube"));
    for (int i = 0; i < width * height; ++i) {
        const int x = place(i % width, 0, 0);
        const float light = out[size_t(3 * i)];
        EXPECT_TRUE(x < -4 ? light < 0.01f : x <= 4 || light > 0.2f) << x << ": " << light;
    }
    map(32);
    refuses("32 x 192");
}

TEST_F(ShadeFeatures, AProfileIsEnough) {
    addSphere(30);
    write("mine.toml",
          "name = \"mine\"\nkind = \"burley\"\nunit = \"mm\"\nsource = \"a test\"\ndistance = [0.8, 0.4, "
          "0.2]\n");
    scene_.materials[0].profile = "mine.toml";
    // Rows of equal places have no area on a screen.
    scene_.materials[0].material.scattering = PEL_SCATTERING_PREINTEGRATED;
    const auto scattered = shaded();
    EXPECT_FALSE(contains(said_.err, "unit_mm")) << said_.err;
    scene_.materials[0].profile.clear();
    EXPECT_GT(farthest(shaded(), scattered), 0.005);
    scene_.materials[0].profile = "granite";
    refuses("granite");
    // FaceWorks' preset is what its tables are.
    scene_.materials[0].profile.clear();
    scene_.materials[0].preset = io::ScenePreset::faceworks;
    const auto preset = shaded();
    scene_.materials[0].preset = io::ScenePreset::none;
    scene_.luts.resize(2);
    scene_.luts[0].info = io::presetInfo(io::LutPreset::faceworks, PEL_LUT_CURVATURE);
    scene_.luts[1].info = io::presetInfo(io::LutPreset::faceworks, PEL_LUT_SHADOW);
    scene_.luts[0].name = scene_.luts[1].name = "t";
    scene_.materials[0].curvatureLut = scene_.materials[0].shadowLut = "t";
    EXPECT_EQ(shaded(), preset);
}

TEST_F(ShadeFeatures, SizesThatCannotBeTheProfilesAreSaid) {
    addSphere(90);
    scene_.materials[0].profile = "skin";
    for (const auto& [unit, likely] : {std::pair{1.0f, true}, {0.1f, false}, {100.0f, false}}) {
        scene_.options.millimetresPerUnit = unit;
        shaded();
        EXPECT_EQ(said_.err.find("unit_mm") == std::string::npos, likely) << unit << ": " << said_.err;
    }
}

// Distances below 1, as a scene in metres has them, would be places that are much too near or too far apart;
// so would the right depth of a scene whose unit is wrong.
TEST_F(ShadeFeatures, DepthThatGivesNoLikelySizeIsSaid) {
    const io::Image without = gbuffer_;
    const auto with = [&](float value, float unit) {
        gbuffer_ = without;
        add(PEL_SLOT_DEPTH, {"D.Z"}, [&](int, int, size_t) { return value; });
        scene_.options.millimetresPerUnit = unit;
        shaded();
        return said_.err;
    };
    EXPECT_TRUE(contains(with(250, 1), "depth channel reaches 250"));
    scene_.materials[0].profile = "skin";
    // A camera at the origin that looks along z, 90 degrees of view, planes at 0.1 m and 100 m.
    const float near = 0.1f, far = 100;
    std::fill(scene_.camera.inverseViewProjection, scene_.camera.inverseViewProjection + 16, 0.0f);
    float* m = scene_.camera.inverseViewProjection;
    m[0] = m[5] = 1;                                         // x, y of a point at distance 1
    m[11] = 1;                                               // z
    m[14] = -(far - near) / (far * near), m[15] = 1 / near;  // 1 / distance
    const float distance = 0.15f, device = far / (far - near) * (1 - near / distance);
    EXPECT_FALSE(contains(with(device, 1000), "unit_mm")) << said_.err;
    EXPECT_TRUE(contains(with(device, 1), "unit_mm"));
    EXPECT_TRUE(contains(with(0.99999f, 1000), "a distance along the view"));
    EXPECT_TRUE(contains(with(-250, 1), "depth channel reaches -250"));
}

TEST_F(ShadeFeatures, MapsOfPigmentsAreSkin) {
    addPlane();
    scene_.channels[PEL_SLOT_ALBEDO].clear();
    PelSkin skin = pelSkinDefaults();
    skin.melanin = 0.03f, skin.blood = 0.01f;
    done("profile skin --melanin 0.03 --blood 0.01 -o @cheek.toml");
    io::SceneMaterial& material = scene_.materials[0];
    material.profile = "cheek.toml";
    std::ranges::copy(skinInfo(skin).albedo, material.material.albedo);
    const auto plain = shaded();
    material.material.albedo[0] = 0.9f;
    const io::Image without = gbuffer_;
    const auto mapped = [&](const std::vector<float>& pigments) {
        gbuffer_ = without;
        add(PEL_SLOT_SKIN, Names{"Melanin.V", "Blood.V", "Oxygen.V"},
            [&](int, int, size_t c) { return pigments[std::min(c, pigments.size() - 1)]; });
        scene_.channels[PEL_SLOT_SKIN].resize(pigments.size());
        return shaded();
    };
    const auto even = mapped({0.03f, 0.01f});
    EXPECT_LT(farthest(even, plain), 1e-3);
    EXPECT_LT(farthest(mapped({0.03f, 0.01f, 0.75f}), plain), 1e-3);
    EXPECT_EQ(mapped({NAN, NAN}), even) << "the profile's own";
    EXPECT_EQ(mapped({7, -1}), mapped({0.5f, 0})) << "clamped";
    EXPECT_GT(farthest(mapped({0.12f, 0.01f}), plain), 0.1);
    scene_.channels[PEL_SLOT_SKIN] = {"Melanin.V", "Carotene.V"};
    refuses("Carotene.V");
}

// Every control of scattering that a scene file can name.
TEST_F(ShadeFeatures, MethodsAndTheirControls) {
    addPlane();
    add(PEL_SLOT_UV, {"UV.U", "UV.V"}, [](int x, int, size_t c) { return c ? 0.5f : float(x) / width; });
    addChannels(gbuffer_, {"B.R", "B.G", "B.B"}, [](int, int, size_t) { return 0.3; });
    addChannels(gbuffer_, {"W.V"}, [](int, int, size_t) { return 0; });
    scene_.channels[PEL_SLOT_UV].clear();
    scene_.materials[0].profile = "skin";
    PelMaterial& m = scene_.materials[0].material;
    m.scattering = PEL_SCATTERING_NONE;
    std::vector<std::vector<float>> all{shaded()};
    const auto differs = [&](const char* what) {
        all.push_back(shaded());
        for (size_t k = 0; k + 1 < all.size(); ++k) EXPECT_NE(all[k], all.back()) << what;
    };
    m.scattering = PEL_SCATTERING_SEPARABLE;
    differs("separable");
    m.scattering = PEL_SCATTERING_SCREEN;
    m.scatterTaps = 9;
    differs("disk");
    m.thinThickness = 0.2f;
    scene_.channels[PEL_SLOT_IRRADIANCE_BACK] = {"B.R", "B.G", "B.B"};
    differs("sheet");
    m.thinThickness = 0;
    scene_.channels[PEL_SLOT_SCATTER_WEIGHT] = {"W.V"};
    EXPECT_EQ(shaded(), all[0]);  // nothing of it is taken
    scene_.channels[PEL_SLOT_SCATTER_WEIGHT].clear();
    scene_.channels[PEL_SLOT_UV] = {"UV.U", "UV.V"};
    io::writeExr(path("lit.exr"), imageOf(4, 2, colorNames, [](int, int, size_t) { return 0.75; }));
    m.scattering = PEL_SCATTERING_TEXTURE;
    m.scatterTaps = 0;
    scene_.materials[0].scatteredTexture = "lit.exr";
    EXPECT_NEAR(shaded()[3 * 5], 0.75 * 0.5, 1e-3);  // times the albedo
    scene_.materials[0].scatteredTexture = "no.exr";
    refuses("no.exr");
}

// The front of a ball of 12 mm in units of 10 mm becomes an eye, whose table and textures come from files.
TEST_F(ShadeFeatures, EyesOfScenes) {
    begin(24, 24);
    const auto place = ball(24, 0.1f, 1.2f);
    add(PEL_SLOT_POSITION, positionNames, place);
    add(PEL_SLOT_NORMAL_SHADING, {"N.X", "N.Y", "N.Z"}, [&](int x, int y, size_t c) {
        const float p[3] = {place(x, y, 0), place(x, y, 1), place(x, y, 2)};
        return p[c] / std::hypot(p[0], p[1], p[2]);
    });
    add(PEL_SLOT_MATERIAL, {"Id.X"},
        [&](int x, int y, size_t) { return std::hypot(place(x, y, 0), place(x, y, 1)) < std::sqrt(1.4f); });
    scene_.options.millimetresPerUnit = 10;
    scene_.camera.position[2] = 40;
    const std::vector<float> plain = shaded();
    scene_.eyes.resize(1);
    const std::vector<float> eye = shaded("--stats");
    EXPECT_GT(said_.json()["stats"]["pixels_iris"], 0);
    size_t changed = 0;
    for (size_t i = 0; i < eye.size(); ++i) changed += eye[i] != plain[i];
    EXPECT_GT(changed, eye.size() / 10);
    done("lut eye -o @e.exr");
    scene_.eyes[0].caustics = "e.exr";
    EXPECT_EQ(shaded(), eye);

    const io::SceneFile good = scene_;
    const auto wrong = [&](const char* message, const std::function<void()>& change) {
        scene_ = good;
        change();
        std::filesystem::remove(path("o.exr"));
        write("s.toml", io::sceneText(scene_));
        refused(shade_, 3, message);
    };
    wrong("[[material]]", [&] { scene_.eyes[0].material = 9; });
    wrong("PelEye.pupilRadius", [&] { scene_.eyes[0].eye.pupilRadius = 6; });
    wrong("PelEye.gaze", [&] { scene_.eyes[0].eye.gaze[2] = 0; });
    wrong("position", [&] { scene_.channels[PEL_SLOT_POSITION].clear(); });
    wrong("another [[eye]]", [&] { scene_.eyes.push_back(scene_.eyes[0]); });
    write("s.toml", io::sceneText(good) + "\n[[eye]]\nmaterial = 2\n");
    refused(shade_, 3, "center");
}
