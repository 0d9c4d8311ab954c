// Outputs beside radiance: parts that add up to it and change no bit of it.
#include <gtest/gtest.h>

#include <limits>

#include "shade_scene.h"
#include "tolerances.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::imageDesc;
using pellucid::Shader;

namespace {

struct Shaded {
    std::vector<float> radiance, diffuse, deepScatter, specular, thickness;
    PelShaderStats stats = pelShaderStatsDefaults();
};

// RGB float32 over zeros; -1 in the thickness of pixels that are left alone.
Shaded shadeParts(const Frame& f) {
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    const size_t bytes = f.pixels() * 12;
    const Buffer targets[4] = {Buffer(device(), bytes), Buffer(device(), bytes), Buffer(device(), bytes),
                               Buffer(device(), bytes)};
    const Buffer thickness(device(), std::vector<float>(f.pixels(), -1));
    const PelImageSlot slots[4] = {PEL_SLOT_RADIANCE, PEL_SLOT_OUT_DIFFUSE, PEL_SLOT_OUT_DEEP_SCATTER,
                                   PEL_SLOT_OUT_SPECULAR};
    for (int i = 0; i < 4; ++i)
        shader.set(slots[i], imageDesc(targets[i], PEL_FORMAT_RGB32F, f.width, f.height));
    shader.set(PEL_SLOT_OUT_THICKNESS, imageDesc(thickness, PEL_FORMAT_R32F, f.width, f.height));
    shader.commit().execute();
    return {targets[0].readAll<float>(), targets[1].readAll<float>(), targets[2].readAll<float>(),
            targets[3].readAll<float>(), thickness.readAll<float>(),  shader.stats()};
}

Frame partsFrame(uint32_t seed) {
    Frame f = randomFrame(seed, 211, 60, 2);
    for (auto& [id, m] : f.materials) {
        m.deepScatterAmbient = 0.3f;
        m.specularModel = id == 2 ? PEL_SPECULAR_GGX : PEL_SPECULAR_KSK;
    }
    if (seed % 2) {
        f.slots[PEL_SLOT_THICKNESS] = f.slots[PEL_SLOT_AMBIENT_OCCLUSION];
        for (float& t : f.slots[PEL_SLOT_THICKNESS].values) t *= 60;
    }
    return f;
}

TEST(ShadeOutputs, EachMatchesTheOracleAndRadianceStaysWhatItIs) {
    for (uint32_t seed : {1u, 2u}) {
        const Frame f = partsFrame(seed);
        const Shaded shaded = shadeParts(f);
        if (seed == 2) {
            EXPECT_EQ(shaded.radiance, shade(device(), f, tables())) << "to the bit";
        }
        EXPECT_TRUE(shaded.stats.features & PEL_FEATURE_OUTPUTS);
        for (size_t i = 0; i < f.pixels(); ++i) {
            if (f.slots[PEL_SLOT_MATERIAL].values[i] == 0) {
                EXPECT_EQ(shaded.thickness[i], -1) << "background is left alone";
                continue;
            }
            const reference::Shaded truth = shade_test::truth(f, tables(), i);
            const Rgb diffuse = truth.scattered + truth.ambient;
            const PelMaterial& m = f.materials.at(uint32_t(f.slots[PEL_SLOT_MATERIAL].at(i)));
            EXPECT_NEAR(shaded.thickness[i], truthLight(f, m, f.lights[0], i).thickness,
                        tolerance::shadeThickness)
                << i;
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(shaded.diffuse[3 * i + c], diffuse[c], tolerance::shadeSum);
                EXPECT_NEAR(shaded.deepScatter[3 * i + c], truth.deepScatter[c], tolerance::shadeTerm);
                EXPECT_NEAR(shaded.specular[3 * i + c], truth.specular[c], tolerance::shadeTerm);
            }
        }
    }
}

TEST(ShadeOutputs, ThicknessThatNothingMeasuresIsZero) {
    Frame f = partsFrame(2);
    for (auto& light : f.lights) light.mapSize = 0, light.map.values.clear();
    const Shaded none = shadeParts(f);
    for (size_t i = 0; i < f.pixels(); ++i)
        EXPECT_EQ(none.thickness[i], f.slots[PEL_SLOT_MATERIAL].values[i] == 0 ? -1 : 0) << i;
}

