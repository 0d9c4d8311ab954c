// What holds for every look-up table: random profiles of each kind, every form, large tables, and numbers at
// the edges of float.
#include <limits>
#include <numbers>
#include <random>

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
    float a[3], b[3];
    if (kind == PEL_PROFILE_BURLEY) {
        for (int c = 0; c < 3; ++c) {
            a[c] = logUniform(random, 0.1, 3) * scale;
            b[c] = logUniform(random, 0.1, 1);
        }
        return Profile::burley(a, b);
    }
    if (kind == PEL_PROFILE_DIPOLE) {
        for (int c = 0; c < 3; ++c) {
            a[c] = logUniform(random, 1e-3, 1) / scale;
            b[c] = logUniform(random, 0.3, 3) / scale;
        }
        return Profile::dipole(a, b, 1.3f);
    }
    std::vector<float> distances, values;  // a table that falls
    const size_t count = 3 + random() % 40;
    float d = logUniform(random, 1e-3, 0.1), value[3] = {1, 1, 1};
    for (size_t i = 0; i < count; ++i) {
        distances.push_back(d * scale);
        d += logUniform(random, 0.05, 1);
        for (float& v : value) {
            values.push_back(v);
            v *= logUniform(random, 0.3, 1);
        }
    }
    return Profile::table(distances, values);
}

constexpr PelProfileKind kinds[] = {PEL_PROFILE_GAUSSIANS, PEL_PROFILE_BURLEY, PEL_PROFILE_DIPOLE,
                                    PEL_PROFILE_TABLE};

double bound(PelProfileKind kind) {
    return kind == PEL_PROFILE_GAUSSIANS ? tolerance::lutTexelGaussians : tolerance::lutTexelOther;
}

}  // namespace

// D rises with N.L: max(cos, 0) and every kernel here fall symmetrically from their middle, and so does what
// one makes of the other. It is no less than 0 and no more than 1; lit and dark side differ by N.L times one
// number.
TEST(LutProperties, CurvatureRisesIsBoundedAndScales) {
    const Device device("");
    const uint32_t width = sized(65u, 9u), height = sized(24u, 3u);
    for (PelProfileKind kind : kinds)
        for (unsigned seed = 0; seed < sized(4u, 1u); ++seed) {
            const Profile profile = randomProfile(kind, seed, 1), large = randomProfile(kind, seed, 1000);
            for (const auto& entry : forms) {
                const PelCurvatureForm form = entry.first;
                const auto texels = [&](const Profile& of) {
                    const auto desc = curvatureTable(of, form, width, height, 0.05, 1e4);
                    return Lut(device, desc).read<float>(PEL_LUT_FLOAT);
                };
                const auto D = texels(profile), scaled = texels(large);
                const auto where = [&](size_t i) {
                    return ::testing::Message()
                           << "kind " << int(kind) << " seed " << seed << " form " << int(form) << " texel "
                           << i / 3 % width << ", " << i / 3 / width;
                };
                for (size_t i = 0; i < D.size(); ++i) {
                    ASSERT_GE(D[i], 0) << where(i);
                    ASSERT_LE(D[i], 1 + bound(kind)) << where(i);
                    ASSERT_NEAR(D[i], scaled[i], bound(kind)) << where(i);
                    const size_t x = i / 3 % width;
                    if (x > 0) {
                        ASSERT_GE(D[i] - D[i - 3], -bound(kind)) << where(i);
                    }
                    if (x < width / 2) {  // (D(u) - D(-u)) / u is the same along the row
                        const size_t mirror = i + 3 * (width - 1 - 2 * x), last = i + 3 * (width - 1 - x);
                        const double s = 1 - 2.0 * double(x) / (width - 1);
                        const double wanted = s * s * (D[last] - D[i - 3 * x]);
                        ASSERT_NEAR(D[mirror] - D[i], wanted, bound(kind)) << where(i);
                    }
                }
            }
        }
}

TEST(LutProperties, ShadowRisesAndIsOdd) {
    const Device device("");
    const uint32_t width = sized(64u, 9u), height = sized(12u, 3u);
    for (PelProfileKind kind : kinds)
        for (unsigned seed = 0; seed < sized(4u, 1u); ++seed) {
            const Profile profile = randomProfile(kind, seed, 1);
            const auto desc = fixture::shadowTable(profile, width, height, 0.3, 300, seed % 2 ? 1.0f : 10.0f);
            const auto T = Lut(device, desc).read<float>(PEL_LUT_FLOAT);
            for (size_t i = 0; i < T.size(); ++i) {
                const size_t x = i / 3 % width;
                ASSERT_GE(T[i], -bound(kind));
                ASSERT_LE(T[i], 1 + bound(kind));
                if (x > 0) {
                    ASSERT_GE(T[i] - T[i - 3], -bound(kind)) << "kind " << int(kind) << " seed " << seed;
                }
                ASSERT_NEAR(T[i] + T[i + 3 * (width - 1) - 6 * x], T[i % 3] + T[3 * (width - 1) + i % 3],
                            bound(kind));
            }
        }
}

