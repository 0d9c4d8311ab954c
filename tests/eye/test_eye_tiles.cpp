// Eyes cost nothing where there are none, and bad input around them is an error by name or a finite picture.
#include <gtest/gtest.h>

#include "eye/eye_frame.h"
#include "refusal.h"

using namespace pellucid;
using eye_test::EyeFrame;

namespace {

void expectFinite(const std::vector<float>& picture) {
    size_t wrong = 0;
    for (const float v : picture) wrong += !std::isfinite(v);
    EXPECT_EQ(wrong, 0u);
}

}  // namespace

TEST(EyeTiles, TilesWithoutAnEyeHaveNoCodeForEyes) {
    EyeFrame frame;
    const std::vector<float> plain = frame.shade();
    EXPECT_EQ(frame.stats.tilesEye, 0u);
    EXPECT_EQ(frame.stats.variants, 1u);
    EXPECT_EQ(frame.stats.pixelsEye, 0u);
    const auto withEye = [](Shader& s) { s.setEye(2, pelEyeDefaults()); };
    const std::vector<float> eye = frame.shade(withEye);
    // Tiles of 128 x 2: the ball is 88 pixels high, in the last two columns of tiles.
    EXPECT_EQ(frame.stats.tilesShaded, 4u * 128);
    EXPECT_GE(frame.stats.tilesEye, 44u);
    EXPECT_LE(frame.stats.tilesEye, 2u * 46);
    EXPECT_EQ(frame.stats.tilesPartial, frame.stats.tilesShaded - frame.stats.tilesEye);
    EXPECT_EQ(frame.stats.variants, 2u);
    size_t changed = 0, pixels = 0;
    for (size_t i = 0; i < plain.size(); ++i) {
        if (frame.isEye(i / 3))
            changed += eye[i] != plain[i], ++pixels;
        else
            ASSERT_EQ(eye[i], plain[i]) << i / 3 % frame.width << ", " << i / 3 / frame.width;
    }
    EXPECT_EQ(frame.stats.pixelsEye, pixels / 3);
    EXPECT_GT(changed, pixels / 5);
    // All ways to find tiles give the same bits.
    EXPECT_EQ(frame.shade(withEye, PEL_TILES_PER_VARIANT), eye);
    EXPECT_EQ(frame.shade(withEye, PEL_TILES_NO_LIST), eye);
    EXPECT_EQ(frame.shade([&](Shader& s) { withEye(s), s.clearEye(2); }), plain);
}

TEST(EyeTiles, OutputsAddUp) {
    EyeFrame frame;
    const std::vector<float> alone = frame.shade([](Shader& s) { s.setEye(2, pelEyeDefaults()); });
    const Buffer diffuse(frame.device, std::vector<float>(alone.size())),
        specular(frame.device, std::vector<float>(alone.size()));
    const std::vector<float> picture = frame.shade([&](Shader& s) {
        s.setEye(2, pelEyeDefaults());
        s.set(PEL_SLOT_OUT_DIFFUSE, frame.image(diffuse));
        s.set(PEL_SLOT_OUT_SPECULAR, frame.image(specular));
    });
    EXPECT_EQ(picture, alone);
    const std::vector<float> d = diffuse.readAll<float>(), s = specular.readAll<float>();
    for (size_t i = 0; i < picture.size(); ++i)
        ASSERT_NEAR(d[i] + s[i], picture[i], 1e-5f * std::max(1.0f, picture[i]));
}

TEST(EyeTiles, NeedsWhatItReads) {
    expectRefused("by eyes", [] {
        EyeFrame().shade([](Shader& s) {
            PelMaterial dull = pelMaterialDefaults();
            dull.scattering = PEL_SCATTERING_NONE;
            s.setMaterial(1, dull).setEye(2, pelEyeDefaults());
            s.clear(PEL_SLOT_POSITION);
        });
    });
}

TEST(EyeTiles, BadInputGivesFiniteValues) {
    EyeFrame frame;
    const auto scale = [](PelEye& e, float by) {
        for (float* f : {&e.scleraRadius, &e.corneaRadius, &e.limbusRadius, &e.chamberDepth, &e.pupilRadius,
                         &e.limbusWidth})
            *f *= by;
    };
    struct Case {
        const char* name;
        std::function<void(PelEye&)> change;
        float lightZ = 0, cameraZ = 300;  // 0: a parallel light
    };
    const auto nothing = [](PelEye&) {};
    const Case cases[] = {
        {"a light inside the eye", nothing, 8},
        {"a light on the surface", nothing, 12},
        {"the camera inside the cornea", nothing, 0, 11},
        {"the camera at a pixel", nothing, 0, 12},
        {"an eye elsewhere", [](PelEye& e) { e.center[0] = 1e6f; }},
        {"a huge eye", [&](PelEye& e) { scale(e, 1e5f); }},
        {"a tiny eye", [&](PelEye& e) { scale(e, 1e-4f); }},
        {"a cornea as wide as it can be, an iris that nearly fills it",
         [](PelEye& e) {
             e.pupilRadius = std::nextafter(e.limbusRadius, 0.0f);
             e.irisRadius = e.limbusRadius;
         }},
        {"no pupil, no border", [](PelEye& e) { e.pupilRadius = e.limbusWidth = 0, e.limbusDarkening = 1; }}};
    for (const Case& bad : cases)
        for (bool two : {false, true}) {  // eyes in one place
            SCOPED_TRACE(bad.name);
            expectFinite(frame.shade([&](Shader& s) {
                PelEye eye = pelEyeDefaults();
                bad.change(eye);
                s.setEye(2, eye).set(pellucid::cameraAt({0, 0, bad.cameraZ}));
                if (two) s.setEye(1, pelEyeDefaults());
                if (bad.lightZ > 0) s.set(pellucid::pointLight({0, 0, bad.lightZ}, {1, 1, 1}));
            }));
            EXPECT_EQ(frame.stats.pixelsInvalid, 0u);
        }
}

