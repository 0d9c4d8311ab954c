// PELLUCID_CAPTURE: `pellucid shade` makes the same bits of a captured frame as the program it comes from.
#include "cli_shade.h"
#include "diffusion/scatter_scene.h"
#include "eye/eye_frame.h"
#include "shading/scattering_frame.h"
#include "variable.h"

using namespace shade_test;
using pellucid::Lut;
using pellucid::Profile;
namespace fs = std::filesystem;

namespace {

class Capture : public CommandTest {
  protected:
    void TearDown() override {
        pelSetLogCallback(nullptr, nullptr);
        CommandTest::TearDown();
    }
    // Runs `work` with the variable set. What the log says is in said_.
    template <class Work>
    void capturing(const std::string& folder, const Work& work) {
        said_.clear();
        pelSetLogCallback([](void* said, PelLogLevel, const char*,
                             const char* line) { static_cast<std::string*>(said)->append(line) += '\n'; },
                          &said_);
        const Variable capture("PELLUCID_CAPTURE", path(folder).c_str());
        work();
        pelSetLogCallback(nullptr, nullptr);
    }
    void capture(Shader& shader, const std::string& folder = "captures") {
        capturing(folder, [&] {
            shader.commit();
            said_.clear();
            shader.execute();
        });
    }
    void expectBits(const std::string& file, const std::vector<float>& expected) const {
        const pellucid::io::Image image = pellucid::io::readImage(path(file));
        const std::vector<float> is = image.channels.size() == 1 ? image.channels[0].pixels
                                                                 : image.interleaved(shade_files::colorNames);
        ASSERT_EQ(is.size(), expected.size());
        EXPECT_EQ(std::memcmp(is.data(), expected.data(), 4 * is.size()), 0) << file;
    }
    static void expectSomeLight(const std::vector<float>& values) {
        EXPECT_TRUE(std::ranges::any_of(values, [](float v) { return v > 0; }));
    }
    // Captures an execution, and compares what the command makes of it.
    void expectRepeats(Shader& shader, const Buffer& target) {
        capture(shader);
        expectRepeats("shader-1", target.readAll<float>());
    }
    void expectRepeats(const std::string& name, const std::vector<float>& expected) {
        EXPECT_EQ(said_, "");
        expectSomeLight(expected);
        done("shade @captures/" + name + "/scene.toml -o @again.exr");
        expectBits("again.exr", expected);
        fs::rename(path("captures"), path("captures-" + std::to_string(++number_)));
    }
    void expectRepeats(const Frame& f, const std::function<void(Shader&)>& change = {}) {
        auto [shader, target] = shaderOf(f);
        if (change) change(shader);
        expectRepeats(shader, target);
    }

    std::string said_;
    int number_ = 0;
};

std::vector<Profile> profiles() {
    const float paths[] = {1.2f, 0.7f, 0.31f}, albedos[] = {0.7f, 0.4f, 0.3f}, few[] = {0.02f, 0.1f, 0.3f};
    PelSkin skin = pelSkinDefaults();
    skin.melanin = 0.17f;
    return {Profile::skin(),
            Profile::gaussians({{0.1f, {0.3f, 0.4f, 0.5f}}, {1.3f, {0.7f, 0.5f, 0.1f}}}),
            Profile::burley(paths, albedos, PEL_BURLEY_SEARCHLIGHT),
            Profile::burleyDistance(paths),
            Profile::dipole(few, paths, 1.37f),
            Profile::table({0, 0.3f, 1.7f, 4}, {1, 1, 1, 0.5f, 0.4f, 0.3f, 0.1f, 0.05f, 0.01f, 0, 0, 0}),
            Profile::skinLayers(skin)};
}

}  // namespace

