// Texels of curvature and shadow tables against the oracle's adaptive quadrature: every form, kind of
// profile, axis, size and range; and invariants of all tables.
#include "kept_sums.h"
#include "lut_cases.h"

using namespace pellucid;
using fixture::curvatureTable;
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

void compareCurvature(const ProfileCase& profile, const PelCurvatureLutDesc& usual, int samples) {
    const PelCurvatureLutDesc desc = sizedTable(usual);
    const Lut lut(device(), desc);
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

void compareShadow(const ProfileCase& profile, const PelShadowLutDesc& usual, int samples) {
    const PelShadowLutDesc desc = sizedTable(usual);
    const Lut lut(device(), desc);
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

template <class Desc>
std::vector<float> texelsOf(const Desc& desc) {
    return Lut(device(), desc).read<float>(PEL_LUT_FLOAT);
}

void expectRises(const std::vector<float>& texels, size_t width, double bound) {
    for (size_t i = 0; i < texels.size(); ++i) {
        ASSERT_GE(texels[i], 0) << i;
        ASSERT_LE(texels[i], 1 + bound) << i;
        if (i / 3 % width > 0) {
            ASSERT_GE(texels[i] - texels[i - 3], -bound) << i;
        }
    }
}

}  // namespace

TEST(LutIntegral, CurvatureOfEveryFormAndProfile) {
    for (const ProfileCase& profile : fixture::profiles())
        for (const auto& [form, trueForm] : forms)
            for (const auto& [axis, min, max] :
                 {std::tuple{PEL_AXIS_LINEAR, 0.3, 40.0}, {PEL_AXIS_ROOT, 0.05, 1e4}}) {
                if (axis == PEL_AXIS_LINEAR && profile.ours.info().kind == PEL_PROFILE_TABLE) continue;
                PelCurvatureLutDesc desc = curvatureTable(profile.ours, form, 48, 12, min, max);
                desc.axis = axis;
                compareCurvature(profile, desc, 16);
            }
}

TEST(LutIntegral, CurvatureOfOtherSizesAndUnits) {
    compareCurvature(skin(), pelCurvatureLutDescFaceWorks(), 600);
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
        compareCurvature(skin(), desc, c.samples);
    }
}

TEST(LutIntegral, ShadowOfEveryProfile) {
    for (const ProfileCase& profile : fixture::profiles())
        for (auto [min, max, sharpening] : {std::tuple{2.0, 40.0, 1.0f},
                                            {0.05, 1000.0, 1.0f},
                                            {2.0, 40.0, 10.0f},
                                            {0.5, 40.0, 4.0f},
                                            {1.0, 10.0, 1e5f}}) {
            const PelShadowLutDesc desc = fixture::shadowTable(profile.ours, 40, 8, min, max, sharpening);
            compareShadow(profile, desc, 12);
        }
}

TEST(LutIntegral, ShadowOfOtherSizesAndUnits) {
    compareShadow(skin(), pelShadowLutDescFaceWorks(), 1000);
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
        compareShadow(skin(), desc, 100);
    }
}

// Some rows and columns of large tables, the outermost among them: of a form in closed terms and of one that
// is integrated.
TEST(LutIntegral, LargestTables) {
    for (const PelCurvatureForm form : {PEL_FORM_ARC, PEL_FORM_SPHERE}) {
        PelCurvatureLutDesc desc = curvatureTable(skin().ours, form, 4096, 4096, 0.05, 1e4);
        desc.axis = PEL_AXIS_LINEAR;
        compareCurvature(skin(), desc, 160);
    }
}

// One column of the axis of roots is its middle, N.L = 0.
TEST(LutIntegral, OneColumnIsTheMiddle) {
    for (const auto& [form, trueForm] : forms)
        for (double r : {0.05, 1.0, 30.0}) {
            const auto desc = curvatureTable(skin().ours, form, 1, 1, r, r);
            const auto texels = Lut(device(), desc).read<float>(PEL_LUT_FLOAT);
            const reference::Rgb truth = reference::curvatureD(trueForm, *skin().truth, 0, r * 2.7);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(texels[size_t(c)], truth[c], tolerance::lutTexelGaussians);
        }
}

