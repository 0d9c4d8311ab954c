// PelLut through the public interface: descriptions, sizes, texels from outside, errors.
#include "lut_cases.h"

using namespace pellucid;

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
    // A range that is reversed once the profile's lengths are filled in.
    curvature("radiusMax", [](auto& d) { d = pelCurvatureLutDescDefaults(), d.radiusMin = 1e5f; });
    shadow("widthMin", [](auto& d) { d = pelShadowLutDescDefaults(), d.widthMax = 0.1f; });
    const PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    PelLut lut = nullptr;
    EXPECT_EQ(pelCurvatureLutCreate(nullptr, &desc, &lut, nullptr), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(pelCurvatureLutCreate(device().get(), nullptr, &lut, nullptr), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(lut, nullptr);
}

// Omitted values follow from the profile, as in the tables that a material makes.
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

// A program whose header had neither closed ends nor axes of shadow tables gets the tables of that header.
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
    std::fill_n(wrong.profile, sizeof wrong.profile, 'x');
    EXPECT_EQ(Lut(device(), wrong, texels).info().profile[63], '\0');
    wrong.kind = PelLutKind(7);
    EXPECT_THROW(Lut(device(), wrong, texels), Error);
    wrong = info;
    wrong.shadow.widthMin = -1;
    EXPECT_THROW(Lut(device(), wrong, texels), Error);
}

// Each table of a stack has the same bits as when made alone, also if launches end between tables, and
// together with tabulated profiles, which are made one by one.
TEST(LutApi, TablesOfAStackAreThoseOfTheirOwn) {
    const Profile tabulated = Profile::table({0, 1, 2, 4}, {9, 8, 7, 4, 3, 2, 1, .5f, .2f, 0, 0, 0}),
                  narrow = Profile::burleyDistance({0.3f, 0.2f, 0.1f}), skin = Profile::skin();
    const auto compare = [&](std::vector<PelLutInfo> stack, PelLutEncoding encoding) {
        std::vector<uint8_t> expected;
        for (const PelLutInfo& info : stack) {
            const Lut lut =
                info.kind == PEL_LUT_CURVATURE ? Lut(device(), info.curvature) : Lut(device(), info.shadow);
            const auto texels = lut.read<uint8_t>(encoding);
            expected.insert(expected.end(), texels.begin(), texels.end());
        }
        std::vector<uint8_t> texels(expected.size() + 1, 77);
        Lut::readStack(device(), stack, encoding, texels.data(), expected.size());
        EXPECT_EQ(texels.back(), 77);
        texels.pop_back();
        EXPECT_TRUE(texels == expected) << encoding;
    };
    PelLutInfo info = pelLutInfoDefaults();
    for (const auto& [width, height] : {std::pair(1u, 1u), {33, 18}, {90, 70}})
        for (PelLutAxis axis : {PEL_AXIS_LINEAR, PEL_AXIS_ROOT}) {
            SCOPED_TRACE(testing::Message() << width << " x " << height << ", axis " << axis);
            std::vector<PelLutInfo> curvature, shadow;
            for (int i = 0; i < 12; ++i) {
                const Profile& profile = i == 5 ? tabulated : i % 3 == 1 ? narrow : skin;
                info.kind = PEL_LUT_CURVATURE;
                info.curvature = pelCurvatureLutDescDefaults();
                info.curvature.width = width, info.curvature.height = height, info.curvature.axis = axis;
                info.curvature.profile = profile.get();
                info.curvature.diffusionRadius = i % 4 == 2 ? 0.5f * float(i) : 0;
                curvature.push_back(info);
                info.kind = PEL_LUT_SHADOW;
                info.shadow = pelShadowLutDescDefaults();
                info.shadow.width = width, info.shadow.height = height, info.shadow.axis = axis;
                info.shadow.profile = profile.get();
                info.shadow.sharpening = 1 + float(i);
                info.shadow.closedEnds = axis == PEL_AXIS_ROOT;
                shadow.push_back(info);
            }
            for (PelLutEncoding encoding : {PEL_LUT_FLOAT, PEL_LUT_HALF, PEL_LUT_FACEWORKS8}) {
                compare(curvature, encoding);
                compare(shadow, encoding);
            }
            for (PelCurvatureForm form : {PEL_FORM_ARC, PEL_FORM_HALF_RING}) {
                for (PelLutInfo& one : curvature) one.curvature.form = form;
                compare(curvature, PEL_LUT_HALF);
            }
        }
}

TEST(LutApi, StacksRefuseWhatMakesNoSense) {
    PelLutInfo info = pelLutInfoDefaults();
    info.kind = PEL_LUT_SHADOW;
    info.curvature.width = info.curvature.height = info.shadow.width = info.shadow.height = 8;
    std::vector<char> texels(2 * 8 * 8 * 12);
    const auto refused = [&](const char* field, auto change) {
        std::vector<PelLutInfo> stack{info, info};
        size_t bytes = texels.size();
        change(stack, bytes);
        expectRefused(field, [&] { Lut::readStack(device(), stack, PEL_LUT_FLOAT, texels.data(), bytes); });
    };
    refused("1535", [](auto&, size_t& bytes) { bytes -= 1; });
    refused("kind", [](auto& stack, size_t&) { stack[1].kind = PEL_LUT_CURVATURE; });
    refused("width", [](auto& stack, size_t&) { stack[1].shadow.width = 7; });
    refused("height", [](auto& stack, size_t&) { stack[1].shadow.height = 7; });
    refused("axis", [](auto& stack, size_t&) { stack[1].shadow.axis = PEL_AXIS_ROOT; });
    refused("closedEnds", [](auto& stack, size_t&) { stack[1].shadow.closedEnds = 1; });
    refused("sharpening", [](auto& stack, size_t&) { stack[1].shadow.sharpening = NAN; });
    refused("structSize", [](auto& stack, size_t&) { stack[1].structSize = 3; });
    refused("form", [](auto& stack, size_t&) {
        stack[0].kind = stack[1].kind = PEL_LUT_CURVATURE;
        stack[1].curvature.form = PEL_FORM_RING;
    });
    for (const PelLutKind kind : {PEL_LUT_SPECULAR, PEL_LUT_EYE})
        refused("kind", [&](auto& stack, size_t&) { stack[0].kind = stack[1].kind = kind; });
    EXPECT_EQ(pelLutReadStack(device().get(), &info, 1, PEL_LUT_FLOAT, nullptr, 0),
              PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(pelLutReadStack(device().get(), nullptr, 1, PEL_LUT_FLOAT, texels.data(), texels.size()),
              PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(pelLutReadStack(device().get(), nullptr, 0, PEL_LUT_FLOAT, texels.data(), 0), PEL_SUCCESS);
}
