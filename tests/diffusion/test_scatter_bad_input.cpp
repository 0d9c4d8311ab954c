// Bad and extreme input, through the shader, for every method: a finite, documented result, or an error that
// says what is wrong. Also the values that the controls of scattering accept.
#include "diffusion/lit_ball.h"
#include "test.h"

using namespace lit_ball;
using pellucid::Shader;
using pellucid::TextureScatter;

namespace {

struct Way {
    const char* name;
    PelScattering scattering;
    uint32_t taps;
    bool gathers;  // from irradiance per pixel
};
constexpr Way everyWay[] = {{"pre-integrated", PEL_SCATTERING_PREINTEGRATED, 0, false},
                            {"separable", PEL_SCATTERING_SEPARABLE, 0, true},
                            {"disk", PEL_SCATTERING_SCREEN, 32, true},
                            {"screen", PEL_SCATTERING_SCREEN, 0, true},
                            {"light", PEL_SCATTERING_LIGHT, 0, true},
                            {"texture", PEL_SCATTERING_TEXTURE, 0, false},
                            {"auto", PEL_SCATTERING_AUTO, 0, true}};

constexpr uint32_t texels = 8;  // along a side of the scattered texture

// A ball of 2 mm under a light with its map, by a narrow skin.
Frame frame(uint32_t side, uint32_t mapSide = 64) {
    Frame f = frameOf({makeBall(Form::parallel, {1, 0.2, 0.3}, mapSide)}, side, PEL_SCATTERING_AUTO, 0.4f);
    f.options.targetError = 1e-4f;
    return f;
}

// Another picture under the same light.
Frame frame(const Picture& p, uint32_t mapSide) {
    Frame f(p, PEL_SCATTERING_AUTO), like = frame(4, mapSide);
    f.lamps = like.lamps, f.options = like.options;
    f.material.diffusionRadius = 0.4f;
    return f;
}

Shown shade(Frame f, const Way& way) {
    f.material.scattering = way.scattering;
    f.material.scatterTaps = way.taps;
    f.giveIrradiance = way.gathers;
    const size_t pixels = f.picture.pixels();
    f.images[PEL_SLOT_CURVATURE].assign(pixels, 0.5f);
    if (way.scattering == PEL_SCATTERING_TEXTURE) {
        std::vector<float>& uvs = f.images[PEL_SLOT_UV];
        for (size_t i = 0; i < pixels; ++i) uvs.insert(uvs.end(), {float(i % 7) / 7, float(i % 5) / 5});
        if (f.texture.empty()) f.texture.assign(3 * texels * texels, 0.5f);
    }
    return f.shade();
}

void expectLight(const std::vector<float>& light, float most, const std::string& where) {
    for (size_t i = 0; i < light.size(); ++i)
        ASSERT_TRUE(light[i] >= 0 && light[i] <= most) << where << ", value " << i << ": " << light[i];
}

}  // namespace

// A pixel with NaN or Inf in its light or normal is counted and black; its neighbours lack its light, and
// beyond the profile's reach nothing changes.
TEST(ScatterBadInput, NoNumberSpreadsNoFurtherThanTheProfile) {
    const Frame clean = frame(sized(64u, 24u));
    const Picture& p = clean.picture;
    const double reach = reference::scatterReach(*reference::skinProfile()) * 0.4 / 2.7;
    const size_t bad = p.at(p.width * 5 / 8, p.width / 2);
    size_t component = 0;  // another one each time
    for (const Way& way : everyWay) {
        const Shown before = shade(clean, way);
        ++component;
        for (const std::string what : {"irradiance", "position", "normal"}) {
            const bool position = what == "position";
            if (what == "irradiance" && !way.gathers) continue;
            Frame f = clean;
            (what == "irradiance" ? f.picture.irradiance
             : position           ? f.picture.positions
                                  : f.images[PEL_SLOT_NORMAL_SHADING])[3 * bad + component % 3] =
                position ? infinity : notANumber;
            const Shown after = shade(f, way);
            const std::string where = std::string(way.name) + ", " + what;
            // If only scattering reads the position, the pixel keeps its irradiance.
            const bool keeps = position && way.scattering != PEL_SCATTERING_PREINTEGRATED;
            EXPECT_EQ(after.stats.pixelsInvalid, keeps ? 0u : 1u) << where;
            if (keeps && way.gathers) {
                EXPECT_EQ(after.light[3 * bad], f.picture.irradiance[3 * bad]) << where;
            }
            size_t far = 0;
            for (size_t i = 0; i < p.pixels(); ++i) {
                // a block reaches further than its middle
                const bool beyond = length(p.place(i) - p.place(bad)) > 2.2 * reach;
                far += p.ids[i] && beyond;
                for (size_t k = 3 * i; p.ids[i] && k < 3 * i + 3; ++k) {
                    ASSERT_TRUE(std::isfinite(after.light[k])) << where << " " << i;
                    if (i != bad) {
                        ASSERT_NEAR(after.light[k], before.light[k],
                                    beyond ? 2e-6 : double(tolerance::scatterOneMissing))
                            << where << " " << i;
                    }
                }
            }
            EXPECT_GT(far, p.pixels() / 10);
        }
    }
}

