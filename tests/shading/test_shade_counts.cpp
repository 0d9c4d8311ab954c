// Counters of PelShaderStats against the host's own counts; and materials in the last column alone, of frames
// one pixel wider than the vectors: nothing is left out, and nothing else is touched. On devices of all
// widths.
#include "device_lanes.h"
#include "shadow_forms.h"
#include "shared/shade.h"

using namespace shade_test;

namespace {

// The expected counters of pixels, from the scene in double precision. `doubtful`: pixels that rounding may
// put on either side.
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
            const double nl = dot(normalized(s[PEL_SLOT_NORMAL_SHADING].vec(i)), l.toLight);
            const double bl = dot(normalized(s[PEL_SLOT_NORMAL_BLURRED].vec(i)), l.toLight);
            const double reach = magnitude(l.color);
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
    for (size_t i = seed; i < f.pixels(); i += 41) f.slots[PEL_SLOT_ALBEDO].values[3 * i + i % 3] = NAN;
    for (size_t i = seed; i < f.pixels(); i += 53)
        f.slots[PEL_SLOT_NORMAL_SHADING].values[3 * i + i % 3] = INFINITY;
    return f;
}

class Lanes : public testing::TestWithParam<int> {
  protected:
    const Device device = lanes::deviceOf(GetParam());
    const Tables tables = makeTables(device, 24, 16);
    PelShaderStats stats = pelShaderStatsDefaults();
};
using ShadeCounts = Lanes;
using LastColumn = Lanes;

constexpr PelTileLists allLists[] = {PEL_TILES_ONE_LIST, PEL_TILES_PER_VARIANT, PEL_TILES_NO_LIST};

TEST_P(ShadeCounts, PixelsAreTheHostsOwn) {
    for (uint32_t seed = 1; seed <= 3; ++seed) {
        Frame f = countedFrame(seed, 97 + 8 * seed, 41);
        const Counts c = countsOf(f, tables);
        EXPECT_LE(c.doubtful, 3u);
        for (const auto& [lists, skip] : {std::pair{PEL_TILES_ONE_LIST, true},
                                          {PEL_TILES_PER_VARIANT, true},
                                          {PEL_TILES_NO_LIST, true},
                                          {PEL_TILES_ONE_LIST, false}}) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << " skip " << skip << " lists " << lists);
            f.options.disableSkipping = !skip;
            f.options.tileLists = lists;
            shade(device, f, tables, &stats);
            EXPECT_EQ(stats.pixelsTotal, f.pixels());
            EXPECT_EQ(stats.pixelsShaded, c.shaded);
            EXPECT_EQ(stats.pixelsInvalid, c.invalid);
            EXPECT_NEAR(double(stats.pixelsShadowLut), double(c.shadowLut), double(c.doubtful));
            EXPECT_NEAR(double(stats.pixelsSpecular), double(c.specular), double(c.doubtful));
            const uint64_t thick = skip ? c.thickness : (c.shaded - c.invalid) * f.lights.size();
            EXPECT_NEAR(double(stats.pixelsThickness), double(thick), double(skip * c.doubtful));
            EXPECT_EQ(stats.pixelsWideShadow, 0u);
            EXPECT_EQ(stats.pixelsShadowTexels, 0u);
        }
    }
}

// Tiles with a material, and those whose materials need less than the whole shader.
TEST_P(ShadeCounts, TilesAreTheHostsOwn) {
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
    for (const PelTileLists lists : allLists) {
        f.options.tileLists = lists;
        shade(device, f, tables, &stats);
        EXPECT_EQ(stats.tilesTotal, ofTile.size());
        EXPECT_EQ(stats.tilesShaded, lists == PEL_TILES_NO_LIST ? ofTile.size() : with + less);
        EXPECT_EQ(stats.bands, 1u);
        EXPECT_EQ(stats.variants > 1, lists == PEL_TILES_PER_VARIANT);
        EXPECT_LE(stats.tilesPartial, lists == PEL_TILES_PER_VARIANT ? less : 0);
        EXPECT_EQ(stats.launches, stats.variants + (lists != PEL_TILES_NO_LIST))
            << "the list, and each variant";
    }
}

