// Blending with the light of earlier frames (PelShaderOptions.historyWeight): against the oracle, and
// invariants of any sequence of frames.
#include "diffusion/lit_ball.h"
#include "reference/diffusion_taps.h"
#include "test.h"

using namespace lit_ball;

namespace {

// A frame of a clip: where pixels were, columns and rows and, as an image of three components, a length.
struct ClipFrame {
    Frame frame;
    std::vector<Vec3> motion;
};

ClipFrame clipFrame(const Picture& p, PelScattering method, uint32_t taps, uint32_t index, Vec3 motion) {
    ClipFrame c{Frame(p, method), std::vector<Vec3>(p.pixels(), motion)};
    c.frame.material.scatterTaps = taps;
    c.frame.materials = 2;
    c.frame.options.frameIndex = index;
    c.frame.options.historyWeight = 0.9f;
    return c;
}

Shown shade(ClipFrame c, ShownImages& shown) {
    std::vector<float>& motion = c.frame.images[PEL_SLOT_MOTION];
    const bool comes = std::ranges::any_of(c.motion, [](Vec3 m) { return m.z != 0; });
    for (const Vec3& m : c.motion)
        for (int k = 0; k < (comes ? 3 : 2); ++k) motion.push_back(float(m[k]));
    return c.frame.shade(shown);
}

// The frame as a new shader's first.
std::vector<float> alone(const ClipFrame& c) {
    return c.frame.shade().light;
}

// A ball of two materials seen along z, with a hard shadow across it: moved by columns, rows and a length.
Picture movedBall(Vec3 by, uint32_t side) {
    constexpr double ballRadius = 10;
    const double size = 24.0 / side;
    Picture p(side, side);
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const double u = (x + 0.5 - 0.5 * side - by.x) * size, v = (y + 0.5 - 0.5 * side - by.y) * size,
                         rest = ballRadius * ballRadius - u * u - v * v;
            if (rest <= 0) continue;
            const Vec3 n = Vec3{u, v, -std::sqrt(rest)} / ballRadius;
            const double e = u > 1 ? 0 : reference::max0(dot(n, normalized(Vec3{-0.4, -0.3, -1})));
            p.set(p.at(x, y), ballRadius * n + Vec3{by.x * size, by.y * size, by.z}, {e, 0.8 * e, 0.6 * e},
                  v > 4 ? 2 : 1);
        }
    return p;
}

// A plane in stripes of light, and a plate before it `shift` columns further to the right than at first.
ClipFrame plateFrame(uint32_t index, uint32_t shift, uint8_t plateId, double nearer) {
    Picture p = plane(64, 40, 0.25, [](double x, double) {
        const double e = std::fmod(x, 4) < 2 ? 1 : 0.2;
        return Vec3{e, e, e};
    });
    ClipFrame c = clipFrame(p, screen, 8, index, {});
    for (uint32_t y = 8; y < 32; ++y)
        for (uint32_t x = 10 + shift; x < 26 + shift; ++x) {
            const size_t i = p.at(x, y);
            c.frame.picture.set(i, p.place(i) - Vec3{0, 0, nearer}, {0.6, 0.3, 0.1}, plateId);
            c.motion[i] = {-double(shift), 0, 0};
        }
    return c;
}

// Stripes and two materials that fill the picture, moved by columns and rows.
Picture movedWall(Vec3 by, uint32_t side) {
    const double size = 0.25;
    Picture p = plane(side, side - 4, size, [&](double x, double y) {
        const double e = std::fmod(x - by.x * size + 100, 4) < 2 ? 0.6 : 0.4;
        return Vec3{e, 0.8 * e, 0.3 + 0.05 * (y - by.y * size)};
    });
    for (uint32_t i = 0; i < p.pixels(); ++i) p.ids[i] = p.place(i).y - by.y * size > 2 ? 2 : 1;
    return p;
}

uint64_t covered(const Picture& p) {
    return p.pixels() - uint64_t(std::ranges::count(p.ids, 0));
}

}  // namespace