// A texel of a scattered texture with NaN affects the pixels that read it, and no others.
TEST(ScatterBadInput, NoNumberInATextureIsThatTexelsOwn) {
    Frame f = frame(32);
    const Way& texture = everyWay[5];
    const Shown before = shade(f, texture);
    f.texture.assign(3 * texels * texels, 0.5f);
    f.texture[3 * (texels * 3 + 3)] = notANumber;
    const Shown after = shade(f, texture);
    EXPECT_GT(after.stats.pixelsInvalid, 0u);
    EXPECT_LT(after.stats.pixelsInvalid, after.stats.pixelsShaded / 4);
    size_t changed = 0;
    for (size_t i = 0; i < after.light.size(); ++i) {
        ASSERT_TRUE(std::isfinite(after.light[i]));
        changed += i % 3 == 0 && after.light[i] != before.light[i];
    }
    EXPECT_EQ(changed, after.stats.pixelsInvalid);
}

TEST(ScatterBadInput, RadiiFromAMillionthToAMillionPixels) {
    const uint32_t side = sized(48u, 16u);
    const double pixel = 2.2 * lit_ball::radius / side;
    for (const Way& way : everyWay) {
        Frame f = frame(side);
        for (float pixels : {1e-6f, 1e-3f, 1e3f, 1e6f}) {
            f.material.diffusionRadius = std::max(float(pixels * pixel), 1e-6f);
            const Shown lit = shade(f, way);
            const std::string where = std::string(way.name) + ", " + std::to_string(pixels) + " pixels";
            expectLight(lit.light, 1.001f, where);
            EXPECT_EQ(lit.stats.pixelsInvalid, 0u) << where;
            if (pixels < 1e-2f && way.gathers) {  // nothing is scattered
                EXPECT_LE(difference(f.picture, lit.light, f.picture.irradiance).most, 1e-4) << where;
            }
        }
        Frame same = f;  // 0: the profile's own
        f.material.diffusionRadius = 0, same.material.diffusionRadius = float(f.profile.info().radius);
        EXPECT_EQ(shade(f, way).light, shade(same, way).light) << way.name;
    }
}

TEST(ScatterBadInput, PicturesOfOnePixel) {
    const auto light = [](double x, double) { return Vec3{1, 0.5, x}; };
    const std::tuple<uint32_t, uint32_t, uint32_t, float> pictures[] = {{1, 1, 1, 0.4f},  {1, 1, 16, 1e-6f},
                                                                        {1, 1, 16, 1e6f}, {1, 9, 16, 1e6f},
                                                                        {9, 1, 1, 0.4f},  {2, 2, 16, 1e-6f}};
    for (const Way& way : everyWay)
        for (const auto& [width, height, mapSide, radius] : pictures) {
            Frame f = frame(plane(width, height, 0.2, light), mapSide);
            f.material.diffusionRadius = radius;
            const Shown lit = shade(f, way);
            const std::string where = std::string(way.name) + ", " + std::to_string(width) + " x " +
                                      std::to_string(height) + ", map of " + std::to_string(mapSide);
            expectLight(lit.light, 2, where);
            EXPECT_EQ(lit.stats.pixelsInvalid, 0u) << where;
            EXPECT_EQ(lit.stats.pixelsShaded, width * height) << where;
            if (width * height == 1 && radius < 1 && way.gathers && way.scattering != PEL_SCATTERING_LIGHT) {
                EXPECT_NEAR(lit.light[0], 1, 1e-5) << where;
            }
        }
}

