// Scattering alone: against the sum over every pixel, and what must hold for any picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "diffusion/scatter_scene.h"
#include "reference/lut.h"
#include "tolerances.h"

using namespace scatter_scene;

namespace {

constexpr float notANumber = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

Profile narrow() {
    const PelGaussian gaussian{0.25f, {1, 0.5f, 0.25f}};
    return Profile::gaussians({gaussian});
}

struct Difference {
    double rms = 0, most = 0;
};

template <class Expected>
Difference difference(const Picture& p, const std::vector<float>& result, const Expected& expected) {
    Difference d;
    size_t count = 0;
    for (size_t i = 0; i < p.pixels(); ++i) {
        if (!p.ids[i]) continue;
        for (int c = 0; c < 3; ++c) {
            const double e = result[3 * i + c] - expected(i, c);
            d.rms += e * e, d.most = std::max(d.most, std::abs(e)), ++count;
        }
    }
    d.rms = std::sqrt(d.rms / double(std::max<size_t>(count, 1)));
    return d;
}

Vec3 sideLight() {
    return normalized(Vec3{1, 0.3, 0.2});
}

}  // namespace

TEST(Scatter, EqualsTheSumOverEveryPixel) {
    const uint32_t side = sized(72u, 24u);
    const double size = 21.0 / side;
    Picture p = ball(side, 10, size, sideLight());
    for (size_t i = 0; i < p.pixels(); ++i)  // a hard shadow across it
        if (p.positions[3 * i + 1] > 2) std::fill_n(&p.irradiance[3 * i], 3, 0.0f);
    p.params.everywhere = 1;
    const float meanFreePath[] = {1.2f, 0.6f, 0.3f}, albedo[] = {0.8f, 0.8f, 0.8f};
    const std::pair<Profile, reference::ProfilePtr> profiles[] = {
        {Profile::skin(), reference::skinProfile()},
        {Profile::burley(meanFreePath, albedo),
         reference::burleyProfile({1.2f, 0.6f, 0.3f}, {0.8f, 0.8f, 0.8f})}};
    for (const auto& [profile, exact] : profiles) {
        const auto expected = reference::scatterOnScreen(p.exact(), *exact);
        const Result result = run(p, profile);
        const Difference d = difference(p, result.scattered, [&](size_t i, int c) { return expected[i][c]; });
        EXPECT_LT(d.rms, tolerance::scatterBlocksRms);
        EXPECT_LT(d.most, tolerance::scatterBlocksMax);
        EXPECT_EQ(result.stats.pixelsTapped, result.stats.pixelsCovered);
    }
}

TEST(Scatter, LeavesOutNoMoreThanTheTargetErrorSays) {
    const uint32_t side = sized(160u, 32u);
    Picture p = ball(side, 10, 21.0 / side, sideLight());
    p.params.everywhere = 1;
    const Result all = run(p, narrow());
    p.params.everywhere = 0;
    uint64_t before = all.stats.taps + 1;
    for (float target : {1e-3f, 2e-3f, 8e-3f}) {
        p.params.targetError = target;
        const Result result = run(p, narrow());
        std::vector<double> errors;
        for (size_t i = 0; i < p.pixels(); ++i)
            if (p.ids[i])
                for (int c = 0; c < 3; ++c)
                    errors.push_back(std::abs(result.scattered[3 * i + c] - all.scattered[3 * i + c]));
        std::sort(errors.begin(), errors.end());
        EXPECT_LE(errors[errors.size() * 99 / 100], std::max<double>(target, tolerance::scatterLeastError));
        EXPECT_LE(result.stats.taps, before);
        before = result.stats.taps;
    }
    EXPECT_LT(before, all.stats.taps);
}