TEST(History, EqualsTheOracle) {
    const struct {
        Picture (*moved)(Vec3 by, uint32_t side);
        Vec3 step;
        PelScattering method;
        uint32_t taps;
    } clips[] = {{movedBall, {2.3, -1.6, 0.8}, screen, 8},  // into the picture
                 {movedBall, {2.3, -1.6, 0.8}, separable, 9},
                 {movedWall, {2.3, -1.6, 0}, screen, 8},
                 {movedWall, {-1.3, 1.7, 0}, screen, 8}};
    for (const auto& [moved, step, method, taps] : clips)
        for (const uint32_t half : {0u, 1u}) {
            ShownImages shown(device(), 1, 1);
            std::vector<reference::HistoryPixel> history;
            for (uint32_t k = 0; k < 5; ++k) {
                ClipFrame c = clipFrame(moved((k - 5.0) * step, sized(44u, 20u)), method, taps, k, -1 * step);
                c.frame.options.halfRate = half;
                const Picture& p = c.frame.picture;
                std::vector<reference::Rgb> gathered;
                const std::vector<float> own = alone(c);
                for (size_t i = 0; i < p.pixels(); ++i)
                    gathered.push_back({own[3 * i], own[3 * i + 1], own[3 * i + 2]});
                reference::TapScene scene{p.exact(), int(taps), int(k)};
                scene.rate = half ? 2 : 1;
                const Shown now = shade(c, shown);
                const auto exact =
                    blendHistory(scene, *reference::skinProfile(), gathered, c.motion, 0.9, history);
                const Difference d = difference(p, now.light, exact), by = difference(p, own, exact);
                const std::string where = "method " + std::to_string(int(method)) + ", half " +
                                          std::to_string(half) + ", frame " + std::to_string(k);
                EXPECT_LT(d.rms, tolerance::historyRms) << where;
                EXPECT_LT(d.most, tolerance::historyMost) << where;
                if (k > 0) {
                    EXPECT_GT(by.rms, 20 * tolerance::historyRms) << where;
                    EXPECT_GT(now.stats.pixelsHistory, covered(p) / 2) << where;
                    EXPECT_LT(now.stats.pixelsHistory, covered(p)) << where;
                } else {
                    EXPECT_EQ(now.light, own) << where;
                }
            }
        }
}

TEST(History, AtRestComesCloserToAllTaps) {
    const uint32_t side = sized(64u, 24u);
    const Picture p = movedBall({}, side);
    for (const uint32_t half : {0u, 1u}) {
        ClipFrame dense = clipFrame(p, screen, 256, 0, {});
        dense.frame.options.halfRate = half;
        const std::vector<float> manyTaps = alone(dense);
        ShownImages shown(device(), 1, 1);
        double first = 0, last = 0;
        for (uint32_t k = 0; k < 16; ++k) {
            ClipFrame c = clipFrame(p, screen, 8, k, {});
            c.frame.options.halfRate = half;
            const Shown now = shade(c, shown);
            EXPECT_EQ(now.stats.pixelsHistory, k ? covered(p) : 0);
            last = difference(p, now.light, manyTaps).rms;
            if (k == 0) first = last;
        }
        EXPECT_LT(last, 0.45 * first);
    }
}

// More frames than a byte counts.
TEST(History, GoesOnForHundredsOfFrames) {
    const Picture p = movedBall({}, 16);
    ShownImages shown(device(), 1, 1);
    for (uint32_t k = 0; k < 300; ++k)
        ASSERT_EQ(shade(clipFrame(p, screen, 8, k, {}), shown).stats.pixelsHistory, k ? covered(p) : 0) << k;
}

// Light that a frame does not have around a pixel is not added from earlier frames.
TEST(History, LightThatWentOutLeavesNoTrail) {
    Picture p = movedBall({}, sized(64u, 24u));
    ShownImages shown(device(), 1, 1);
    for (uint32_t k = 0; k < 4; ++k) shade(clipFrame(p, screen, 8, k, {}), shown);
    for (float& e : p.irradiance) e *= 0.3f;
    const ClipFrame dim = clipFrame(p, screen, 8, 4, {});
    const std::vector<float> own = alone(dim), now = shade(dim, shown).light;
    EXPECT_NE(own, now);
    const auto sum = [](const std::vector<float>& v) { return std::accumulate(v.begin(), v.end(), 0.0); };
    EXPECT_NEAR(sum(now) / sum(own), 1, 0.02);  // 0.3 of the light of the frames before
    std::ranges::fill(p.irradiance, 0.0f);
    const Shown dark = shade(clipFrame(p, screen, 8, 5, {}), shown);
    EXPECT_EQ(dark.light, p.irradiance);
    EXPECT_EQ(dark.stats.pixelsHistory, covered(p));
}

