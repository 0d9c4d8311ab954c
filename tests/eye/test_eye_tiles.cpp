// Pixels without eyes cost nothing extra, and bad input for eyes is an error that names it, or gives a finite
// picture.
#include "cl/cl_spy.h"
#include "device_lanes.h"
#include "eye/eye_frame.h"

using namespace pellucid;
using eye_test::EyeFrame;

namespace {

void expectFinite(const std::vector<float>& picture) {
    size_t wrong = 0;
    for (const float v : picture) wrong += !std::isfinite(v);
    EXPECT_EQ(wrong, 0u);
}

class EyeSettings : public ::testing::Test {
  protected:
    Device device{""};
    Shader shader{device};
    EyeSettings() { shader.setMaterial(1, pelMaterialDefaults()); }
};

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

// Among others the footprints of pixels on the iris, which a lane finds from its neighbour's position, also
// where the last vector of a row begins in an odd column.
TEST(EyeTiles, OneLaneShowsWhatSixteenDo) {
    for (const uint32_t width : {512u, 397u}) {
        const auto shown = [&](int lanes) {
            EyeFrame frame(width, 256, 0.25f, width == 512 ? 400 : 384, 128, lanes::deviceOf(lanes));
            return frame.shade([](Shader& s) { s.setEye(2, pelEyeDefaults()); });
        };
        const std::vector<float> one = shown(1), sixteen = shown(16);
        for (size_t i = 0; i < one.size(); ++i)
            ASSERT_NEAR(one[i], sixteen[i], 1e-4) << i / 3 % width << ", " << i / 3 / width;
    }
}

// The table of a small iris takes long; only a caller who waits for a table may cancel it meanwhile.
TEST(EyeTiles, ACommitDoesNotWaitForATable) {
    EyeFrame frame;
    const auto waits = [&](float irisRadius) {
        const uint64_t before = spy::counts().waits;
        frame.shade([&](Shader& s) {
            PelEye eye = pelEyeDefaults();
            eye.irisRadius = irisRadius, eye.pupilRadius = 0.5f;
            s.setEye(2, eye);
        });
        return spy::counts().waits - before;
    };
    const uint64_t usual = waits(6);
    EXPECT_EQ(waits(1.5f), usual);
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

// --- PelEye and PelEyeLutDesc: errors by name for what does not fit together ---

TEST_F(EyeSettings, WrongFieldsAreNamed) {
    const float nan = std::nanf(""), inf = INFINITY;
    const std::pair<const char*, std::function<void(PelEye&)>> wrong[] = {
        {"gaze", [](PelEye& e) { e.gaze[2] = 0; }},
        {"gaze", [=](PelEye& e) { e.gaze[1] = nan; }},
        {"up", [](PelEye& e) { e.up[1] = 0; }},
        {"up", [](PelEye& e) { e.up[1] = 0, e.up[2] = -3; }},  // along gaze
        {"center", [=](PelEye& e) { e.center[0] = inf; }},
        {"scleraRadius", [](PelEye& e) { e.scleraRadius = 0; }},
        {"corneaRadius", [](PelEye& e) { e.corneaRadius = 0; }},
        {"corneaConic", [=](PelEye& e) { e.corneaConic = nan; }},
        {"limbusRadius", [](PelEye& e) { e.limbusRadius = 0; }},
        {"limbusRadius", [](PelEye& e) { e.limbusRadius = 12; }},
        {"limbusRadius", [](PelEye& e) { e.corneaRadius = 6, e.corneaConic = 0; }},  // a half ball
        {"limbusWidth", [](PelEye& e) { e.limbusWidth = -1; }},
        {"limbusDarkening", [](PelEye& e) { e.limbusDarkening = 2; }},
        {"chamberDepth", [](PelEye& e) { e.chamberDepth = 1; }},
        {"chamberDepth", [](PelEye& e) { e.chamberDepth = 30; }},
        {"corneaIndex", [](PelEye& e) { e.corneaIndex = 0.5f; }},
        {"aqueousIndex", [=](PelEye& e) { e.aqueousIndex = nan; }},
        {"irisRadius", [](PelEye& e) { e.irisRadius = 7; }},
        {"irisConcavity", [](PelEye& e) { e.irisConcavity = -1; }},
        {"pupilRadius", [](PelEye& e) { e.pupilRadius = 6; }},
        {"pupilRadius", [](PelEye& e) { e.pupilRadius = -1; }},
        {"texturePupil", [](PelEye& e) { e.texturePupil = 1; }},
        {"irisColor", [](PelEye& e) { e.irisColor[1] = -0.5f; }},
        {"tearRoughness", [](PelEye& e) { e.tearRoughness = 0; }},
        {"wetLineRoughness", [=](PelEye& e) { e.wetLineRoughness = nan; }},
        {"tearIndex", [](PelEye& e) { e.tearIndex = 0; }},
    };
    shader.setEye(1, pelEyeDefaults());
    for (const auto& [field, change] : wrong) {
        PelEye eye = pelEyeDefaults();
        change(eye);
        expectRefused({"PelEye.", field}, [&] { shader.setEye(1, eye); });
    }
}

TEST_F(EyeSettings, AMaterialComesFirst) {
    expectRefused("pelShaderSetMaterial", [&] { shader.setEye(2, pelEyeDefaults()); });
    Buffer texels(device, 16 * 16 * 12);
    const auto texture = imageDesc(texels, PEL_FORMAT_RGB32F, 16, 16);
    expectRefused("pelShaderSetEye", [&] { shader.setIrisTexture(1, texture); });
    shader.setEye(1, pelEyeDefaults());
    shader.setIrisTexture(1, texture).clearIrisTexture(1);
    expectRefused("square", [&] { shader.setIrisTexture(1, imageDesc(texels, PEL_FORMAT_RGB32F, 16, 8)); });
    shader.clearEye(1);
    expectRefused("pelShaderSetEye", [&] { shader.setIrisTexture(1, texture); });
    expectRefused("six", [&] { shader.setReflectionCube(imageDesc(texels, PEL_FORMAT_RGB32F, 4, 16)); });
}

TEST_F(EyeSettings, SixtyFourAreTheMost) {
    for (uint32_t id = 1; id <= 65; ++id) shader.setMaterial(id, pelMaterialDefaults());
    for (uint32_t id = 1; id <= 64; ++id) shader.setEye(id, pelEyeDefaults());
    shader.setEye(7, pelEyeDefaults());  // once more
    expectRefused("64", [&] { shader.setEye(65, pelEyeDefaults()); });
    shader.clearEye(7).setEye(65, pelEyeDefaults());
}

TEST_F(EyeSettings, OtherTablesAreRefused) {
    PelSpecularLutDesc desc = pelSpecularLutDescDefaults();
    desc.width = desc.height = 4;
    const Lut other(device, desc);
    expectRefused("pelEyeLutCreate", [&] { shader.setEye(1, pelEyeDefaults(), other); });
}

TEST_F(EyeSettings, WrongFieldsOfTablesAreNamed) {
    const std::pair<const char*, std::function<void(PelEyeLutDesc&)>> wrong[] = {
        {"width", [](PelEyeLutDesc& d) { d.width = 1; }},
        {"depth", [](PelEyeLutDesc& d) { d.depth = 257; }},
        {"corneaRadius", [](PelEyeLutDesc& d) { d.corneaRadius = -1; }},
        {"irisRadius", [](PelEyeLutDesc& d) { d.irisRadius = 8; }},
        {"millimetresPerUnit", [](PelEyeLutDesc& d) { d.millimetresPerUnit = 0; }},
    };
    for (const auto& [field, change] : wrong) {
        PelEyeLutDesc desc = pelEyeLutDescDefaults();
        change(desc);
        expectRefused({"PelEyeLutDesc.", field}, [&] { Lut(device, desc); });
    }
}