TEST(Scatter, ABallIsNearerToItsClosedFormThanLambert) {
    const uint32_t side = sized(256u, 32u);
    const Vec3 toLight = sideLight();
    const Picture p = ball(side, 10, 20.5 / side, toLight);
    const float meanFreePath[] = {0.321f, 0.12f, 0.06f}, albedo[] = {0.8f, 0.8f, 0.8f};
    const auto exact = reference::burleyProfile({0.321f, 0.12f, 0.06f}, {0.8f, 0.8f, 0.8f});
    std::vector<reference::Rgb> curve;  // over N.L from -1 to 1
    const int steps = 100;
    for (int k = 0; k <= steps; ++k)
        curve.push_back(reference::curvatureD(reference::Form::sphere, *exact, -1 + 2.0 * k / steps, 10));
    const Result result = run(p, Profile::burley(meanFreePath, albedo));
    reference::Rgb error, lambert;
    size_t count = 0;
    for (size_t i = 0; i < p.pixels(); ++i) {
        if (!p.ids[i]) continue;
        ++count;
        const Vec3 n = Vec3{p.positions[3 * i], p.positions[3 * i + 1], p.positions[3 * i + 2]} / 10;
        const double u = std::clamp((dot(n, toLight) + 1) / 2 * steps, 0.0, steps - 1e-9);
        const reference::Rgb s = mix(curve[size_t(u)], curve[size_t(u) + 1], u - std::floor(u));
        for (int c = 0; c < 3; ++c) {
            error[c] += std::pow(result.scattered[3 * i + c] - s[c], 2);
            lambert[c] += std::pow(p.irradiance[3 * i + c] - s[c], 2);
        }
    }
    for (int c = 0; c < 3; ++c) {
        RecordProperty("rmse" + std::to_string(c), std::to_string(std::sqrt(error[c] / count)));
        EXPECT_LT(std::sqrt(error[c] / count), tolerance::scatterBall);
        EXPECT_LT(error[c], lambert[c]);
    }
}

TEST(Scatter, ConstantIrradianceStays) {
    Picture p = ball(sized(96u, 32u), 10, 0.25, {0, 0, 1});
    for (float& e : p.irradiance) e = 0.75f;
    p.params.everywhere = 1;
    const Result result = run(p, Profile::skin());
    for (size_t i = 0; i < p.pixels(); ++i)
        if (p.ids[i]) {
            ASSERT_NEAR(result.scattered[3 * i], 0.75f, 1e-5) << i;
        }
}

TEST(Scatter, NoLightIsLostOnAPlane) {
    const double size = 0.25, middle = 16;
    const Picture p = plane(128, 128, size, [&](double x, double y) {
        return std::hypot(x - middle, y - middle) < 3 ? Vec3{1, 1, 1} : Vec3{0, 0, 0};
    });
    const Result result = run(p, narrow());
    double before = 0, after = 0;
    for (size_t i = 0; i < p.irradiance.size(); ++i) before += p.irradiance[i], after += result.scattered[i];
    EXPECT_NEAR(after, before, tolerance::scatterEnergy * before);
    EXPECT_GT(result.scattered[3 * p.at(uint32_t(middle / size) + 13, uint32_t(middle / size))], 0.1f);
}

// Its light comes from blocks of every level, the coarsest too. The sum over a picture of an edge has a
// closed form for a Gaussian.
TEST(Scatter, AProfileAsWideAsThePicture) {
    const uint32_t width = sized(640u, 64u), height = sized(320u, 32u);
    const double edge = 0.4 * width, sigma = 0.15 * width;
    Picture p = plane(width, height, 1, [&](double x, double) { return x < edge ? Vec3{1, 1, 1} : Vec3{}; });
    p.params.everywhere = 1;
    const PelGaussian gaussian{float(sigma * sigma), {1, 1, 1}};
    const Result result = run(p, Profile::gaussians({gaussian}));
    const auto below = [&](double x) { return 0.5 * std::erfc(-x / (sigma * std::sqrt(2.0))); };
    const Difference d = difference(p, result.scattered, [&](size_t i, int) {
        const double x = p.positions[3 * i];
        return (below(edge - x) - below(-x)) / (below(width - x) - below(-x));
    });
    EXPECT_LT(d.rms, tolerance::scatterWideRms);
    EXPECT_LT(d.most, tolerance::scatterWideMost);
}

