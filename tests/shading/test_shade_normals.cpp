// Blurred normals that the shader makes itself on screen.
#include <gtest/gtest.h>

#include <limits>

#include "pass_scene.h"
#include "tolerances.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::imageDesc;
using pellucid::Shader;

namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

struct Worst {
    double error = 0;
    size_t compared = 0, doubtful = 0;
};
Worst againstOracle(const Frame& f, const std::vector<float>& radiance) {
    std::vector<bool> doubtful;
    const auto truth = reference::blurredNormals(surfaceOf(f), &doubtful);
    Worst worst;
    for (size_t i = 0; i < f.pixels(); ++i) {
        if (!truth[i]) continue;
        if (doubtful[i]) {
            ++worst.doubtful;
            continue;
        }
        ++worst.compared;
        worst.error = std::max(worst.error, distance(shownNormal(radiance, i), *truth[i]));
    }
    return worst;
}

TEST(BlurNormals, MatchesTheOracle) {
    for (const auto& [seed, pixel] : {std::pair{1u, 0.31f}, {2u, 0.9f}, {3u, 0.07f}, {4u, 4.0f}}) {
        Frame f = reliefFrame(seed, 150, 70, pixel);
        showBlurredNormal(f);
        f.options.blurNormals = 1;
        PelShaderStats stats = pelShaderStatsDefaults();
        const auto shown = shade(device(), f, tables(), &stats);
        EXPECT_EQ(stats.features, uint32_t(PEL_FEATURE_AMBIENT | PEL_FEATURE_BLUR_NORMALS));
        EXPECT_EQ(stats.launches, 5u) << "classify, prepare, along x, along y, shade";
        const Worst worst = againstOracle(f, shown);
        EXPECT_LE(worst.error, tolerance::shadeTerm) << "pixels " << pixel << " apart";
        EXPECT_GT(worst.compared, 9 * worst.doubtful);
    }
}

TEST(BlurNormals, OffCostsNothingAndAnImageGoesFirst) {
    Frame f = reliefFrame(1, 64, 32, 0.5f);
    showBlurredNormal(f);
    PelShaderStats off = pelShaderStatsDefaults(), on = off, given = off;
    const auto plain = shade(device(), f, tables(), &off);
    EXPECT_EQ(off.launches, 2u);
    f.options.blurNormals = 1;
    EXPECT_NE(plain, shade(device(), f, tables(), &on));
    EXPECT_GE(on.scratchBytes, off.scratchBytes + 40 * f.pixels());
    f.slots[PEL_SLOT_NORMAL_BLURRED] = f.slots[PEL_SLOT_NORMAL_GEOMETRIC];
    EXPECT_EQ(plain, shade(device(), f, tables(), &given));
    EXPECT_EQ(given.launches, off.launches);
    EXPECT_EQ(given.scratchBytes, off.scratchBytes);
}

// A plane whose normals wave along x: the blur's response is the Fourier transform of its kernel.
TEST(BlurNormals, DampsWavesAsItsKernelDoes) {
    for (const double wavelength : {4.0, 6.0, 12.0}) {
        Frame f = reliefFrame(1, 200, 8, 0.1f);
        for (size_t i = 0; i < f.pixels(); ++i) {
            f.slots[PEL_SLOT_MATERIAL].values[i] = 1;
            f.slots[PEL_SLOT_POSITION].values[3 * i + 2] = 0;
            const double tilt =
                0.05 * std::sin(2 * 3.14159265358979 / wavelength * 0.1 * double(i % f.width));
            const float n[3] = {float(tilt), 0, float(std::sqrt(1 - tilt * tilt))};
            std::copy_n(n, 3, &f.slots[PEL_SLOT_NORMAL_SHADING].values[3 * i]);
        }
        showBlurredNormal(f);
        f.options.blurNormals = 1;
        const auto shown = shade(device(), f, tables());
        double seen = 0, response = 0, total = 0;
        for (uint32_t x = 50; x < 150; ++x) seen = std::max(seen, shownNormal(shown, 4 * f.width + x).x);
        for (double t = -0.9995; t < 1; t += 0.001) {
            response += (1 - t * t) * (1 - t * t) * std::cos(2 * 3.14159265358979 / wavelength * 2.7 * t);
            total += (1 - t * t) * (1 - t * t);
        }
        EXPECT_NEAR(seen / 0.05, response / total, tolerance::blurResponse) << wavelength;
    }
}

