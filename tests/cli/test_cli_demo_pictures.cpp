// The demo's pictures are those in tests/cli/pictures. After a change that is meant to be visible, look at
// the new pictures at full size and keep them: PELLUCID_KEEP_PICTURES=1 test_cli_demo_pictures.
#include <cstdlib>

#include "cli_run.h"
#include "io/scene/scene_file.h"

using DemoPictures = CommandTest;

TEST_F(DemoPictures, AreThoseThatSomebodyLookedAt) {
    namespace fs = std::filesystem;
    const fs::path kept = fs::path(PELLUCID_SOURCE_DIR) / "tests/cli/pictures";
    const Result demo = run({"demo", "-o", path("demo"), "--size", "192x108"});
    ASSERT_EQ(demo.exitCode, 0) << demo.err;
    const char* keep = std::getenv("PELLUCID_KEEP_PICTURES");
    // 0.0003 is one bit in each 170th value, which other roundings may change; a backdrop or a sky that is a
    // tenth off is more. Labels of the sheet are drawn by another library.
    for (const auto& [name, most] : {std::pair{"key.png", "0.0003"},
                                     {"backlit.png", "0.0003"},
                                     {"backlit_parts.png", "0.0003"},
                                     {"demo.png", "0.0006"}}) {
        const std::string now = path(std::string("demo/") + name), then = (kept / name).string();
        if (keep && *keep) {
            fs::create_directories(kept);
            fs::copy_file(now, then, fs::copy_options::overwrite_existing);
            continue;
        }
        const Result compared = run({"compare", now, then, "--max-rmse", most});
        EXPECT_EQ(compared.exitCode, 0) << name << ": " << compared.out << compared.err;
    }
    // Too small in a picture to be seen there.
    const auto scene = pellucid::io::readScene(path("demo/key.toml"));
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