TEST(Scatter, NothingFlowsBetweenIds) {
    Picture p = plane(64, 64, 0.2, [](double, double) { return Vec3{}; });
    for (size_t i = 0; i < p.pixels(); ++i) {
        p.ids[i] = i % 64 < 29 ? 1 : i % 64 < 41 ? 2 : 0;
        std::fill_n(&p.irradiance[3 * i], 3, p.ids[i] == 2 ? 1.0f : p.ids[i] == 0 ? 5.0f : 0.0f);
    }
    p.params.everywhere = 1;
    const Result result = run(p, {{1, Profile::skin(), 1}, {2, narrow(), 1}});
    for (size_t i = 0; i < p.pixels(); ++i)
        EXPECT_NEAR(result.scattered[3 * i], p.irradiance[3 * i], 1e-5) << i % 64;
}

TEST(Scatter, NothingComesFromBeyondTheReach) {
    const double reach = reference::scatterReach(*reference::gaussiansProfile({{0.25, {1, 1, 1}}}));
    const Picture p = plane(96, 96, 0.1, [](double x, double y) {
        return std::hypot(x - 4.8, y - 4.8) < 0.4 ? Vec3{1, 1, 1} : Vec3{0.25, 0.25, 0.25};
    });
    const Result result = run(p, narrow());
    for (size_t i = 0; i < p.pixels(); ++i) {
        const double distance = std::hypot(p.positions[3 * i] - 4.8, p.positions[3 * i + 1] - 4.8);
        // A block of pixels may reach in further than its middle.
        if (distance > 2.2 * reach) {
            ASSERT_NEAR(result.scattered[3 * i], 0.25f, 2e-6) << distance;
        }
    }
}

TEST(Scatter, NoNumberSpreadsNoFurtherThanItself) {
    Picture p = ball(64, 10, 0.33, sideLight());
    const Result clean = run(p, Profile::skin());
    const size_t bad = p.at(40, 30), worse = p.at(20, 30);
    p.irradiance[3 * bad + 1] = notANumber;
    p.positions[3 * worse] = infinity;
    const Result result = run(p, Profile::skin());
    EXPECT_EQ(result.stats.pixelsInvalid, 2u);
    EXPECT_TRUE(std::isnan(result.scattered[3 * bad + 1]));
    for (size_t i = 0; i < p.pixels(); ++i)
        for (int c = 0; c < 3; ++c) {
            if (i == bad && c == 1) continue;
            const bool kept = i == bad || i == worse;
            ASSERT_NEAR(result.scattered[3 * i + c],
                        kept ? p.irradiance[3 * i + c] : clean.scattered[3 * i + c],
                        tolerance::scatterOneMissing)
                << i << " " << c;
        }
}

TEST(Scatter, SizesAndRadiiAtTheirEnds) {
    const auto light = [](double x, double) { return x < 3 ? Vec3{1, 0.5, 0.25} : Vec3{}; };
    for (const auto& [width, height] :
         {std::pair{1u, 1u}, {1u, 40u}, {40u, 1u}, {3u, 2u}, {17u, 33u}, {130u, 20u}})
        for (float scale : {1e-6f, 1e-3f, 1.0f, 1e3f, 1e6f}) {
            Picture p = plane(width, height, 0.2, light);
            p.params.everywhere = 1;
            const Result result = run(p, Profile::skin(), scale);
            for (size_t i = 0; i < result.scattered.size(); ++i) {
                ASSERT_TRUE(result.scattered[i] >= 0 && result.scattered[i] <= 1.00001f)
                    << width << " x " << height << ", " << scale;
                // Far narrower than a pixel: nothing changes.
                if (scale < 1e-4f) {
                    ASSERT_NEAR(result.scattered[i], p.irradiance[i], 1e-4);
                }
            }
        }
}

TEST(Scatter, EveryPixelOfItsOwnKeepsItsLight) {
    Picture p = plane(48, 16, 0.2, [](double x, double) { return Vec3{x, 1, 0}; });
    std::vector<Material> materials;
    for (uint32_t id = 1; id < 256; ++id) materials.push_back({id, Profile::skin(), 1});
    for (size_t i = 0; i < p.pixels(); ++i) p.ids[i] = uint8_t(1 + (i % 48 + 48 * (i / 48)) % 255);
    p.params.everywhere = 1;
    const Result result = run(p, materials);
    EXPECT_EQ(result.scattered, p.irradiance);
}

