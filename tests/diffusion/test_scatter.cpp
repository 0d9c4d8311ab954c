// A PelScatter: blocks of pixels, taps on a disk and the separable filter against the sums that they
// approximate, and invariants of any picture.

#include "device_lanes.h"
#include "diffusion/scatter_scene.h"
#include "reference/diffusion_taps.h"
#include "test.h"

using namespace scatter_scene;

namespace {

constexpr std::pair<PelScattering, uint32_t> byTaps[] = {
    {separable, 25}, {separable, 0}, {screen, 8}, {screen, 64}};
constexpr std::pair<PelScattering, uint32_t> ways[] = {
    {screen, 0}, {separable, 25}, {separable, 0}, {screen, 8}, {screen, 64}};

Profile narrow() {
    return Profile::gaussians({{0.25f, {1, 0.5f, 0.25f}}});
}

Vec3 sideLight() {
    return normalized(Vec3{1, 0.3, 0.2});
}

// The same for the ids 1 to 3.
std::vector<Material> alike(const Profile& profile, float scale, const PelScatterControls& controls) {
    return {{1, profile, scale, controls}, {2, profile, scale, controls}, {3, profile, scale, controls}};
}
Result scatterBy(const Picture& p, float scale, const PelScatterControls& controls,
                 const std::vector<float>& weights = {}) {
    return run(p, alike(Profile::skin(), scale, controls), {weights});
}

// A ball of one or two materials seen along -z, half of it lit.
Picture scene(bool two = true) {
    Picture p = ball(96, 10, 0.22, normalized(Vec3{1, 0.4, 0.3}));
    for (size_t i = 0; two && i < 40 * 96; ++i)
        if (p.ids[i]) p.ids[i] = 2;
    std::fill_n(p.params.inverseViewProjection, 16, 0.0f);
    for (int k : {0, 5, 10, 15}) p.params.inverseViewProjection[k] = 1;
    return p;
}

}  // namespace

TEST(Scatter, EqualsTheSumOverEveryPixel) {
    const uint32_t side = sized(72u, 24u);
    Picture p = ball(side, 10, 21.0 / side, sideLight());
    for (size_t i = 0; i < p.pixels(); ++i)  // a hard shadow across it
        if (p.positions[3 * i + 1] > 2) std::fill_n(&p.irradiance[3 * i], 3, 0.0f);
    p.params.everywhere = 1;
    const float meanFreePath[] = {1.2f, 0.6f, 0.3f}, albedo[] = {0.8f, 0.8f, 0.8f};
    const std::pair<Profile, reference::ProfilePtr> profiles[] = {
        {Profile::skin(), reference::skinProfile()},
        {Profile::burley(meanFreePath, albedo),
         reference::burleyProfile({1.2f, 0.6f, 0.3f}, {0.8f, 0.8f, 0.8f})}};
    for (const auto& [profile, exact] : profiles) {
        const Result result = run(p, profile);
        const Difference d = difference(p, result.scattered, reference::scatterOnScreen(p.exact(), *exact));
        EXPECT_LT(d.rms, tolerance::scatterBlocksRms);
        EXPECT_LT(d.most, tolerance::scatterBlocksMax);
        EXPECT_EQ(result.stats.pixelsTapped, result.stats.pixelsCovered);
    }
}

// Half a plane that faces the camera and half a steep one, on which pixels on a diagonal lie nearer to each
// other than those beside each other: narrow parts of the profile count at each, whatever its neighbours are.
TEST(Scatter, OneLaneFindsTheLightOfSixteen) {
    Picture p = plane(64, 64, 0.1, [](double u, double v) {
        return Vec3(Vec3{1, 1, 1} * (u > v ? 1.0 : 0.1));
    });
    for (size_t i = 0; i < p.pixels(); ++i)
        p.positions[3 * i + 2] = -5 * std::max(p.positions[3 * i] + p.positions[3 * i + 1] - 6.4f, 0.0f);
    Frame f(p, PEL_SCATTERING_SCREEN);
    f.profile = narrow();
    const auto light = [&](int lanes) {
        ShownImages shown(lanes::deviceOf(lanes), 1, 1);
        return f.shade(shown).light;
    };
    EXPECT_LT(difference(p, light(1), light(16)).most, tolerance::scatterLanes);
}

