// Cascades of directional lights: which map a point takes, thickness and wide shadow from it.
#include <gtest/gtest.h>

#include <limits>

#include "shader_ready.h"
#include "shadow_form_truth.h"
#include "tolerances.h"

using namespace shade_test;

namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

// Leaves out pixels near the line where another cascade is taken; `taken`: those that the others take, -1
// where none.
Worst worstCascade(const Frame& f, const CascadeLight& from, const Seen& seen,
                   std::vector<int>* taken = nullptr) {
    const auto matrices = matricesOf(from);
    const double perUv = 1 / reference::uvPerLength(matrices[0], 0);
    const auto sure = [&](Vec3 at, double radius) {
        const int chosen = reference::cascadeOf(matrices, at, radius);
        return chosen == reference::cascadeOf(matrices, at, radius - 1e-4) &&
               chosen == reference::cascadeOf(matrices, at, radius + 1e-4);
    };
    return worstOf(f, seen, truthOf(from), [&](const PelMaterial& m, Vec3 p, Vec3 n) {
        const double half = m.shadowFilterWidth / 2;
        if (!sure(p, half) || !sure(insetOf(m, p, n), m.thicknessFilterRadius * perUv)) return false;
        if (taken) taken->push_back(reference::cascadeOf(matrices, p, half));
        return true;
    });
}

TEST(ShadowCascades, MatchTheOracle) {
    Frame f = formFrame();
    for (const bool reversed : {false, true})
        for (const bool atlas : {false, true}) {
            const CascadeLight from = cascadeLight({14, 24, 36, 52}, reversed, 97, atlas);
            f.options.rotateTaps = reversed && atlas;
            const Seen seen = shadeForms(f, {from.light}, atlas);
            EXPECT_TRUE(seen.stats.features & PEL_FEATURE_SHADOW_CASCADES);
            std::vector<int> taken;
            const Worst worst = worstCascade(f, from, seen, &taken);
            EXPECT_LE(worst.wide, tolerance::wideShadow) << "reversed " << reversed << ", atlas " << atlas;
            EXPECT_LE(worst.thickness, tolerance::mapThickness)
                << "reversed " << reversed << ", atlas " << atlas;
            for (int k = -1; k < 4; ++k)
                EXPECT_GT(std::count(taken.begin(), taken.end(), k), 100) << "pixels that take cascade " << k;
            EXPECT_GT(worst.penumbra, f.pixels() / 50);
            EXPECT_GT(worst.thick, f.pixels() / 20);
        }
}

TEST(ShadowCascades, OneIsTheParallelMapToTheBit) {
    const Frame f = formFrame();
    for (const bool reversed : {false, true}) {
        const CascadeLight one = cascadeLight({70}, reversed);
        Light plain = one.light;
        plain.params.shadowCascades = 0;
        const Seen as = shadeForms(f, {one.light}), is = shadeForms(f, {plain});
        EXPECT_EQ(as.wide, is.wide);
        EXPECT_EQ(as.thickness, is.thickness);
        EXPECT_GT(*std::max_element(is.thickness.begin(), is.thickness.end()), 1);
    }
}

TEST(ShadowCascades, SkippingAndRunsChangeNoBit) {
    Frame f = formFrame(2);
    f.options.countPixels = 1;
    const CascadeLight from = cascadeLight({14, 24});
    const Seen with = shadeForms(f, {from.light}), again = shadeForms(f, {from.light});
    f.options.disableSkipping = 1;
    const Seen without = shadeForms(f, {from.light});
    EXPECT_EQ(with.wide, again.wide);
    EXPECT_EQ(with.wide, without.wide);
    EXPECT_EQ(with.thickness, without.thickness);
    size_t skin = 0;
    for (size_t i = 0; i < f.pixels(); ++i) skin += materialAt(f, i) != nullptr;
    EXPECT_GT(with.stats.pixelsWideShadow, 0u);
    EXPECT_LT(with.stats.pixelsWideShadow, skin) << "outside of all cascades nothing is filtered";
}

