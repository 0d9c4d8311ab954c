// What holds for every look-up table: random profiles of each kind, every form, and numbers at the edges of
// float.
#include <limits>
#include <numbers>

#include "lut_cases.h"
#include "test_size.h"

using namespace pellucid;
using fixture::curvatureTable;
using fixture::forms;

namespace {

using Random = std::mt19937;
float logUniform(Random& random, double least, double most) {
    return float(least * std::pow(most / least, std::uniform_real_distribution<>(0, 1)(random)));
}

// The same random numbers with every length times `scale`: the same profile, larger.
Profile randomProfile(PelProfileKind kind, unsigned seed, float scale) {
    Random random(seed);
    if (kind == PEL_PROFILE_GAUSSIANS) {
        std::vector<PelGaussian> gaussians(1 + random() % 8);
        for (PelGaussian& g : gaussians) {
            g.variance = logUniform(random, 1e-3, 10) * scale * scale;
            for (float& w : g.weight) w = logUniform(random, 1e-2, 1);
        }
        return Profile::gaussians(gaussians);
    }
    if (kind == PEL_PROFILE_TABLE) {  // one that falls
        std::vector<float> distances, values;
        const size_t count = 3 + random() % 40;
        float d = logUniform(random, 1e-3, 0.1), value[3] = {1, 1, 1};
        for (size_t i = 0; i < count; ++i) {
            distances.push_back(d * scale);
            d += logUniform(random, 0.05, 1);
            values.insert(values.end(), value, value + 3);
            for (float& v : value) v *= logUniform(random, 0.3, 1);
        }
        return Profile::table(distances, values);
    }
    const bool burley = kind == PEL_PROFILE_BURLEY;
    float a[3], b[3];
    for (int c = 0; c < 3; ++c) {
        a[c] = burley ? logUniform(random, 0.1, 3) * scale : logUniform(random, 1e-3, 1) / scale;
        b[c] = burley ? logUniform(random, 0.1, 1) : logUniform(random, 0.3, 3) / scale;
    }
    return burley ? Profile::burley(a, b) : Profile::dipole(a, b, 1.3f);
}

// Each random profile, at this scale and 1000 times as large, and the tolerance of its tables.
template <class Use>
void eachProfile(const Use& use) {
    for (PelProfileKind kind :
         {PEL_PROFILE_GAUSSIANS, PEL_PROFILE_BURLEY, PEL_PROFILE_DIPOLE, PEL_PROFILE_TABLE})
        for (unsigned seed = 0; seed < sized(4u, 1u); ++seed) {
            SCOPED_TRACE("kind " + std::to_string(kind) + " seed " + std::to_string(seed));
            use(randomProfile(kind, seed, 1), randomProfile(kind, seed, 1000), seed,
                kind == PEL_PROFILE_GAUSSIANS ? tolerance::lutTexelGaussians : tolerance::lutTexelOther);
        }
}

template <class Desc>
std::vector<float> texelsOf(const Desc& desc) {
    static const Device device("");
    return Lut(device, desc).read<float>(PEL_LUT_FLOAT);
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

// D rises with N.L: max(cos, 0) and every kernel here fall symmetrically from their middle, and so does what
// one makes of the other. It is no less than 0 and no more than 1; lit and dark side differ by N.L times one
// number.
TEST(LutProperties, CurvatureRisesIsBoundedAndScales) {
    const uint32_t width = sized(65u, 9u), height = sized(24u, 3u);
    eachProfile([&](const Profile& profile, const Profile& large, unsigned, double bound) {
        for (const auto& [form, trueForm] : forms) {
            SCOPED_TRACE("form " + std::to_string(form));
            const auto D = texelsOf(curvatureTable(profile, form, width, height, 0.05, 1e4)),
                       scaled = texelsOf(curvatureTable(large, form, width, height, 0.05, 1e4));
            expectRises(D, width, bound);
            for (size_t i = 0; i < D.size(); ++i) {
                ASSERT_NEAR(D[i], scaled[i], bound) << i;
                const size_t x = i / 3 % width;
                if (x >= width / 2) continue;  // (D(u) - D(-u)) / u is the same along the row
                const size_t mirror = i + 3 * (width - 1 - 2 * x), last = i + 3 * (width - 1 - x);
                const double s = 1 - 2.0 * double(x) / (width - 1);
                ASSERT_NEAR(D[mirror] - D[i], s * s * (D[last] - D[i - 3 * x]), bound) << i;
            }
        }
    });
}

TEST(LutProperties, ShadowRisesAndIsOdd) {
    const uint32_t width = sized(64u, 9u), height = sized(12u, 3u);
    eachProfile([&](const Profile& profile, const Profile&, unsigned seed, double bound) {
        const auto T =
            texelsOf(fixture::shadowTable(profile, width, height, 0.3, 300, seed % 2 ? 1.0f : 10.0f));
        expectRises(T, width, bound);
        for (size_t i = 0; i < T.size(); ++i) {
            const size_t x = i / 3 % width;
            ASSERT_NEAR(T[i] + T[i + 3 * (width - 1) - 6 * x], T[i % 3] + T[3 * (width - 1) + i % 3], bound)
                << i;
        }
    });
}

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
    for (const auto& [form, trueForm] : forms) {
        const auto one = texelsOf(curvatureTable(few, form, 33, sized(560u, 1u), 0.05, 1000)),
                   other = texelsOf(curvatureTable(many, form, 33, sized(560u, 1u), 0.05, 1000));
        for (size_t i = 0; i < one.size(); ++i)
            ASSERT_NEAR(one[i], other[i], tolerance::lutTexelOther) << "form " << int(form) << " " << i;
    }
}

// Where a table has nothing within reach the result is the light itself.
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
        // A width of almost 0 gives the light itself. A very large width leaves hardly any light where it
        // spreads along an arc, and even light where what there is stays on the circle or the sphere; on the
        // half circle round the point its mean.
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