// Dots in the middle of nine tiles, which affect the middle tile and the four beside it. Pixels are too far
// apart for light to get from one to the next, except in one tile: every tile round it must assume pixels as
// close.
TEST(Scatter, ATileCountsWhereAnyTileAroundItIsFine) {
    const Profile profile = Profile::burleyDistance({0.02, 0.02, 0.02});
    const auto tapped = [&](uint32_t fineX, uint32_t fineY) {
        Picture p(48, 48);
        for (uint32_t y = 0; y < 48; ++y)
            for (uint32_t x = 0; x < 48; ++x) {
                const bool fine = x / 16 == fineX && y / 16 == fineY,
                           dotted = x / 4 >= 5 && x / 4 < 7 && y / 4 >= 5 && y / 4 < 7;
                const double step = fine ? 0.02 : 1, e = dotted ? (x + y) % 2 : 0.5;
                p.set(p.at(x, y), {step * x, step * y, 0}, {e, e, e});
            }
        return run(p, profile).stats.tilesTapped;
    };
    EXPECT_EQ(tapped(9, 9), 0u);
    const uint32_t expected[] = {3, 4, 3, 4, 5, 4, 3, 4, 3};
    for (uint32_t i = 0; i < 9; ++i) EXPECT_EQ(tapped(i % 3, i / 3), expected[i]) << i;
}

TEST(Scatter, TapsAreThoseOfTheOracle) {
    Picture p = scene();
    p.params.frameIndex = 3;
    p.params.everywhere = 1;
    reference::TapScene s{p.exact(), 0, 3, 1, {}, {}, {}};
    std::vector<float> weights;
    for (size_t i = 0; i < p.pixels(); ++i) {
        s.weights.push_back(0.25 + 0.75 * double(i % 7) / 6);
        s.radii.push_back(i % 96 < 40 ? 1 : 0.5);
        weights.insert(weights.end(), {float(s.weights[i]), float(s.radii[i])});
    }
    for (const auto& [method, taps] :
         {std::pair{separable, 25u}, {separable, 9u}, {screen, 8u}, {screen, 64u}})
        for (float border : {0.0f, 0.5f}) {
            s.taps = int(taps), s.border = {border, border, border};
            const auto exact = method == screen ? reference::scatterOnDisk(s, *reference::skinProfile())
                                                : reference::scatterSeparably(s, *reference::skinProfile());
            const Difference d =
                difference(p, scatterBy(p, 1, controlsOf(method, taps, border), weights).scattered, exact);
            EXPECT_LT(d.rms, tolerance::scatterTapsRms);
            EXPECT_LT(d.most, tolerance::scatterTapsMost);
        }
}

// Each pixel of an even column and row is a sample; others lie between those of their surface, and gather
// where there are none.
TEST(Scatter, HalfRateIsThatOfTheOracle) {
    Picture p = scene();
    p.params.frameIndex = 3;
    p.params.everywhere = 1;
    for (size_t i = 0; i < p.pixels(); ++i)  // a line of one pixel, in an odd column
        if (i % p.width % 16 == 4 || i % p.width % 16 == 6) p.ids[i] = 0;
    reference::TapScene s{p.exact(), 0, 3, 2, {}, {}, {}};
    std::vector<float> radii;
    for (size_t i = 0; i < p.pixels(); ++i) {
        s.radii.push_back(i % 96 < 40 ? 1 : 0.5);
        radii.insert(radii.end(), {1.0f, float(s.radii[i])});
    }
    for (const auto& [method, taps] : {std::pair{separable, 25u}, {screen, 16u}}) {
        s.taps = int(taps);
        const auto gathered = method == screen ? reference::scatterOnDisk(s, *reference::skinProfile())
                                               : reference::scatterSeparably(s, *reference::skinProfile());
        const auto between = reference::betweenSamples(s, *reference::skinProfile(), gathered);
        p.params.halfRate = 0;
        const Result whole = scatterBy(p, 1, controlsOf(method, taps), radii);
        p.params.halfRate = 1;
        const Result half = scatterBy(p, 1, controlsOf(method, taps), radii);
        std::vector<Vec3> exact = gathered;
        Picture compared = p;
        size_t alone = 0;
        for (size_t i = 0; i < p.pixels(); ++i) {
            if (between[i]) exact[i] = *between[i];
            alone += p.ids[i] && !between[i];
            // Lines of pixels without a sample are filtered along their columns alone.
            if (!between[i] && method == separable) compared.ids[i] = 0;
        }
        EXPECT_GT(alone, 50u);
        const Difference d = difference(compared, half.scattered, exact);
        EXPECT_LT(d.rms, tolerance::scatterTapsRms);
        EXPECT_LT(d.most, tolerance::scatterTapsMost);
        EXPECT_LT(half.stats.taps, whole.stats.taps * (method == screen ? 0.35 : 0.5));
        EXPECT_LT(half.stats.pixelsTapped, 0.35 * double(whole.stats.pixelsTapped));
        EXPECT_GT(half.stats.pixelsTapped, alone);
    }
}

