// Every counter of PelShaderStats against the host's own count of the same frame.
#include <gtest/gtest.h>

#include <limits>

#include "lanes.h"
#include "shared/shade.h"

using namespace shade_test;

namespace {

// What the counters of pixels should hold, from the scene in double precision. `doubtful`: pixels that
// rounding may put on either side.
struct Counts {
    uint64_t shaded = 0, invalid = 0, shadowLut = 0, thickness = 0, specular = 0, doubtful = 0;
};

Counts countsOf(const Frame& f, const Tables& tables) {
    constexpr double near = 1e-5;
    Counts c;
    const auto& s = f.slots;
    for (size_t i = 0; i < f.pixels(); ++i) {
        const auto found = f.materials.find(uint32_t(s[PEL_SLOT_MATERIAL].at(i)));
        if (found == f.materials.end()) continue;
        const PelMaterial& m = found->second;
        ++c.shaded;
        bool valid = true;
        for (int slot : {PEL_SLOT_NORMAL_SHADING, PEL_SLOT_ALBEDO})
            for (uint32_t k = 0; k < 3; ++k) valid &= std::isfinite(s[slot].at(i, k));
        if (!valid) {
            ++c.invalid;
            continue;
        }
        for (const Light& light : f.lights) {
            const reference::PixelLight l = truthLight(f, m, light, i);
            const double nl =
                reference::dot(reference::normalized(s[PEL_SLOT_NORMAL_SHADING].vec(i)), l.toLight);
            const double bl =
                reference::dot(reference::normalized(s[PEL_SLOT_NORMAL_BLURRED].vec(i)), l.toLight);
            const double reach = reference::magnitude(l.color);
            const double halfTexel = 0.5 / tables.shadowTruth.table.width, w = light.wide.at(i);
            const double shadow = reference::sharpenedShadow(w, tables.shadowTruth.sharpening);
            for (double edge : {nl, bl - 0.3, w > 0 ? w - halfTexel : 1, w < 1 ? 1 - w - halfTexel : 1,
                                w > 0 && shadow > 0 ? shadow : 1})
                if (std::abs(edge) < near) ++c.doubtful;
            if (reach == 0) continue;
            c.shadowLut += nl > 0 && w > halfTexel && 1 - w > halfTexel;
            c.thickness += bl < 0.3;
            c.specular += nl > 0 && shadow > 0;
        }
    }
    return c;
}

// Direct light without a curvature table, so that the cosine alone says where there is some.
Frame countedFrame(uint32_t seed, uint32_t width, uint32_t height) {
    Frame f = randomFrame(seed, width, height, 3);
    f.curvatureLut = false;
    f.options.countPixels = 1;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (size_t i = seed; i < f.pixels(); i += 41) f.slots[PEL_SLOT_ALBEDO].values[3 * i + i % 3] = nan;
    for (size_t i = seed; i < f.pixels(); i += 53)
        f.slots[PEL_SLOT_NORMAL_SHADING].values[3 * i + i % 3] = INFINITY;
    return f;
}

class ShadeCounts : public testing::TestWithParam<int> {};

TEST_P(ShadeCounts, PixelsAreTheHostsOwn) {
    const pellucid::Device device = deviceOf(GetParam());
    const Tables tables = makeTables(device);
    for (uint32_t seed = 1; seed <= 3; ++seed) {
        Frame f = countedFrame(seed, 97 + 8 * seed, 41);
        for (const bool skip : {true, false})
            for (const PelTileLists lists : {PEL_TILES_ONE_LIST, PEL_TILES_PER_VARIANT, PEL_TILES_NO_LIST}) {
                f.options.disableSkipping = !skip;
                f.options.tileLists = lists;
                PelShaderStats stats = pelShaderStatsDefaults();
                shade(device, f, tables, &stats);
                const Counts c = countsOf(f, tables);
                const std::string where = "seed " + std::to_string(seed) + (skip ? ", skipping" : "") +
                                          ", lists " + std::to_string(lists);
                EXPECT_LE(c.doubtful, 3u);
                EXPECT_EQ(stats.pixelsTotal, f.pixels()) << where;
                EXPECT_EQ(stats.pixelsShaded, c.shaded) << where;
                EXPECT_EQ(stats.pixelsInvalid, c.invalid) << where;
                EXPECT_NEAR(double(stats.pixelsShadowLut), double(c.shadowLut), double(c.doubtful)) << where;
                EXPECT_NEAR(double(stats.pixelsSpecular), double(c.specular), double(c.doubtful)) << where;
                if (skip) {
                    EXPECT_NEAR(double(stats.pixelsThickness), double(c.thickness), double(c.doubtful))
                        << where;
                } else {
                    EXPECT_EQ(stats.pixelsThickness, (c.shaded - c.invalid) * f.lights.size()) << where;
                }
                EXPECT_EQ(stats.pixelsWideShadow, 0u);
                EXPECT_EQ(stats.pixelsShadowTexels, 0u);
            }
    }
}

// A second execution counts from 0. Without the option only what is always counted is counted.
TEST_P(ShadeCounts, AnExecutionStartsAtZero) {
    const pellucid::Device device = deviceOf(GetParam());
    const Tables tables = makeTables(device);
    const Frame f = countedFrame(5, 70, 33);
    pellucid::Shader shader(device);
    setFrame(device, shader, f, tables);
    const auto target = setTarget(device, shader, f);
    shader.commit().execute();
    const PelShaderStats first = shader.stats();
    shader.execute();
    const PelShaderStats second = shader.stats();
    EXPECT_GT(first.pixelsSpecular, 0u);
    EXPECT_EQ(second.pixelsSpecular, first.pixelsSpecular);
    EXPECT_EQ(second.pixelsShaded, first.pixelsShaded);
    EXPECT_EQ(second.pixelsInvalid, first.pixelsInvalid);
    EXPECT_EQ(second.launches, first.launches);
    EXPECT_EQ(second.tilesShaded, first.tilesShaded);
    EXPECT_EQ(second.programsBuilt, first.programsBuilt);
    EXPECT_EQ(second.bytesUploaded, 0u) << "nothing has changed";
    EXPECT_GT(first.bytesUploaded, 0u);
}

// Tiles with a material, and those whose materials need less than the whole shader.
TEST_P(ShadeCounts, TilesAreTheHostsOwn) {
    const pellucid::Device device = deviceOf(GetParam());
    const Tables tables = makeTables(device);
    Frame f = randomFrame(9, 7 * PEL_TILE_WIDTH + 3, 5 * PEL_TILE_HEIGHT + 1);
    Random random(4);
    const uint32_t columns = (f.width + PEL_TILE_WIDTH - 1) / PEL_TILE_WIDTH,
                   rows = (f.height + PEL_TILE_HEIGHT - 1) / PEL_TILE_HEIGHT;
    std::vector<uint32_t> ofTile(columns * rows);
    for (uint32_t& id : ofTile) id = random.below(3);
    // One pixel of each tile that has a material, not always the same.
    auto& ids = f.slots[PEL_SLOT_MATERIAL].values;
    std::fill(ids.begin(), ids.end(), 0.0f);
    for (uint32_t t = 0; t < ofTile.size(); ++t) {
        const uint32_t x0 = t % columns * PEL_TILE_WIDTH, y0 = t / columns * PEL_TILE_HEIGHT;
        const uint32_t x = x0 + random.below(std::min<uint32_t>(PEL_TILE_WIDTH, f.width - x0));
        const uint32_t y = y0 + random.below(std::min<uint32_t>(PEL_TILE_HEIGHT, f.height - y0));
        ids[size_t(y) * f.width + x] = float(ofTile[t]);
    }
    // Material 2 is Lambert's alone.
    PelMaterial plain = pelMaterialDefaults();
    plain.specular = 0;
    for (float& c : plain.deepScatterColor) c = 0;
    f.materials[2] = plain;
    const auto with = uint64_t(std::count(ofTile.begin(), ofTile.end(), 1u)),
               less = uint64_t(std::count(ofTile.begin(), ofTile.end(), 2u));
    ASSERT_GT(with, 5u);
    ASSERT_GT(less, 5u);
    for (const PelTileLists lists : {PEL_TILES_ONE_LIST, PEL_TILES_PER_VARIANT, PEL_TILES_NO_LIST}) {
        f.options.tileLists = lists;
        PelShaderStats stats = pelShaderStatsDefaults();
        shade(device, f, tables, &stats);
        EXPECT_EQ(stats.tilesTotal, ofTile.size());
        EXPECT_EQ(stats.tilesShaded, lists == PEL_TILES_NO_LIST ? ofTile.size() : with + less);
        EXPECT_EQ(stats.bands, 1u);
        if (lists == PEL_TILES_PER_VARIANT) {
            EXPECT_GT(stats.variants, 1u);
            EXPECT_LE(stats.tilesPartial, less);
        } else {
            EXPECT_EQ(stats.variants, 1u);
            EXPECT_EQ(stats.tilesPartial, 0u);
        }
        EXPECT_EQ(stats.launches, stats.variants + (lists != PEL_TILES_NO_LIST))
            << "the list, and each variant";
    }
}

INSTANTIATE_TEST_SUITE_P(Lanes, ShadeCounts, testing::Values(1, 8, 16), testing::PrintToStringParamName());

}  // namespace
