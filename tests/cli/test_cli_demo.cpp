// `pellucid demo`: mesh in, pictures out, and `pellucid shade` makes the same of what it leaves; its pictures
// are those in tests/cli/pictures. After a change that is meant to be visible, look at the new pictures at
// full size and keep them: PELLUCID_KEEP_PICTURES=1 test_cli_demo.
#include "cli_shade.h"

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
    for (const char* part : {"G-buffer (sample host)", "shadow maps (sample host)", "kernels"})
        EXPECT_TRUE(stages.contains(io::concat("key: ", part))) << part;
    // The scenes of which bench/roofline counts instructions can be made of the demo's, and can be read.
    const std::string roofline = "python3 '" PELLUCID_SOURCE_DIR "/bench/roofline' --scenes @demo";
    ASSERT_EQ(std::system(filled(roofline).c_str()), 0);
    for (const std::string scene : {"surface", "taps", "wide", "blur"}) {
        const io::SceneFile read = io::readScene(path("demo/" + scene + ".toml"));
        EXPECT_EQ(read.lights.size(), 1u) << scene;
        EXPECT_EQ(read.materials.at(0).material.scattering, PEL_SCATTERING_PREINTEGRATED) << scene;
    }

    namespace fs = std::filesystem;
    const fs::path kept = fs::path(PELLUCID_SOURCE_DIR) / "tests/cli/pictures";
    const char* keep = std::getenv("PELLUCID_KEEP_PICTURES");
    // 0.0003 is one bit in each 170th value, which other roundings may change; a backdrop or a sky that is a
    // tenth off is more. Labels of the sheet are drawn by another library.
    for (const auto& [name, most] : {std::pair<std::string, std::string>{"key.png", "0.0003"},
                                     {"backlit.png", "0.0003"},
                                     {"backlit_parts.png", "0.0003"},
                                     {"demo.png", "0.0006"}}) {
        const std::string then = (kept / name).string();
        if (keep && *keep)
            fs::copy_file(path("demo/" + name), then, fs::copy_options::overwrite_existing);
        else
            done("compare @demo/" + name + " '" + then + "' --max-rmse " + most);
    }
    // Too small in a picture to be seen there.
    const auto scene = io::readScene(path("demo/key.toml"));
    const auto gloss = [&](uint32_t id) {
        for (const auto& m : scene.materials)
            if (m.id == id) return std::pair(m.material.specular, m.material.roughness);
        return std::pair(-1.0f, -1.0f);
    };
    for (const uint32_t id : {2u, 5u, 6u})
        EXPECT_EQ(gloss(id), std::pair(0.0f, 1.0f)) << "eyes, and where the head is cut: " << id;
    for (const uint32_t id : {3u, 4u})
        EXPECT_EQ(gloss(id), std::pair(0.05f, 0.2f)) << "teeth and tongue: " << id;
}