TEST(ScatterBadInput, EveryPixelOfItsOwnId) {
    Frame f = frame(plane(16, 15, 0.2, [](double x, double) { return Vec3{x / 4, 1, 0}; }), 16);
    f.lamps[0].maps.clear();
    f.materials = 255;
    for (size_t i = 0; i < f.picture.pixels(); ++i) f.picture.ids[i] = uint8_t(1 + i % 255);
    for (const Way& way : everyWay) {
        const Shown lit = shade(f, way);
        expectLight(lit.light, 1.001f, way.name);
        EXPECT_EQ(lit.stats.pixelsInvalid, 0u) << way.name;
        if (way.gathers) {
            EXPECT_LE(difference(f.picture, lit.light, f.picture.irradiance).most, 1e-6) << way.name;
        }
    }
}

// Empty maps, maps of NaN, and maps that point elsewhere count as absent; `light`, which takes all light from
// beyond some pixels from its maps, only loses light.
TEST(ScatterBadInput, MapsWithoutTheObject) {
    const Frame clean = frame(sized(40u, 20u));
    Frame without = clean;
    without.lamps[0].maps.clear();
    for (const Way& way : everyWay) {
        const Shown none = shade(without, way);
        for (int kind = 0; kind < 4; ++kind) {
            Frame f = clean;
            std::vector<float>& map = f.lamps[0].maps[0];
            if (kind < 3) map.assign(map.size(), kind == 0 ? 1.0f : kind == 1 ? 0.0f : notANumber);
            if (kind == 3) f.lamps[0].light.worldToShadow[3] += 40;  // the ball is beside it
            const Shown lit = shade(f, way);
            const std::string where = std::string(way.name) + ", map " + std::to_string(kind);
            expectLight(lit.light, 1.1f, where);
            EXPECT_EQ(lit.stats.pixelsInvalid, 0u) << where;
            const bool byLight = way.scattering == PEL_SCATTERING_LIGHT;
            if (way.gathers && !byLight && kind < 3) {
                EXPECT_EQ(lit.light, none.light) << where;
            }
            if (kind < 3 || !(byLight || way.scattering == PEL_SCATTERING_AUTO)) continue;
            for (size_t i = 0; i < f.picture.pixels(); ++i)  // light of maps falls on nobody else
                if (f.picture.ids[i] &&
                    dot(f.picture.place(i), normalized(Vec3{1, 0.2, 0.3})) < -0.5 * radius) {
                    ASSERT_NEAR(lit.light[3 * i], 0, 0.02) << where << " " << i;
                }
        }
    }
}

// Ranges of fields: test_field_ranges.
TEST(ScatterControls, WhatAMethodCannotDoIsRefused) {
    Frame f(plane(8, 8, 1, [](double, double) { return Vec3{}; }), PEL_SCATTERING_SCREEN);
    f.material.borderColor[0] = 1;
    expectRefused(PEL_ERROR_UNSUPPORTED, {"scatterTaps of 8 to 256"}, [&] { f.shade(); });
    f.material.scatterTaps = 16;
    f.shade();
    f.material = whiteMaterial(Profile(), PEL_SCATTERING_SCREEN);
    f.material.thinThickness = 1;  // nothing comes from behind
    for (PelScattering method : {PEL_SCATTERING_SCREEN, PEL_SCATTERING_PREINTEGRATED}) {
        f.material.scattering = method;
        expectRefused("thinThickness", [&] { f.shade(); });
    }
}

