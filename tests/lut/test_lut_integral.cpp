// Texels of curvature and shadow tables against the oracle's adaptive quadrature: every form, kind of
// profile, axis, size and range.
#include "lut_cases.h"
#include "test_size.h"

using namespace pellucid;
using fixture::forms;
using fixture::ProfileCase;

namespace {

// Calls compare(x, y) for the corners and for random texels; each row is met before any is met again.
template <class Compare>
void eachTexel(uint32_t width, uint32_t height, int samples, Compare&& compare) {
    std::mt19937 random(7);
    for (int i = 0; i < samples; ++i) {
        const bool corner = i < 4;
        const int x = corner ? (i & 1) * (int(width) - 1) : int(random() % width),
                  y = corner ? (i >> 1) * (int(height) - 1) : i % int(height);
        compare(x, y);
    }
}

void compareCurvature(const Device& device, const ProfileCase& profile, const PelCurvatureLutDesc& usual,
                      int samples) {
    const PelCurvatureLutDesc desc = sizedTable(usual);
    const Lut lut(device, desc);
    const PelCurvatureLutDesc made = lut.info().curvature;
    const std::vector<float> texels = lut.read<float>(PEL_LUT_FLOAT);
    const auto truth = reference::profileForRadius(profile.truth, made.diffusionRadius);
    const double c0 = 1 / double(made.radiusMax), c1 = 1 / double(made.radiusMin);
    eachTexel(desc.width, desc.height, samples, [&](int x, int y) {
        double u = -1 + (x + 0.5) * 2 / desc.width, c = c0 + (y + 0.5) / desc.height * (c1 - c0);
        if (desc.axis == PEL_AXIS_ROOT) {
            const double s = -1 + 2.0 * x / (desc.width - 1);
            u = s * std::abs(s);
            c = std::pow(std::sqrt(c0) + y / (desc.height - 1.0) * (std::sqrt(c1) - std::sqrt(c0)), 2);
        }
        const reference::Rgb D = reference::curvatureD(forms[desc.form].second, *truth, u, 1 / c);
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(texels[(size_t(y) * desc.width + size_t(x)) * 3 + size_t(k)], D[k], profile.tolerance)
                << profile.name << " form " << int(desc.form) << " axis " << int(desc.axis) << " u " << u
                << " r " << 1 / c << " channel " << k;
    });
}

void compareShadow(const Device& device, const ProfileCase& profile, const PelShadowLutDesc& usual,
                   int samples) {
    const PelShadowLutDesc desc = sizedTable(usual);
    const Lut lut(device, desc);
    const PelShadowLutDesc made = lut.info().shadow;
    const std::vector<float> texels = lut.read<float>(PEL_LUT_FLOAT);
    const reference::ShadowLutSpec spec{int(desc.width), int(desc.height),     desc.widthMin,
                                        desc.widthMax,   made.diffusionRadius, desc.sharpening};
    eachTexel(desc.width, desc.height, samples, [&](int x, int y) {
        const reference::Rgb T = reference::shadowTexel(spec, *profile.truth, x, y);
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(texels[(size_t(y) * desc.width + size_t(x)) * 3 + size_t(k)], T[k], profile.tolerance)
                << profile.name << " (" << x << ", " << y << ") sharpening " << desc.sharpening << " widths "
                << desc.widthMin << " to " << desc.widthMax << " channel " << k;
    });
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

TEST(LutIntegral, MeanOverTheSphereIsAQuarter) {
    const Device device("");
    for (const ProfileCase& profile : fixture::profiles()) {
        const auto desc =
            fixture::curvatureTable(profile.ours, PEL_FORM_SPHERE, 2049, sized(12u, 2u), 0.05, 1000);
        const Lut lut(device, desc);
        fixture::expectMeansOfAQuarter(lut.read<float>(PEL_LUT_FLOAT), desc.width, profile.name);
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
