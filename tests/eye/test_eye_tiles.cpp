// Eyes cost nothing where there are none, and bad input around them is an error by name or a finite picture.
#include <gtest/gtest.h>

#include "eye/eye_frame.h"

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
    EyeFrame frame;
    try {
        frame.shade([](Shader& s) {
            PelMaterial dull = pelMaterialDefaults();
            dull.scattering = PEL_SCATTERING_NONE;
            s.setMaterial(1, dull).setEye(2, pelEyeDefaults());
            s.clear(PEL_SLOT_POSITION);
        });
        FAIL() << "no position";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), PEL_ERROR_INVALID_ARGUMENT);
        EXPECT_NE(std::string(e.what()).find("by eyes"), std::string::npos) << e.what();
    }
}

TEST(EyeTiles, BadInputGivesFiniteValues) {
    EyeFrame frame;
    const std::pair<const char*, std::function<void(Shader&)>> cases[] = {
        {"a light inside the eye",
         [](Shader& s) {
             PelLight light = pelLightDefaults();
             light.type = PEL_LIGHT_POINT;
             light.position[2] = 8;
             s.set(std::vector{light});
         }},
        {"a light on the surface",
         [](Shader& s) {
             PelLight light = pelLightDefaults();
             light.type = PEL_LIGHT_POINT;
             light.position[2] = 12;
             s.set(std::vector{light});
         }},
        {"the camera inside the cornea",
         [](Shader& s) {
             PelCamera camera = pelCameraDefaults();
             camera.position[2] = 11;
             s.set(camera);
         }},
        {"the camera at a pixel",
         [](Shader& s) {
             PelCamera camera = pelCameraDefaults();
             camera.position[2] = 12;
             s.set(camera);
         }},
        {"an eye elsewhere",
         [](Shader& s) {
             PelEye eye = pelEyeDefaults();
             eye.center[0] = 1e6f;
             s.setEye(2, eye);
         }},
        {"a huge eye",
         [](Shader& s) {
             PelEye eye = pelEyeDefaults();
             for (float* f : {&eye.scleraRadius, &eye.corneaRadius, &eye.limbusRadius, &eye.chamberDepth,
                              &eye.pupilRadius})
                 *f *= 1e5f;
             s.setEye(2, eye);
         }},
        {"a tiny eye",
         [](Shader& s) {
             PelEye eye = pelEyeDefaults();
             for (float* f : {&eye.scleraRadius, &eye.corneaRadius, &eye.limbusRadius, &eye.chamberDepth,
                              &eye.pupilRadius, &eye.limbusWidth})
                 *f *= 1e-4f;
             s.setEye(2, eye);
         }},
        {"a cornea as wide as it can be, an iris that nearly fills it",
         [](Shader& s) {
             PelEye eye = pelEyeDefaults();
             eye.pupilRadius = std::nextafter(eye.limbusRadius, 0.0f);
             eye.irisRadius = eye.limbusRadius;
             s.setEye(2, eye);
         }},
        {"two eyes in one place",
         [](Shader& s) {
             s.setEye(1, pelEyeDefaults());
             s.setEye(2, pelEyeDefaults());
         }},
        {"no pupil, no border",
         [](Shader& s) {
             PelEye eye = pelEyeDefaults();
             eye.pupilRadius = eye.limbusWidth = 0;
             eye.limbusDarkening = 1;
             s.setEye(2, eye);
         }},
    };
    for (const auto& bad : cases) {
        SCOPED_TRACE(bad.first);
        expectFinite(frame.shade([&](Shader& s) {
            s.setEye(2, pelEyeDefaults());
            bad.second(s);
        }));
        EXPECT_EQ(frame.stats.pixelsInvalid, 0u);
    }
}

// Pixels of an eye whose texture or surroundings are NaN or Inf show PelShaderOptions.invalidColor, wetness
// counts as the nearest of 0 and 1 (NaN as 0), and no other pixels change.
TEST(EyeTiles, NanInImagesOfEyesStaysInItsPixels) {
    EyeFrame frame;
    const float bad[] = {std::nanf(""), INFINITY, -INFINITY};
    const auto withEye = [](Shader& s) { s.setEye(2, pelEyeDefaults()); };
    const size_t pixels = frame.pixels();
    // At least one pixel and at most `limit` change.
    const auto sameBeyond = [&](const std::vector<float>& is, const std::vector<float>& should,
                                size_t limit) {
        expectFinite(is);
        size_t changed = 0;
        for (size_t k = 0; k < pixels; ++k) changed += is[3 * k] != should[3 * k];
        EXPECT_GE(changed, 1u);
        EXPECT_LE(changed, limit);
        EXPECT_LE(frame.stats.pixelsInvalid, changed);
    };
    std::vector<float> wet(pixels);
    const Buffer even(frame.device, wet);
    const auto wetFrame = [&](const Buffer& wetness) {
        return frame.shade([&](Shader& s) {
            withEye(s);
            s.set(PEL_SLOT_WETNESS, imageDesc(wetness, PEL_FORMAT_R32F, frame.width, frame.height));
        });
    };
    const std::vector<float> dry = wetFrame(even);
    for (int i = 0; i < 3; ++i) wet[128 * frame.width + 400 + 9 * i] = bad[i];
    wet[100] = bad[0];  // on the wall, which has no tears
    sameBeyond(wetFrame(Buffer(frame.device, wet)), dry, 3);

    const auto textured = [&](const std::vector<float>& texels) {
        const Buffer texture(frame.device, texels);
        return frame.shade([&](Shader& s) {
            withEye(s);
            PelAmbient ambient = pelAmbientDefaults();
            ambient.constant[0] = ambient.constant[1] = ambient.constant[2] = 0.5f;
            s.set(ambient);
            s.setIrisTexture(2, imageDesc(texture, PEL_FORMAT_RGB32F, 64, 64));
        });
    };
    std::vector<float> texels(64 * 64 * 3, 0.3f);
    const std::vector<float> clean = textured(texels);
    for (int i = 0; i < 3; ++i) texels[size_t(3 * (20 * 64 + 16 * i + 8))] = bad[i];
    sameBeyond(textured(texels), clean, 200);

    const auto reflecting = [&](const std::vector<float>& cube) {
        const Buffer faces(frame.device, cube);
        return frame.shade([&](Shader& s) {
            withEye(s);
            s.setReflectionCube(imageDesc(faces, PEL_FORMAT_RGB32F, 4, 24));
        });
    };
    std::vector<float> cube(4 * 24 * 3, 0.7f);
    const std::vector<float> mirrored = reflecting(cube);
    cube[3 * 30] = bad[0], cube[3 * 70] = bad[1];
    sameBeyond(reflecting(cube), mirrored, pixels / 4);
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
