// Texels of curvature and shadow tables against the oracle's adaptive quadrature: every form, kind of
// profile, axis, size and range.
#include "lut_cases.h"
#include "test_size.h"

using namespace pellucid;
using fixture::forms;
using fixture::ProfileCase;

namespace {

// The corners and random texels against truth(x, y); each row is met before any is met again.
template <class Desc, class Truth>
void compareTexels(const Lut& lut, const Desc& desc, const ProfileCase& profile, int samples, Truth&& truth) {
    const std::vector<float> texels = lut.read<float>(PEL_LUT_FLOAT);
    std::mt19937 random(7);
    for (int i = 0; i < samples; ++i) {
        const bool corner = i < 4;
        const int x = corner ? (i & 1) * (int(desc.width) - 1) : int(random() % desc.width),
                  y = corner ? (i >> 1) * (int(desc.height) - 1) : i % int(desc.height);
        const reference::Rgb expected = truth(x, y);
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(texels[(size_t(y) * desc.width + size_t(x)) * 3 + size_t(k)], expected[k],
                        profile.tolerance)
                << profile.name << " (" << x << ", " << y << ") channel " << k;
    }
}

void compareCurvature(const Device& device, const ProfileCase& profile, const PelCurvatureLutDesc& usual,
                      int samples) {
    const PelCurvatureLutDesc desc = sizedTable(usual);
    const Lut lut(device, desc);
    const PelCurvatureLutDesc made = lut.info().curvature;
    SCOPED_TRACE("form " + std::to_string(desc.form) + " axis " + std::to_string(desc.axis));
    const auto truth = reference::profileForRadius(profile.truth, made.diffusionRadius);
    const double c0 = 1 / double(made.radiusMax), c1 = 1 / double(made.radiusMin);
    compareTexels(lut, desc, profile, samples, [&](int x, int y) {
        double u = -1 + (x + 0.5) * 2 / desc.width, c = c0 + (y + 0.5) / desc.height * (c1 - c0);
        if (desc.axis == PEL_AXIS_ROOT) {
            const double s = -1 + 2.0 * x / (desc.width - 1);
            u = s * std::abs(s);
            c = std::pow(std::sqrt(c0) + y / (desc.height - 1.0) * (std::sqrt(c1) - std::sqrt(c0)), 2);
        }
        return reference::curvatureD(forms[desc.form].second, *truth, u, 1 / c);
    });
}

void compareShadow(const Device& device, const ProfileCase& profile, const PelShadowLutDesc& usual,
                   int samples) {
    const PelShadowLutDesc desc = sizedTable(usual);
    const Lut lut(device, desc);
    const PelShadowLutDesc made = lut.info().shadow;
    SCOPED_TRACE("sharpening " + std::to_string(desc.sharpening) + ", widths " +
                 std::to_string(desc.widthMin) + " to " + std::to_string(desc.widthMax));
    const reference::ShadowLutSpec spec{int(desc.width), int(desc.height),     desc.widthMin,
                                        desc.widthMax,   made.diffusionRadius, desc.sharpening};
    compareTexels(lut, desc, profile, samples,
                  [&](int x, int y) { return reference::shadowTexel(spec, *profile.truth, x, y); });
}

const ProfileCase& skin() {
    static const ProfileCase skin = fixture::profiles()[0];
    return skin;
}

}  // namespace

TEST(LutIntegral, CurvatureOfEveryFormAndProfile) {
    const Device device("");
    for (const ProfileCase& profile : fixture::profiles())
        for (const auto& [form, trueForm] : forms)
            for (const auto& [axis, min, max] :
                 {std::tuple{PEL_AXIS_LINEAR, 0.3, 40.0}, {PEL_AXIS_ROOT, 0.05, 1e4}}) {
                if (axis == PEL_AXIS_LINEAR && profile.ours.info().kind == PEL_PROFILE_TABLE) continue;
                PelCurvatureLutDesc desc = fixture::curvatureTable(profile.ours, form, 48, 12, min, max);
                desc.axis = axis;
                compareCurvature(device, profile, desc, 20);
            }
}

