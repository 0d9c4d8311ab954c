// Bad and extreme input, through the shader, for every method: a finite result that is documented, or an
// error that says what is wrong.
#include <gtest/gtest.h>

#include <functional>

#include "diffusion/lit_ball.h"
#include "tolerances.h"

using namespace lit_ball;

namespace {

constexpr float notANumber = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

struct Way {
    const char* name;
    PelScattering scattering;
    uint32_t taps;
    bool gathers;  // from irradiance per pixel
};
constexpr Way ways[] = {{"pre-integrated", PEL_SCATTERING_PREINTEGRATED, 0, false},
                        {"separable", PEL_SCATTERING_SEPARABLE, 0, true},
                        {"disk", PEL_SCATTERING_SCREEN, 32, true},
                        {"screen", PEL_SCATTERING_SCREEN, 0, true},
                        {"light", PEL_SCATTERING_LIGHT, 0, true},
                        {"texture", PEL_SCATTERING_TEXTURE, 0, false},
                        {"auto", PEL_SCATTERING_AUTO, 0, true}};

constexpr uint32_t texels = 8;  // along a side of the scattered texture

struct Frame {
    Picture picture;
    LitBall ball;
    std::vector<float> normals, texture;
    float radius = 0.4f;  // of the profile; the ball has 2
    uint32_t materials = 1;

    explicit Frame(uint32_t side, uint32_t mapSide = 64)
        : picture(side, side), ball(makeBall(Form::parallel, normalized(Vec3{1, 0.2, 0.3}), mapSide)) {
        picture = pictureOf(ball, side);
        normals = picture.positions;
        for (float& n : normals) n /= float(lit_ball::radius);
        texture.assign(3 * texels * texels, 0.5f);
    }
    Frame(Picture p, uint32_t mapSide) : Frame(4, mapSide) {
        picture = std::move(p);
        normals.assign(picture.positions.size(), 0.0f);
        for (size_t i = 0; i < picture.pixels(); ++i) normals[3 * i + 2] = 1;
    }

    Lit shade(const Way& way) const {
        const Picture& p = picture;
        ShownImages images(device(), p.width, p.height);
        PelShaderOptions options = pelShaderOptionsDefaults();
        options.targetError = 1e-4f;
        images.shader.set(options);
        images.set(PEL_SLOT_POSITION, p.positions);
        images.set(PEL_SLOT_NORMAL_SHADING, normals);
        if (way.gathers) images.set(PEL_SLOT_IRRADIANCE, p.irradiance);
        images.set(PEL_SLOT_MATERIAL, p.ids);
        std::vector<float> uvs, curvature(p.pixels(), 0.5f);
        for (size_t i = 0; i < p.pixels(); ++i) uvs.insert(uvs.end(), {float(i % 7) / 7, float(i % 5) / 5});
        images.set(PEL_SLOT_CURVATURE, curvature);
        if (way.scattering == PEL_SCATTERING_TEXTURE) images.set(PEL_SLOT_UV, uvs);
        const Profile skin = Profile::skin();
        PelMaterial material = whiteMaterial(skin, way.scattering);
        material.scatterTaps = way.taps;
        material.diffusionRadius = radius;
        material.specular = 0;
        const Buffer light(device(), texture);
        for (uint32_t id = 1; id <= materials; ++id) {
            images.shader.setMaterial(id, material);
            if (way.scattering == PEL_SCATTERING_TEXTURE)
                images.shader.setScatteredTexture(
                    id, pellucid::imageDesc(light, PEL_FORMAT_RGB32F, texels, texels));
        }
        images.shader.set(std::vector<PelLight>{ball.light});
        if (!ball.maps.empty()) images.setMap(PEL_LIGHT_SHADOW_MAP, ball.maps[0], ball.width, ball.height);
        std::vector<float> result = images.execute();
        return {std::move(result), images.shader.stats(), images.shader.warnings()};
    }
};

std::string errorOf(const std::function<void()>& call) {
    try {
        call();
    } catch (const pellucid::Error& e) {
        EXPECT_EQ(e.code(), PEL_ERROR_INVALID_ARGUMENT) << e.what();
        return e.what();
    }
    return "";
}

void expectLight(const std::vector<float>& light, float most, const std::string& where) {
    for (size_t i = 0; i < light.size(); ++i)
        ASSERT_TRUE(light[i] >= 0 && light[i] <= most) << where << ", value " << i << ": " << light[i];
}

}  // namespace