// Lights of all types with maps of both projections and wide shadows, tables of the caller's, every image.
TEST_F(Capture, RepeatsLightsAndTables) {
    const Frame f = randomFrame(5, 70, 40, 3);
    auto [shader, target] = shaderOf(f);
    const Buffer diffuse = setTarget(device(), shader, f, PEL_SLOT_OUT_DIFFUSE),
                 thickness = setTarget(device(), shader, f, PEL_SLOT_OUT_THICKNESS);
    expectRepeats(shader, target);
    expectBits("captures-1/shader-1/diffuse.exr", diffuse.readAll<float>());
    expectBits("captures-1/shader-1/thickness.exr", thickness.readAll<float>());
    // Textures that nothing reads need no coordinates.
    expectRepeats(randomFrame(7, 32, 16, 1), [](Shader& unread) {
        const Buffer values(device(), std::vector<float>(12, 0.5f));
        const PelImageDesc texture = imageDesc(values, PEL_FORMAT_RGB32F, 2, 2);
        unread.setScatteredTexture(1, texture).setNormalMap(1, {texture});
    });
}

// The previous radiance stays where there is no material, and is added to elsewhere.
TEST_F(Capture, RepeatsWhatRadianceHeld) {
    Frame f = randomFrame(5, 70, 40, 2);
    for (size_t i = 0; i < f.pixels(); i += 3) f.slots[PEL_SLOT_MATERIAL].values[i] = 0;
    Random random(3);
    for (const uint32_t accumulate : {0, 1}) {
        f.options.accumulate = accumulate;
        auto [shader, target] = shaderOf(f);
        std::vector<float> held(3 * f.pixels());
        for (float& v : held) v = random.uniform();
        target.write(held.data(), target.bytes());
        expectRepeats(shader, target);
        EXPECT_EQ(target.readAll<float>()[0], held[0]);
    }
}

TEST_F(Capture, RepeatsPackedFormats) {
    const Frame f = randomFrame(6, 64, 32, 1);
    Random random(7);
    const auto bytes = [&](uint32_t count, uint32_t highest = 255) {
        std::vector<uint8_t> values(count);
        for (uint8_t& v : values) v = uint8_t(random.below(highest + 1));
        return Buffer(device(), values);
    };
    const uint32_t n = uint32_t(f.pixels());
    expectRepeats(f, [&](Shader& shader) {
        const auto set = [&](PelImageSlot slot, PelFormat format, const Buffer& values) {
            shader.set(slot, imageDesc(values, format, f.width, f.height));
        };
        set(PEL_SLOT_NORMAL_SHADING, PEL_FORMAT_OCT16X2_SNORM, bytes(4 * n));
        set(PEL_SLOT_NORMAL_GEOMETRIC, PEL_FORMAT_RGBA8_UNORM, bytes(4 * n));
        set(PEL_SLOT_NORMAL_BLURRED, PEL_FORMAT_A2B10G10R10_UNORM, bytes(4 * n));
        set(PEL_SLOT_POSITION, PEL_FORMAT_RGBA16F, bytes(8 * n, 0x5b));  // no Inf, no NaN
        set(PEL_SLOT_ALBEDO, PEL_FORMAT_RGBA8_SRGB, bytes(4 * n));
        set(PEL_SLOT_AMBIENT_OCCLUSION, PEL_FORMAT_R8_UNORM, bytes(n));
        set(PEL_SLOT_ROUGHNESS, PEL_FORMAT_R16_UNORM, bytes(2 * n));
        set(PEL_SLOT_CURVATURE, PEL_FORMAT_R16F, bytes(2 * n, 0x38));
        set(PEL_SLOT_MATERIAL, PEL_FORMAT_R8_UINT, bytes(n, 3));
        shader.set(0, PEL_LIGHT_SHADOW_MAP, imageDesc(bytes(2 * 61 * 61), PEL_FORMAT_R16_UNORM, 61, 61));
        // A part of a larger image, every second pixel.
        const Buffer larger = bytes(2 * n + 64);
        PelImageDesc specular = imageDesc(larger, PEL_FORMAT_R8_UNORM, f.width, f.height, 33);
        specular.pixelStride = 2, specular.rowStride = 2 * f.width;
        shader.set(PEL_SLOT_SPECULAR, specular);
    });
}

