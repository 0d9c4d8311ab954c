// Look-up tables of measured profiles, R linear between distances.
#include "lut_cases.h"
#include "test_size.h"

using namespace pellucid;
using fixture::forms;

namespace {

std::vector<float> curvatureTexels(const Device& device, const Profile& profile, PelCurvatureForm form,
                                   uint32_t width, uint32_t height) {
    const auto desc = fixture::curvatureTable(profile, form, width, height, 0.05, 1000);
    return Lut(device, desc).read<float>(PEL_LUT_FLOAT);
}

}  // namespace

// 4096 distances on the corners and the straight lines of five: the same profile, by other meshes.
TEST(LutTables, MoreDistancesOnTheSameLinesChangeNothing) {
    const Device device("");
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
    for (const auto& [form, trueForm] : forms) {
        const auto texels = [&, form = form](const Profile& profile) {
            return curvatureTexels(device, profile, form, 33, sized(560u, 1u));
        };
        const auto one = texels(Profile::table(corners, R)),
                   other = texels(Profile::table(distances, values));
        for (size_t i = 0; i < one.size(); ++i)
            ASSERT_NEAR(one[i], other[i], tolerance::lutTexelOther)
                << "form " << int(form) << " texel " << i / 3;
    }
}

// Where a table has nothing within reach the result is the light itself.
TEST(LutTables, NothingWithinReachScattersNothing) {
    const Device device("");
    const Profile far = Profile::table({1, 1.5f, 2}, {0, 0, 0, 1, 1, 1, 0, 0, 0});
    for (PelCurvatureForm form : {PEL_FORM_RING, PEL_FORM_HALF_RING, PEL_FORM_SPHERE}) {
        const auto texels = curvatureTexels(device, far, form, 33, 2);  // the second row: r = 0.05 radii
        for (int x = 0; x < 33; ++x) {
            const double s = -1 + x / 16.0;
            const double light = std::max(0.0, s * std::abs(s));
            EXPECT_NEAR(texels[(33 + size_t(x)) * 3], light, tolerance::lutTexelOther);
        }
    }
}

TEST(LutTables, LimitsAreFiniteAndBounded) {
    const Device device("");
    const std::tuple<const char*, std::vector<float>, std::vector<float>> extremes[] = {
        {"ends in a step", {0.3f, 1, 3}, {3, 1, 1, 2, 1, 0.5f, 1, 1, 0.1f}},
        {"short", {0, 1e-30f}, {1, 1, 1, 1, 1, 1}},
        {"long", {1e15f, 1e18f}, {1, 1, 1, 1, 1, 1}},
        {"two distances far apart", {1e-6f, 1e6f}, {9, 9, 9, 0, 0, 0}}};
    for (const auto& [name, distances, values] : extremes) {
        const Profile profile = Profile::table(distances, values);
        for (const auto& [form, trueForm] : forms)
            for (float radius : {1e-30f, 1.0f, 1e30f}) {
                PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
                desc.width = 17;
                desc.height = 1;
                desc.form = form;
                desc.profile = profile.get();
                desc.diffusionRadius = 0;
                desc.radiusMin = desc.radiusMax = radius;
                for (float texel : Lut(device, desc).read<float>(PEL_LUT_FLOAT)) {
                    ASSERT_TRUE(std::isfinite(texel)) << name << " form " << int(form) << " r " << radius;
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
            ASSERT_TRUE(std::isfinite(texel)) << name;
            EXPECT_GE(texel, 0);
            EXPECT_LE(texel, 1 + tolerance::lutTexelOther);
        }
    }
}