TEST(ScatterControls, OfAPelScatterAreChecked) {
    const Picture p = plane(8, 8, 1, [](double, double) { return Vec3{}; });
    Scatter scatter(device());
    const auto setControls = [&](auto field, auto value) {
        PelScatterControls controls = pelScatterControlsDefaults();
        controls.*field = value;
        scatter.setControls(1, controls);
    };
    expectRefused("material 1 is not set", [&] { scatter.setControls(1, pelScatterControlsDefaults()); });
    scatter.setMaterial(1, Profile::skin());
    using Controls = PelScatterControls;
    expectRefused("PEL_SCATTERING_SEPARABLE",
                  [&] { setControls(&Controls::scattering, PEL_SCATTERING_LIGHT); });
    expectRefused("scatterTaps is 300", [&] { setControls(&Controls::scatterTaps, 300u); });
    expectRefused("albedoBefore is 2", [&] { setControls(&Controls::albedoBefore, 2.0f); });
    expectRefused("thinThickness", [&] { setControls(&Controls::thinThickness, notANumber); });
    for (float scale : {-1.0f, infinity, notANumber, 1e20f})
        expectRefused("profile", [&] { scatter.setMaterial(1, Profile::skin(), scale); });
    expectRefused("1 to 255", [&] { scatter.setMaterial(256, Profile::skin()); });
    const auto rgb = [](const Buffer& b, uint32_t side = 8) {
        return pellucid::imageDesc(b, PEL_FORMAT_RGB32F, side, side);
    };
    const auto grey = imageOf(device(), std::vector<float>(16), 4, 4);
    expectRefused("not a slot of a PelScatter", [&] { scatter.set(PEL_SLOT_CURVATURE, grey); });
    expectRefused("albedo", [&] { scatter.set(PEL_SLOT_ALBEDO, grey); });
    scatter.clear(PEL_SLOT_ALBEDO);
    const Buffer light(device(), p.irradiance), places(device(), p.positions);
    const PelImageDesc image = rgb(light), at = rgb(places), other = rgb(places, 4);
    const auto execute = [&](const PelImageDesc* positions, const PelImageDesc& out) {
        scatter.execute(p.params, image, positions, nullptr, nullptr, out);
    };
    expectRefused("either `positions` or `depth`", [&] { execute(nullptr, image); });
    expectRefused("4 x 4", [&] { execute(&other, image); });
    expectRefused("overlaps", [&] { execute(&image, image); });
    execute(&at, image);
    // Over the positions' own memory by another name.
    std::vector<float> host(3 * 64);
    const Buffer first = Buffer::fromHost(device(), host.data(), host.size() * 4),
                 second = Buffer::fromHost(device(), host.data(), host.size() * 4);
    const PelImageDesc from = rgb(first);
    expectRefused("overlaps", [&] { execute(&from, rgb(second)); });
    PelScatterParams params = pelScatterParamsDefaults();
    params.targetError = notANumber;
    expectRefused("targetError", [&] { scatter.execute(params, image, at, nullptr, nullptr, image); });
}

TEST(ScatterControls, OfTexturesAreChecked) {
    Shader shader(device());
    const auto color = imageOf(device(), std::vector<float>(48), 4, 4),
               grey = imageOf(device(), std::vector<float>(16), 4, 4);
    expectRefused("material 3 is not set", [&] { shader.setScatteredTexture(3, color); });
    shader.setMaterial(3, pelMaterialDefaults());
    shader.setScatteredTexture(3, color).clearScatteredTexture(3);
    expectRefused("scattered texture", [&] { shader.setScatteredTexture(3, grey); });
    const float uvs[] = {0, 0, 1, 0, 0, 1}, far[] = {0, 0, 1, 0, 0, notANumber};
    const uint32_t triangle[] = {0, 1, 2}, beyond[] = {0, 1, 3};
    PelTextureScatterDesc desc = pelTextureScatterDescDefaults();
    const auto make = [&] { TextureScatter(device(), desc); };
    expectRefused("0 x 0 texels", make);
    desc.width = 8, desc.height = 4;
    make();
    desc.numVertices = 3, desc.numIndices = 3;
    expectRefused("indices is NULL", make);
    desc.indices = triangle;
    expectRefused("uvs is NULL", make);
    desc.uvs = uvs;
    EXPECT_EQ(TextureScatter(device(), desc).stats().texelsTotal, 32u);
    desc.uvStride = 4;
    expectRefused("uvStride is 4", make);
    desc.uvStride = 0, desc.numIndices = 2;
    expectRefused("no multiple of 3", make);
    desc.numIndices = 3, desc.indices = beyond;
    expectRefused("triangle 0 has the vertex 3 of 3", make);
    desc.indices = triangle, desc.uvs = far;
    expectRefused("vertex 2 has the texture coordinates", make);
}
