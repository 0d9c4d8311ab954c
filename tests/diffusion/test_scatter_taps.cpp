// Methods that gather by taps: on a disk, and separably.
#include <gtest/gtest.h>

#include <cstdio>

#include "diffusion/scatter_scene.h"
#include "reference/diffusion_taps.h"
#include "tolerances.h"

using namespace scatter_scene;

namespace {

constexpr PelScattering separable = PEL_SCATTERING_SEPARABLE, disk = PEL_SCATTERING_SCREEN;

PelScatterControls controls(PelScattering method, uint32_t taps, float border = 0) {
    PelScatterControls c = pelScatterControlsDefaults();
    c.scattering = method;
    c.scatterTaps = taps;
    std::fill_n(c.borderColor, 3, border);
    return c;
}

struct Taken {
    std::vector<float> scattered;
    PelScatterStats stats;
};

// By every id's material alike. `weights`: one or two components a pixel.
Taken scatterBy(const Picture& p, const Profile& profile, float scale, const PelScatterControls& c,
                const std::vector<float>& weights = {}) {
    Scatter scatter(device());
    for (uint32_t id : {1u, 2u, 3u}) {
        scatter.setMaterial(id, profile, scale);
        scatter.setControls(id, c);
    }
    const Buffer e(device(), p.irradiance), x(device(), p.positions), i(device(), p.ids),
        w(device(), weights.empty() ? std::vector<float>(1) : weights),
        out(device(), std::vector<float>(p.irradiance.size(), -7.0f));
    const auto rgb = [&](const Buffer& b) {
        return pellucid::imageDesc(b, PEL_FORMAT_RGB32F, p.width, p.height);
    };
    const PelImageDesc positions = rgb(x),
                       ids = pellucid::imageDesc(i, PEL_FORMAT_R8_UINT, p.width, p.height);
    if (!weights.empty())
        scatter.set(PEL_SLOT_SCATTER_WEIGHT,
                    pellucid::imageDesc(w, weights.size() == p.pixels() ? PEL_FORMAT_R32F : PEL_FORMAT_RG32F,
                                        p.width, p.height));
    scatter.execute(p.params, rgb(e), &positions, nullptr, &ids, rgb(out));
    return {out.readAll<float>(), scatter.stats()};
}

// A view along -z.
void lookDown(Picture& p) {
    std::fill_n(p.params.inverseViewProjection, 16, 0.0f);
    for (int k : {0, 5, 10, 15}) p.params.inverseViewProjection[k] = 1;
}

// A ball of two materials, half of it lit.
Picture scene() {
    Picture p = ball(96, 10, 0.22, normalized(Vec3{1, 0.4, 0.3}));
    for (uint32_t y = 0; y < 40; ++y)
        for (uint32_t x = 0; x < 96; ++x)
            if (p.ids[p.at(x, y)]) p.ids[p.at(x, y)] = 2;
    lookDown(p);
    return p;
}

struct Difference {
    double rms = 0, most = 0;
};
Difference difference(const std::vector<float>& a, const std::vector<reference::Rgb>& b) {
    Difference d;
    for (size_t i = 0; i < b.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const double e = std::abs(a[3 * i + c] - b[i][c]);
            d.rms += e * e / (3.0 * double(b.size()));
            d.most = std::max(d.most, e);
        }
    d.rms = std::sqrt(d.rms);
    return d;
}

double rms(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum / double(a.size()));
}

}  // namespace

const std::pair<PelScattering, uint32_t> methods[] = {{separable, 25}, {separable, 0}, {disk, 8}, {disk, 64}};

TEST(ScatterTaps, IsTheOracle) {
    for (const auto& [method, taps] : {std::pair{separable, 25u}, {separable, 9u}, {disk, 16u}, {disk, 64u}})
        for (float border : {0.0f, 0.5f}) {
            reference::TapScene s{scene().exact(), int(taps), 3, {}, {}, {border, border, border}};
            Picture p = scene();
            p.params.frameIndex = 3;
            p.params.everywhere = 1;
            std::vector<float> weights;
            for (size_t i = 0; i < p.pixels(); ++i) {
                s.weights.push_back(0.25 + 0.75 * double(i % 7) / 6);
                s.radii.push_back(i % 96 < 40 ? 1 : 0.5);
                weights.push_back(float(s.weights[i]));
                weights.push_back(float(s.radii[i]));
            }
            const Taken taken = scatterBy(p, Profile::skin(), 1, controls(method, taps, border), weights);
            const auto exact = method == disk ? reference::scatterOnDisk(s, *reference::skinProfile())
                                              : reference::scatterSeparably(s, *reference::skinProfile());
            const Difference d = difference(taken.scattered, exact);
            std::printf("method %d, %u taps, border %g: rms %.1e, most %.1e\n", int(method), taps,
                        double(border), d.rms, d.most);
            EXPECT_LT(d.rms, tolerance::scatterTapsRms);
            EXPECT_LT(d.most, tolerance::scatterTapsMost);
        }
}

