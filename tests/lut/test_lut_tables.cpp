// Look-up tables of measured profiles, R linear between distances, against the oracle.
#include <random>

#include "lut_cases.h"
#include "test_size.h"

using namespace pellucid;
using fixture::forms;

namespace {

struct Table {
    const char* name;
    std::vector<float> distances, values;

    Profile ours() const { return Profile::table(distances, values); }
    reference::ProfilePtr truth() const {
        std::vector<double> d(distances.begin(), distances.end());
        std::vector<reference::Rgb> R;
        for (size_t i = 0; i < d.size(); ++i)
            R.push_back({values[3 * i], values[3 * i + 1], values[3 * i + 2]});
        return reference::tableProfile(d, R);
    }
};

std::vector<Table> tables() {
    std::vector<Table> all{
        {"smooth", {0, 0.5f, 1, 2, 4}, {9, 8, 7, 4, 3, 2, 1, .5f, .2f, .2f, .05f, .01f, 0, 0, 0}},
        {"ends in a step", {0.3f, 1, 3}, {3, 1, 1, 2, 1, 0.5f, 1, 1, 0.1f}},
        {"disk", {1, 2}, {1, 1, 1, 1, 1, 1}},
        {"hollow", {0, 0.9f, 1, 1.2f, 3}, {0.1f, 0.01f, 1, 0.1f, 0.02f, 1, 5, 1, 0.2f, 0, 0.1f, 0, 0, 0, 0}}};
    std::mt19937 random(17);
    std::uniform_real_distribution<float> even(0, 1);
    Table noise{"noise", {}, {}}, measured{"measured", {}, {}};
    for (int i = 0; i < 20; ++i) {
        noise.distances.push_back(float(i) + 0.5f * even(random));
        for (int c = 0; c < 3; ++c) noise.values.push_back(even(random));
    }
    // Like a measurement of Burley's profile: logarithmic distances, three decades of R.
    for (int i = 0; i < 40; ++i) {
        const float d = 0.01f * std::pow(10.0f, 3.2f * float(i) / 39);
        measured.distances.push_back(d);
        for (float decay : {1.0f, 0.6f, 0.3f}) measured.values.push_back(std::exp(-d / decay) / d);
    }
    all.push_back(noise);
    all.push_back(measured);
    return all;
}

}  // namespace

TEST(LutTables, EveryFormEqualsTheIntegral) {
    const Device device("");
    for (const Table& table : tables()) {
        const Profile ours = table.ours();
        const auto truth = table.truth();
        EXPECT_NEAR(ours.info().radius / truth->radius(), 1, tolerance::profileEvaluation);
        for (const auto& [form, trueForm] : forms) {
            const PelCurvatureLutDesc desc =
                fixture::curvatureTable(ours, form, sized(60u, 9u), sized(16u, 3u), 0.05, 1e4);
            const auto texels = Lut(device, desc).read<float>(PEL_LUT_FLOAT);
            std::mt19937 random(5);
            for (int i = 0; i < 40; ++i) {
                const int x = int(random() % desc.width), y = i % int(desc.height);
                const double s = -1 + 2.0 * x / (desc.width - 1), u = s * std::abs(s);
                const double first = std::sqrt(1 / double(desc.radiusMax)),
                             last = std::sqrt(1 / double(desc.radiusMin));
                const double c = std::pow(first + y / (desc.height - 1.0) * (last - first), 2);
                const reference::Rgb D = reference::curvatureD(trueForm, *truth, u, 1 / c);
                for (int k = 0; k < 3; ++k) {
                    const double error = std::abs(texels[(size_t(y) * desc.width + x) * 3 + k] - D[k]);
                    EXPECT_LT(error, tolerance::lutTexelOther)
                        << table.name << " form " << int(form) << " u " << u << " r/radius "
                        << 1 / c / truth->radius() << " channel " << k << " truth " << D[k];
                }
            }
        }
    }
}

TEST(LutTables, ShadowEqualsTheIntegral) {
    const Device device("");
    for (const Table& table : tables()) {
        const Profile ours = table.ours();
        const auto truth = table.truth();
        const double radius = truth->radius();
        for (auto [least, most, sharpening] : {std::tuple{2.0, 40.0, 1.0f},
                                               {0.05, 1000.0, 1.0f},
                                               {2.0, 40.0, 10.0f},
                                               {0.5, 40.0, 4.0f},
                                               {1.0, 10.0, 1e5f}}) {
            const int width = sized(41, 9), height = sized(9, 3);
            const PelShadowLutDesc desc =
                fixture::shadowTable(ours, uint32_t(width), uint32_t(height), least, most, sharpening);
            const auto texels = Lut(device, desc).read<float>(PEL_LUT_FLOAT);
            const reference::ShadowLutSpec spec{width,         height, desc.widthMin,
                                                desc.widthMax, radius, sharpening};
            for (int y = 0; y < height; y += 2)
                for (int x = y % 3; x < width; x += 4) {
                    const auto T = reference::shadowTexel(spec, *truth, x, y);
                    for (int k = 0; k < 3; ++k) {
                        const double error =
                            std::abs(texels[(size_t(y) * size_t(width) + size_t(x)) * 3 + k] - T[k]);
                        EXPECT_LT(error, tolerance::lutTexelOther)
                            << table.name << " (" << x << ", " << y << ") sharpening " << sharpening
                            << " widths " << least << " to " << most << " truth " << T[k];
                    }
                }
        }
    }
}

