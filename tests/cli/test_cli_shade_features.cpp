// `pellucid shade`: features of scene files other than plain light: tables, profiles and their units,
// scattering, parts of the picture, cubes, eyes.
#include "cli_shade.h"
#include "io/image/color_map.h"

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
    // Another file's profile of the same name is another one.
    scene_.luts.clear();
    scene_.materials[0].curvatureLut = "";
    scene_.materials[0].profile = "own.toml";
    scene_.materials[0].preset = io::ScenePreset::faceworks;
    const auto alone = shaded();
    write("too.toml", "name = \"own\"\nsource = \"a test\"\nkind = \"skin\"\n");
    scene_.materials.insert(scene_.materials.begin(), scene_.materials[0]);
    scene_.materials[0].id = 2;
    scene_.materials[0].profile = "too.toml";
    EXPECT_EQ(shaded(), alone);
}

// What is measured: tests/shading/test_screen_curvature.cpp.
TEST_F(ShadeFeatures, CurvatureFromThePictureItself) {
    addSphere(4);
    addChannels(gbuffer_, {"Flat.V"}, [](int, int, size_t) { return 0; });
    scene_.materials[0].curvatureLut = "skin";
    scene_.luts.resize(1);
    scene_.luts[0].name = "skin";
    scene_.luts[0].info.curvature.width = scene_.luts[0].info.curvature.height = 16;
    const auto of = [&](const char* curvature) {
        scene_.channels[PEL_SLOT_CURVATURE] = {curvature};
        return shaded();
    };
    // As the library measures it from the same images, without differences between materials.
    add(PEL_SLOT_MATERIAL, {"Two.V"}, [](int x, int, size_t) { return x < 2 ? 0 : x < 7 ? 1 : 2; });
    const std::vector<float> sphere = gbuffer_.interleaved(positionNames);
    const Names apartNames = {"Apart.X", "Apart.Y", "Apart.Z"};
    add(PEL_SLOT_POSITION, apartNames, [&](int x, int y, size_t c) {
        return sphere[size_t(3 * (y * width + x)) + c] + (c == 0 && x >= 7 ? 0.2f : 0.0f);
    });
    scene_.materials.push_back(scene_.materials[0]);
    scene_.materials[1].id = 2;
    const Device device;
    const auto image = [&](const Names& names, PelFormat format) {
        return imageDesc(Buffer(device, gbuffer_.interleaved(names)), format, width, height);
    };
    const Buffer measured(device, size_t(width) * height * sizeof(float));
    screenCurvature(device, pelScreenCurvatureParamsDefaults(), image(normalNames, PEL_FORMAT_RGB32F),
                    image(apartNames, PEL_FORMAT_RGB32F), nullptr, image({"Two.V"}, PEL_FORMAT_R32F),
                    imageDesc(measured, PEL_FORMAT_R32F, width, height));
    gbuffer_.addInterleaved(Names{"Measured.V"}, measured.readAll<float>());
    EXPECT_EQ(of("screen"), of("Measured.V"));
    EXPECT_GT(farthest(of("screen"), of("Flat.V")), 0.01);
    // Of geometric normals where there are some.
    add(PEL_SLOT_NORMAL_GEOMETRIC, {"G.X", "G.Y", "G.Z"}, [](int, int, size_t c) { return c == 2; });
    EXPECT_LE(farthest(of("screen"), of("Flat.V")), 1e-6);
    scene_.channels[PEL_SLOT_CURVATURE] = {"screen"};
    scene_.channels[PEL_SLOT_POSITION].clear();
    refuses("[channels] curvature");
}