// What holds for all of them: uniform light stays as it is, for every profile, size, border and weight.
TEST(ScatterTaps, UniformLightStaysAsItIs) {
    for (const auto& [method, taps] : methods) {
        Picture p = scene();
        for (float& e : p.irradiance) e = 0.7f;
        for (float scale : {1e-3f, 0.3f, 3.0f}) {
            const Taken taken = scatterBy(p, Profile::skin(), scale, controls(method, taps, 0.4f));
            for (size_t i = 0; i < taken.scattered.size(); ++i)
                ASSERT_NEAR(taken.scattered[i], 0.7f, 2e-6) << i;
        }
    }
}

TEST(ScatterTaps, NothingFlowsOverBordersUnlessAsked) {
    for (const auto& [method, taps] : methods) {
        Picture p = scene();
        for (size_t i = 0; i < p.pixels(); ++i)
            for (int c = 0; c < 3; ++c) p.irradiance[3 * i + c] = p.ids[i] == 2 ? 1.0f : 0.0f;
        const auto apart = scatterBy(p, Profile::skin(), 1, controls(method, taps)).scattered;
        for (size_t i = 0; i < apart.size(); ++i) ASSERT_EQ(apart[i], p.irradiance[i]) << i;
        // A border of 1: as if all pixels had one id.
        const auto open = scatterBy(p, Profile::skin(), 1, controls(method, taps, 1)).scattered;
        Picture one = p;
        for (uint8_t& id : one.ids) id = id ? 1 : 0;
        const auto joined = scatterBy(one, Profile::skin(), 1, controls(method, taps)).scattered;
        EXPECT_LT(rms(open, joined), 2e-3);  // sizes of pixels next to the border are measured on one side
        EXPECT_GT(rms(open, apart), 0.02);
        // Teeth, eyes, clothes: an id that does not scatter gives nothing either way.
        for (size_t i = 0; i < p.pixels(); ++i)
            if (p.ids[i] == 2) p.ids[i] = 9;
        const auto beside = scatterBy(p, Profile::skin(), 1, controls(method, taps, 1)).scattered;
        for (size_t i = 0; i < beside.size(); ++i) ASSERT_EQ(beside[i], p.irradiance[i]) << i;
    }
}

TEST(ScatterTaps, WeightAndRadiusPerPixel) {
    for (const auto& [method, taps] : methods) {
        const Picture p = scene();
        const auto whole = scatterBy(p, Profile::skin(), 1, controls(method, taps)).scattered;
        std::vector<float> weights(p.pixels());
        for (size_t i = 0; i < weights.size(); ++i) weights[i] = i % 3 == 0 ? 0.0f : i % 3 == 1 ? 0.5f : NAN;
        const Taken some = scatterBy(p, Profile::skin(), 1, controls(method, taps), weights);
        for (size_t i = 0; i < p.pixels(); ++i)
            for (int c = 0; c < 3; ++c) {
                const float e = p.irradiance[3 * i + c],
                            expected = i % 3 == 1 ? 0.5f * (e + whole[3 * i + c]) : e;
                ASSERT_NEAR(some.scattered[3 * i + c], expected, 1e-6) << i;
            }
        EXPECT_LT(some.stats.pixelsTapped, p.pixels() / 3);  // the others cost nothing
        // Half of the radius is a profile of half the size.
        std::vector<float> halves;
        for (size_t i = 0; i < p.pixels(); ++i) halves.insert(halves.end(), {1.0f, 0.5f});
        const auto narrow = scatterBy(p, Profile::skin(), 1, controls(method, taps), halves).scattered;
        EXPECT_LT(rms(narrow, scatterBy(p, Profile::skin(), 0.5f, controls(method, taps)).scattered), 1e-4);
    }
}

