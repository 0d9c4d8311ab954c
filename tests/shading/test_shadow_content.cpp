// Shadow maps of moments (VSM) and exponentials (ESM): against the oracle, and against plain depth.
#include <gtest/gtest.h>

#include <limits>

#include "shader_ready.h"
#include "shadow_form_truth.h"
#include "tolerances.h"

using namespace shade_test;

namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

TEST(ShadowContent, MatchesTheOracle) {
    const Frame f = formFrame();
    for (const auto content : {PEL_SHADOW_CONTENT_MOMENTS, PEL_SHADOW_CONTENT_EXPONENTIAL})
        for (const bool perspective : {false, true})
            for (const bool reversed : {false, true}) {
                const ContentLight from = contentLight(content, perspective, reversed, 131);
                const Seen seen = shadeForms(f, {from.light});
                EXPECT_TRUE(seen.stats.features &
                            (content == PEL_SHADOW_CONTENT_MOMENTS ? PEL_FEATURE_SHADOW_MOMENTS
                                                                   : PEL_FEATURE_SHADOW_EXPONENTIAL));
                const Worst worst = worstOf(f, seen, truthOf(from));
                const auto what = testing::Message() << "content " << content << ", perspective "
                                                     << perspective << ", reversed " << reversed;
                EXPECT_LE(worst.wide, tolerance::contentShadow) << what;
                EXPECT_LE(worst.thickness, tolerance::contentThickness) << what;
                EXPECT_GT(worst.penumbra, f.pixels() / 50) << what;
                EXPECT_GT(worst.thick, f.pixels() / 20) << what;
            }
}

TEST(ShadowContent, OfAFlatOccluderEqualsDepth) {
    const Frame f = formFrame();
    for (const bool perspective : {false, true})
        for (const bool reversed : {false, true}) {
            const auto seen = [&](PelShadowContent content) {
                return shadeForms(f, {contentLight(content, perspective, reversed, 131, true).light});
            };
            const Seen depth = seen(PEL_SHADOW_CONTENT_DEPTH);
            for (const auto content : {PEL_SHADOW_CONTENT_MOMENTS, PEL_SHADOW_CONTENT_EXPONENTIAL}) {
                const Seen as = seen(content);
                size_t dark = 0;
                for (size_t i = 0; i < f.pixels(); ++i) {
                    if (!materialAt(f, i)) continue;
                    EXPECT_NEAR(as.thickness[i], depth.thickness[i], tolerance::contentThickness) << i;
                    if (depth.wide[i] == 1.0f) {
                        EXPECT_GE(as.wide[i], 1 - tolerance::contentShadow);
                    } else if (depth.thickness[i] > 15) {
                        ++dark;
                        EXPECT_LE(as.wide[i], tolerance::contentBehind)
                            << "at least 15 mm behind an occluder";
                    }
                }
                EXPECT_GT(dark, 200u);
            }
        }
}

// Filters that bounds of blocks decide give what their texels would, to the bit.
TEST(ShadowContent, BoundsChangeNothing) {
    Frame f = formFrame();
    for (const auto content :
         {PEL_SHADOW_CONTENT_DEPTH, PEL_SHADOW_CONTENT_MOMENTS, PEL_SHADOW_CONTENT_EXPONENTIAL})
        for (const bool perspective : {false, true})
            for (const bool reversed : {false, true}) {
                const ContentLight from = contentLight(content, perspective, reversed, 131);
                f.options.disableSkipping = 0;
                const Seen bounded = shadeForms(f, {from.light});
                f.options.disableSkipping = 1;
                EXPECT_EQ(bounded.wide, shadeForms(f, {from.light}).wide)
                    << "content " << content << ", perspective " << perspective << ", reversed " << reversed;
            }
}

