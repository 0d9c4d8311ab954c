// Materials in the last column alone, and in single pixels, of frames one pixel wider than the vectors:
// nothing is left out, and nothing else is touched.
#include <gtest/gtest.h>

#include "lanes.h"
#include "pass_scene.h"
#include "shared/shade.h"
#include "tolerances.h"

using namespace shade_test;

namespace {

class LastColumn : public testing::TestWithParam<int> {};

constexpr uint32_t widths[] = {1, 2, 7, 8, 9, 15, 16, 17, 31, 33, PEL_TILE_WIDTH + 1, 2 * PEL_TILE_WIDTH + 1};

// Material 1 where `where` says so, and nothing elsewhere.
template <class Where>
void onlyAt(Frame& f, Where where) {
    for (size_t i = 0; i < f.pixels(); ++i)
        f.slots[PEL_SLOT_MATERIAL].values[i] =
            where(uint32_t(i % f.width), uint32_t(i / f.width)) ? 1.0f : 0.0f;
}

TEST_P(LastColumn, IsShaded) {
    const pellucid::Device device = deviceOf(GetParam());
    const Tables tables = makeTables(device);
    for (const uint32_t width : widths)
        for (const PelTileLists lists : {PEL_TILES_ONE_LIST, PEL_TILES_PER_VARIANT, PEL_TILES_NO_LIST}) {
            Frame f = randomFrame(width, width, 2 * PEL_TILE_HEIGHT + 1);
            f.options.countPixels = 1;
            f.options.tileLists = lists;
            onlyAt(f, [&](uint32_t x, uint32_t) { return x + 1 == f.width; });
            PelShaderStats stats = pelShaderStatsDefaults();
            const std::vector<float> shown = shade(device, f, tables, &stats);
            const std::string where = std::to_string(width) + " wide, lists " + std::to_string(lists);
            EXPECT_EQ(stats.pixelsShaded, f.height) << where;
            if (lists != PEL_TILES_NO_LIST) {
                EXPECT_EQ(stats.tilesShaded, (f.height + PEL_TILE_HEIGHT - 1) / PEL_TILE_HEIGHT) << where;
            }
            for (size_t i = 0; i < f.pixels(); ++i) {
                const Rgb right = i % width + 1 == width ? truth(f, tables, i).sum() : Rgb{0, 0, 0};
                for (int c = 0; c < 3; ++c)
                    ASSERT_NEAR(shown[3 * i + c], right[c], tolerance::shadeSum) << where << ", pixel " << i;
            }
        }
}

// Of every column alone, with what the passes make before.
TEST_P(LastColumn, HasItsPasses) {
    const pellucid::Device device = deviceOf(GetParam());
    const Tables none = makeTables(device, 8, 8);
    const MapLight from = mapLight(3, false, false, {0.5, 0.2, 0.9}, {3, 2, 5}, 40, 61);
    for (const uint32_t width : {1u, 9u, 17u, 33u})
        for (const uint32_t column : {0u, width / 2, width - 1}) {
            Frame f = reliefFrame(1, width, PEL_TILE_HEIGHT + 3, 0.4f);
            onlyAt(f, [&](uint32_t x, uint32_t) { return x == column; });
            f.lights = {from.light};
            f.options.countPixels = 1;
            const std::string where = std::to_string(width) + " wide, column " + std::to_string(column);

            Frame lit = f;
            showWideShadow(lit);
            PelShaderStats stats = pelShaderStatsDefaults();
            const std::vector<float> shadow = shade(device, lit, none, &stats);
            EXPECT_EQ(stats.pixelsWideShadow, f.height) << where;
            const PelLight& l = from.light.params;
            const reference::WideFilterParams params{f.materials[1].shadowFilterWidth, l.shadowBias,
                                                     l.shadowSoftness, l.shadowConeSlope,
                                                     int(l.shadowFilterTexels)};
            Frame soft = f;
            showBlurredNormal(soft);
            soft.options.blurNormals = 1;
            const std::vector<float> blurred = shade(device, soft, none);
            std::vector<bool> doubtful;
            const auto normals = reference::blurredNormals(surfaceOf(soft), &doubtful);
            for (size_t i = 0; i < f.pixels(); ++i) {
                if (i % width != column) {
                    ASSERT_EQ(shadow[3 * i], 0.0f) << where;
                    ASSERT_EQ(blurred[3 * i], 0.0f) << where;
                    continue;
                }
                ASSERT_NEAR(shadow[3 * i],
                            reference::wideShadow(from.map, from.view, f.slots[PEL_SLOT_POSITION].vec(i),
                                                  f.slots[PEL_SLOT_NORMAL_GEOMETRIC].vec(i), params),
                            tolerance::wideShadow)
                    << where << ", pixel " << i;
                ASSERT_TRUE(normals[i].has_value());
                if (doubtful[i]) continue;
                ASSERT_LE(reference::magnitude(shownNormal(blurred, i) - *normals[i]), tolerance::shadeTerm)
                    << where << ", " << i;
            }
        }
}

INSTANTIATE_TEST_SUITE_P(Lanes, LastColumn, testing::Values(1, 8, 16), testing::PrintToStringParamName());

}  // namespace