// Under lights with and without a size, from two sides that share what is made of the shadow map.
TEST_F(Capture, RepeatsEveryMethodAndProfile) {
    const std::vector<Profile> all = profiles();
    for (const auto scattering :
         {PEL_SCATTERING_NONE, PEL_SCATTERING_PREINTEGRATED, PEL_SCATTERING_SEPARABLE, PEL_SCATTERING_SCREEN,
          PEL_SCATTERING_LIGHT, PEL_SCATTERING_TEXTURE, PEL_SCATTERING_AUTO}) {
        SCOPED_TRACE(int(scattering));
        Frame f = scatteringFrame(scattering, 96, 64);
        // Both materials have the same profile, except in one frame.
        const Profile first = all[scattering], second = scattering == PEL_SCATTERING_AUTO ? all[0] : first;
        f.materials[1].profile = first.get();
        f.materials[2].profile = second.get();
        f.materials[1].specular = 1, f.materials[1].specularModel = PEL_SPECULAR_GGX;
        if (scattering == PEL_SCATTERING_SEPARABLE) {
            f.options.historyWeight = 0.5f;
            f.slots[PEL_SLOT_MOTION] = {3, std::vector<float>(3 * f.pixels(), 0.25f)};
        }
        if (scattering == PEL_SCATTERING_SCREEN) {
            f.options.halfRate = f.options.frameIndex = 1;
            for (auto& [id, m] : f.materials) m.scatterTaps = 16, m.albedoBefore = 0.5f;
        }
        f.lights.resize(3);
        f.lights[1].params = pellucid::sphereLight({20, 0, 40}, 7, {800, 800, 800});
        f.lights[2].params = pellucid::rectangleLight({20, 0, 40}, {5, 0, 0}, {0, -3, 0}, {800, 800, 800});
        f.lights[0].params.shadowMapVersion = 1;
        const Buffer map(device(), f.lights[0].map.values);
        for (const float side : {-5.0f, 5.0f}) {
            f.camera.position[0] = side;
            expectRepeats(f, [&](Shader& shader) {
                shader.set(0, PEL_LIGHT_SHADOW_MAP, imageDesc(map, PEL_FORMAT_R32F, 64, 64));
                if (scattering != PEL_SCATTERING_TEXTURE) return;
                Random random(8);
                std::vector<float> texels(3 * 16 * 8);
                for (float& t : texels) t = random.uniform();
                for (uint32_t id : {1u, 2u})
                    shader.setScatteredTexture(id,
                                               imageDesc(Buffer(device(), texels), PEL_FORMAT_RGB32F, 16, 8));
            });
            if (scattering != PEL_SCATTERING_PREINTEGRATED) break;
        }
    }
}

TEST_F(Capture, RepeatsFormsOfShadowMaps) {
    for (const auto content :
         {PEL_SHADOW_CONTENT_DEPTH, PEL_SHADOW_CONTENT_MOMENTS, PEL_SHADOW_CONTENT_EXPONENTIAL}) {
        SCOPED_TRACE(int(content));
        Frame f = scatteringFrame(PEL_SCATTERING_PREINTEGRATED, 96, 64);
        for (auto& [id, m] : f.materials) std::fill_n(m.deepScatterColor, 3, 0.5f);
        const uint32_t components = content == PEL_SHADOW_CONTENT_MOMENTS ? 2 : 1;
        Light light = f.lights[0];
        light.map = {};
        PelLight& l = light.params;
        l.shadowContent = content;
        l.shadowExponent = 80;
        const auto map = [&](PelLightSlot slot, uint32_t width, uint32_t height) {
            std::vector<float> values;
            for (uint32_t i = 0; i < width * height; ++i) {
                const float z = i % width > width / 2 ? 0.2f : 0.48f;
                values.push_back(content == PEL_SHADOW_CONTENT_EXPONENTIAL ? std::exp(80 * z) : z);
                if (components == 2) values.push_back(z * z + 1e-4f);
            }
            return MapImage{slot, width, height, components, values};
        };
        l.shadowCascades = 3;
        for (int i = 0; i < 2; ++i) {
            std::copy_n(l.worldToShadow, 16, l.cascadeToShadow[i]);
            l.cascadeToShadow[i][0] /= float(2 + i);
            l.cascadeDepthRange[i] = l.shadowDepthRange;
        }
        light.maps = {map(PEL_LIGHT_SHADOW_MAP, 32, 32), map(PEL_LIGHT_CASCADE_1, 24, 40),
                      map(PEL_LIGHT_CASCADE_2, 16, 16)};
        Light lamp;
        lamp.params = pellucid::pointLight({20, 10, 40}, {800, 800, 800});
        for (int r = 0; r < 3; ++r)
            lamp.params.worldToShadow[5 * r] = 1,
                                          lamp.params.worldToShadow[4 * r + 3] = -lamp.params.position[r];
        lamp.params.shadowProjection = PEL_SHADOW_CUBE_RADIAL;
        lamp.params.shadowContent = content;
        lamp.params.shadowExponent = 80;
        lamp.params.shadowDepthRange = 100;
        lamp.params.shadowFilterTexels = 8;
        lamp.maps = {map(PEL_LIGHT_SHADOW_MAP, 12, 72)};
        f.lights = {light, lamp};
        expectRepeats(f);
    }
}

