// The disks of thickness taps (bench/shading/generate_disks.py): centred, as wide as the disk, evenly spread,
// and better than random points at what they are for: how much of the disk lies on one side of an edge.
#include <gtest/gtest.h>

#include <numbers>

#include "shade_scene.h"
#include "tolerances.h"

using shade_test::diskTaps;

namespace {

constexpr double pi = std::numbers::pi;

class PoissonDisk : public testing::TestWithParam<uint32_t> {};

TEST_P(PoissonDisk, IsCentredInTheUnitDisk) {
    double x = 0, y = 0, r2 = 0;
    const auto taps = diskTaps(GetParam());
    for (const auto& tap : taps) {
        x += tap.x, y += tap.y;
        r2 += (tap.x * tap.x + tap.y * tap.y) / double(taps.size());
        EXPECT_LE(std::hypot(tap.x, tap.y), 1);
    }
    EXPECT_NEAR(x, 0, 1e-6);
    EXPECT_NEAR(y, 0, 1e-6);
    EXPECT_NEAR(r2, 0.5, tolerance::diskMoment);
}

// Relative to the distance in a hexagonal packing of as many points in the same area [Lagae and Dutre 2008].
TEST_P(PoissonDisk, KeepsItsTapsApart) {
    const auto taps = diskTaps(GetParam());
    double least = INFINITY;
    for (size_t i = 0; i < taps.size(); ++i)
        for (size_t j = 0; j < i; ++j)
            least = std::min(least, std::hypot(taps[i].x - taps[j].x, taps[i].y - taps[j].y));
    const double relative = least / std::sqrt(2 * pi / (std::sqrt(3.0) * double(taps.size())));
    std::printf("%zu taps: %.3f of a hexagonal packing's distance\n", taps.size(), relative);
    EXPECT_GE(relative, tolerance::diskSpacing);
}

TEST_P(PoissonDisk, SeesEdgesBetterThanRandomTaps) {
    const auto taps = diskTaps(GetParam());
    const double count = double(taps.size());
    double ours = 0, random = 0;
    for (int angle = 0; angle < 180; ++angle)
        for (int step = 0; step < 100; ++step) {
            const double a = angle * pi / 180, offset = (step + 0.5) / 50 - 1;
            double beyond = 0;
            for (const auto& tap : taps) beyond += std::cos(a) * tap.x + std::sin(a) * tap.y > offset;
            const double area = (std::acos(offset) - offset * std::sqrt(1 - offset * offset)) / pi;
            ours += std::pow(beyond / count - area, 2);
            random += area * (1 - area) / count;
        }
    std::printf("%.0f taps: %.3f of random taps' RMS error over edges\n", count, std::sqrt(ours / random));
    EXPECT_LE(std::sqrt(ours / random), tolerance::diskEdge);
}

TEST(TurnedTaps, TheAnglesFillTheCircle) {
    // Any 4 x 4 pixels: the largest gap between angles is far below that of random ones (about 76 degrees of
    // 16).
    const reference::Vec2 tap{1, 0};
    for (uint32_t x0 : {0u, 1u, 777u, 16380u})
        for (uint32_t y0 : {0u, 5u, 16380u}) {
            std::vector<double> turns;
            for (uint32_t k = 0; k < 16; ++k) {
                const auto turned = reference::turnedTaps({tap}, x0 + k % 4, y0 + k / 4)[0];
                turns.push_back(std::atan2(turned.y, turned.x) / (2 * M_PI));
            }
            std::sort(turns.begin(), turns.end());
            double gap = 1 + turns[0] - turns[15];
            for (size_t k = 1; k < 16; ++k) gap = std::max(gap, turns[k] - turns[k - 1]);
            EXPECT_LT(gap, 0.13) << x0 << ' ' << y0;
        }
}

INSTANTIATE_TEST_SUITE_P(Disks, PoissonDisk, testing::Values(8u, 16u, 32u),
                         [](const auto& info) { return std::to_string(info.param); });

}  // namespace