// What lies in front of a cube's face is seen alike in every form.
TEST(ShadowContent, CubesAndCascadesHoldThemToo) {
    const Frame f = formFrame();
    const Vec3 lamp{24, 10, 70};
    const auto shelf = [&](Vec3 d, int) {
        return d.z < -1e-3 ? std::min((d.x * 40 < -d.z * 3 ? 30.0 : 78.0) / -d.z, 500.0) : 500;
    };
    for (const bool radial : {false, true}) {
        const CubeLight cube = cubeLight(256, radial, turnTo({0, 0, -1}, {-1, 1, 1}), lamp, shelf);
        const Seen depth = shadeForms(f, {cube.light});
        for (const auto content : {PEL_SHADOW_CONTENT_MOMENTS, PEL_SHADOW_CONTENT_EXPONENTIAL}) {
            Light other = cube.light;
            other.params.shadowContent = content;
            other.params.shadowExponent = 80;
            MapImage& map = other.maps[0];
            map.components = content == PEL_SHADOW_CONTENT_MOMENTS ? 2 : 1;
            map.values.clear();
            for (const double z : cube.map.depth) {
                if (content == PEL_SHADOW_CONTENT_MOMENTS)
                    map.values.insert(map.values.end(), {float(z), float(z * z)});
                else
                    map.values.push_back(float(std::exp(80 * z)));
            }
            const Seen as = shadeForms(f, {other});
            double wide = 0;
            for (size_t i = 0; i < f.pixels(); ++i) {
                if (!materialAt(f, i)) continue;
                EXPECT_NEAR(as.thickness[i], depth.thickness[i],
                            tolerance::contentInCubeThickness + 0.02 * depth.thickness[i])
                    << i << " radial " << radial;
                wide += std::abs(as.wide[i] - depth.wide[i]) / double(f.pixels());
            }
            EXPECT_LE(wide, tolerance::contentInCube) << "mean; content " << content << ", radial " << radial;
        }
    }
    ContentLight one = contentLight(PEL_SHADOW_CONTENT_MOMENTS, false, false, 131);
    const Seen plain = shadeForms(f, {one.light});
    one.light.params.shadowCascades = 1;
    EXPECT_EQ(shadeForms(f, {one.light}).wide, plain.wide);
}

TEST(ShadowContent, BadTexels) {
    const Frame f = formFrame();
    for (const auto content : {PEL_SHADOW_CONTENT_MOMENTS, PEL_SHADOW_CONTENT_EXPONENTIAL}) {
        ContentLight from = contentLight(content, true, false, 131);
        const uint32_t components = from.light.maps[0].components;
        const float bad[] = {nan, std::numeric_limits<float>::infinity(), components == 1 ? -1.0f : nan,
                             components == 1 ? 0.0f : nan};
        for (size_t i = 0; i < from.first.depth.size(); i += 5) {
            from.light.maps[0].values[components * i] = bad[i % 4];
            from.first.depth[i] = bad[i % 4];
        }
        const Seen seen = shadeForms(f, {from.light});
        EXPECT_LE(worstOf(f, seen, truthOf(from)).wide, tolerance::contentShadow)
            << "such texels throw no shadow, content " << content;
        for (size_t i = 0; i < f.pixels(); ++i) EXPECT_TRUE(std::isfinite(seen.thickness[i])) << i;
    }
}

TEST(ShadowContent, WhatIsRefused) {
    const auto refused = [&](PelError code, PelShadowContent content, const char* word, auto change) {
        ContentLight from = contentLight(content, false, false, 31);
        std::vector<Light> lights{from.light};
        change(lights);
        expectError(code, {word}, [&] { shadeForms(formFrame(1, 9, 3), lights); });
    };
    using Lights = std::vector<Light>;
    const auto invalid = PEL_ERROR_INVALID_ARGUMENT;
    refused(invalid, PEL_SHADOW_CONTENT_EXPONENTIAL, "two components", [](Lights& l) {
        l[0].params.shadowContent = PEL_SHADOW_CONTENT_MOMENTS, l[0].params.shadowExponent = 1;
    });
    for (const float c : {0.0f, -80.0f, nan, 1e5f})
        refused(invalid, PEL_SHADOW_CONTENT_EXPONENTIAL, "shadowExponent",
                [c](Lights& l) { l[0].params.shadowExponent = c; });
    refused(invalid, PEL_SHADOW_CONTENT_EXPONENTIAL, "below 0",
            [](Lights& l) { l[0].params.shadowDepthRange *= -1; });
    refused(invalid, PEL_SHADOW_CONTENT_MOMENTS, "PelShadowContent",
            [](Lights& l) { l[0].params.shadowContent = PelShadowContent(3); });
    refused(PEL_ERROR_UNSUPPORTED, PEL_SHADOW_CONTENT_EXPONENTIAL, "shadowContent", [](Lights& l) {
        l.push_back(l[0]);
        l[1].params.shadowContent = PEL_SHADOW_CONTENT_DEPTH;
    });
}

}  // namespace