TEST(ShadeOutputs, OneAloneInHalf) {
    const Frame f = partsFrame(2);
    const Shaded all = shadeParts(f);
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    const Buffer radiance(device(), f.pixels() * 12), specular(device(), f.pixels() * 8),
        thickness(device(), f.pixels() * 2);
    shader.set(PEL_SLOT_RADIANCE, imageDesc(radiance, PEL_FORMAT_RGB32F, f.width, f.height));
    shader.set(PEL_SLOT_OUT_SPECULAR, imageDesc(specular, PEL_FORMAT_RGBA16F, f.width, f.height));
    shader.set(PEL_SLOT_OUT_THICKNESS, imageDesc(thickness, PEL_FORMAT_R16F, f.width, f.height));
    shader.commit().execute();
    EXPECT_EQ(radiance.readAll<float>(), all.radiance);
    const auto toFloat = [](uint16_t h) {
        const double value =
            std::ldexp((h & 0x3ff) + (h & 0x7c00 ? 0x400 : 0), std::max(h >> 10 & 31, 1) - 25);
        return h & 0x8000 ? -value : value;
    };
    const auto s = specular.readAll<uint16_t>(), t = thickness.readAll<uint16_t>();
    for (size_t i = 0; i < f.pixels(); ++i) {
        const bool background = f.slots[PEL_SLOT_MATERIAL].values[i] == 0;
        EXPECT_NEAR(toFloat(s[4 * i]), all.specular[3 * i], std::abs(all.specular[3 * i]) * 0x1p-11 + 1e-7);
        EXPECT_NEAR(toFloat(t[i]), background ? 0 : all.thickness[i],
                    std::abs(all.thickness[i]) * 0x1p-11 + 1e-7);
    }
}

TEST(ShadeOutputs, BadPixelsAndBadInput) {
    Frame f = partsFrame(1);
    f.options.invalidColor[2] = -7;
    const size_t bad = f.height / 2 * f.width + 50;
    f.slots[PEL_SLOT_MATERIAL].values[bad] = 1;
    f.slots[PEL_SLOT_NORMAL_SHADING].values[3 * bad] = std::numeric_limits<float>::quiet_NaN();
    const Shaded shaded = shadeParts(f);
    for (const auto* part : {&shaded.radiance, &shaded.diffuse, &shaded.deepScatter, &shaded.specular}) {
        EXPECT_EQ((*part)[3 * bad + 2], -7);
        for (float v : *part) EXPECT_TRUE(std::isfinite(v));
    }
    EXPECT_EQ(shaded.thickness[bad], 0);

    Shader shader(device());
    setFrame(device(), shader, f, tables());
    const Buffer one(device(), f.pixels() * 12), two(device(), f.pixels() * 12);
    shader.set(PEL_SLOT_RADIANCE, imageDesc(one, PEL_FORMAT_RGB32F, f.width, f.height));
    shader.set(PEL_SLOT_OUT_DIFFUSE, imageDesc(one, PEL_FORMAT_RGB32F, f.width - 1, f.height));
    EXPECT_THROW(shader.commit(), pellucid::Error) << "another size";
    PelImageDesc shifted = imageDesc(two, PEL_FORMAT_R32F, f.width, f.height, 4);
    shader.clear(PEL_SLOT_OUT_DIFFUSE)
        .set(PEL_SLOT_OUT_SPECULAR, imageDesc(two, PEL_FORMAT_RGB32F, f.width, f.height));
    shader.set(PEL_SLOT_OUT_THICKNESS, shifted);
    EXPECT_THROW(shader.commit(), pellucid::Error) << "outputs over each other";
    EXPECT_NE(std::string(pelGetErrorMessage()).find("overlap"), std::string::npos) << pelGetErrorMessage();
    EXPECT_THROW(shader.set(PEL_SLOT_OUT_THICKNESS, imageDesc(two, PEL_FORMAT_R8_UNORM, f.width, f.height)),
                 pellucid::Error);
    EXPECT_THROW(shader.set(PEL_SLOT_OUT_DIFFUSE, imageDesc(two, PEL_FORMAT_RG32F, f.width, f.height)),
                 pellucid::Error);
    PelMaterial m = fixture::faceworksMaterial();
    m.specularModel = PelSpecularModel(2);
    EXPECT_THROW(shader.setMaterial(1, m), pellucid::Error);
}

// --- the oracle's GGX against what is known of it ---

TEST(ReferenceGgx, IsReciprocalAndLosesWhatMaskingTakes) {
    using namespace reference;
    const Vec3 n{0, 0, 1};
    const auto direction = [](double cosine, double angle) {
        const double s = std::sqrt(1 - cosine * cosine);
        return Vec3{s * std::cos(angle), s * std::sin(angle), cosine};
    };
    // What one bounce leaves, by another method: the mean of G2 (V.H) / ((N.V) (N.H)) over half vectors drawn
    // from D cos.
    for (const auto& [a, left] : {std::pair{0.1, 0.9867}, {0.3, 0.8678}, {0.8, 0.4441}}) {
        const Vec3 l = direction(0.7, 0.3), v = direction(0.4, 2.1);
        EXPECT_NEAR(ggxLobe(n, l, v, a), ggxLobe(n, v, l, a), tolerance::oracleExact);
        double out = 0;
        const int steps = 600;
        for (int i = 0; i < steps; ++i)
            for (int j = 0; j < steps; ++j) {
                const Vec3 to = direction((i + 0.5) / steps, 2 * 3.14159265358979323846 * (j + 0.5) / steps);
                out += specularGgx(n, to, direction(0.9, 0), a, a, 0, 1, 1) * 2 / (double(steps) * steps);
            }
        EXPECT_NEAR(out, left, tolerance::ggxEnergy) << a;
    }
}

}  // namespace