// Beside highlights of a single pixel, where the pixel's share of its own light differs from that of the
// taps.
TEST(Scatter, HalfRateLeavesNoLightBelowZero) {
    for (const auto& [method, taps] : byTaps)
        for (float scale : {0.03f, 0.1f, 0.3f}) {
            Picture p = plane(64, 48, 0.2, [](double x, double y) {
                const bool bright = std::lround(x / 0.2) % 8 == 0 && std::lround(y / 0.2) % 8 == 0;
                return bright ? Vec3{1e3, 1e3, 1e3} : Vec3{0.01, 0.01, 0.01};
            });
            p.params.everywhere = p.params.halfRate = 1;
            const auto scattered = scatterBy(p, scale, controlsOf(method, taps)).scattered;
            EXPECT_GE(*std::ranges::min_element(scattered), 0.0f) << int(method) << ", " << scale;
            EXPECT_LE(*std::ranges::max_element(scattered), 1.001e3f) << int(method) << ", " << scale;
        }
}

TEST(Scatter, UniformLightStaysAsItIs) {
    Picture p = scene();
    for (float& e : p.irradiance) e = 0.7f;
    for (const auto& [method, taps] : ways)
        for (const uint32_t half : {0u, 1u}) {
            const bool blocks = method == screen && !taps;
            p.params.everywhere = blocks;
            p.params.halfRate = half;
            for (float scale : {1e-3f, 0.3f, 1.0f, 3.0f}) {
                if (blocks && scale < 1) continue;
                const auto result =
                    scatterBy(p, scale, controlsOf(method, taps, blocks ? 0 : 0.4f)).scattered;
                EXPECT_LE(difference(p, result, p.irradiance).most, blocks ? 2e-5
                                                                    : half ? 4e-6
                                                                           : 2e-6)
                    << int(method) << ", " << taps << ", " << scale << ", half rate " << half;
            }
        }
}

// Its light comes from blocks of every level, the coarsest too. The sum over a picture of an edge has a
// closed form for a Gaussian.
TEST(Scatter, AProfileAsWideAsThePicture) {
    const uint32_t width = sized(640u, 64u), height = sized(320u, 32u);
    const double edge = 0.4 * width, sigma = 0.15 * width;
    Picture p = plane(width, height, 1, [&](double x, double) { return x < edge ? Vec3{1, 1, 1} : Vec3{}; });
    p.params.everywhere = 1;
    const Result result = run(p, Profile::gaussians({{float(sigma * sigma), {1, 1, 1}}}));
    const auto below = [&](double x) { return 0.5 * std::erfc(-x / (sigma * std::sqrt(2.0))); };
    const Difference d = difference(p, result.scattered, [&](size_t i, int) {
        const double x = p.positions[3 * i];
        return (below(edge - x) - below(-x)) / (below(width - x) - below(-x));
    });
    EXPECT_LT(d.rms, tolerance::scatterWideRms);
    EXPECT_LT(d.most, tolerance::scatterWideMost);
}

