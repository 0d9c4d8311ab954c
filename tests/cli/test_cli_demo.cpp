// `pellucid demo`: mesh in, pictures out, and `pellucid shade` makes the same pictures from the demo's files.
#include "cli_shade.h"
#include "sample/vector.h"

using namespace pellucid;

using Demo = CommandTest;

TEST_F(Demo, ShadeMakesTheSamePicturesAndSomebodyLookedAtThem) {
    const auto report = reportOf("demo -o @demo --size 192x108");
    expectReport(report);
    for (const auto& entry : report.at("pictures"))
        EXPECT_GT(std::filesystem::file_size(entry.get<std::string>()), 0u) << entry;
    for (const std::string view : {"key", "backlit"}) {
        const std::string base = "@demo/" + view;
        done("shade " + base + "_gbuffer.exr --scene " + base + ".toml -o @again.exr");
        const std::vector<float> a = io::readImage(path("demo/" + view + ".exr"))
                                         .interleaved(shade_files::colorNames),
                                 b = io::readImage(path("again.exr")).interleaved(shade_files::colorNames);
        ASSERT_EQ(a.size(), 3 * 192u * 108u);
        ASSERT_EQ(a.size(), b.size());
        EXPECT_EQ(std::memcmp(a.data(), b.data(), 4 * a.size()), 0) << view;
        EXPECT_GT(*std::ranges::max_element(a), 0);
    }
    std::set<std::string> stages;
    for (const auto& stage : report.at("stages")) {
        EXPECT_GE(stage.at("wall_ms"), stage.at("device_ms"));
        stages.insert(stage.at("stage"));
    }
    for (const char* part :
         {"G-buffer (sample host)", "key: light and shadow maps (sample host)", "key: kernels"})
        EXPECT_TRUE(stages.contains(part)) << part;
    // The scenes of bench/roofline can be derived from the demo's scenes, and can be read.
    const std::string roofline = "python3 '" PELLUCID_SOURCE_DIR "/bench/roofline' --scenes @demo";
    ASSERT_EQ(std::system(filled(roofline).c_str()), 0);
    for (const std::string scene : {"surface", "taps", "wide", "blur"}) {
        const io::SceneFile read = io::readScene(path("demo/" + scene + ".toml"));
        EXPECT_EQ(read.lights.size(), 1u) << scene;
        EXPECT_EQ(read.materials.at(0).material.scattering, PEL_SCATTERING_PREINTEGRATED) << scene;
    }

    // 0.0003 is one bit in each 170th value, which other roundings may change; a backdrop or a sky that is a
    // tenth off is more. Labels of the sheet are drawn by another library.
    for (const std::string name : {"key.png", "backlit.png", "backlit_parts.png"})
        expectKept("demo/" + name, name, "0.0003");
    expectKept("demo/demo.png", "demo.png", "0.0006");
    // Too small in a picture to be seen there.
    const auto scene = io::readScene(path("demo/key.toml"));
    // A pixel's place is on its line of sight.
    const io::Image gbuffer = io::readImage(path("demo/key_gbuffer.exr"));
    const std::vector<float> places = gbuffer.interleaved(scene.channels[PEL_SLOT_POSITION]);
    const std::vector<float> ids = gbuffer.interleaved(scene.channels[PEL_SLOT_MATERIAL]);
    const auto vector = [](const float* v) { return sample::Vec3{v[0], v[1], v[2]}; };
    const sample::Vec3 eye = vector(scene.camera.position);
    sample::Matrix4 toWorld;
    std::copy_n(scene.camera.inverseViewProjection, 16, toWorld.m.begin());
    size_t seen = 0;
    for (size_t i = 192 * 54 + 60; i < 192 * 54 + 130; ++i) {
        if (ids[i] == 0) continue;
        ++seen;
        const double x = (double(i % 192) + 0.5) / 96 - 1, y = 1 - (double(i / 192) + 0.5) / 54;
        const sample::Vec3 along = normalize(toWorld.project({x, y, 0.5}) - eye);
        EXPECT_LT(length(cross(along, vector(&places[3 * i]) - eye)), 0.5) << i;  // mm
    }
    EXPECT_GT(seen, 10u);
    const auto gloss = [&](uint32_t id) {
        for (const auto& m : scene.materials)
            if (m.id == id) return std::pair(m.material.specular, m.material.roughness);
        return std::pair(-1.0f, -1.0f);
    };
    for (const uint32_t id : {2u, 5u, 6u, 7u})
        EXPECT_EQ(gloss(id), std::pair(0.0f, 1.0f)) << "eyes, lashes, and where the head is cut: " << id;
    for (const uint32_t id : {3u, 4u})
        EXPECT_EQ(gloss(id), std::pair(0.05f, 0.2f)) << "teeth and tongue: " << id;
}
