// Counters of PelShaderStats against the host's own counts; and materials in the last column alone, of frames
// one pixel wider than the vectors: nothing is left out, and nothing else is touched. On devices of all
// widths.
#include "device_lanes.h"
#include "shadow_forms.h"
#include "shared/shade.h"

using namespace shade_test;
using lanes::deviceOf;

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
    for (size_t i = seed; i < f.pixels(); i += 41) f.slots[PEL_SLOT_ALBEDO].values[3 * i + i % 3] = NAN;
    for (size_t i = seed; i < f.pixels(); i += 53)
        f.slots[PEL_SLOT_NORMAL_SHADING].values[3 * i + i % 3] = INFINITY;
    return f;
}

class ShadeCounts : public testing::TestWithParam<int> {};

TEST_P(ShadeCounts, PixelsAreTheHostsOwn) {
    const Device device = deviceOf(GetParam());
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
                const uint64_t thick = skip ? c.thickness : (c.shaded - c.invalid) * f.lights.size();
                EXPECT_NEAR(double(stats.pixelsThickness), double(thick), double(skip * c.doubtful)) << where;
                EXPECT_EQ(stats.pixelsWideShadow, 0u);
                EXPECT_EQ(stats.pixelsShadowTexels, 0u);
            }
    }
}

// Tiles with a material, and those whose materials need less than the whole shader.
TEST_P(ShadeCounts, TilesAreTheHostsOwn) {
    const Device device = deviceOf(GetParam());
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
        EXPECT_EQ(stats.variants > 1, lists == PEL_TILES_PER_VARIANT);
        EXPECT_LE(stats.tilesPartial, lists == PEL_TILES_PER_VARIANT ? less : 0);
        EXPECT_EQ(stats.launches, stats.variants + (lists != PEL_TILES_NO_LIST))
            << "the list, and each variant";
    }
}

// --- the last column ---

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
    const Device device = deviceOf(GetParam());
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
    const Device device = deviceOf(GetParam());
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
                const Vec3 p = f.slots[PEL_SLOT_POSITION].vec(i),
                           n = f.slots[PEL_SLOT_NORMAL_GEOMETRIC].vec(i);
                ASSERT_NEAR(shadow[3 * i], truthOf(from).wide(f.materials[1], p, n), tolerance::wideShadow)
                    << where << ", pixel " << i;
                ASSERT_TRUE(normals[i].has_value());
                if (doubtful[i]) continue;
                ASSERT_LE(reference::magnitude(shownNormal(blurred, i) - *normals[i]), tolerance::shadeTerm)
                    << where << ", " << i;
            }
        }
}

INSTANTIATE_TEST_SUITE_P(Lanes, ShadeCounts, testing::Values(1, 8, 16), testing::PrintToStringParamName());
INSTANTIATE_TEST_SUITE_P(Lanes, LastColumn, testing::Values(1, 8, 16), testing::PrintToStringParamName());

}  // namespace