// Exchanging channels of light and profile exchanges the channels of the result, to the bit.
TEST(Scatter, ChannelsAreTreatedAlike) {
    Picture p = scene();
    for (size_t i = 0; i < p.pixels(); ++i) {
        const size_t x = i % p.width, y = i / p.width;
        p.irradiance[3 * i + 1] *= 0.2f + float(x) / float(p.width);
        p.irradiance[3 * i + 2] *= y % 12 < 6 ? 1 : 0.3f;
    }
    Picture turned = p;
    for (size_t k = 0; k < p.irradiance.size(); ++k)
        turned.irradiance[k] = p.irradiance[k / 3 * 3 + (k + 1) % 3];
    const Profile profile = Profile::burleyDistance({1.2f, 0.8f, 0.4f}),
                  turnedProfile = Profile::burleyDistance({0.8f, 0.4f, 1.2f});
    Extra extra;
    for (size_t i = 0; i < p.pixels(); ++i)
        for (int c = 0; c < 3; ++c) extra.normals.push_back(p.positions[3 * i + c] / 10);
    for (const auto& [method, taps] : ways) {
        const PelScatterControls controls = controlsOf(method, taps);
        const std::vector<float> first = run(p, alike(profile, 1, controls), extra).scattered,
                                 second = run(turned, alike(turnedProfile, 1, controls), extra).scattered;
        for (size_t k = 0; k < first.size(); ++k)
            ASSERT_EQ(second[k], first[k / 3 * 3 + (k + 1) % 3]) << int(method) << " " << taps << ", " << k;
    }
}

TEST(Scatter, NothingFlowsBetweenIdsUnlessAsked) {
    Picture flat = plane(64, 64, 0.2, [](double, double) { return Vec3{}; });
    for (size_t i = 0; i < flat.pixels(); ++i) {
        flat.ids[i] = i % 64 < 29 ? 1 : i % 64 < 41 ? 2 : 0;
        std::fill_n(&flat.irradiance[3 * i], 3, flat.ids[i] == 2 ? 1.0f : flat.ids[i] == 0 ? 5.0f : 0.0f);
    }
    flat.params.everywhere = 1;
    const Result blocks = run(flat, {{1, Profile::skin()}, {2, narrow()}});
    for (size_t i = 0; i < flat.irradiance.size(); ++i)
        EXPECT_NEAR(blocks.scattered[i], flat.irradiance[i], 1e-5) << i;
    for (const auto& [method, taps] : byTaps) {
        Picture p = scene();
        for (size_t i = 0; i < p.irradiance.size(); ++i) p.irradiance[i] = p.ids[i / 3] == 2 ? 1.0f : 0.0f;
        const auto apart = scatterBy(p, 1, controlsOf(method, taps)).scattered;
        expectSameBits(device(), apart, p.irradiance);  // x / x need not be 1 on a GPU
        // A border of 1: as if all pixels had one id.
        const auto open = scatterBy(p, 1, controlsOf(method, taps, 1)).scattered;
        Picture one = p;
        for (uint8_t& id : one.ids) id = id ? 1 : 0;
        const auto joined = scatterBy(one, 1, controlsOf(method, taps)).scattered;
        // Sizes of pixels next to the border are measured on one side.
        EXPECT_LT(difference(p, open, joined).rms, 2e-3);
        EXPECT_GT(difference(p, open, apart).rms, 0.02);
        // A channel without flow is as if no channel had any.
        PelScatterControls red = controlsOf(method, taps);
        red.borderColor[0] = 1;
        const auto some = scatterBy(scene(), 1, red).scattered,
                   none = scatterBy(scene(), 1, controlsOf(method, taps)).scattered;
        for (size_t i = 0; i < some.size(); ++i)
            if (i % 3) ASSERT_NEAR(some[i], none[i], 1e-6) << int(method) << " " << i;
        // Teeth, eyes, clothes: no light flows to or from an id that does not scatter.
        for (uint8_t& id : p.ids) id = id == 2 ? 9 : id;
        EXPECT_EQ(scatterBy(p, 1, controlsOf(method, taps, 1)).scattered, p.irradiance);
    }
}