TEST(Scatter, WithoutMaterialsThePictureStays) {
    const Picture p = ball(40, 10, 0.6, sideLight());
    EXPECT_EQ(run(p, std::vector<Material>{}).scattered, p.irradiance);
    EXPECT_EQ(run(p, {{7, Profile::skin(), 1}}).stats.pixelsCovered, 0u);
    EXPECT_EQ(run(p, Profile::skin(), 0).scattered, p.irradiance);
}

TEST(Scatter, FlatLightTakesNoTaps) {
    Picture p = plane(160, 90, 0.3, [](double x, double y) {
        return Vec3{0.3 + 0.01 * x, 0.4 + 0.004 * y, 0.5};
    });
    const Result result = run(p, Profile::skin());
    EXPECT_EQ(result.stats.pixelsTapped, 0u);
    EXPECT_EQ(result.stats.taps, 0u);
    EXPECT_EQ(result.stats.pixelsCovered, p.pixels());
    EXPECT_EQ(result.scattered, p.irradiance);
}

TEST(Scatter, SameInputSameBitsAlsoInPlace) {
    const Picture p = ball(100, 10, 0.21, sideLight());
    const Result first = run(p, Profile::skin());
    EXPECT_EQ(run(p, Profile::skin()).scattered, first.scattered);
    EXPECT_EQ(run(p, {{1, Profile::skin(), 1}}, true).scattered, first.scattered);
}

TEST(Scatter, UnitsDoNotMatter) {
    Picture p = ball(80, 10, 0.26, sideLight());
    p.params.everywhere = 1;
    const Result mm = run(p, Profile::skin(), 1);
    for (float& x : p.positions) x *= 0.001f;
    const Result m = run(p, Profile::skin(), 0.001f);
    const Difference d = difference(p, m.scattered, [&](size_t i, int c) { return mm.scattered[3 * i + c]; });
    EXPECT_LT(d.rms, tolerance::scatterUnits);
    EXPECT_LT(d.most, 10 * tolerance::scatterUnits);
}

TEST(Scatter, DepthIsAsGoodAsPositions) {
    // A perspective view from (0, 0, 40) down -z: ndc = p / (-z / 3), depth between 20 and 60.
    const uint32_t side = 96;
    Picture p(side, side);
    std::vector<float> depth(side * side, 1.0f);
    const float near = 20, far = 60, a = far / (near - far), b = near * far / (near - far);
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const Vec3 d =
                normalized(Vec3{((x + 0.5) / side * 2 - 1) / 3, (1 - (y + 0.5) / side * 2) / 3, -1});
            const double along = dot(d, Vec3{0, 0, 40}), rest = along * along - 1600 + 100;
            if (rest <= 0) continue;
            const Vec3 world = Vec3{0, 0, 40} + (-along - std::sqrt(rest)) * d;
            const double e = reference::max0(dot(world / 10, sideLight()));
            p.set(p.at(x, y), world, {e, e, e});
            const double z = world.z - 40;
            depth[p.at(x, y)] = float((a * z + b) / -z);
        }
    // Of clip = (3 x, 3 y, a z + b, -z) with z from the camera, inverted; then 40 is added to z.
    float* m = p.params.inverseViewProjection;
    m[0] = m[5] = 1 / 3.0f;
    m[11] = -1, m[14] = 1 / b, m[15] = a / b;
    for (int k = 0; k < 4; ++k) m[8 + k] += 40 * m[12 + k];
    const Result byPosition = run(p, Profile::skin());
    Scatter scatter(device());
    scatter.setMaterial(1, Profile::skin());
    const Buffer e(device(), p.irradiance), z(device(), depth), i(device(), p.ids);
    const PelImageDesc image = pellucid::imageDesc(e, PEL_FORMAT_RGB32F, side, side);
    const PelImageDesc depths = pellucid::imageDesc(z, PEL_FORMAT_R32F, side, side);
    const PelImageDesc ids = pellucid::imageDesc(i, PEL_FORMAT_R8_UINT, side, side);
    scatter.execute(p.params, image, nullptr, &depths, &ids, image);
    const Difference d =
        difference(p, e.readAll<float>(), [&](size_t k, int c) { return byPosition.scattered[3 * k + c]; });
    EXPECT_GT(byPosition.stats.pixelsTapped, 0u);
    EXPECT_LT(d.most, tolerance::scatterUnits);
    // By taps as well.
    for (const PelScattering method : {PEL_SCATTERING_SCREEN, PEL_SCATTERING_SEPARABLE}) {
        PelScatterControls controls = pelScatterControlsDefaults();
        controls.scattering = method;
        controls.scatterTaps = 16;
        scatter.setControls(1, controls);
        const Buffer lit(device(), p.irradiance), x(device(), p.positions), a(device(), p.irradiance),
            b(device(), p.irradiance);
        const auto rgb = [&](const Buffer& of) {
            return pellucid::imageDesc(of, PEL_FORMAT_RGB32F, side, side);
        };
        const PelImageDesc positions = rgb(x);
        scatter.execute(p.params, rgb(lit), &positions, nullptr, &ids, rgb(a));
        scatter.execute(p.params, rgb(lit), nullptr, &depths, &ids, rgb(b));
        const std::vector<float> known = a.readAll<float>();
        EXPECT_LT(difference(p, b.readAll<float>(), [&](size_t k, int c) { return known[3 * k + c]; }).most,
                  tolerance::scatterUnits)
            << int(method);
        EXPECT_GT(difference(p, p.irradiance, [&](size_t k, int c) { return known[3 * k + c]; }).most, 0.02);
    }
}