// 4096 x 4096 texels of each form: some rows and columns, the outermost among them, against the integral.
TEST(LutProperties, LargestTables) {
    const Device device("");
    constexpr uint32_t side = 4096;
    const auto skin = reference::skinProfile();
    const Profile profile = Profile::skin();
    Random random(23);
    for (const auto& [form, trueForm] : forms) {
        PelCurvatureLutDesc desc = curvatureTable(profile, form, side, side, 0.05, 1e4);
        desc.axis = PEL_AXIS_LINEAR;
        const auto D = Lut(device, desc).read<float>(PEL_LUT_FLOAT);
        const int texels = side;
        const reference::CurvatureLutSpec spec{trueForm, texels, texels, desc.radiusMin, desc.radiusMax};
        for (int i = 0; i < 160; ++i) {
            const int edges[] = {0, int(side) - 1, int(side) / 2};
            const int x = i % 4 == 3 ? int(random() % side) : edges[i % 4],
                      y = i < 9 ? edges[i / 3] : int(random() % side);
            const reference::Rgb truth = reference::curvatureTexel(spec, *skin, x, y);
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(D[(size_t(y) * side + size_t(x)) * 3 + size_t(c)], truth[c],
                            tolerance::lutTexelGaussians)
                    << "form " << int(form) << " texel " << x << ", " << y;
        }
    }
}

// N.L = +-1 exactly, where the oracle's angle is pi and 0; one column; one radius.
TEST(LutProperties, EndsOfTheAxesAreExact) {
    const Device device("");
    const auto skin = reference::skinProfile();
    const Profile profile = Profile::skin();
    for (const auto& [form, trueForm] : forms)
        for (double r : {0.05, 1.0, 30.0}) {
            const auto texels = [&](uint32_t width) {
                return Lut(device, curvatureTable(profile, form, width, 1, r, r)).read<float>(PEL_LUT_FLOAT);
            };
            const auto D = texels(3), one = texels(1);
            for (size_t x = 0; x < 3; ++x) {
                const reference::Rgb truth = reference::curvatureD(trueForm, *skin, double(x) - 1, r * 2.7);
                for (int c = 0; c < 3; ++c) {
                    EXPECT_NEAR(D[3 * x + size_t(c)], truth[c], tolerance::lutTexelGaussians)
                        << int(form) << " r " << r;
                    if (x == 1) {
                        EXPECT_NEAR(one[size_t(c)], truth[c], tolerance::lutTexelGaussians);
                    }
                }
            }
        }
}

TEST(LutProperties, WeightsAndVariancesAtTheEdgesOfFloat) {
    const Device device("");
    constexpr float most = std::numeric_limits<float>::max(), tiny = std::numeric_limits<float>::denorm_min();
    const auto texels = [&](const Profile& profile, PelCurvatureForm form, float least, float largest,
                            float radius) {
        PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
        desc.width = 33;
        desc.height = 4;
        desc.form = form;
        desc.profile = profile.get();
        desc.radiusMin = least;
        desc.radiusMax = largest;
        desc.diffusionRadius = radius;
        return Lut(device, desc).read<float>(PEL_LUT_FLOAT);
    };
    const Profile plain = Profile::gaussians({{1, {1, 1, 1}}, {4, {1, 3, 1}}});
    for (const auto& [form, trueForm] : forms) {
        // Weights are shares, whatever their size: their sum leaves the range of float here.
        const auto expected = texels(plain, form, 1, 50, 0);
        for (float unit : {0x1p126f, 0x1p-120f, 0x1p90f})
            EXPECT_EQ(texels(Profile::gaussians({{1, {unit, unit, unit}}, {4, {unit, 3 * unit, unit}}}), form,
                             1, 50, 0),
                      expected);
        // A term whose weight is negligible, however wide it is; but it sets the profile's radius, and
        // with it where an arc is cut.
        if (form != PEL_FORM_ARC) {
            const Profile three =
                Profile::gaussians({{1, {1, 1, 1}}, {4, {1, 3, 1}}, {9, {tiny, tiny, tiny}}});
            const auto beside = texels(three, form, 1, 50, 0);
            for (size_t i = 0; i < beside.size(); ++i)
                EXPECT_NEAR(beside[i], expected[i], tolerance::lutTexelGaussians) << int(form) << ' ' << i;
        }
        // A width of almost 0 gives the light itself. A very large width leaves hardly any light where it
        // spreads along an arc, and even light where what there is stays on the circle or the sphere.
        const auto narrow = texels(Profile::gaussians({{tiny, {1, 1, 1}}}), form, 1, 50, 0);
        const auto wide = texels(Profile::gaussians({{most, {1, 1, 1}}}), form, 1, 50, 0);
        const double even = form == PEL_FORM_ARC ? 0 : form == PEL_FORM_SPHERE ? 0.25 : 1 / std::numbers::pi;
        // Within the cut.
        const double kept = form == PEL_FORM_ARC ? std::erf(10 / 2.7 / std::numbers::sqrt2) : 1;
        for (size_t i = 0; i < narrow.size(); ++i) {
            const double u = -1 + (double(i / 3 % 33) + 0.5) * 2 / 33;
            EXPECT_NEAR(narrow[i], kept * std::max(0.0, u), tolerance::lutTexelGaussians) << int(form);
            if (form != PEL_FORM_HALF_RING) {
                EXPECT_NEAR(wide[i], even, tolerance::lutTexelGaussians) << int(form);
            } else {  // the mean over the half circle round the point
                const double theta = std::acos(u);
                EXPECT_NEAR(wide[i], (1 + std::cos(theta)) / std::numbers::pi, tolerance::lutTexelGaussians);
            }
        }
    }
    const auto refused = [](auto make) {
        EXPECT_THROW(make(), Error);
        EXPECT_FALSE(std::string(pelGetErrorMessage()).empty());
    };
    refused([&] { Profile::gaussians({{INFINITY, {1, 1, 1}}}); });
    refused([&] { Profile::gaussians({{1, {most, INFINITY, 1}}}); });
    refused([&] { Profile::gaussians({{1, {0, 0, 0}}}); });
    refused([&] { Profile::table({0, 1}, {most, 1, 1, INFINITY, 1, 1}); });
}
