// Descriptions of look-up tables, and their comparison with the oracle's numbers, for tests.
#pragma once
#include <gtest/gtest.h>

#include <pellucid/pellucid.hpp>

#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "npy.h"
#include "reference/lut.h"
#include "tolerances.h"

namespace fixture {

// Every form, and what the oracle calls it.
inline constexpr std::pair<PelCurvatureForm, reference::Form> forms[] = {
    {PEL_FORM_ARC, reference::Form::arc},
    {PEL_FORM_RING, reference::Form::ring},
    {PEL_FORM_HALF_RING, reference::Form::halfRing},
    {PEL_FORM_SPHERE, reference::Form::sphere},
    {PEL_FORM_PENNER_RING, reference::Form::pennerRing}};

// Of the profile as it is, on the axis of roots; `least`, `most`: radii of curvature in units of the profile's.
inline PelCurvatureLutDesc curvatureTable(const pellucid::Profile& profile, PelCurvatureForm form,
                                          uint32_t width, uint32_t height, double least, double most) {
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.width = width;
    desc.height = height;
    desc.form = form;
    desc.axis = PEL_AXIS_ROOT;
    desc.diffusionRadius = 0;
    desc.profile = profile.get();
    desc.radiusMin = float(least * profile.info().radius);
    desc.radiusMax = float(most * profile.info().radius);
    return desc;
}

// `least`, `most`: widths of the penumbra in units of the profile's radius.
inline PelShadowLutDesc shadowTable(const pellucid::Profile& profile, uint32_t width, uint32_t height,
                                    double least, double most, float sharpening) {
    PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
    desc.width = width;
    desc.height = height;
    desc.profile = profile.get();
    desc.diffusionRadius = 0;
    desc.widthMin = float(least * profile.info().radius);
    desc.widthMax = float(most * profile.info().radius);
    desc.sharpening = sharpening;
    return desc;
}

// D integrated over the light's directions is a quarter in each row of a sphere's table on the axis of roots: no light is lost.
// u = s |s|, du/2 = |s| ds, which vanishes at the middle; trapezoids between texels.
inline void expectMeansOfAQuarter(const std::vector<float>& texels, uint32_t width, const std::string& name) {
    for (size_t row = 0; row < texels.size() / 3 / width; ++row)
        for (size_t c = 0; c < 3; ++c) {
            double mean = 0;
            for (uint32_t x = 0; x < width; ++x) {
                const double s = -1 + 2.0 * x / (width - 1), end = x == 0 || x + 1 == width ? 0.5 : 1;
                mean += texels[(row * width + x) * 3 + c] * std::abs(s) * end * 2 / (width - 1);
            }
            EXPECT_NEAR(mean, 0.25, tolerance::sphereMean) << name << " row " << row << " channel " << c;
        }
}

// RGBA bytes of a texel against the oracle's exact `steps`, wherever these are not about to round either way.
inline void expectRounded(const uint8_t* bytes, const reference::Rgb& steps, int x, int y) {
    EXPECT_EQ(bytes[3], 255);
    for (int c = 0; c < 3; ++c) {
        const double fromBoundary = std::abs(steps[c] - std::floor(steps[c]) - 0.5);
        if (fromBoundary > tolerance::lutRoundingBoundary) {
            EXPECT_EQ(bytes[c], reference::roundedSteps(steps)[c]) << x << ", " << y << ": " << steps[c];
        }
    }
}

// FaceWorks' own tables are sampled and clipped: near, but not the same.
inline void expectNearFaceWorks(const pellucid::Lut& lut, const std::filesystem::path& file) {
    const auto theirs = npy::read<uint8_t>(file);
    const auto bytes = lut.read<uint8_t>(PEL_LUT_FACEWORKS8);
    ASSERT_EQ(bytes.size(), theirs.data.size());
    int furthest = 0;
    for (size_t i = 0; i < bytes.size(); ++i)
        furthest = std::max(furthest, std::abs(int(bytes[i]) - theirs.data[i]));
    EXPECT_LE(furthest, int(tolerance::faceWorksBytes.value));
}

}  // namespace fixture