TEST(Scatter, SaysWhatIsWrong) {
    Scatter scatter(device());
    const Picture p = plane(8, 8, 1, [](double, double) { return Vec3{}; });
    const Buffer e(device(), p.irradiance), small(device(), std::vector<float>(3 * 16));
    const PelImageDesc image = pellucid::imageDesc(e, PEL_FORMAT_RGB32F, 8, 8);
    const PelImageDesc other = pellucid::imageDesc(small, PEL_FORMAT_RGB32F, 4, 4);
    const auto message = [&](const std::function<PelError()>& call) {
        EXPECT_EQ(call(), PEL_ERROR_INVALID_ARGUMENT);
        return std::string(pelGetErrorMessage());
    };
    const auto execute = [&](const PelImageDesc* positions, const PelImageDesc* depth,
                             const PelImageDesc* out) {
        return pelScatterExecute(scatter.get(), nullptr, &image, positions, depth, nullptr, out, nullptr);
    };
    EXPECT_NE(
        message([&] { return execute(nullptr, nullptr, &image); }).find("either `positions` or `depth`"),
        std::string::npos);
    EXPECT_NE(message([&] { return execute(&other, nullptr, &image); }).find("4 x 4"), std::string::npos);
    EXPECT_NE(message([&] { return execute(&image, nullptr, &image); }).find("overlaps"), std::string::npos);
    const Buffer places(device(), p.positions);
    const PelImageDesc at = pellucid::imageDesc(places, PEL_FORMAT_RGB32F, 8, 8);
    EXPECT_EQ(execute(&at, nullptr, &image), PEL_SUCCESS) << pelGetErrorMessage();
    // Over the positions' own memory by another name.
    std::vector<float> host(3 * 64);
    const Buffer first = Buffer::fromHost(device(), host.data(), host.size() * 4),
                 second = Buffer::fromHost(device(), host.data(), host.size() * 4);
    const PelImageDesc from = pellucid::imageDesc(first, PEL_FORMAT_RGB32F, 8, 8),
                       to = pellucid::imageDesc(second, PEL_FORMAT_RGB32F, 8, 8);
    EXPECT_NE(message([&] { return execute(&from, nullptr, &to); }).find("overlaps"), std::string::npos);
    PelScatterParams params = pelScatterParamsDefaults();
    params.targetError = notANumber;
    EXPECT_NE(message([&] {
                  return pelScatterExecute(scatter.get(), &params, &image, &other, nullptr, nullptr, &image,
                                           nullptr);
              }).find("targetError"),
              std::string::npos);
    const Profile skin = Profile::skin();
    for (float scale : {-1.0f, infinity, notANumber, 1e20f})
        EXPECT_NE(message([&] {
                      return pelScatterSetMaterial(scatter.get(), 1, skin.get(), scale);
                  }).find("profile"),
                  std::string::npos);
    EXPECT_NE(
        message([&] { return pelScatterSetMaterial(scatter.get(), 256, skin.get(), 1); }).find("1 to 255"),
        std::string::npos);
}