namespace {

std::vector<float> curvatureTexels(const Device& device, const Profile& profile, PelCurvatureForm form,
                                   uint32_t width, uint32_t height) {
    return Lut(device, fixture::curvatureTable(profile, form, width, height, 0.05, 1000)).read<float>(PEL_LUT_FLOAT);
}

}  // namespace

// 4096 distances on the corners and the straight lines of five: the same profile, by other meshes.
TEST(LutTables, MoreDistancesOnTheSameLinesChangeNothing) {
    const Device device("");
    const Table few = tables()[0];
    Table many{"many", {}, {}};
    for (size_t i = 0; i + 1 < few.distances.size(); ++i)
        for (int j = 0; j < 1023; ++j) {
            const float t = float(j) / 1023;
            many.distances.push_back(few.distances[i] + t * (few.distances[i + 1] - few.distances[i]));
            for (size_t c = 0; c < 3; ++c)
                many.values.push_back(few.values[3 * i + c] +
                                      t * (few.values[3 * i + 3 + c] - few.values[3 * i + c]));
        }
    many.distances.push_back(few.distances.back());
    many.values.insert(many.values.end(), {0, 0, 0});
    for (const auto& [form, name] : forms) {
        const auto one = curvatureTexels(device, few.ours(), form, 33, sized(560u, 1u)),
                   other = curvatureTexels(device, many.ours(), form, 33, sized(560u, 1u));
        for (size_t i = 0; i < one.size(); ++i)
            ASSERT_NEAR(one[i], other[i], tolerance::lutTexelOther)
                << "form " << int(form) << " texel " << i / 3;
    }
}

TEST(LutTables, MeanOverTheSphereIsAQuarter) {
    const Device device("");
    for (const Table& table : tables())
        fixture::expectMeansOfAQuarter(
            curvatureTexels(device, table.ours(), PEL_FORM_SPHERE, 2049, sized(8u, 1u)), 2049, table.name);
}

// Where a table has nothing within reach the result is the light itself.
TEST(LutTables, NothingWithinReachScattersNothing) {
    const Device device("");
    const Profile far = Profile::table({1, 1.5f, 2}, {0, 0, 0, 1, 1, 1, 0, 0, 0});
    for (PelCurvatureForm form : {PEL_FORM_RING, PEL_FORM_HALF_RING, PEL_FORM_SPHERE}) {
        const auto texels = curvatureTexels(device, far, form, 33, 2);  // the second row: r = 0.05 radii
        for (int x = 0; x < 33; ++x) {
            const double s = -1 + x / 16.0;
            EXPECT_NEAR(texels[(33 + size_t(x)) * 3], std::max(0.0, s * std::abs(s)), tolerance::lutTexelOther);
        }
    }
}

TEST(LutTables, LimitsAreFiniteAndBounded) {
    const Device device("");
    for (const Table& table : {tables()[1], Table{"short", {0, 1e-30f}, {1, 1, 1, 1, 1, 1}},
                               Table{"long", {1e15f, 1e18f}, {1, 1, 1, 1, 1, 1}},
                               Table{"two of far apart", {1e-6f, 1e6f}, {9, 9, 9, 0, 0, 0}}}) {
        const Profile profile = table.ours();
        for (const auto& [form, name] : forms)
            for (float radius : {1e-30f, 1.0f, 1e30f}) {
                PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
                desc.width = 17;
                desc.height = 1;
                desc.form = form;
                desc.profile = profile.get();
                desc.diffusionRadius = 0;
                desc.radiusMin = desc.radiusMax = radius;
                for (float texel : Lut(device, desc).read<float>(PEL_LUT_FLOAT)) {
                    ASSERT_TRUE(std::isfinite(texel)) << table.name << " form " << int(form) << " r " << radius;
                    EXPECT_GE(texel, 0);
                    EXPECT_LE(texel, 1 + tolerance::lutTexelOther);
                }
            }
        PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
        desc.width = 17;
        desc.height = 5;
        desc.profile = profile.get();
        desc.widthMin = 1e-30f;
        desc.widthMax = 1e30f;
        for (float texel : Lut(device, desc).read<float>(PEL_LUT_FLOAT)) {
            ASSERT_TRUE(std::isfinite(texel)) << table.name;
            EXPECT_GE(texel, 0);
            EXPECT_LE(texel, 1 + tolerance::lutTexelOther);
        }
    }
}