// A pixel without a number in its light or normal is counted and black; its neighbours miss its light, and
// beyond the profile's reach nothing changes.
TEST(ScatterBadInput, NoNumberSpreadsNoFurtherThanTheProfile) {
    const Frame clean(sized(64u, 24u));
    const Picture& p = clean.picture;
    const double reach = reference::scatterReach(*reference::skinProfile()) * 0.4 / 2.7;
    const uint32_t side = p.width;
    const size_t bad = p.at(side * 5 / 8, side / 2);
    for (const Way& way : ways)
        for (const char* what : {"irradiance", "position", "normal"}) {
            if (what[0] == 'i' && !way.gathers) continue;
            Frame f = clean;
            (what[0] == 'i'   ? f.picture.irradiance
             : what[0] == 'p' ? f.picture.positions
                              : f.normals)[3 * bad + 1] = what[0] == 'p' ? infinity : notANumber;
            const Lit before = clean.shade(way), after = f.shade(way);
            const std::string where = std::string(way.name) + ", " + what;
            // If only scattering reads the position, the pixel keeps its irradiance.
            const bool keeps = what[0] == 'p' && way.scattering != PEL_SCATTERING_PREINTEGRATED;
            EXPECT_EQ(after.stats.pixelsInvalid, keeps ? 0u : 1u) << where;
            if (keeps && way.gathers) {
                EXPECT_EQ(after.light[3 * bad], f.picture.irradiance[3 * bad]) << where;
            }
            size_t far = 0;
            for (size_t i = 0; i < p.pixels(); ++i) {
                if (!p.ids[i]) continue;
                double distance2 = 0;
                for (size_t c = 0; c < 3; ++c)
                    distance2 += std::pow(double(p.positions[3 * i + c]) - p.positions[3 * bad + c], 2);
                // a block reaches further than its middle
                const bool beyond = std::sqrt(distance2) > 2.2 * reach;
                far += beyond;
                for (size_t c = 0; c < 3; ++c) {
                    ASSERT_TRUE(std::isfinite(after.light[3 * i + c])) << where << " " << i;
                    if (i != bad) {
                        ASSERT_NEAR(after.light[3 * i + c], before.light[3 * i + c],
                                    beyond ? 2e-6 : double(tolerance::scatterOneMissing))
                            << where << " " << i;
                    }
                }
            }
            EXPECT_GT(far, p.pixels() / 10);
        }
}

// A texel of a scattered texture without a number: its four neighbours' pixels and no others.
TEST(ScatterBadInput, NoNumberInATextureIsThatTexelsOwn) {
    const Frame clean(32);
    Frame f = clean;
    f.texture[3 * (texels * 3 + 3)] = notANumber;
    const Way& texture = ways[5];
    const Lit before = clean.shade(texture), after = f.shade(texture);
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
    const Frame clean(side);
    const double pixel = 2.2 * lit_ball::radius / side;
    for (const Way& way : ways) {
        for (float pixels : {1e-6f, 1e-3f, 1e3f, 1e6f}) {
            Frame f = clean;
            f.radius = std::max(float(pixels * pixel), 1e-6f);
            const Lit lit = f.shade(way);
            const std::string where = std::string(way.name) + ", " + std::to_string(pixels) + " pixels";
            expectLight(lit.light, 1.001f, where);
            EXPECT_EQ(lit.stats.pixelsInvalid, 0u) << where;
            if (pixels > 1e-2f || !way.gathers) continue;
            for (size_t i = 0; i < lit.light.size(); ++i)  // narrower than a pixel: nothing is scattered
                ASSERT_NEAR(lit.light[i], f.picture.ids[i / 3] ? f.picture.irradiance[i] : 0, 1e-4) << where;
        }
        Frame own = clean, same = clean;  // 0: the profile's own
        own.radius = 0, same.radius = float(Profile::skin().info().radius);
        EXPECT_EQ(own.shade(way).light, same.shade(way).light) << way.name;
        for (float bad : {-1.0f, 1e-8f, infinity, notANumber}) {
            Frame f = clean;
            f.radius = bad;
            const std::string error = errorOf([&] { f.shade(way); });
            EXPECT_NE(error.find("diffusionRadius"), std::string::npos) << way.name << ": " << error;
        }
    }
}