// Pixels of an eye whose texture or surroundings are NaN or Inf show PelShaderOptions.invalidColor, wetness
// counts as the nearest of 0 and 1 (NaN as 0), and no other pixels change.
TEST(EyeTiles, NanInImagesOfEyesStaysInItsPixels) {
    EyeFrame frame;
    const float bad[] = {std::nanf(""), INFINITY, -INFINITY};
    const size_t pixels = frame.pixels();
    // Overwrites these floats of an image, which `set` gives to the shader.
    const auto expectLocal = [&](std::vector<float> values, std::initializer_list<size_t> faulty,
                                 size_t limit, const std::function<void(Shader&, const Buffer&)>& set) {
        const auto picture = [&] {
            const Buffer image(frame.device, values);
            return frame.shade([&](Shader& s) {
                s.setEye(2, pelEyeDefaults());
                set(s, image);
            });
        };
        const std::vector<float> clean = picture();
        size_t next = 0;
        for (const size_t at : faulty) values[at] = bad[next++ % 3];
        const std::vector<float> is = picture();
        expectFinite(is);
        size_t changed = 0;
        for (size_t k = 0; k < pixels; ++k) changed += is[3 * k] != clean[3 * k];
        EXPECT_GE(changed, 1u);
        EXPECT_LE(changed, limit);
        EXPECT_LE(frame.stats.pixelsInvalid, changed);
    };
    const size_t row = 128 * size_t(frame.width);
    // The last one lies on the wall, which has no tears.
    expectLocal(std::vector<float>(pixels), {row + 400, row + 409, row + 418, 100}, 3,
                [&](Shader& s, const Buffer& wetness) {
                    s.set(PEL_SLOT_WETNESS, imageDesc(wetness, PEL_FORMAT_R32F, frame.width, frame.height));
                });
    expectLocal(std::vector<float>(64 * 64 * 3, 0.3f), {3864, 3912, 3960},
                200,  // row 20, columns 8, 24, 40
                [](Shader& s, const Buffer& texture) {
                    PelAmbient ambient = pelAmbientDefaults();
                    std::fill_n(ambient.constant, 3, 0.5f);
                    s.set(ambient).setIrisTexture(2, imageDesc(texture, PEL_FORMAT_RGB32F, 64, 64));
                });
    expectLocal(std::vector<float>(4 * 24 * 3, 0.7f), {90, 210}, pixels / 4,
                [](Shader& s, const Buffer& cube) {
                    s.setReflectionCube(imageDesc(cube, PEL_FORMAT_RGB32F, 4, 24));
                });
}

// Light of the lids does not reach the eye, nor the other way: by every method that gathers on the screen.
// Within the sclera it does scatter.
TEST(EyeTiles, NothingBleedsBetweenEyeAndLid) {
    EyeFrame frame;
    const size_t pixels = frame.pixels();
    const Profile profile = Profile::skin();
    const auto shade = [&](PelScattering method, float onWall, float onEye) {
        std::vector<float> light(3 * pixels);
        for (size_t k = 0; k < pixels; ++k)
            for (size_t c = 0; c < 3; ++c)
                light[3 * k + c] = frame.isEye(k) ? (k % frame.width / 4 % 2 ? onEye : 0) : onWall;
        const Buffer irradiance(frame.device, light);
        return frame.shade([&](Shader& s) {
            PelMaterial m = pelMaterialDefaults();
            m.profile = profile.get();
            m.scattering = method;
            s.setMaterial(1, m).setMaterial(2, m).setEye(2, pelEyeDefaults());
            s.set(PEL_SLOT_IRRADIANCE, frame.image(irradiance));
        });
    };
    for (const PelScattering method :
         {PEL_SCATTERING_SEPARABLE, PEL_SCATTERING_SCREEN, PEL_SCATTERING_AUTO}) {
        SCOPED_TRACE(method);
        const std::vector<float> dark = shade(method, 0, 1), bright = shade(method, 9, 1),
                                 off = shade(method, 9, 0);
        const std::vector<float> sharp = shade(PEL_SCATTERING_NONE, 0, 1);
        size_t scattered = 0;
        float bled = 0, wall = 0;  // largest change
        for (size_t i = 0; i < dark.size(); ++i) {
            const bool eye = frame.isEye(i / 3);
            if (eye) bled = std::max(bled, std::abs(dark[i] - bright[i]));
            scattered += eye && std::abs(dark[i] - sharp[i]) > 0.02f;
            if (!eye) wall = std::max(wall, std::abs(bright[i] - off[i]));
        }
        // Sums over neighbours round by what others there are.
        EXPECT_LE(bled, 1e-5f);
        EXPECT_LE(wall, 9e-5f);
        EXPECT_GT(scattered, 5000u);
    }
}