TEST(Scatter, WeightAndRadiusPerPixel) {
    for (const auto& [method, taps] : byTaps) {
        const Picture p = scene();
        const auto whole = scatterBy(p, 1, controlsOf(method, taps)).scattered;
        std::vector<float> weights(p.pixels()), halves;
        for (size_t i = 0; i < weights.size(); ++i) {
            weights[i] = i % 3 == 0 ? 0.0f : i % 3 == 1 ? 0.5f : notANumber;
            halves.insert(halves.end(), {1.0f, 0.5f});
        }
        const Result some = scatterBy(p, 1, controlsOf(method, taps), weights);
        for (size_t i = 0; i < whole.size(); ++i) {
            const float e = p.irradiance[i];
            ASSERT_NEAR(some.scattered[i], i / 3 % 3 == 1 ? 0.5f * (e + whole[i]) : e, 1e-6) << i;
        }
        EXPECT_LT(some.stats.pixelsTapped, p.pixels() / 3);  // the others cost nothing
        // Half of the radius is a profile of half the size.
        const auto thin = scatterBy(p, 1, controlsOf(method, taps), halves).scattered;
        const auto half = scatterBy(p, 0.5f, controlsOf(method, taps)).scattered;
        EXPECT_LT(difference(p, thin, half).rms, 1e-4);
        // A radius below a pixel: no taps, and no bit changes.
        const Result small = scatterBy(p, 1e-3f, controlsOf(method, taps));
        EXPECT_EQ(small.stats.taps, 0u);
        EXPECT_EQ(small.stats.tilesTapped, 0u);
        EXPECT_EQ(small.scattered, p.irradiance);
    }
}

// Finite values whose sums overflow are treated as NaN and Inf are: the pixel keeps its value, and is
// counted.
TEST(Scatter, LightTooLargeToSumStaysWhereItIs) {
    for (const auto& [method, taps] : ways) {
        Picture p = plane(40, 40, 0.2, [](double x, double) { return x < 4 ? Vec3{1, 1, 1} : Vec3{}; });
        const size_t bright = 3 * p.at(19, 21) + 1;
        p.irradiance[bright] = 3e38f;
        const Result result = scatterBy(p, 1, controlsOf(method, taps));
        EXPECT_EQ(result.stats.pixelsInvalid, 1u) << int(method);
        for (size_t i = 0; i < result.scattered.size(); ++i) {
            const float v = result.scattered[i];
            ASSERT_TRUE(i == bright ? v == 3e38f : v >= 0 && v < 1.001f)
                << int(method) << " " << i << ": " << v;
        }
    }
}

// The choice of tiles does not depend on orientation: pixels are close together in one of two tiles and far
// apart in the other; the picture is mirrored and transposed; the contrast grows until tiles begin to
// scatter.
TEST(Scatter, TwoTilesAreChosenAlikeFromEverySide) {
    uint64_t tapped[3] = {};
    const int contrasts = 60;
    const Profile profile = Profile::gaussians({{2.25f, {1, 0.6f, 0.3f}}, {0.09f, {0, 0.4f, 0.7f}}});
    for (int k = 0; k < contrasts; ++k)
        for (int way = 0; way < 3; ++way) {
            Picture p = way < 2 ? Picture(32, 16) : Picture(16, 32);
            for (uint32_t i = 0; i < 32; ++i)
                for (uint32_t j = 0; j < 16; ++j) {
                    const double size = i < 16 ? 2 : 0.25, x = i < 16 ? 2.0 * i : 30 + 0.25 * (i - 15);
                    const double e = 0.5 + 1e-4 * std::pow(1.1, k) * (i % 8 < 4 ? 1 : -1);
                    const uint32_t column = way == 0 ? i : way == 1 ? 31 - i : j, row = way < 2 ? j : i;
                    p.set(p.at(column, row), {x, size * j, 0}, {e, e, e});
                }
            tapped[way] += run(p, profile).stats.tilesTapped;
        }
    EXPECT_GT(tapped[0], 0u);
    EXPECT_LT(tapped[0], 2u * contrasts);
    EXPECT_EQ(tapped[1], tapped[0]) << "mirrored";
    EXPECT_EQ(tapped[2], tapped[0]) << "transposed";
}