TEST(ScatterBadInput, PicturesOfOnePixel) {
    for (const Way& way : ways)
        for (const auto& [width, height] : {std::pair{1u, 1u}, {1u, 9u}, {9u, 1u}, {2u, 2u}})
            for (uint32_t mapSide : {1u, 16u}) {
                const Frame f(plane(width, height, 0.2,
                                    [](double x, double) {
                                        return Vec3{1, 0.5, x};
                                    }),
                              mapSide);
                const Lit lit = f.shade(way);
                const std::string where = std::string(way.name) + ", " + std::to_string(width) + " x " +
                                          std::to_string(height) + ", map of " + std::to_string(mapSide);
                expectLight(lit.light, 2, where);
                EXPECT_EQ(lit.stats.pixelsInvalid, 0u) << where;
                EXPECT_EQ(lit.stats.pixelsShaded, width * height) << where;
                if (width * height == 1 && way.gathers && way.scattering != PEL_SCATTERING_LIGHT) {
                    EXPECT_NEAR(lit.light[0], 1, 1e-5) << where;
                }
            }
}

TEST(ScatterBadInput, EveryPixelOfItsOwnId) {
    Frame f(plane(16, 15, 0.2, [](double x, double) { return Vec3{x / 4, 1, 0}; }), 16);
    f.ball.maps.clear();
    f.materials = 255;
    for (size_t i = 0; i < f.picture.pixels(); ++i) f.picture.ids[i] = uint8_t(1 + i % 255);
    for (const Way& way : ways) {
        const Lit lit = f.shade(way);
        expectLight(lit.light, 1.001f, way.name);
        EXPECT_EQ(lit.stats.pixelsInvalid, 0u) << way.name;
        for (size_t i = 0; way.gathers && i < lit.light.size(); ++i)
            ASSERT_NEAR(lit.light[i], f.picture.irradiance[i], 1e-6) << way.name << " " << i;
    }
}

// Empty maps, maps of NaN, and maps that look elsewhere: as if there were none; `light`, which takes all
// that is further than some pixels from its maps, only loses light.
TEST(ScatterBadInput, MapsWithoutTheObject) {
    const Frame clean(sized(40u, 20u));
    Frame without = clean;
    without.ball.maps.clear();
    for (const Way& way : ways)
        for (int kind = 0; kind < 4; ++kind) {
            Frame f = clean;
            std::vector<float>& map = f.ball.maps[0];
            if (kind < 3) map.assign(map.size(), kind == 0 ? 1.0f : kind == 1 ? 0.0f : notANumber);
            if (kind == 3) f.ball.light.worldToShadow[3] += 40;  // the ball is beside it
            const Lit lit = f.shade(way), none = without.shade(way);
            const std::string where = std::string(way.name) + ", map " + std::to_string(kind);
            expectLight(lit.light, 1.1f, where);
            EXPECT_EQ(lit.stats.pixelsInvalid, 0u) << where;
            if (way.gathers && way.scattering != PEL_SCATTERING_LIGHT && kind < 3) {
                EXPECT_EQ(lit.light, none.light) << where;
            }
        }
}