// Closed ends: (T - T(0)) / (T(1) - T(0)) per row of the oracle's T, 0 and 1 at the ends of the axis of
// roots, whose columns are even in the position across the edge and whose rows are even in the root of
// 1/width.
TEST(LutIntegral, ClosedEndsOfShadowsRunFromNoneToAll) {
    const std::vector<ProfileCase> all = fixture::profiles();
    for (const auto& of : {std::pair{0, 1.0f}, {0, 10.0f}, {3, 1.0f}, {int(all.size()) - 1, 10.0f}}) {
        const ProfileCase& profile = all[size_t(of.first)];
        const float sharpening = of.second;
        PelShadowLutDesc desc = fixture::shadowTable(profile.ours, 33, 5, 4 / 2.7, 400 / 2.7, sharpening);
        desc.closedEnds = 1;
        desc.axis = PEL_AXIS_ROOT;
        const auto texels = Lut(device(), desc).read<float>(PEL_LUT_FLOAT);
        for (uint32_t y = 0; y < 5; ++y) {
            const double root = std::sqrt(1.0 / desc.widthMax) +
                                y / 4.0 * (std::sqrt(1.0 / desc.widthMin) - std::sqrt(1.0 / desc.widthMax));
            const auto T = [&](double w) {
                return reference::shadowT(*profile.truth, w, root * root, sharpening);
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
                        << profile.name << " " << x << " " << y;
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
    const Lut lut(device(), desc);
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
    EXPECT_THROW(Lut(device(), desc), Error);
}

// --- numbers at the edges of float, and meshes of tabulated profiles ---

// Light is never negative, not even by rounding, and never more than the profile has.
TEST(LutProperties, ExtremesAreFiniteAndRise) {
    const std::pair<const char*, Profile> profiles[] = {
        {"skin", Profile::skin()},
        {"ends in a step", Profile::table({0.3f, 1, 3}, {3, 1, 1, 2, 1, 0.5f, 1, 1, 0.1f})},
        {"short", Profile::table({0, 1e-30f}, {1, 1, 1, 1, 1, 1})},
        {"long", Profile::table({1e15f, 1e18f}, {1, 1, 1, 1, 1, 1})},
        {"two distances far apart", Profile::table({1e-6f, 1e6f}, {9, 9, 9, 0, 0, 0})}};
    for (const auto& [name, profile] : profiles) {
        SCOPED_TRACE(name);
        const double bound = tolerance::lutTexelOther;
        const std::tuple<float, float, float> lengths[] = {
            {1e-38f, 1e38f, 0}, {1e-30f, 1e-30f, 0}, {1, 1, 0}, {1e30f, 1e30f, 0}, {1e-38f, 1e-38f, 1e38f}};
        for (const auto& [least, most, radius] : lengths)
            for (const auto& [form, trueForm] : forms) {
                PelCurvatureLutDesc desc = curvatureTable(profile, form, 17, 4, 1, 1);
                desc.axis = PEL_AXIS_LINEAR;
                desc.radiusMin = least, desc.radiusMax = most, desc.diffusionRadius = radius;
                expectRises(texelsOf(desc), 17, bound);
            }
        const std::tuple<float, float, float> widths[] = {
            {1e-30f, 1e30f, 0}, {1e-38f, 1e38f, 1}, {1e-38f, 1e-38f, 1e38f}, {1e38f, 1e38f, 1e-38f},
            {0.1f, 8, 2.7f},    {1, 30, 2.7f},      {8, 30000, 2.7f}};
        for (const auto& [least, most, radius] : widths)
            for (float sharpening : {1.0f, 10.0f, 1000.0f, 1e6f, 3e38f}) {
                PelShadowLutDesc desc = fixture::shadowTable(profile, sized(64u, 9u), 8, 1, 1, sharpening);
                desc.widthMin = least, desc.widthMax = most, desc.diffusionRadius = radius;
                SCOPED_TRACE(std::to_string(least) + " " + std::to_string(sharpening));
                expectRises(texelsOf(desc), desc.width, bound);
            }
    }
}

// 4096 distances on the corners and the straight lines of five: the same profile, by other meshes.
TEST(LutProperties, MoreDistancesOnTheSameLinesChangeNothing) {
    const std::vector<float> corners{0, 0.5f, 1, 2, 4},
        R{9, 8, 7, 4, 3, 2, 1, .5f, .2f, .2f, .05f, .01f, 0, 0, 0};
    std::vector<float> distances, values;
    for (size_t i = 0; i + 1 < corners.size(); ++i)
        for (int j = 0; j < 1023; ++j) {
            const float t = float(j) / 1023;
            distances.push_back(corners[i] + t * (corners[i + 1] - corners[i]));
            for (size_t c = 0; c < 3; ++c)
                values.push_back(R[3 * i + c] + t * (R[3 * i + 3 + c] - R[3 * i + c]));
        }
    distances.push_back(corners.back());
    values.insert(values.end(), {0, 0, 0});
    const Profile few = Profile::table(corners, R), many = Profile::table(distances, values);
    const double most =
        tolerance::lutTexelOther * (device().info().type == PEL_DEVICE_CPU ? 1 : 1.1);  // an H200: 1.002
    for (const auto& [form, trueForm] : forms) {
        const auto one = texelsOf(curvatureTable(few, form, 33, sized(560u, 1u), 0.05, 1000)),
                   other = texelsOf(curvatureTable(many, form, 33, sized(560u, 1u), 0.05, 1000));
        for (size_t i = 0; i < one.size(); ++i)
            ASSERT_NEAR(one[i], other[i], most) << "form " << int(form) << " " << i;
    }
}

// If no profile content is within reach, the result is the light itself.
TEST(LutProperties, NothingWithinReachScattersNothing) {
    const Profile far = Profile::table({1, 1.5f, 2}, {0, 0, 0, 1, 1, 1, 0, 0, 0});
    for (PelCurvatureForm form : {PEL_FORM_RING, PEL_FORM_HALF_RING, PEL_FORM_SPHERE}) {
        const auto texels =
            texelsOf(curvatureTable(far, form, 33, 2, 0.05, 1000));  // the second row: r = 0.05
        for (int x = 0; x < 33; ++x) {
            const double s = -1 + x / 16.0;
            EXPECT_NEAR(texels[(33 + size_t(x)) * 3], std::max(0.0, s * std::abs(s)),
                        tolerance::lutTexelOther);
        }
    }
}

TEST(LutProperties, WeightsAndVariancesAtTheEdgesOfFloat) {
    constexpr float most = std::numeric_limits<float>::max(), tiny = std::numeric_limits<float>::denorm_min();
    const auto texels = [&](PelCurvatureForm form, const std::vector<PelGaussian>& gaussians) {
        const Profile profile = Profile::gaussians(gaussians);
        PelCurvatureLutDesc desc = curvatureTable(profile, form, 33, 4, 1, 1);
        desc.axis = PEL_AXIS_LINEAR;
        desc.radiusMin = 1, desc.radiusMax = 50;
        return texelsOf(desc);
    };
    for (const auto& [form, trueForm] : forms) {
        // Weights are shares, whatever their size: their sum leaves the range of float here.
        const auto expected = texels(form, {{1, {1, 1, 1}}, {4, {1, 3, 1}}});
        for (float unit : {0x1p126f, 0x1p-120f, 0x1p90f})
            EXPECT_EQ(texels(form, {{1, {unit, unit, unit}}, {4, {unit, 3 * unit, unit}}}), expected);
        // A term whose weight is negligible, however wide it is; but it sets the profile's radius, and
        // with it where an arc is cut.
        const auto beside = texels(form, {{1, {1, 1, 1}}, {4, {1, 3, 1}}, {9, {tiny, tiny, tiny}}});
        for (size_t i = 0; i < beside.size() && form != PEL_FORM_ARC; ++i)
            EXPECT_NEAR(beside[i], expected[i], tolerance::lutTexelGaussians) << int(form) << ' ' << i;
        // A width of almost 0 gives the light itself. With a very large width, hardly any light is left along
        // an arc; on the circle and the sphere, which keep all light, it becomes uniform; on the half circle
        // round the point it is the mean there.
        const auto narrow = texels(form, {{tiny, {1, 1, 1}}}), wide = texels(form, {{most, {1, 1, 1}}});
        const double even = form == PEL_FORM_ARC ? 0 : form == PEL_FORM_SPHERE ? 0.25 : 1 / std::numbers::pi;
        const double kept =
            form == PEL_FORM_ARC ? std::erf(10 / 2.7 / std::numbers::sqrt2) : 1;  // by the cut
        for (size_t i = 0; i < narrow.size(); ++i) {
            const double u = -1 + (double(i / 3 % 33) + 0.5) * 2 / 33;
            EXPECT_NEAR(narrow[i], kept * std::max(0.0, u), tolerance::lutTexelGaussians) << int(form);
            EXPECT_NEAR(wide[i], even * (form == PEL_FORM_HALF_RING ? 1 + u : 1),
                        tolerance::lutTexelGaussians)
                << int(form);
        }
    }
}

// Descriptions at random.
TEST(LutKept, TexelsAreTheKeptOnes) {
    const std::vector<ProfileCase> profiles = fixture::profiles();
    KeptSums kept("tables.dat");
    for (uint32_t index = 0; index < 40; ++index) {
        Draw draw(index);
        const Profile& profile = profiles[index % profiles.size()].ours;
        const uint32_t width = 1 + draw.below(40), height = 1 + draw.below(12);
        const double least = double(draw.in(0.1f, 1)), most = least * double(draw.in(2, 300));
        PelCurvatureLutDesc curvature =
            curvatureTable(profile, forms[draw.below(5)].first, width, height, least, most);
        PelShadowLutDesc shadow = fixture::shadowTable(profile, width, height, least, most, draw.in(1, 12));
        curvature.axis = shadow.axis = draw.oneOf(2) ? PEL_AXIS_ROOT : PEL_AXIS_LINEAR;
        curvature.diffusionRadius = shadow.diffusionRadius = draw.oneOf(3) ? draw.in(0.5f, 5) : 0;
        if (curvature.diffusionRadius > 0) {
            const float scale = curvature.diffusionRadius / profile.info().radius;
            for (float* length :
                 {&curvature.radiusMin, &curvature.radiusMax, &shadow.widthMin, &shadow.widthMax})
                *length *= scale;
        }
        shadow.closedEnds = draw.oneOf(3);
        const std::string name = "table " + std::to_string(index);
        kept.expect(Lut(device(), curvature).read<float>(PEL_LUT_FLOAT), tolerance::keptResults, name);
        kept.expect(Lut(device(), shadow).read<float>(PEL_LUT_FLOAT), tolerance::keptResults, name);
    }
}