TEST(ShadowCascades, BadTexelsAndPixels) {
    CascadeLight from = cascadeLight({24, 70});
    for (size_t k = 0; k < 2; ++k)
        for (size_t i = 0; i < from.maps[k].map.depth.size(); i += 5)
            from.light.maps[k].values[i] = nan, from.maps[k].map.depth[i] = NAN;
    Frame f = formFrame();
    EXPECT_LE(worstCascade(f, from, shadeForms(f, {from.light})).wide, tolerance::wideShadow);
    const Seen before = shadeForms(f, {from.light});
    f.slots[PEL_SLOT_POSITION].values[3 * 1700] = nan;
    for (int c = 0; c < 3; ++c) f.slots[PEL_SLOT_POSITION].values[3 * 1703 + c] = 1e30f;
    const Seen after = shadeForms(f, {from.light});
    for (size_t i = 0; i < f.pixels(); ++i) {
        EXPECT_TRUE(std::isfinite(after.thickness[i])) << i;
        if (i != 1700 && i != 1703) {
            EXPECT_EQ(after.wide[i], before.wide[i]) << i;
            EXPECT_EQ(after.thickness[i], before.thickness[i]) << i;
        }
    }
    EXPECT_EQ(after.wide[1703], 1) << "outside of all: no shadow";
    EXPECT_EQ(after.thickness[1703], 0) << "and no thickness";
}

TEST(ShadowCascades, WhatIsRefused) {
    const auto refused = [&](PelError code, const char* word, auto change) {
        CascadeLight from = cascadeLight({24, 70});
        change(from.light);
        expectError(code, {word}, [&] { shadeForms(formFrame(1, 9, 3), {from.light}); });
    };
    const auto invalid = PEL_ERROR_INVALID_ARGUMENT;
    refused(invalid, "cascade 2 is not set", [](Light& l) { l.params.shadowCascades = 3; });
    refused(invalid, "directional", [](Light& l) { l.params.type = PEL_LIGHT_SPOT; });
    refused(invalid, "directional", [](Light& l) { l.params.shadowProjection = PEL_SHADOW_PERSPECTIVE; });
    refused(invalid, "cascadeToShadow[0] is singular",
            [](Light& l) { std::fill_n(l.params.cascadeToShadow[0], 4, 0.0f); });
    refused(invalid, "worldToShadow is singular",
            [](Light& l) { std::fill_n(l.params.worldToShadow, 16, 0.0f); });
    refused(invalid, "cascadeToShadow[0]", [](Light& l) { l.params.cascadeToShadow[0][3] = nan; });
    refused(invalid, "cascadeDepthRange[0] is 0", [](Light& l) { l.params.cascadeDepthRange[0] = 0; });
    refused(invalid, "one sign", [](Light& l) { l.params.cascadeDepthRange[0] *= -1; });
    refused(PEL_ERROR_UNSUPPORTED, "cascade has format", [](Light& l) {
        l.maps[1].components = 2;
        l.maps[1].values.resize(2 * l.maps[1].values.size());
    });
}

// Before cascades a map that began inside its buffer was read from the buffer's start.
TEST(ShadowCascades, MapsMayBeginInsideTheirBuffer) {
    const Frame f = formFrame();
    CascadeLight two = cascadeLight({70, 70}, false, 97, true);
    const Seen alone = shadeForms(f, {two.light});
    EXPECT_EQ(alone.thickness, shadeForms(f, {two.light}, true).thickness);
    Light second = two.light;  // the second of the atlas as a plain map
    second.params.shadowCascades = 0;
    std::copy_n(two.light.params.cascadeToShadow[0], 16, second.params.worldToShadow);
    std::swap(second.maps[0].slot, second.maps[1].slot);
    Light plain = second;
    plain.maps = {second.maps[1]};
    EXPECT_EQ(shadeForms(f, {plain}).thickness, shadeForms(f, {second}, true).thickness);
}

}  // namespace