TEST(Scatter, WithoutMaterialsOrContrastThePictureStays) {
    const Picture p = ball(40, 10, 0.6, sideLight());
    EXPECT_EQ(run(p, std::vector<Material>{}).scattered, p.irradiance);
    EXPECT_EQ(run(p, {{7, Profile::skin()}}).stats.pixelsCovered, 0u);
    EXPECT_EQ(run(p, Profile::skin(), 0).scattered, p.irradiance);
    const Picture flat = plane(160, 90, 0.3, [](double x, double y) {
        return Vec3{0.3 + 0.01 * x, 0.4 + 0.004 * y, 0.5};
    });
    const Result result = run(flat, Profile::skin());
    EXPECT_EQ(result.stats.pixelsTapped, 0u);
    EXPECT_EQ(result.stats.taps, 0u);
    EXPECT_EQ(result.stats.pixelsCovered, flat.pixels());
    EXPECT_EQ(result.scattered, flat.irradiance);
}

TEST(Scatter, InPlaceAndInAnyUnit) {
    Picture p = ball(100, 10, 0.21, sideLight());
    Extra extra;
    extra.inPlace = true;
    EXPECT_EQ(run(p, {{1, Profile::skin()}}, extra).scattered, run(p, Profile::skin()).scattered);
    p.params.everywhere = 1;
    Picture metres = p;
    for (float& x : metres.positions) x *= 0.001f;
    for (const PelScatterControls& controls :
         {pelScatterControlsDefaults(), controlsOf(PEL_SCATTERING_SEPARABLE, 11)}) {
        const Result mm = run(p, {{1, Profile::skin(), 1, controls}});
        const Difference d =
            difference(p, run(metres, {{1, Profile::skin(), 0.001f, controls}}).scattered, mm.scattered);
        EXPECT_LT(d.rms, tolerance::scatterUnits) << int(controls.scattering);
        EXPECT_LT(d.most, 10 * tolerance::scatterUnits) << int(controls.scattering);
    }
}

TEST(Scatter, DepthIsAsGoodAsPositions) {
    // A perspective view from (0, 0, 40) down -z: ndc = p / (-z / 3), depth between 20 and 60.
    const uint32_t side = 96;
    Picture p(side, side);
    Extra extra;
    extra.depth.assign(side * side, 1.0f);
    const float near = 20, far = 60, a = far / (near - far), b = near * far / (near - far);
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const Vec3 d =
                normalized(Vec3{((x + 0.5) / side * 2 - 1) / 3, (1 - (y + 0.5) / side * 2) / 3, -1});
            const double along = dot(d, Vec3{0, 0, 40}), rest = along * along - 1600 + 100;
            if (rest <= 0) continue;
            const Vec3 world = Vec3{0, 0, 40} + (-along - std::sqrt(rest)) * d;
            const double e = reference::max0(dot(world / 10, sideLight())), z = world.z - 40;
            p.set(p.at(x, y), world, {e, e, e});
            extra.depth[p.at(x, y)] = float((a * z + b) / -z);
        }
    // Of clip = (3 x, 3 y, a z + b, -z) with z from the camera, inverted; then 40 is added to z.
    float* m = p.params.inverseViewProjection;
    m[0] = m[5] = 1 / 3.0f;
    m[11] = -1, m[14] = 1 / b, m[15] = a / b;
    for (int k = 0; k < 4; ++k) m[8 + k] += 40 * m[12 + k];
    for (const auto& [method, taps] : {std::pair{screen, 0u}, {screen, 16u}, {separable, 16u}}) {
        const std::vector<Material> materials{{1, Profile::skin(), 1, controlsOf(method, taps)}};
        const std::vector<float> known = run(p, materials).scattered;
        EXPECT_LT(difference(p, run(p, materials, extra).scattered, known).most, tolerance::scatterUnits)
            << int(method);
        EXPECT_GT(difference(p, p.irradiance, known).most, 0.02);
    }
}