// A PelScatter with irradiance of the host.
TEST_F(Capture, RepeatsScatteringAlone) {
    namespace scene = scatter_scene;
    scene::Picture p = scene::ball(72, 10, 0.3, {0.8, 0.6, 0});
    for (size_t i = 0; i < 72 * 30; ++i)
        if (p.ids[i]) p.ids[i] = 2;
    p.params.white = 1.5f;
    p.params.targetError = 1e-3f;
    // Pixels of 0.3, depth along z.
    p.params.inverseViewProjection[0] = p.params.inverseViewProjection[5] = 36 * 0.3f;
    p.params.inverseViewProjection[10] = p.params.inverseViewProjection[15] = 1;
    Random random(4);
    const auto values = [&](uint32_t components) {
        std::vector<float> image(components * p.pixels());
        for (float& v : image) v = random.uniform(0.2f, 1);
        return image;
    };
    scene::Extra plain, full, byDepth;
    full.weights = values(2), full.albedo = values(3), full.back = values(3), full.curvature = values(1);
    full.inPlace = true;
    for (size_t i = 2; i < p.positions.size(); i += 3) byDepth.depth.push_back(p.positions[i]);
    byDepth.normals = p.positions;
    for (float& n : byDepth.normals) n /= 10;
    const std::vector<Profile> all = profiles();
    struct Case {
        PelScattering method;
        uint32_t taps;
        const scene::Extra& extra;
    };
    for (const Case& c : {Case{PEL_SCATTERING_SCREEN, 0, plain},
                          {PEL_SCATTERING_SCREEN, 0, full},
                          {PEL_SCATTERING_SCREEN, 16, byDepth},
                          {PEL_SCATTERING_SEPARABLE, 0, full}}) {
        SCOPED_TRACE(number_);
        p.params.halfRate = c.extra.inPlace;
        p.params.everywhere = !c.extra.depth.empty();
        p.params.frameIndex = c.taps;
        scene::Material first{1, all[2], 0.9f, scene::controlsOf(c.method, c.taps)},
            second{2, all[0], 1.1f, scene::controlsOf(PEL_SCATTERING_SCREEN, 32, 0.25f)};
        if (c.extra.inPlace) first.controls.albedoBefore = 0.3f, first.controls.thinThickness = 0.7f;
        std::vector<float> light;
        capturing("captures", [&] { light = scene::run(p, {first, second}, c.extra).scattered; });
        expectRepeats("scatter-1", light);
    }

    // Into an image that holds something, after a warm-up and a refused call, which are no frames.
    scene::Scatter scatter(device());
    std::vector<float> sum;
    p.params.accumulate = 1;
    capturing("captures", [&] {
        const auto image = scene::imageOf(device(), p.irradiance, p.width, p.height),
                   places = scene::imageOf(device(), p.positions, p.width, p.height);
        const Buffer result(device(), p.irradiance);
        const PelImageDesc out = imageDesc(result, PEL_FORMAT_RGB32F, p.width, p.height);
        scatter.setMaterial(1, all[0]);
        scatter.warmUp(device(), p.params, image, places, nullptr, nullptr, out);
        EXPECT_THROW(scatter.execute(p.params, image, nullptr, nullptr, nullptr, out), pellucid::Error);
        EXPECT_FALSE(fs::exists(path("captures")));
        pellucid::check(pelSetName(scatter.get(), "head"));
        scatter.execute(p.params, image, places, nullptr, nullptr, out);
        sum = result.readAll<float>();
        scatter.execute(p.params, image, places, nullptr, nullptr, out);
    });
    EXPECT_FALSE(fs::exists(path("captures/head-2")));
    const std::string file = "@captures/head-1/scene.toml";
    done("shade " + file + " -o @light.exr --picture @light.png");
    expectBits("light.exr", sum);
    EXPECT_TRUE(fs::exists(path("light.png")));
    refused("shade " + file + " -o @o.exr --stats", 2, "[scatter] table, whose result is one image");
    refused("warm-up " + file, 3, "nothing to shade: `pellucid shade` alone");
}

