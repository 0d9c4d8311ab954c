// PelLut through the public interface: descriptions, sizes, texels from outside, errors.
#include "lut_cases.h"

using namespace pellucid;

namespace {

const Device& device() {
    static const Device device("");
    return device;
}

}  // namespace

TEST(LutApi, RefusesWhatMakesNoSense) {
    const auto curvature = [&](const char* field, auto change) {
        PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
        change(desc);
        expectRefused(field, [&] { Lut(device(), desc); });
    };
    curvature("width", [](auto& d) { d.width = 0; });
    curvature("height", [](auto& d) { d.height = 16385; });
    curvature("form", [](auto& d) { d.form = PelCurvatureForm(99); });
    curvature("axis", [](auto& d) { d.axis = PelLutAxis(7); });
    curvature("diffusionRadius", [](auto& d) { d.diffusionRadius = -1; });
    curvature("diffusionRadius", [](auto& d) { d.diffusionRadius = INFINITY; });
    curvature("radiusMin", [](auto& d) { d.radiusMin = -1; });
    curvature("radiusMin", [](auto& d) { d.radiusMin = NAN; });
    curvature("radiusMin", [](auto& d) { d.radiusMin = 2 * d.radiusMax; });
    curvature("radiusMax", [](auto& d) { d.radiusMax = NAN; });
    const auto shadow = [&](const char* field, auto change) {
        PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
        change(desc);
        expectRefused(field, [&] { Lut(device(), desc); });
    };
    shadow("width", [](auto& d) { d.width = 16385; });
    shadow("height", [](auto& d) { d.height = 0; });
    shadow("diffusionRadius", [](auto& d) { d.diffusionRadius = -2; });
    shadow("widthMin", [](auto& d) { d.widthMin = -1; });
    shadow("widthMin", [](auto& d) { d.widthMin = 200; });
    shadow("widthMax", [](auto& d) { d.widthMax = INFINITY; });
    shadow("sharpening", [](auto& d) { d.sharpening = 0.5f; });
    shadow("sharpening", [](auto& d) { d.sharpening = NAN; });
    // A range that ends before it begins, once the profile's lengths are known.
    curvature("radiusMax", [](auto& d) { d = pelCurvatureLutDescDefaults(), d.radiusMin = 1e5f; });
    shadow("widthMin", [](auto& d) { d = pelShadowLutDescDefaults(), d.widthMax = 0.1f; });
    const PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    PelLut lut = nullptr;
    EXPECT_EQ(pelCurvatureLutCreate(nullptr, &desc, &lut, nullptr), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(pelCurvatureLutCreate(device().get(), nullptr, &lut, nullptr), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(lut, nullptr);
}

// What is left out follows from the profile, as in the tables that a material makes.
TEST(LutApi, LengthsThatAreLeftOutAreTheProfiles) {
    for (const char* name : {"skin", "marble"}) {
        const Profile profile = Profile::named(name);
        const PelProfileInfo lengths = profile.info();
        PelCurvatureLutDesc c = pelCurvatureLutDescDefaults();
        PelShadowLutDesc s = pelShadowLutDescDefaults();
        EXPECT_EQ(c.diffusionRadius + c.radiusMin + c.radiusMax + s.diffusionRadius + s.widthMin + s.widthMax,
                  0);
        c.profile = s.profile = profile.get();
        for (float stretch : {1.0f, 0.1f}) {
            if (stretch != 1) c.diffusionRadius = s.diffusionRadius = stretch * lengths.radius;
            const PelCurvatureLutDesc madeC = Lut(device(), c).info().curvature;
            const PelShadowLutDesc madeS = Lut(device(), s).info().shadow;
            const float scale = stretch * lengths.radius;
            EXPECT_EQ(madeC.form, PEL_FORM_SPHERE);
            EXPECT_FLOAT_EQ(madeC.diffusionRadius, scale);
            EXPECT_FLOAT_EQ(madeC.radiusMin, 0.25f * scale);
            EXPECT_FLOAT_EQ(madeC.radiusMax, 1000 * scale);
            EXPECT_FLOAT_EQ(madeS.widthMin,
                            1.3f * stretch * *std::max_element(lengths.width, lengths.width + 3));
            EXPECT_FLOAT_EQ(madeS.widthMax, 1000 * madeS.widthMin);
            EXPECT_EQ(madeS.closedEnds, 1u);
        }
    }
    // Any radius there may be.
    for (float radius : {1e-38f, 1e-6f, 1e6f, 1e38f}) {
        PelCurvatureLutDesc c = pelCurvatureLutDescDefaults();
        PelShadowLutDesc s = pelShadowLutDescDefaults();
        c.width = c.height = s.width = s.height = 8;
        c.diffusionRadius = s.diffusionRadius = radius;
        for (const Lut& lut : {Lut(device(), c), Lut(device(), s)})
            for (float v : lut.read<float>(PEL_LUT_FLOAT))
                ASSERT_TRUE(v >= 0 && v <= 1) << radius << ": " << v;
    }
}

// A program whose header had neither closed ends nor axes of shadow tables means those that it knew.
TEST(LutApi, WhatAnOlderHeaderLacksIsAsItWas) {
    PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
    desc.structSize = offsetof(PelShadowLutDesc, closedEnds);
    desc.closedEnds = 1, desc.axis = PEL_AXIS_ROOT;  // beyond its end
    const PelShadowLutDesc made = Lut(device(), desc).info().shadow;
    EXPECT_EQ(made.closedEnds, 0u);
    EXPECT_EQ(made.axis, PEL_AXIS_LINEAR);
}

TEST(LutApi, InfoSizesAndRanges) {
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.width = 20;
    desc.height = 10;
    desc.radiusMax = 40;
    const Lut lut(device(), desc);
    const PelLutInfo info = lut.info();
    EXPECT_EQ(info.kind, PEL_LUT_CURVATURE);
    EXPECT_EQ(info.curvature.width, 20u);
    EXPECT_EQ(info.curvature.height, 10u);
    EXPECT_EQ(info.curvature.radiusMax, 40);
    size_t bytes = 0;
    for (auto [encoding, size] :
         {std::pair(PEL_LUT_FLOAT, 12u), {PEL_LUT_HALF, 6}, {PEL_LUT_FACEWORKS8, 4}}) {
        check(pelLutGetSize(lut.get(), encoding, &bytes));
        EXPECT_EQ(bytes, 20 * 10 * size);
    }
    EXPECT_EQ(pelLutGetSize(lut.get(), PelLutEncoding(9), &bytes), PEL_ERROR_INVALID_ARGUMENT);
    std::vector<float> texels(20 * 10 * 3);
    EXPECT_EQ(pelLutRead(lut.get(), PEL_LUT_FLOAT, texels.data(), 20 * 10 * 12 - 1, nullptr),
              PEL_ERROR_INVALID_ARGUMENT);
}

TEST(LutApi, TexelsFromOutsideComeBackBitForBit) {
    PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
    desc.width = 31;
    desc.height = 7;
    const Lut lut(device(), desc);
    const auto texels = lut.read<float>(PEL_LUT_FLOAT);
    const PelLutInfo info = lut.info();
    EXPECT_EQ(info.kind, PEL_LUT_SHADOW);
    const Lut copy(device(), info, texels);
    EXPECT_EQ(copy.read<float>(PEL_LUT_FLOAT), texels);
    EXPECT_EQ(copy.read<uint8_t>(PEL_LUT_FACEWORKS8), lut.read<uint8_t>(PEL_LUT_FACEWORKS8));
    EXPECT_EQ(copy.info().shadow.sharpening, info.shadow.sharpening);

    std::vector<float> broken = texels;
    broken[(3 * 31 + 5) * 3 + 1] = NAN;
    expectRefused("(5, 3)", [&] { Lut(device(), info, broken); });
    broken.pop_back();
    EXPECT_THROW(Lut(device(), info, broken), Error);
    PelLutInfo wrong = info;
    wrong.kind = PelLutKind(7);
    EXPECT_THROW(Lut(device(), wrong, texels), Error);
    wrong = info;
    wrong.shadow.widthMin = -1;
    EXPECT_THROW(Lut(device(), wrong, texels), Error);
}
