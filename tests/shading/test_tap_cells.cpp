// Thickness interpolated between nodes of a grid in the shadow map, against a disk of very many taps and
// against the taps of each pixel.
#include "shader_ready.h"
#include "shadow_forms.h"

using namespace shade_test;

namespace {

// A radius whose nodes are just few enough for the frame.
float radiusFor(const Frame& f) {
    return float(4 / (std::sqrt(double(f.pixels()) / 8) - 12));
}

Frame cellFrame(uint32_t seed, uint32_t width = 360, uint32_t height = 250) {
    Frame f = formFrame(seed, width, height);
    for (auto& [id, m] : f.materials) {
        m.thicknessFilterRadius = radiusFor(f);
        m.thicknessTaps = 32;
    }
    return f;
}

// Bodies under a parallel or perspective map that is smaller than the frame: some pixels lie beyond its
// border.
MapLight bumps(uint32_t seed, bool perspective, uint32_t size = 256) {
    return mapLight(seed, perspective, false, {0.3, 0.2, 0.9}, {60, 45, 5}, 120, size);
}

std::vector<reference::Vec2> spiral(int count) {
    std::vector<reference::Vec2> taps;
    for (int i = 0; i < count; ++i) {
        const double r = std::sqrt((i + 0.5) / count), a = i * std::numbers::pi * (3 - std::sqrt(5.0));
        taps.push_back({r * std::cos(a), r * std::sin(a)});
    }
    return taps;
}

// Of samples and nodes; without cells the wide shadows of all lights take one launch less as well.
uint64_t cellLaunches(const Seen& cells, const Seen& taps) {
    return cells.stats.launches - taps.stats.launches - 1;
}

// Against a disk of very many taps, on a map for which few taps are inaccurate.
template <class From>
void expectNearer(const Frame& f, const From& from, uint64_t launches, const std::string& what) {
    const Seen taps = shadeForms(f, {from.light}), cells = shadeForms(interpolated(f), {from.light});
    EXPECT_EQ(cellLaunches(cells, taps), launches) << what;
    const auto many = spiral(1024);
    double ofTaps = 0, ofCells = 0, count = 0;  // squares of errors
    for (size_t i = 0; i < f.pixels(); i += 37)
        if (const auto at = placeAt(f, i)) {
            const double truth = thicknessOf(from, *at, many);
            ofTaps += std::pow(taps.thickness[i] - truth, 2),
                ofCells += std::pow(cells.thickness[i] - truth, 2);
            ++count;
        }
    ASSERT_GT(count, sized(1000, 20));
    EXPECT_LT(ofCells, ofTaps) << what;
    EXPECT_GT(std::sqrt(ofTaps / count), 0.02) << what;
}

TEST(TapCells, AreNearerToAFineDiskThanTheTapsAre) {
    // Of its map, and of the one of a black light.
    for (uint32_t seed = 0; seed < sized(6u, 2u); ++seed)
        expectNearer(cellFrame(seed), bumps(seed, seed & 1), 4, "seed " + std::to_string(seed));
    Frame f = cellFrame(1);
    for (auto& [id, m] : f.materials) m.thicknessFilterRadius *= 4.2f;
    expectNearer(f, cascadeLight({40, 90, 160}, false, 97, false), 8, "cascades");
}

TEST(TapCells, EachDiskHasItsOwn) {
    Frame f = cellFrame(3);
    f.materials[2].thicknessFilterRadius *= 2.5f;
    f.materials[2].thicknessTaps = 8;
    const MapLight from = bumps(3, false);
    expectNearer(f, from, 8, "two disks");
    // More disks than cells are made for: the other disks use taps per pixel.
    for (uint32_t id = 3; id < 9; ++id) {
        f.materials[id] = f.materials[1];
        f.materials[id].thicknessFilterRadius *= 1 + 0.1f * float(id);
    }
    for (size_t i = 0; i < f.pixels(); ++i)
        f.slots[PEL_SLOT_MATERIAL].values[i] = float(1 + i % f.width * 8 / f.width);
    const auto own = shadeForms(f, {from.light}), some = shadeForms(interpolated(f), {from.light});
    size_t same = 0, other = 0;
    for (size_t i = 0; i < f.pixels(); ++i)
        (f.slots[PEL_SLOT_MATERIAL].at(i) > 4 ? same : other) += own.thickness[i] == some.thickness[i];
    EXPECT_EQ(same, f.pixels() / 2);
    EXPECT_LT(other, f.pixels() / 4);
}

TEST(TapCells, AreNotUsedWhereTapsAreAskedForOrNodesWouldBeMany) {
    const Light light = bumps(1, false).light;
    Frame f = cellFrame(1);
    f.options.rotateTaps = 1;
    EXPECT_EQ(shadeForms(f, {light}).thickness, shadeForms(interpolated(f), {light}).thickness);
    for (const float factor : {0.7f, 0.0f}) {
        f = cellFrame(1);
        for (auto& [id, m] : f.materials) m.thicknessFilterRadius *= factor;
        EXPECT_EQ(shadeForms(f, {light}).thickness, shadeForms(interpolated(f), {light}).thickness);
    }
}

// A viewer makes small pictures while something moves: it must not wait for a compiler then.
TEST(TapCells, AnotherSizeOfTheFrameNeedsNoOtherProgram) {
    const Light light = bumps(1, false).light;
    const Frame large = interpolated(cellFrame(1));
    Frame small = interpolated(formFrame(1));
    for (auto& [id, m] : small.materials) m = large.materials.at(id);
    const Seen cells = shadeForms(large, {light});
    const uint32_t built = device().stats().programsBuilt;
    const Seen taps = shadeForms(small, {light});
    EXPECT_LT(taps.stats.launches, cells.stats.launches) << "too few pixels for nodes";
    EXPECT_EQ(device().stats().programsBuilt, built);
}

TEST(TapCells, BadTexelsAreNoThicknessAndBadPixelsStayAlone) {
    const MapLight from = bumps(5, false);
    Light light = from.light;
    Frame f = interpolated(cellFrame(5));
    const auto before = shadeForms(f, {light}).thickness;
    const size_t bad = f.pixels() / 2 + 31;
    f.slots[PEL_SLOT_POSITION].values[3 * bad] = NAN;
    f.slots[PEL_SLOT_POSITION].values[3 * bad + 3] = INFINITY;
    auto after = shadeForms(f, {light}).thickness;
    for (size_t i = 0; i < f.pixels(); ++i) {
        if (i == bad || i == bad + 1)
            EXPECT_EQ(after[i], 0);
        else
            ASSERT_EQ(after[i], before[i]) << i;
    }
    f = interpolated(cellFrame(5));
    for (const float value : {NAN, INFINITY}) {
        for (size_t i = 0; i < light.map.values.size(); i += 2) light.map.values[i] = value;
        const auto holes = shadeForms(f, {light}).thickness;
        double sum = 0, all = 0;
        for (size_t i = 0; i < f.pixels(); ++i) {
            ASSERT_TRUE(std::isfinite(holes[i])) << i;
            ASSERT_LE(holes[i], before[i] + 60);
            sum += holes[i], all += before[i];
        }
        EXPECT_LT(sum, 0.1 * all) << "each tap reads a bad texel beside a good one";
        for (float& v : light.map.values) v = value;
        for (const float t : shadeForms(f, {light}).thickness) ASSERT_NEAR(t, 0, 1e-4);
    }
}

TEST(TapCells, AtAnyScaleOfLengths) {
    for (const float scale : {1e-5f, 1e5f}) {
        const MapLight from = bumps(4, false);
        Light light = from.light;
        Frame f = interpolated(cellFrame(4));
        const auto usual = shadeForms(f, {light}).thickness;
        for (float& p : f.slots[PEL_SLOT_POSITION].values) p *= scale;
        for (float* row = light.params.worldToShadow; row < light.params.worldToShadow + 12; row += 4)
            copyTo(row, 1 / double(scale) * vectorOf(row));
        light.params.shadowDepthRange *= scale;
        for (auto& [id, m] : f.materials) {
            m.deepScatterNormalOffset *= scale;
            m.deepScatterRadius *= scale;
        }
        const auto scaled = shadeForms(f, {light}).thickness;
        double square = 0;
        for (size_t i = 0; i < f.pixels(); ++i) square += std::pow(scaled[i] / scale - usual[i], 2);
        EXPECT_LE(std::sqrt(square / double(f.pixels())), tolerance::cellsScaled) << scale;
    }
}

}  // namespace
