// PelLut through the public interface: descriptions, packing, texels from outside, errors.
#include <gtest/gtest.h>

#include <pellucid/pellucid.hpp>

#include <cmath>
#include <limits>

#include "test_size.h"
#include "tolerances.h"

using namespace pellucid;

namespace {

constexpr float notANumber = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

// Expects an error whose message holds the name of the field.
template <class Desc>
void expectRefused(const Device& device, const Desc& desc, const char* field) {
    try {
        Lut lut(device, desc);
        FAIL() << "accepted a wrong " << field;
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), PEL_ERROR_INVALID_ARGUMENT);
        EXPECT_NE(std::string(e.what()).find(field), std::string::npos) << e.what();
    }
}

float fromHalf(uint16_t bits) {
    const int exponent = bits >> 10 & 31, mantissa = bits & 1023;
    const float value =
        exponent ? std::ldexp(float(mantissa + 1024), exponent - 25) : std::ldexp(float(mantissa), -24);
    return bits >> 15 ? -value : value;
}

}  // namespace

TEST(LutApi, RefusesWhatMakesNoSense) {
    const Device device("");
    auto curvature = [&](auto change, const char* field) {
        PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
        change(desc);
        expectRefused(device, desc, field);
    };
    curvature([](auto& d) { d.width = 0; }, "width");
    curvature([](auto& d) { d.height = 16385; }, "height");
    curvature([](auto& d) { d.form = PelCurvatureForm(99); }, "form");
    curvature([](auto& d) { d.axis = PelLutAxis(7); }, "axis");
    curvature([](auto& d) { d.diffusionRadius = -1; }, "diffusionRadius");
    curvature([](auto& d) { d.diffusionRadius = infinity; }, "diffusionRadius");
    curvature([](auto& d) { d.radiusMin = -1; }, "radiusMin");
    curvature([](auto& d) { d.radiusMin = notANumber; }, "radiusMin");
    curvature([](auto& d) { d.radiusMax = notANumber; }, "radiusMax");
    curvature([](auto& d) { d.radiusMin = 2 * d.radiusMax; }, "radiusMin");
    auto shadow = [&](auto change, const char* field) {
        PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
        change(desc);
        expectRefused(device, desc, field);
    };
    shadow([](auto& d) { d.width = 16385; }, "width");
    shadow([](auto& d) { d.height = 0; }, "height");
    shadow([](auto& d) { d.diffusionRadius = -2; }, "diffusionRadius");
    shadow([](auto& d) { d.widthMin = -1; }, "widthMin");
    shadow([](auto& d) { d.widthMax = infinity; }, "widthMax");
    shadow([](auto& d) { d.widthMin = 200; }, "widthMin");
    shadow([](auto& d) { d.sharpening = 0.5f; }, "sharpening");
    shadow([](auto& d) { d.sharpening = notANumber; }, "sharpening");

    const PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    PelLut lut = nullptr;
    EXPECT_EQ(pelCurvatureLutCreate(nullptr, &desc, &lut, nullptr), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(pelCurvatureLutCreate(device.get(), nullptr, &lut, nullptr), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(pelCurvatureLutCreate(device.get(), &desc, nullptr, nullptr), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(lut, nullptr);
}

// What is left out follows from the profile, as in the tables that a material makes.
TEST(LutApi, LengthsThatAreLeftOutAreTheProfiles) {
    const Device device("");
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
            const PelCurvatureLutDesc madeC = Lut(device, c).info().curvature;
            const PelShadowLutDesc madeS = Lut(device, s).info().shadow;
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
        for (const Lut& lut : {Lut(device, c), Lut(device, s)})
            for (float v : lut.read<float>(PEL_LUT_FLOAT))
                ASSERT_TRUE(v >= 0 && v <= 1) << radius << ": " << v;
    }
    // A range that ends before it begins, once the rest is known, is named.
    PelCurvatureLutDesc reversed = pelCurvatureLutDescDefaults();
    reversed.radiusMin = 1e5f;
    expectRefused(device, reversed, "radiusMax");
    PelShadowLutDesc narrow = pelShadowLutDescDefaults();
    narrow.widthMax = 0.1f;
    expectRefused(device, narrow, "widthMin");
}

// A program whose header had neither closed ends nor axes of shadow tables means those that it knew.
TEST(LutApi, WhatAnOlderHeaderLacksIsAsItWas) {
    PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
    desc.structSize = offsetof(PelShadowLutDesc, closedEnds);
    desc.closedEnds = 1, desc.axis = PEL_AXIS_ROOT;  // beyond its end
    const PelShadowLutDesc made = Lut(Device(""), desc).info().shadow;
    EXPECT_EQ(made.closedEnds, 0u);
    EXPECT_EQ(made.axis, PEL_AXIS_LINEAR);
}

TEST(LutApi, InfoSizesAndRanges) {
    const Device device("");
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.width = 20;
    desc.height = 10;
    desc.radiusMax = 40;
    const Lut lut(device, desc);
    const PelLutInfo info = lut.info();
    EXPECT_EQ(info.kind, PEL_LUT_CURVATURE);
    EXPECT_EQ(info.curvature.width, 20u);
    EXPECT_EQ(info.curvature.height, 10u);
    EXPECT_EQ(info.curvature.radiusMax, 40);
    size_t bytes = 0;
    check(pelLutGetSize(lut.get(), PEL_LUT_FLOAT, &bytes));
    EXPECT_EQ(bytes, 20u * 10 * 12);
    check(pelLutGetSize(lut.get(), PEL_LUT_HALF, &bytes));
    EXPECT_EQ(bytes, 20u * 10 * 6);
    check(pelLutGetSize(lut.get(), PEL_LUT_FACEWORKS8, &bytes));
    EXPECT_EQ(bytes, 20u * 10 * 4);
    EXPECT_EQ(pelLutGetSize(lut.get(), PelLutEncoding(9), &bytes), PEL_ERROR_INVALID_ARGUMENT);
    std::vector<float> texels(20 * 10 * 3);
    EXPECT_EQ(pelLutRead(lut.get(), PEL_LUT_FLOAT, texels.data(), 20 * 10 * 12 - 1, nullptr),
              PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(pelLutRead(lut.get(), PEL_LUT_FLOAT, nullptr, 20 * 10 * 12, nullptr),
              PEL_ERROR_INVALID_ARGUMENT);
}

TEST(LutApi, HalfIsTheNearestHalf) {
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.width = 64;
    desc.height = 32;
    const Lut lut(Device(""), desc);
    const auto texels = lut.read<float>(PEL_LUT_FLOAT);
    const auto halves = lut.read<uint16_t>(PEL_LUT_HALF);
    ASSERT_EQ(halves.size(), texels.size());
    for (size_t i = 0; i < texels.size(); ++i) {
        const double error = std::abs(double(fromHalf(halves[i])) - texels[i]);
        const double below =
            std::abs(double(fromHalf(uint16_t(std::max(1, int(halves[i])) - 1))) - texels[i]);
        const double above = std::abs(double(fromHalf(halves[i] + 1)) - texels[i]);
        EXPECT_LE(error, std::min(below, above)) << i << ": " << texels[i];
    }
}

TEST(LutApi, TexelsFromOutsideComeBackBitForBit) {
    const Device device("");
    PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
    desc.width = 31;
    desc.height = 7;
    const Lut lut(device, desc);
    const auto texels = lut.read<float>(PEL_LUT_FLOAT);
    const PelLutInfo info = lut.info();
    EXPECT_EQ(info.kind, PEL_LUT_SHADOW);
    const Lut copy(device, info, texels);
    EXPECT_EQ(copy.read<float>(PEL_LUT_FLOAT), texels);
    EXPECT_EQ(copy.read<uint8_t>(PEL_LUT_FACEWORKS8), lut.read<uint8_t>(PEL_LUT_FACEWORKS8));
    EXPECT_EQ(copy.info().shadow.sharpening, info.shadow.sharpening);

    std::vector<float> broken = texels;
    broken[(3 * 31 + 5) * 3 + 1] = notANumber;
    EXPECT_THROW(Lut(device, info, broken), Error);
    EXPECT_NE(std::string(pelGetErrorMessage()).find("(5, 3)"), std::string::npos) << pelGetErrorMessage();
    broken.pop_back();
    EXPECT_THROW(Lut(device, info, broken), Error);
    PelLutInfo wrong = info;
    wrong.kind = PelLutKind(7);
    EXPECT_THROW(Lut(device, wrong, texels), Error);
    wrong = info;
    wrong.shadow.widthMin = -1;
    EXPECT_THROW(Lut(device, wrong, texels), Error);
}

TEST(LutApi, SubmittedWorkFinishesWithItsEvent) {
    const Device device("");
    const PelCurvatureLutDesc desc = sizedTable(pelCurvatureLutDescFaceWorks());
    const auto expected = Lut(device, desc).read<float>(PEL_LUT_FLOAT);
    PelEvent made = nullptr, read = nullptr;
    const PelSubmit make{nullptr, 0, &made};
    const Lut lut(device, desc, &make);
    std::vector<float> texels(expected.size());
    const PelSubmit then{&made, 1, &read};
    check(pelLutRead(lut.get(), PEL_LUT_FLOAT, texels.data(), texels.size() * sizeof(float), &then));
    check(pelEventWait(read));
    EXPECT_EQ(texels, expected);
    pelEventRelease(made);
    pelEventRelease(read);
}