TEST(LutIntegral, CurvatureOfOtherSizesAndUnits) {
    const Device device("");
    compareCurvature(device, skin(), pelCurvatureLutDescFaceWorks(), 600);
    const struct {
        uint32_t width, height;
        float radiusMin, radiusMax, diffusionRadius;
        int samples;
    } cases[] = {{1, 1, 1, 100, 2.7f, 1},
                 {1, 9, 2, 50, 2.7f, 9},
                 {37, 3, 2, 50, 2.7f, 60},
                 {64, 64, 5, 5, 2.7f, 60},
                 {32, 33, 0.001f, 0.1f, 0.0027f, 60},  // metres
                 // 0.05 to 10,000 times the widest sigma
                 {64, 16, 0.135f, 0.135f, 2.7f, 100},
                 {64, 16, 0.135f, 27000, 2.7f, 150},
                 {64, 16, 1000, 27000, 2.7f, 150},
                 {1024, 4, 27000, 27000, 2.7f, 150},
                 {33, 7, 1, 100, 270, 60},
                 {33, 7, 1, 100, 0.01f, 60}};
    for (const auto& c : cases) {
        PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
        desc.width = c.width, desc.height = c.height;
        desc.radiusMin = c.radiusMin, desc.radiusMax = c.radiusMax, desc.diffusionRadius = c.diffusionRadius;
        compareCurvature(device, skin(), desc, c.samples);
    }
}

TEST(LutIntegral, ShadowOfEveryProfile) {
    const Device device("");
    for (const ProfileCase& profile : fixture::profiles())
        for (auto [min, max, sharpening] : {std::tuple{2.0, 40.0, 1.0f},
                                            {0.05, 1000.0, 1.0f},
                                            {2.0, 40.0, 10.0f},
                                            {0.5, 40.0, 4.0f},
                                            {1.0, 10.0, 1e5f}}) {
            const PelShadowLutDesc desc = fixture::shadowTable(profile.ours, 40, 8, min, max, sharpening);
            compareShadow(device, profile, desc, 24);
        }
}

TEST(LutIntegral, ShadowOfOtherSizesAndUnits) {
    const Device device("");
    compareShadow(device, skin(), pelShadowLutDescFaceWorks(), 1000);
    struct Case {
        uint32_t width, height;
        float widthMin, widthMax, diffusionRadius, sharpening;
    };
    std::vector<Case> cases{{1, 1, 8, 100, 2.7f, 10},   {1, 5, 8, 100, 2.7f, 10},
                            {2, 2, 8, 100, 2.7f, 10},   {37, 3, 8, 100, 2.7f, 10},
                            {64, 64, 20, 20, 2.7f, 10}, {64, 64, 0.008f, 0.1f, 0.0027f, 10},
                            {64, 64, 3, 40, 1, 4}};
    for (float sharpening : {1.0f, 3.0f, 100.0f, 1e6f})
        for (auto [min, max] : {std::pair{8.0f, 100.0f}, {0.1f, 8.0f}, {100.0f, 30000.0f}})
            cases.push_back({128, 16, min, max, 2.7f, sharpening});
    for (const Case& c : cases) {
        PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
        desc.width = c.width, desc.height = c.height;
        desc.widthMin = c.widthMin, desc.widthMax = c.widthMax;
        desc.diffusionRadius = c.diffusionRadius, desc.sharpening = c.sharpening;
        compareShadow(device, skin(), desc, 100);
    }
}

// Some rows and columns of the largest tables, the outermost among them.
TEST(LutIntegral, LargestTables) {
    const Device device("");
    for (const auto& [form, trueForm] : forms) {
        PelCurvatureLutDesc desc = fixture::curvatureTable(skin().ours, form, 4096, 4096, 0.05, 1e4);
        desc.axis = PEL_AXIS_LINEAR;
        compareCurvature(device, skin(), desc, 160);
    }
}

// One column of the axis of roots is its middle, N.L = 0.
TEST(LutIntegral, OneColumnIsTheMiddle) {
    const Device device("");
    for (const auto& [form, trueForm] : forms)
        for (double r : {0.05, 1.0, 30.0}) {
            const auto desc = fixture::curvatureTable(skin().ours, form, 1, 1, r, r);
            const auto texels = Lut(device, desc).read<float>(PEL_LUT_FLOAT);
            const reference::Rgb truth = reference::curvatureD(trueForm, *skin().truth, 0, r * 2.7);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(texels[size_t(c)], truth[c], tolerance::lutTexelGaussians);
        }
}