// --- the last column ---

constexpr uint32_t widths[] = {1, 2, 7, 8, 9, 15, 16, 17, 31, 33, PEL_TILE_WIDTH + 1, 2 * PEL_TILE_WIDTH + 1};

// Material 1 in that column, and nothing elsewhere.
void onlyColumn(Frame& f, uint32_t column) {
    for (size_t i = 0; i < f.pixels(); ++i) f.slots[PEL_SLOT_MATERIAL].values[i] = i % f.width == column;
}

TEST_P(LastColumn, IsShaded) {
    for (const uint32_t width : widths)
        for (const PelTileLists lists : allLists) {
            SCOPED_TRACE(testing::Message() << width << " wide, lists " << lists);
            Frame f = randomFrame(width, width, 2 * PEL_TILE_HEIGHT + 1);
            f.options.tileLists = lists;
            onlyColumn(f, width - 1);
            const std::vector<float> shown = shade(device, f, tables, &stats);
            EXPECT_EQ(stats.pixelsShaded, f.height);
            if (lists != PEL_TILES_NO_LIST) {
                EXPECT_EQ(stats.tilesShaded, (f.height + PEL_TILE_HEIGHT - 1) / PEL_TILE_HEIGHT);
            }
            for (size_t i = 0; i < f.pixels(); ++i) {
                const Rgb right = i % width + 1 == width ? truth(f, tables, i).sum() : Rgb{0, 0, 0};
                for (int c = 0; c < 3; ++c)
                    ASSERT_NEAR(shown[3 * i + c], right[c], tolerance::shadeSum) << "pixel " << i;
            }
        }
}

// Of every column alone, with what the passes make before.
TEST_P(LastColumn, HasItsPasses) {
    const MapLight from = mapLight(3, false, false, {0.5, 0.2, 0.9}, {3, 2, 5}, 40, 61);
    for (const uint32_t width : {1u, 9u, 17u, 33u})
        for (const uint32_t column : {0u, width / 2, width - 1}) {
            SCOPED_TRACE(testing::Message() << width << " wide, column " << column);
            Frame f = reliefFrame(1, width, PEL_TILE_HEIGHT + 3, 0.4f);
            onlyColumn(f, column);
            f.lights = {from.light};

            Frame lit = f;
            showWideShadow(lit);
            const std::vector<float> shadow = shade(device, lit, tables, &stats);
            EXPECT_EQ(stats.pixelsWideShadow, f.height);
            Frame soft = f;
            showBlurredNormal(soft);
            soft.options.blurNormals = 1;
            const std::vector<float> blurred = shade(device, soft, tables);
            std::vector<bool> doubtful;
            const auto normals = reference::blurredNormals(surfaceOf(soft), &doubtful);
            for (size_t i = 0; i < f.pixels(); ++i) {
                if (i % width != column) {
                    ASSERT_EQ(shadow[3 * i], 0.0f);
                    ASSERT_EQ(blurred[3 * i], 0.0f);
                    continue;
                }
                ASSERT_NEAR(shadow[3 * i], wideOf(from, *placeAt(f, i)), tolerance::wideShadow) << i;
                ASSERT_TRUE(normals[i].has_value());
                if (doubtful[i]) continue;
                ASSERT_LE(magnitude(shownNormal(blurred, i) - *normals[i]), tolerance::shadeTerm) << i;
            }
        }
}

INSTANTIATE_TEST_SUITE_P(Of, ShadeCounts, testing::Values(1, 8, 16), testing::PrintToStringParamName());
INSTANTIATE_TEST_SUITE_P(Of, LastColumn, testing::Values(1, 8, 16), testing::PrintToStringParamName());

}  // namespace
