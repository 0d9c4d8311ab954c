// `pellucid shade` and `pellucid warm-up`: G-buffer and scene in, pictures out; what is wrong with either.
#include "cli_shade.h"
#include "io/image/color_map.h"

#include <functional>
#include <regex>

using namespace pellucid;
using namespace shade_files;

TEST_F(Shade, PlainLightIsAlbedoTimesCosine) {
    const std::vector<float> pixels = shaded("--stats");
    const nlohmann::json report = said_.json();
    expectReport(report);
    EXPECT_EQ(report.at("pixels"), width * height);
    EXPECT_EQ(report.at("stats").at("pixels_shaded"), (width - 2) * height);
    EXPECT_EQ(report.at("pixels_invalid"), 0);
    ASSERT_EQ(pixels.size(), size_t(3 * width * height));
    const float color[3] = {2.0f, 1.0f, 0.5f}, albedo[3] = {0.5f, 0.25f, 0.125f};
    for (size_t i = 0; i < pixels.size(); ++i) {
        const size_t column = i / 3 % width, c = i % 3;
        const float lit = std::max(0.0f, std::cos(0.2f * float(column)));
        EXPECT_NEAR(pixels[i], column < 2 ? 0.0f : albedo[c] * color[c] * lit, tolerance::shadeTerm) << i;
    }
}

// Roughness is one of the albedo's channels, and a channel of its own.
TEST_F(Shade, AChannelMayBeInSeveralImages) {
    addChannels(gbuffer_, positionNames, [](int x, int y, size_t c) { return c ? c == 1 ? -y : 0 : x; });
    addChannels(gbuffer_, {"Rough.V"}, [](int, int, size_t) { return 0.25; });
    scene_.channels[PEL_SLOT_POSITION] = positionNames;
    scene_.camera.position[2] = 100;
    scene_.materials[0].material.specular = 1;
    const std::vector<float> plain = shaded();
    scene_.channels[PEL_SLOT_ROUGHNESS] = {"Rough.V"};
    const std::vector<float> apart = shaded();
    EXPECT_NE(apart, plain);
    scene_.channels[PEL_SLOT_ROUGHNESS] = {albedoNames[1]};
    EXPECT_EQ(shaded(), apart);
}

TEST_F(Shade, PicturesToLookAt) {
    const std::vector<float> radiance =
        shaded("--picture @sheet.png --show final,diffuse,specular --tonemap filmic");
    expectKept("sheet.png", "shade.png", "0.0003");
    EXPECT_EQ(reportOf(shade_ + " --picture @sheet.png").at("picture"), path("sheet.png"));
    EXPECT_FALSE(reportOf(shade_).contains("picture"));
    for (const std::string name : {"p.png", "p.jpg", "p.bmp", "p.tga"}) {
        done("shade @g.exr --scene @s.toml --exposure 0.5 --tonemap NONE -o @" + name);
        const io::Image picture = io::readImage(path(name));
        ASSERT_EQ(picture.width, width);
        ASSERT_EQ(picture.channels.size(), 3u);
        if (name == "p.jpg") continue;  // close to it only
        const std::vector<float> shown = picture.interleaved(colorNames);
        for (size_t i = 0; i < shown.size(); ++i)
            EXPECT_NEAR(255 * shown[i], 255 * io::encodeSrgb(std::min(0.5f * radiance[i], 1.0f)), 0.51)
                << name << i;
    }
}