TEST_F(Capture, RepeatsEyesCubesAndNormalMaps) {
    eye_test::EyeFrame frame(128, 96, 0.3f, 64, 48);
    Shader shader(frame.device);
    frame.prepare(shader);
    Random random(9);
    const auto colors = [&](uint32_t count) {
        std::vector<float> values(3 * count);
        for (float& v : values) v = random.uniform();
        return Buffer(frame.device, values);
    };
    PelEye eye = pelEyeDefaults();
    eye.gaze[0] = 0.3f, eye.gaze[1] = 0.1f, eye.gaze[2] = 2;  // not of unit length
    eye.up[0] = 0.2f;
    const Profile iris = profiles()[2];
    eye.irisProfile = iris.get();
    PelEyeLutDesc table = pelEyeLutDescOf(&eye);
    table.profile = nullptr;
    shader.setEye(2, eye, Lut(frame.device, table));
    shader.setIrisTexture(2, imageDesc(colors(32 * 32), PEL_FORMAT_RGB32F, 32, 32));
    shader.setReflectionCube(imageDesc(colors(6 * 16), PEL_FORMAT_RGB32F, 4, 24));
    shader.setAmbientCube(imageDesc(colors(6 * 4), PEL_FORMAT_RGB32F, 12, 2));
    const float axes[9] = {0, 1, 0, 0, 0, 1, 1, 0, 0};
    shader.setEnvironment(imageDesc(colors(8 * 4), PEL_FORMAT_RGB32F, 8, 4), axes);
    const auto set = [&](PelImageSlot slot, PelFormat format, uint32_t components, float low) {
        std::vector<float> values(components * frame.pixels());
        for (float& v : values) v = random.uniform(low, 1);
        shader.set(slot, imageDesc(Buffer(frame.device, values), format, frame.width, frame.height));
    };
    set(PEL_SLOT_WETNESS, PEL_FORMAT_R32F, 1, 0);
    set(PEL_SLOT_UV, PEL_FORMAT_RG32F, 2, 0);
    set(PEL_SLOT_UV_GRADIENT, PEL_FORMAT_RGBA32F, 4, -0.2f);
    set(PEL_SLOT_TANGENT, PEL_FORMAT_RGBA32F, 4, -1);
    PelMaterial wall = pelMaterialDefaults();
    wall.profile = iris.get();
    wall.scattering = PEL_SCATTERING_PREINTEGRATED;
    shader.setMaterial(1, wall);
    // Values that do not survive a detour over 0 to 1, and 8 bits.
    const Buffer levels = colors(16 * 8 + 8 * 4 + 4 * 2);
    shader.setNormalMap(1, {imageDesc(levels, PEL_FORMAT_RGB32F, 16, 8),
                            imageDesc(levels, PEL_FORMAT_RGB32F, 8, 4, 16 * 8 * 12),
                            imageDesc(levels, PEL_FORMAT_RGB32F, 4, 2, (16 * 8 + 8 * 4) * 12)});
    const Buffer target(frame.device, std::vector<float>(3 * frame.pixels()));
    shader.set(PEL_SLOT_RADIANCE, frame.image(target));
    expectRepeats(shader, target);
}