TEST(BlurNormals, NothingCrossesADepthEdgeOrAMaterial) {
    Frame f = reliefFrame(1, 128, 16, 0.3f);
    const float left[3] = {-0.6f, 0, 0.8f}, right[3] = {0.6f, 0, 0.8f};
    for (const float gap : {2.2f, 30.0f})  // the smaller lies within the diffusion radius
        for (const bool material : {false, true}) {
            for (size_t i = 0; i < f.pixels(); ++i) {
                const bool far = i % f.width >= 64;
                f.slots[PEL_SLOT_MATERIAL].values[i] = material && far ? 2 : 1;
                f.slots[PEL_SLOT_POSITION].values[3 * i + 2] = far && !material ? gap : 0;
                std::copy_n(far ? right : left, 3, &f.slots[PEL_SLOT_NORMAL_SHADING].values[3 * i]);
            }
            showBlurredNormal(f);
            f.options.blurNormals = 1;
            const auto shown = shade(device(), f, tables());
            for (size_t i = 0; i < f.pixels(); ++i)
                EXPECT_LE(distance(shownNormal(shown, i), f.slots[PEL_SLOT_NORMAL_SHADING].vec(i)),
                          tolerance::shadeTerm)
                    << "gap " << gap << ", pixel " << i;
        }
}

TEST(BlurNormals, BadPixelsStayAlone) {
    Frame f = reliefFrame(5, 120, 60, 0.3f);
    showBlurredNormal(f);
    f.options.blurNormals = 1;
    f.options.countPixels = 1;
    f.options.invalidColor[0] = -7;
    const auto before = shade(device(), f, tables());
    Frame bad = f;
    const size_t normal = sized(20, 2) * 120 + 30, position = sized(40, 9) * 120 + 90;
    bad.slots[PEL_SLOT_NORMAL_SHADING].values[3 * normal] = nan;
    bad.slots[PEL_SLOT_POSITION].values[3 * position + 1] = std::numeric_limits<float>::infinity();
    PelShaderStats stats = pelShaderStatsDefaults();
    const auto after = shade(device(), bad, tables(), &stats);
    EXPECT_EQ(stats.pixelsInvalid, 2u);
    for (size_t i = 0; i < f.pixels(); ++i) {
        const bool itself = i == normal || i == position;
        EXPECT_EQ(after[3 * i] == -7, itself) << i;
        for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isfinite(after[3 * i + c])) << i;
        // Beyond six taps in both directions nothing changes at all.
        const auto far = [&](size_t centre) {
            return std::abs(int(i % 120) - int(centre % 120)) > 12 ||
                   std::abs(int(i / 120) - int(centre / 120)) > 12;
        };
        for (int c = 0; c < 3 && far(normal) && far(position); ++c)
            EXPECT_EQ(after[3 * i + c], before[3 * i + c]) << i;
    }
    EXPECT_LE(againstOracle(bad, after).error, tolerance::shadeTerm);
}

TEST(BlurNormals, OddFrames) {
    for (const auto& [width, height] : {std::pair{1u, 1u}, {1u, 9u}, {17u, 1u}, {129u, 3u}}) {
        Frame f = reliefFrame(2, width, height, 0.5f);
        f.slots[PEL_SLOT_MATERIAL] = {};
        showBlurredNormal(f);
        f.options.blurNormals = 1;
        EXPECT_LE(againstOracle(f, shade(device(), f, tables())).error, tolerance::shadeTerm)
            << width << " x " << height;
    }
    Frame f = reliefFrame(2, 16, 16, 0.0f);  // all pixels in one place
    showBlurredNormal(f);
    f.options.blurNormals = 1;
    for (float value : shade(device(), f, tables())) EXPECT_TRUE(std::isfinite(value));
    f.slots[PEL_SLOT_POSITION] = {};
    EXPECT_THROW(shade(device(), f, tables()), pellucid::Error) << "positions are needed";
}

}  // namespace