// A frame of NaN gives a warning, not a black picture without a message.
TEST_F(Shade, InvalidPixelsAreCountedAndWarnedOf) {
    const std::vector<float> good = gbuffer_.channels[0].pixels;
    shaded("--strict");
    for (const bool all : {true, false})
        for (const float value :
             {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
            std::vector<float>& normals = gbuffer_.channels[0].pixels = good;
            for (size_t i = 0; i < normals.size(); ++i)
                if (all || i % width == 3) normals[i] = value;
            const std::string message =
                (all ? "all 50 pixels" : "5 of 50 pixels") + std::string(" of a material have NaN or Inf");
            refuses(message, "--strict");
            shaded();
            EXPECT_TRUE(contains(said_.err, "warning: " + message));
            EXPECT_EQ(said_.json().at("pixels_invalid"), all ? 50 : 5);
            EXPECT_EQ(said_.json().at("warnings").size(), 1u);
        }
}

TEST_F(Shade, WhatASceneNamesAndIsNotThereIsAnsweredWithThoseFound) {
    scene_.channels[PEL_SLOT_CURVATURE] = {"Curvature.V"};
    refuses(
        "has no channel 'Curvature.V'; it has: View.Col.R, View.Col.G, View.Col.B, View.Id.X, "
        "View.N.X, View.N.Y, View.N.Z");
    scene_.channels[PEL_SLOT_CURVATURE].clear();
    scene_.lights[0].wideShadow = "W";
    refuses("has no channel 'W'");
    scene_.lights[0].wideShadow.clear();
    scene_.lights[0].shadowMapFile = "none.exr";
    refuses("none.exr: cannot be read");
    // One map's channel is the only one, another map names one that the same file lacks.
    pellucid::io::Image depths;
    depths.source = "z.exr", depths.width = depths.height = 4;
    depths.addInterleaved(std::vector<std::string>{"Z"}, std::vector<float>(16, 1));
    pellucid::io::writeExr(path("z.exr"), depths);
    scene_.lights[0].shadowMapFile = path("z.exr");
    scene_.lights.push_back(scene_.lights[0]);
    scene_.lights[1].shadowMapChannel = "Q";
    refuses("z.exr: has no channel 'Q'; it has: Z");
}

TEST_F(Shade, TablesFromFilesAreThoseThatAreAskedFor) {
    scene_.luts.resize(1);
    scene_.luts[0].name = scene_.materials[0].curvatureLut = "t";
    scene_.luts[0].file = "g.exr";  // an image, but no look-up table
    refuses("pellucid:format");
    done("lut shadow -o @t.exr --size 8x8");
    scene_.luts[0].file = "t.exr";
    refuses("kind is shadow; curvature is asked for");
    done("lut curvature -o @t.exr --size 8x8 --axis root --radius-min 1 --radius-max 100");
    shaded();
    const std::string asking = read(path("s.toml"));
    for (const auto& [keys, message] :
         {std::pair<std::string, const char*>{"axis = \"root\"\nwidth = 8\nradius_max = 100", nullptr},
          {"diffusion_radius = 0\nradius_min = 0", nullptr},  // the profile's own, whatever it is
          {"axis = \"linear\"", "axis is root; linear is asked for"},
          {"form = \"arc\"", "form is sphere; arc is asked for"},
          {"radius_min = 0.5", "radius_min is 1; 0.5 is asked for"},
          {"diffusion_radius = 3", "diffusion_radius is 2.7; 3 is asked for"}}) {
        std::string text = asking;
        write("s.toml", text.replace(text.find("file = \"t.exr\""), 14, "file = \"t.exr\"\n" + keys));
        if (message)
            refused(shade_, 3, message);
        else
            done(shade_);
    }
}

// Shading after a warm-up compiles nothing more; kernels are seen where the device is PoCL's.
class WarmUp : public Shade {
  protected:
    std::vector<std::string> compiled() const {
        std::vector<std::string> kernels;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(path("cache")))
            if (entry.path().extension() == ".so") kernels.push_back(entry.path());
        std::ranges::sort(kernels);
        return kernels;
    }
    void expectNothingLeftToCompile(const std::string& environment, const std::string& kernel) {
        std::filesystem::create_directories(path("cache"));
        io::writeExr(path("g.exr"), gbuffer_, io::ExrCompression::Rle);
        io::writeScene(path("s.toml"), scene_);
        const nlohmann::json built = reportOf("warm-up @s.toml", environment);
        expectReport(built);
        EXPECT_GE(built.at("programs").get<int>(), 1);
        const std::vector<std::string> before = compiled();
        done(shade_, environment);
        EXPECT_EQ(compiled(), before);
        if (contains(built.at("device"), "pthread")) {
            EXPECT_GT(std::ranges::count_if(before, [&](const auto& k) { return k.ends_with(kernel); }), 0);
        }
    }
};