TEST_F(Capture, WritesTheRegionAlone) {
    Frame f = randomFrame(5, 70, 40, 2);
    f.options.regionX = 7, f.options.regionY = 3, f.options.regionWidth = 50, f.options.regionHeight = 31;
    auto [shader, target] = shaderOf(f);
    capture(shader);
    const std::vector<float> all = target.readAll<float>();
    std::vector<float> region;
    for (size_t y = 3; y < 34; ++y)
        region.insert(region.end(), &all[3 * (70 * y + 7)], &all[3 * (70 * y + 57)]);
    expectRepeats("shader-1", region);
}

TEST_F(Capture, WritesEachShaderOnceAndNothingOver) {
    const Frame f = randomFrame(1, 32, 16, 1);
    Shader first(device()), second(device());
    for (Shader* s : {&first, &second}) setFrame(device(), *s, f, tables());
    const Buffer a = setTarget(device(), first, f), b = setTarget(device(), second, f);
    pellucid::check(pelSetName(second.get(), "head/../left"));
    // Links that somebody else put there are left alone, wherever they point to.
    fs::create_directories(path("elsewhere"));
    fs::create_directories(path("captures"));
    fs::create_directory_symlink(path("elsewhere"), path("captures/shader-1"));
    fs::create_symlink(path("nowhere"), path("captures/shader-2"));
    capture(first);
    capture(first);
    capture(second);
    EXPECT_TRUE(fs::is_empty(path("elsewhere")));
    EXPECT_FALSE(fs::exists(path("nowhere")));
    EXPECT_TRUE(fs::exists(path("captures/shader-3/scene.toml")));
    EXPECT_FALSE(fs::exists(path("captures/shader-4")));
    EXPECT_TRUE(fs::exists(path("captures/head____left-1/scene.toml")));
    const std::string before = read(path("captures/shader-3/scene.toml"));
    auto [third, c] = shaderOf(f);
    capture(third);
    EXPECT_EQ(read(path("captures/shader-3/scene.toml")), before);
    EXPECT_EQ(read(path("captures/shader-4/scene.toml")), before);
}

// Settings that a scene cannot hold, and an unwritable folder, are reported; the frame is still shaded.
TEST_F(Capture, SaysWhatIsLeftOut) {
    Frame f = randomFrame(1, 32, 16, 1);
    f.options.scratchBudget = 64 << 20;
    f.options.invalidColor[1] = 1;
    f.lights[0].params.toLight[0] *= 1.0001f;
    f.lights.resize(9, f.lights[0]);
    f.lights[8].params.type = PEL_LIGHT_SPOT;
    f.lights[8].params.spotDirection[0] = f.lights[8].params.spotDirection[1] = 0;
    f.lights[8].params.spotDirection[2] = 1.0001f;
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    const Buffer map(device(), f.lights[0].map.values);
    const PelImageDesc shared = imageDesc(map, PEL_FORMAT_R32F, 61, 61);
    for (uint32_t i = 0; i < 9; ++i) shader.set(i, PEL_LIGHT_SHADOW_MAP, shared);
    const Buffer target = setTarget(device(), shader, f);
    capture(shader);
    for (const char* words :
         {"PelShaderOptions.scratchBudget: --scratch-mib 64", "PelShaderOptions.invalidColor",
          "PelLight 0.toLight", "PelLight 8.spotDirection", "lights' 18 images share buffers"})
        EXPECT_TRUE(contains(said_, words));
    expectSomeLight(target.readAll<float>());

    write("a_file", "");
    const Frame plain = randomFrame(1, 32, 16, 1);
    for (const char* folder : {"captures", "a_file"}) {
        auto [other, kept] = shaderOf(plain);
        capture(other, folder);
        expectSomeLight(kept.readAll<float>());
    }
    EXPECT_TRUE(contains(said_, "PELLUCID_CAPTURE: "));
    const Result heard =
        done("shade @captures/shader-2/scene.toml -o @again.exr", "PELLUCID_CAPTURE=@a_file");
    EXPECT_TRUE(contains(heard.err, "PELLUCID_CAPTURE: ")) << "there is no log callback";
}

TEST_F(Capture, SceneWithoutGBufferIsRefused) {
    write("s.toml", "[channels]\nnormal_shading = ['a.X', 'a.Y', 'a.Z']\n");
    refused("shade @s.toml -o @o.exr", 2, "names none");
}