// Results that no sum over lit surface has: less than the darkest or more than the brightest irradiance, and,
// in a dark gap between lit walls, less light of a channel that scatters farther. Two rods that touch, as
// lips do, seen along -z and lit from above, the upper one casting its shadow on the lower: below the middle
// of the upper one lies a dark gap, which ends at a limb.
TEST(Scatter, NeitherBrighterThanItsLightNorBlueInADarkGap) {
    const uint32_t side = sized(96u, 24u);
    size_t dark = 0;
    for (double size : {0.15, 0.35, 0.7})
        for (double turn : {0.0, 0.3, 1.2})
            for (double elevation : {0.6, 1.0, 1.35}) {
                const double radius = 0.24 * side * size;
                const Vec3 toLight{0, std::sin(elevation), std::cos(elevation)};
                Picture p(side, side);
                for (size_t i = 0; i < p.pixels(); ++i) {
                    const double a = (double(i % side) + 0.5 - 0.5 * side) * size,
                                 b = (0.5 * side - double(i / side) - 0.5) * size,
                                 u = std::cos(turn) * a - std::sin(turn) * b,
                                 v = std::sin(turn) * a + std::cos(turn) * b;
                    const double middle = v > 0 ? radius : -radius,
                                 rest = radius * radius - (v - middle) * (v - middle);
                    if (rest <= 0) continue;
                    const double z = std::sqrt(rest);
                    double e = reference::max0(dot(Vec3{0, (v - middle) / radius, z / radius}, toLight));
                    // The ray to the light passes the upper rod's axis at this distance.
                    const double across = (v - radius) * toLight.z - z * toLight.y;
                    if (v < 0 && std::abs(across) < radius) e = 0;
                    p.set(i, {u, v, z}, {e, e, e});
                }
                const std::vector<float> light = run(p, Profile::skin()).scattered;
                const float brightest = std::ranges::max(p.irradiance);
                double brighter = 0, bluer = 0;
                for (size_t i = 0; i < p.pixels(); ++i) {
                    if (!p.ids[i]) continue;
                    const float *s = &light[3 * i], v = p.positions[3 * i + 1];
                    for (int c = 0; c < 3; ++c) {
                        EXPECT_GE(s[c], 0);
                        brighter = std::max(brighter, double(s[c] - brightest));
                    }
                    const bool atEdge = i % side < 2 || i % side + 2 >= side;  // beyond, nothing is known
                    if (atEdge || p.irradiance[3 * i] > 0 || v < -radius / 8 || v > radius) continue;
                    ++dark;
                    for (int c = 0; c < 2; ++c) bluer = std::max(bluer, double(s[c + 1] - s[c]));
                }
                EXPECT_LE(brighter, 1e-4) << size << " mm, " << turn << ", " << elevation;
                EXPECT_LE(bluer, tolerance::scatterBluer) << size << " mm, " << turn << ", " << elevation;
            }
    EXPECT_GT(dark, 0u);
}

// Of a ball on a background without ids.
TEST(ScatterStats, CountWhatIsCovered) {
    const Picture p = ball(80, 10, 0.6, sideLight());
    std::set<std::pair<size_t, size_t>> tiles;
    for (size_t i = 0; i < p.pixels(); ++i)
        if (p.ids[i]) tiles.insert({i % p.width / 16, i / p.width / 16});
    for (const auto& [method, taps] : ways) {
        const PelScatterStats stats = run(p, {{1, narrow(), 1, controlsOf(method, taps)}}).stats;
        EXPECT_EQ(stats.pixelsTotal, p.pixels());
        EXPECT_GT(stats.deviceMilliseconds, 0);
        EXPECT_EQ(stats.pixelsCovered, size_t(std::ranges::count(p.ids, 1)));
        EXPECT_EQ(stats.tilesCovered, tiles.size()) << int(method) << ", " << taps;
        EXPECT_EQ(std::accumulate(stats.tilesByScattering, std::end(stats.tilesByScattering), uint64_t{0}),
                  stats.tilesTapped);
    }
}