// A plate that is nearer, or of another material, uncovers the plane: there nothing is taken from before.
TEST(History, UncoveredPixelsTakeNothing) {
    constexpr uint32_t shift = 5;
    for (const auto& [id, nearer] : {std::pair{uint8_t{1}, 6.0}, {uint8_t{2}, 0.0}}) {
        ShownImages shown(device(), 1, 1);
        for (uint32_t k = 0; k < 3; ++k) shade(plateFrame(k, 0, id, nearer), shown);
        const ClipFrame c = plateFrame(3, shift, id, nearer);
        const Shown now = shade(c, shown);
        const std::vector<float> own = alone(c);
        const Picture& p = c.frame.picture;
        EXPECT_EQ(now.stats.pixelsHistory, p.pixels() - 24 * shift);
        size_t uncovered = 0, others = 0;
        for (uint32_t y = 0; y < p.height; ++y)
            for (uint32_t x = 0; x < p.width; ++x) {
                const size_t i = 3 * p.at(x, y);
                const bool same = std::equal(&now.light[i], &now.light[i] + 3, &own[i]);
                if (y >= 8 && y < 32 && x >= 10 && x < 10 + shift)
                    uncovered += same;
                else
                    others += !same;
            }
        EXPECT_EQ(uncovered, 24 * shift);
        EXPECT_GT(others, p.pixels() / 4);
    }
}

// After each of these a frame is to the bit the one of a new shader.
TEST(History, BeginsAnew) {
    const Picture p = movedBall({}, 40), other = movedBall({}, 36);
    const struct {
        const char* name;
        std::function<void(ClipFrame&)> change;
        bool between = false;  // a frame without a history comes first
        bool commits = false;  // a commit of another size comes first
    } cases[] = {{"a cut", [](ClipFrame& c) { c.frame.options.historyCut = 7; }},
                 {"another size", [&](ClipFrame& c) { c = clipFrame(other, screen, 8, 3, {}); }},
                 {"a frame without a history", [](ClipFrame&) {}, true},
                 {"another size without a frame", [](ClipFrame&) {}, false, true},
                 {"surfaces that came from far away",
                  [](ClipFrame& c) {
                      for (Vec3& m : c.motion) m.z = 100;
                  }},
                 {"motion out of the picture", [](ClipFrame& c) {
                      for (Vec3& m : c.motion) m.x = -50;
                  }}};
    for (const auto& one : cases) {
        ShownImages shown(device(), 1, 1);
        for (uint32_t k = 0; k < 3; ++k) shade(clipFrame(p, screen, 8, k, {}), shown);
        ClipFrame c = clipFrame(p, screen, 8, 3, {});
        one.change(c);
        if (one.between) {
            ClipFrame without = c;
            without.frame.options.historyWeight = 0;
            shade(without, shown);
        }
        if (one.commits) {
            PelShaderOptions part = c.frame.options;
            part.regionWidth = part.regionHeight = 20;
            shown.shader.set(part).commit();
        }
        const Shown now = shade(c, shown);
        EXPECT_EQ(now.light, alone(c)) << one.name;
        EXPECT_EQ(now.stats.pixelsHistory, 0u) << one.name;
        c.motion.assign(c.motion.size(), {});
        EXPECT_EQ(shade(c, shown).stats.pixelsHistory, covered(c.frame.picture)) << one.name;
    }
}

// Another commit between two executions, or none, makes no difference; nor does another shader.
TEST(History, SameFramesGiveTheSameBits) {
    const Picture p = movedBall({}, 40);
    ShownImages one(device(), 1, 1), two(device(), 1, 1);
    for (uint32_t k = 0; k < 4; ++k) {
        const ClipFrame c = clipFrame(p, k % 2 ? separable : screen, 9, 0, {0.2, 0.1, 0});
        const Shown a = shade(c, one), b = shade(c, two);
        EXPECT_EQ(a.light, b.light) << k;
        EXPECT_EQ(a.stats.pixelsHistory, b.stats.pixelsHistory) << k;
    }
    const ClipFrame c = clipFrame(p, screen, 9, 0, {0.2, 0.1, 0});
    shade(c, one), shade(c, two);
    one.shader.execute();
    EXPECT_EQ(one.out.readAll<float>(), shade(c, two).light);
}

// A moving camera sees resting surfaces at other distances, which follow from its matrices.
TEST(History, FollowsTheCamera) {
    Picture p = plane(32, 24, 0.25, [](double x, double y) { return Vec3{x / 8, y / 6, 0.5}; });
    const auto turned = [](double x) {
        PelCamera camera = standingAt({0, 0, -200});
        camera.inverseViewProjection[14] = 0;
        const double length = std::hypot(x, 1);
        camera.inverseViewProjection[2] = float(x / length),
        camera.inverseViewProjection[10] = float(1 / length);
        return camera;
    };
    const auto frames = {std::pair{standingAt({4, 3, -200}), true},
                         {standingAt({9, 1, -120}), true},
                         {turned(0), false},
                         {turned(0.4), true},
                         {standingAt({4, 3, -200}), false}};
    ShownImages shown(device(), 1, 1);
    uint32_t k = 0;
    for (const auto& [camera, goesOn] : frames) {
        shown.shader.set(camera);
        EXPECT_EQ(shade(clipFrame(p, screen, 8, k, {}), shown).stats.pixelsHistory,
                  k && goesOn ? p.pixels() : 0)
            << k;
        ++k;
    }
}