TEST(ScatterTaps, WhatIsNotThereCostsNothing) {
    for (const auto& [method, taps] : methods) {
        // A radius below a pixel: no taps, and no bit changes.
        const Picture p = scene();
        const Taken small = scatterBy(p, Profile::skin(), 1e-3f, controls(method, taps));
        EXPECT_EQ(small.stats.taps, 0u);
        EXPECT_EQ(small.stats.tilesTapped, 0u);
        EXPECT_EQ(small.scattered, p.irradiance);
        // A tenth of the picture covered: the taps of a tenth of the pixels.
        Picture strip = plane(160, 160, 0.2, [](double x, double) { return Vec3{x, 1, 1}; });
        const uint64_t all = scatterBy(strip, Profile::skin(), 1, controls(method, taps)).stats.taps;
        for (uint32_t y = 16; y < 160; ++y)
            for (uint32_t x = 0; x < 160; ++x) strip.ids[strip.at(x, y)] = 0;
        const Taken tenth = scatterBy(strip, Profile::skin(), 1, controls(method, taps));
        EXPECT_LT(double(tenth.stats.taps), 0.11 * double(all));
        EXPECT_EQ(tenth.stats.tilesByScattering[method], 10u);
        EXPECT_EQ(tenth.stats.tilesTapped, 10u);
    }
}

TEST(ScatterTaps, ManyTapsAreTheWholeProfile) {
    Picture p = ball(96, 10, 0.22, normalized(Vec3{1, 0.4, 0.3}));
    lookDown(p);
    const auto whole = reference::scatterOnScreen(p.exact(), *reference::skinProfile());
    const auto error = [&](uint32_t taps) {
        return difference(scatterBy(p, Profile::skin(), 1, controls(disk, taps)).scattered, whole).rms;
    };
    const double few = error(8), some = error(32), many = error(256);
    RecordProperty("rms", std::to_string(few) + " " + std::to_string(some) + " " + std::to_string(many));
    EXPECT_LT(some, 0.7 * few);
    EXPECT_LT(many, 0.5 * some);
    EXPECT_LT(many, tolerance::scatterManyTaps);
}

// Hosts that average frames get what more taps give.
TEST(ScatterTaps, FramesTurnTheTapsAndAverageOut) {
    Picture p = ball(96, 10, 0.22, normalized(Vec3{1, 0.4, 0.3}));
    lookDown(p);
    const auto whole = reference::scatterOnScreen(p.exact(), *reference::skinProfile());
    std::vector<float> mean(p.irradiance.size());
    double one = 0;
    for (uint32_t frame = 0; frame < 16; ++frame) {
        p.params.frameIndex = frame;
        const auto first = scatterBy(p, Profile::skin(), 1, controls(disk, 16)).scattered;
        // same input, same bits
        ASSERT_EQ(first, scatterBy(p, Profile::skin(), 1, controls(disk, 16)).scattered);
        for (size_t i = 0; i < mean.size(); ++i) mean[i] += first[i] / 16;
        one = difference(first, whole).rms;
    }
    EXPECT_LT(difference(mean, whole).rms, 0.5 * one);
}

TEST(ScatterTaps, InvalidPixelsStayWhereTheyAre) {
    for (const auto& [method, taps] : methods) {
        Picture p = scene();
        const size_t bad = p.at(48, 60), worse = p.at(60, 60);
        p.irradiance[3 * bad] = NAN;
        p.positions[3 * worse + 1] = INFINITY;
        const Taken taken = scatterBy(p, Profile::skin(), 1, controls(method, taps));
        EXPECT_EQ(taken.stats.pixelsInvalid, 2u);
        for (size_t i = 0; i < taken.scattered.size(); ++i)
            ASSERT_EQ(std::isfinite(taken.scattered[i]), i != 3 * bad) << i;
    }
    for (uint32_t side : {1u, 2u, 17u}) {  // and pictures of few pixels
        const Picture p = plane(side, side, 0.2, [](double x, double) { return Vec3{x, 1, 1}; });
        for (const auto& [method, taps] : methods)
            for (float v : scatterBy(p, Profile::skin(), 1e6f, controls(method, taps)).scattered)
                ASSERT_TRUE(std::isfinite(v));
    }
}