// That they add up to the picture: tests/shading/test_shade.cpp.
TEST_F(ShadeFeatures, PartsOfThePictureAreFiles) {
    add(PEL_SLOT_THICKNESS, {"Wall.V"}, [](int, int, size_t) { return 3; });  // that nothing else reads
    scene_.outputs[PEL_SLOT_OUT_THICKNESS] = "own name.exr";                  // beside the scene
    shaded("--outputs all --stats");
    const auto report = said_.json();
    ASSERT_EQ(report.at("outputs").size(), 5u);
    for (const auto& file : report.at("outputs"))
        EXPECT_TRUE(std::filesystem::exists(file.get<std::string>())) << file;
    for (const std::string part : {"diffuse", "deep_scatter", "specular"})
        EXPECT_EQ(io::readImage(path("o_" + part + ".exr")).interleaved(colorNames).size(),
                  3u * width * height);
    const auto thickness = channel("o_thickness.exr", "Thickness.V");
    for (size_t i = 0; i < thickness.size(); ++i) EXPECT_EQ(thickness[i], i % width < 2 ? 0.0f : 3.0f);
    EXPECT_EQ(thickness, channel("own name.exr", "Thickness.V"));
    scene_.options.millimetresPerUnit = 10;  // colours end at 30 mm
    shaded("--picture @t.png --show thickness");
    const io::Image picture = io::readImage(path("t.png"));
    for (size_t c = 0; c < 3; ++c)
        EXPECT_EQ(std::lround(255 * picture.channels[c].pixels[width - 1]), io::sequentialColor(1)[c]);
    for (const auto& [file, message] :
         {std::pair{"o.exr", "written twice"}, {"./o.exr", "written twice"}, {"o.png", ".exr"}}) {
        scene_.outputs[PEL_SLOT_OUT_THICKNESS] = file;
        refuses(message);
    }
}

// Their values are tested in tests/cli/test_cli_capture.cpp, against the bits of the library.
TEST_F(ShadeFeatures, CubesAndEnvironmentsAreReadFromFiles) {
    const auto file = [&](int across, int down, const Names& names = colorNames) {
        io::writeExr(path("sky.exr"), imageOf(across, down, names, ones));
    };
    scene_.ambientCube = "sky.exr";
    scene_.materials[0].material.deepScatterAmbient = 0.5f;
    file(1, 6);
    shaded("--stats --outputs thickness");
    EXPECT_EQ(said_.json().at("stats").at("features"),
              nlohmann::json({"ambient", "outputs", "ambient_cube"}));
    EXPECT_TRUE(contains(said_.err, "deep_scatter_ambient of material 1 does nothing"));
    EXPECT_TRUE(contains(said_.err, "thickness output is 0 everywhere"));
    file(1, 5);
    refuses("six square faces");
    scene_.ambientCube.clear();
    addSphere(30);
    scene_.environment = "sky.exr";
    file(8, 4);
    shaded("--stats");
    EXPECT_TRUE(contains(said_.json().at("stats").at("features").dump(), "ambient_cube"));
    scene_.environmentAxes[0] = 2;
    refuses("unit vectors at right angles");
    scene_.environmentAxes[0] = 1;
    file(8, 5);
    refuses("equirectangular");
    scene_.environment.clear();
    io::SceneLight& lamp = scene_.lights[0];
    lamp.light.type = PEL_LIGHT_POINT;
    lamp.light.position[2] = 50;
    lamp.light.worldToShadow[11] = -50;
    lamp.light.shadowProjection = PEL_SHADOW_CUBE_RADIAL;
    lamp.light.shadowDepthRange = 100;
    lamp.shadowMapFile = path("sky.exr");
    file(32, 6 * 32, {"Z"});
    shaded("--stats");
    EXPECT_TRUE(contains(said_.out, "shadow_cube"));
    file(32, 32, {"Z"});
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

// The file has its radius in mm, whatever the scene's unit.
TEST_F(ShadeFeatures, ATableIsTheSameFromItsFile) {
    addSphere(30);
    scene_.options.millimetresPerUnit = 0.5f;
    scene_.luts.resize(1);
    scene_.luts[0].name = scene_.materials[0].curvatureLut = "t";
    scene_.materials[0].material.scattering = PEL_SCATTERING_PREINTEGRATED;
    const std::vector<float> made = shaded();
    done("lut curvature -o @t.exr --encoding float");
    scene_.luts[0].file = "t.exr";
    const std::vector<float> read = shaded();
    for (size_t i = 0; i < made.size(); ++i) ASSERT_NEAR(read[i], made[i], tolerance::shadeTerm) << i;
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

// Distances below 1, as in a scene in metres, would give positions that are much too close together or too
// far apart; so would the right depth with a wrong unit.
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
    scene_.eyes.resize(1);
    const std::vector<float> eye = shaded("--stats");
    EXPECT_GT(said_.json()["stats"]["pixels_iris"], 0);
    done("lut eye -o @e.exr");
    scene_.eyes[0].caustics = "e.exr";
    EXPECT_EQ(shaded(), eye);

    std::filesystem::remove(path("o.exr"));
    const io::SceneFile good = scene_;
    const auto wrong = [&](const char* message, const std::function<void()>& change) {
        scene_ = good;
        change();
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