TEST_F(WarmUp, BuildsAheadForTheDriversCache) {
    gbuffer_ = imageOf(24, 8, normalNames, [](int, int, size_t) { return 0.577; });
    addChannels(gbuffer_, albedoNames, [](int, int, size_t) { return 0.5; });
    addChannels(gbuffer_, {"View.Id.X"}, [](int, int, size_t) { return 1; });
    expectNothingLeftToCompile("POCL_CACHE_DIR=@cache PELLUCID_CACHE_DIR=@binaries", ".so");
}

// More vectors of pixels, and of shadow-map texels, than the size above which PoCL compiles kernels
// separately.
TEST_F(WarmUp, OfALargeFrameThatScatters) {
    gbuffer_ = imageOf(1440, 760, positionNames, [](int x, int y, size_t c) {
        return c == 0 ? 0.1 * (x - 720) : c == 1 ? 0.1 * (380 - y) : 0;
    });
    addChannels(gbuffer_, normalNames, [](int, int, size_t c) { return c == 2; });
    addChannels(gbuffer_, {"View.Id.X"}, [](int x, int, size_t) { return x < 300; });
    const io::Image map = imageOf(1200, 900, {"Z"}, [](int x, int, size_t) { return x < 400 ? 0.2 : 1; });
    io::writeExr(path("map.exr"), map, io::ExrCompression::Rle);
    scene_.channels[PEL_SLOT_POSITION] = positionNames;
    scene_.channels[PEL_SLOT_ALBEDO] = {};
    scene_.materials[0].profile = "skin";
    scene_.camera.position[2] = 300;
    io::SceneLight& light = scene_.lights[0];
    light.shadowMapFile = path("map.exr");
    for (int i = 0; i < 4; ++i) light.light.worldToShadow[5 * i] = i < 2 ? 0.005f : i == 2 ? -0.01f : 1.0f;
    for (int i = 0; i < 3; ++i) light.light.worldToShadow[4 * i + 3] = 0.5f;
    light.light.shadowDepthRange = 100;
    expectNothingLeftToCompile("PELLUCID_CACHE=auto POCL_CACHE_DIR=@cache", "light_texels.so");
}

// The JSON reports of commands, without times and properties of the device.
TEST_F(Shade, ReportsOfCommandsAreThoseThatWereKept) {
    std::filesystem::copy_file(PELLUCID_SOURCE_DIR "/data/heads/head_male.obj", path("m.obj"));
    const std::regex changes(
        "ms|.*_ms|.*milliseconds|programs_built|device|warnings|passes|launches|bytes.*");
    const std::function<void(nlohmann::json&)> drop = [&](nlohmann::json& part) {
        for (auto at = part.begin(); at != part.end();)
            if (part.is_object() && std::regex_match(at.key(), changes)) {
                at = part.erase(at);
            } else {
                if (at->is_structured()) drop(*at);
                ++at;
            }
    };
    nlohmann::json all;
    for (const char* line :
         {"profile list", "profile show jade", "profile fit marble --gaussians 3",
          "profile skin --melanin 0.1", "lut curvature -o @a.exr",
          "lut curvature --preset faceworks --size 64x64 --axis root -o @b.exr",
          "lut curvature --preset faceworks --size 32x8 -o @c.exr",
          "lut curvature --size 8x6 --form arc --axis linear -o @d.exr",
          "lut shadow --profile marble -o @c.exr",
          "lut shadow --size 16x8 --width-min 4 --width-max 40 --open-ends -o @d.exr",
          "lut shadow --preset faceworks --diffusion-radius 1.5 -o @d.exr",
          "lut specular --size 8x8 -o @d.exr", "lut eye --size 8x8x4 -o @e.exr", "curvature @m.obj -o @c.npy",
          "shade @g.exr --scene @s.toml -o @o.exr --stats", "compare @a.exr @b.exr"})
        drop(all[line] = reportOf(line));
    std::string text = all.dump(1);
    for (size_t at; (at = text.find(path(""))) != std::string::npos;) text.replace(at, path("").size(), "@");
    write("reports.json", text);
    expectKeptText("reports.json", "reports.json");
}