// In a parallel view too, motion along the view is how much farther away a surface was, whichever way depth
// grows.
TEST(History, ParallelViewsKnowWhatIsFar) {
    const Picture p = plane(32, 24, 0.25, [](double x, double y) { return Vec3{x / 8, y / 6, 0.5}; });
    Picture nearer = p;
    for (size_t i = 0; i < p.pixels(); ++i) nearer.positions[3 * i + 2] += 8;
    for (const auto& [depth, motion] :
         {std::pair{-40.0f, 8.0}, {40.0f, 8.0}, {-40.0f, -8.0}, {40.0f, -8.0}}) {
        PelCamera camera = pelCameraDefaults();
        camera.position[2] = 500;
        camera.inverseViewProjection[10] = depth;
        ShownImages shown(device(), 1, 1);
        shown.shader.set(camera);
        shade(clipFrame(p, screen, 8, 0, {0, 0, 1e-6}), shown);
        EXPECT_EQ(shade(clipFrame(nearer, screen, 8, 1, {0, 0, motion}), shown).stats.pixelsHistory,
                  motion > 0 ? p.pixels() : 0)
            << "depth " << depth << ", motion " << motion;
    }
}

TEST(History, BadMotionAndLightAreThePixelsOwn) {
    const Picture p = movedBall({}, 40);
    constexpr double bad[] = {notANumber, infinity, -infinity, 1e30, -1e30};
    ShownImages shown(device(), 1, 1);
    shade(clipFrame(p, screen, 8, 0, {}), shown);
    ClipFrame c = clipFrame(p, screen, 8, 1, {0.25, 0, 0});
    for (size_t i = 0; i < p.pixels(); i += 3) c.motion[i][int(i / 3 % 3)] = bad[i / 9 % 5];
    const std::vector<float> own = alone(c), now = shade(c, shown).light;
    size_t kept = 0, blended = 0;
    for (size_t i = 0; i < p.pixels(); ++i) {
        if (!p.ids[i]) continue;
        const bool same = std::equal(&now[3 * i], &now[3 * i] + 3, &own[3 * i]);
        (i % 3 ? blended : kept) += i % 3 ? !same : same;
        for (size_t k = 3 * i; k < 3 * i + 3; ++k) ASSERT_TRUE(std::isfinite(now[k])) << i;
        if (i % 3 == 0) {
            EXPECT_TRUE(same) << i;
        }
    }
    EXPECT_GT(kept, 200u);
    EXPECT_GT(blended, kept);
    // A pixel without a number in its light is invalid for one frame.
    Picture broken = p;
    const size_t one = p.at(20, 20);
    broken.irradiance[3 * one] = notANumber;
    shade(clipFrame(broken, screen, 8, 2, {}), shown);
    const Shown after = shade(clipFrame(p, screen, 8, 3, {}), shown);
    EXPECT_EQ(after.stats.pixelsHistory, covered(p) - 1);
    EXPECT_EQ(after.stats.pixelsInvalid, 0u);
    EXPECT_TRUE(std::ranges::all_of(after.light, [](float v) { return std::isfinite(v); }));
}

TEST(History, IsCheckedAndCounted) {
    const Picture p = movedBall({}, 40);
    ShownImages shown(device(), 1, 1);
    const ClipFrame c = clipFrame(p, screen, 8, 0, {});
    shade(c, shown);
    const auto bytes = [&] {
        uint64_t held = 0;
        for (const PelPassMemory& pass : shown.shader.memory()) {
            EXPECT_EQ(pass.held, pass.needed) << pass.name;
            held += pass.held;
        }
        return held;
    };
    const uint64_t with = bytes();
    EXPECT_EQ(with, shown.shader.stats().scratchBytes);
    ClipFrame without = c;
    without.frame.options.historyWeight = 0;
    shade(without, shown);
    EXPECT_GE(with - bytes(), 32 * p.pixels());
    shown.set(PEL_SLOT_MOTION, std::vector<float>(2 * p.pixels()));
    EXPECT_THROW(shown.set(PEL_SLOT_MOTION, std::vector<float>(p.pixels())), pellucid::Error);
    PelCamera nowhere = pelCameraDefaults();
    std::fill_n(nowhere.inverseViewProjection, 16, 0.0f);
    shown.shader.set(nowhere);
    expectRefused("inverseViewProjection", [&] { shade(c, shown); });
    shown.shader.set(pelCameraDefaults());
    EXPECT_EQ(shade(c, shown).light, alone(c));
    ClipFrame idle = c;
    idle.frame.material.scatterTaps = 0;
    EXPECT_NE(shade(idle, shown).warnings.find("historyWeight"), std::string::npos);
}