// D integrated over the light's directions is a quarter in each row of a sphere's table on the axis of roots:
// no light is lost. u = s |s|, du/2 = |s| ds, which vanishes at the middle; trapezoids between texels.
TEST(LutIntegral, MeanOverTheSphereIsAQuarter) {
    const Device device("");
    constexpr uint32_t width = 2049;
    for (const ProfileCase& profile : fixture::profiles()) {
        const auto desc =
            fixture::curvatureTable(profile.ours, PEL_FORM_SPHERE, width, sized(12u, 2u), 0.05, 1000);
        const auto texels = Lut(device, desc).read<float>(PEL_LUT_FLOAT);
        for (size_t row = 0; row < desc.height; ++row)
            for (size_t c = 0; c < 3; ++c) {
                double mean = 0;
                for (uint32_t x = 0; x < width; ++x) {
                    const double s = -1 + 2.0 * x / (width - 1), end = x == 0 || x + 1 == width ? 0.5 : 1;
                    mean += texels[(row * width + x) * 3 + c] * std::abs(s) * end * 2 / (width - 1);
                }
                EXPECT_NEAR(mean, 0.25, tolerance::sphereMean) << profile.name << " row " << row;
            }
    }
}

// Closed ends: (T - T(0)) / (T(1) - T(0)) per row of the oracle's T, 0 and 1 at the ends of the axis of
// roots, whose columns are even in the position across the edge and whose rows are even in the root of
// 1/width.
TEST(LutIntegral, ClosedEndsOfShadowsRunFromNoneToAll) {
    const Device device("");
    for (float sharpening : {1.0f, 10.0f}) {
        PelShadowLutDesc desc = fixture::shadowTable(skin().ours, 33, 9, 4 / 2.7, 400 / 2.7, sharpening);
        desc.closedEnds = 1;
        desc.axis = PEL_AXIS_ROOT;
        const auto texels = Lut(device, desc).read<float>(PEL_LUT_FLOAT);
        for (uint32_t y = 0; y < 9; ++y) {
            const double root = std::sqrt(1.0 / 400) + y / 8.0 * (std::sqrt(1.0 / 4) - std::sqrt(1.0 / 400));
            const auto T = [&](double w) {
                return reference::shadowT(*skin().truth, w, root * root, sharpening);
            };
            const reference::Rgb low = T(0), high = T(1);
            for (uint32_t x = 0; x < 33; ++x) {
                // w of a position p: p - 1/2 = (sqrt w - sqrt(1 - w)) / 2 = sin(asin(sqrt w) - pi/4) / sqrt 2
                const double z = x / 32.0 - 0.5,
                             angle = std::asin(std::clamp(z * std::sqrt(2.0), -1.0, 1.0)) + std::atan(1.0);
                const reference::Rgb t = T(std::pow(std::sin(angle), 2));
                for (int c = 0; c < 3; ++c) {
                    const float texel = texels[(y * 33 + x) * 3 + size_t(c)];
                    EXPECT_NEAR(texel, (t[c] - low[c]) / (high[c] - low[c]), tolerance::closedEnds)
                        << x << " " << y;
                    if (x % 32 == 0) {
                        EXPECT_EQ(texel, x == 0 ? 0 : 1);
                    }
                }
            }
        }
    }
}

TEST(LutIntegral, SpecularEqualsBeckmann) {
    PelSpecularLutDesc desc = pelSpecularLutDescDefaults();
    desc.width = 61;
    desc.height = 40;
    const Lut lut(Device(""), desc);
    EXPECT_EQ(lut.info().kind, PEL_LUT_SPECULAR);
    const auto texels = lut.read<float>(PEL_LUT_FLOAT);
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 61; ++x)
            for (int k = 0; k < 3; ++k)
                ASSERT_NEAR(texels[(size_t(y) * 61 + size_t(x)) * 3 + size_t(k)],
                            reference::beckmannEncoded((x + 0.5) / 61, (y + 0.5) / 40),
                            tolerance::lutTexelGaussians)
                    << x << ", " << y;
    desc.width = 0;
    EXPECT_THROW(Lut(Device(""), desc), Error);
}
