// The volumetric oracle against known results for the medium, and against another program's walk of the same
// ball.
#include "test.h"

#include "npy.h"
#include "reference/random_walk.h"

namespace {

const double paths[3] = {0.2984, 0.1114, 0.0553};  // mm
constexpr double albedo = 0.99009;

}  // namespace

// A half-space of an index-matched medium that scatters to all sides alike reflects 1 - 2 sqrt(1 - a)
// (integral of H(m) m dm) of diffuse light, H(m) = 1 / (sqrt(1 - a) + (a / 2) integral of m' H(m') / (m + m')
// dm') [Chandrasekhar 1960].
double halfSpace() {
    constexpr int nodes = 400;
    std::vector<double> H(nodes, 1), m(nodes);
    for (int i = 0; i < nodes; ++i) m[i] = (i + 0.5) / nodes;
    for (int round = 0; round < 300; ++round) {
        std::vector<double> next(nodes);
        for (int i = 0; i < nodes; ++i) {
            double sum = 0;
            for (int k = 0; k < nodes; ++k) sum += m[k] * H[k] / (m[i] + m[k]) / nodes;
            next[i] = 1 / (std::sqrt(1 - albedo) + albedo / 2 * sum);
        }
        H = next;
    }
    double first = 0;
    for (int i = 0; i < nodes; ++i) first += H[i] * m[i] / nodes;
    return 1 - 2 * std::sqrt(1 - albedo) * first;
}

TEST(RandomWalk, HalfSpaceReflectsWhatIsKnown) {
    const reference::WalkResult walk =
        reference::walkSlab({1, albedo}, INFINITY, 50, 20, sized(200000, 2000), 1);
    EXPECT_NEAR(walk.reflected, halfSpace(), testsAreSmall() ? 0.05 : tolerance::walkReflected);
    // Scaling the medium only scales the distances.
    const reference::WalkResult twice =
        reference::walkSlab({2, albedo}, INFINITY, 100, 20, sized(200000, 2000), 1);
    EXPECT_NEAR(twice.reflected, walk.reflected, 1e-12);
    EXPECT_NEAR(twice.radiance[3] * 4, walk.radiance[3], 1e-9 * walk.radiance[3]);
}

TEST(RandomWalk, BallEqualsAnotherWalk) {
    const char* folder = std::getenv("PELLUCID_RULER_DIR");
    if (!folder) GTEST_SKIP() << "PELLUCID_RULER_DIR names no folder";
    const npy::Array<double> theirs = npy::read<double>(std::filesystem::path(folder) / "ball_walk_f64.npy");
    ASSERT_EQ(theirs.shape, (std::vector<size_t>{4, 201}));
    constexpr int bins = 20;
    for (int c = 0; c < 3; ++c) {
        const reference::WalkResult ours =
            reference::walkBall({paths[c], albedo}, 10, bins, sized(200000, 1000), 17 + c);
        for (int i = 0; i < bins; ++i) {
            // Their nodes are 0.01 apart: the mean over our bin by the trapezoid rule.
            double mean = 0;
            for (int k = 0; k <= 10; ++k)
                mean += theirs.data[201 * (size_t(c) + 1) + 10 * size_t(i) + size_t(k)] *
                        (k == 0 || k == 10 ? 0.05 : 0.1);
            EXPECT_NEAR(ours.radiance[i], mean, tolerance::walkErrors * ours.error[i] + tolerance::walkTheirs)
                << "channel " << c << ", N.L from " << -1 + 0.1 * i;
        }
    }
}
