// Eyes cost nothing where there are none, and bad input around them is an error by name or a finite picture.
#include <gtest/gtest.h>

#include <pellucid/pellucid.hpp>

#include <cmath>
#include <functional>

using namespace pellucid;

namespace {

// A wall of material 1, in which a ball of material 2 sits; 1 pixel is 0.25 mm.
class EyeFrame {
  public:
    static constexpr uint32_t width = 512, height = 256;
    EyeFrame() {
        std::vector<float> position, normal;
        std::vector<uint8_t> id;
        for (uint32_t y = 0; y < height; ++y)
            for (uint32_t x = 0; x < width; ++x) {
                const float px = 0.25f * (float(x) - 400), py = 0.25f * (128 - float(y)), r2 = px * px + py * py;
                const bool ball = r2 < 121;
                const float pz = ball ? std::sqrt(144 - r2) : 4.8f, length = ball ? 12 : 1;
                for (const float c : {px, py, pz}) position.push_back(c);
                for (const float c : {ball ? px : 0.0f, ball ? py : 0.0f, ball ? pz : 1.0f})
                    normal.push_back(c / length);
                id.push_back(ball ? 2 : 1);
            }
        positions_ = Buffer(device, position), normals_ = Buffer(device, normal), ids_ = Buffer(device, id);
        out_ = Buffer(device, std::vector<float>(3 * width * height));
    }
    // `prepare` changes the shader before it is committed.
    std::vector<float> shade(const std::function<void(Shader&)>& prepare = {},
                             PelTileLists lists = PEL_TILES_ONE_LIST) {
        Shader shader(device);
        PelMaterial wall = pelMaterialDefaults(), sclera = pelMaterialDefaults();
        wall.specular = 1;
        wall.scattering = sclera.scattering = PEL_SCATTERING_NONE;
        PelShaderOptions options = pelShaderOptionsDefaults();
        options.tileLists = lists;
        options.countPixels = 1;
        PelCamera camera = pelCameraDefaults();
        camera.position[2] = 300;
        PelLight light = pelLightDefaults();
        light.toLight[0] = 0.6f, light.toLight[2] = 0.8f;
        shader.set(options).set(camera).set(std::vector{light}).setMaterial(1, wall).setMaterial(2, sclera);
        shader.set(PEL_SLOT_RADIANCE, imageDesc(out_, PEL_FORMAT_RGB32F, width, height));
        shader.set(PEL_SLOT_POSITION, imageDesc(positions_, PEL_FORMAT_RGB32F, width, height));
        shader.set(PEL_SLOT_NORMAL_SHADING, imageDesc(normals_, PEL_FORMAT_RGB32F, width, height));
        shader.set(PEL_SLOT_MATERIAL, imageDesc(ids_, PEL_FORMAT_R8_UINT, width, height));
        if (prepare) prepare(shader);
        shader.commit().execute();
        stats = shader.stats();
        return out_.readAll<float>();
    }
    static bool isEye(size_t pixel) {
        const float px = 0.25f * (float(pixel % width) - 400), py = 0.25f * (128 - float(pixel / width));
        return px * px + py * py < 121;
    }

    Device device{""};
    PelShaderStats stats{};

  private:
    Buffer positions_, normals_, ids_, out_;
};

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
        if (EyeFrame::isEye(i / 3))
            changed += eye[i] != plain[i], ++pixels;
        else
            ASSERT_EQ(eye[i], plain[i]) << i / 3 % EyeFrame::width << ", " << i / 3 / EyeFrame::width;
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
        s.set(PEL_SLOT_OUT_DIFFUSE, imageDesc(diffuse, PEL_FORMAT_RGB32F, EyeFrame::width, EyeFrame::height));
        s.set(PEL_SLOT_OUT_SPECULAR, imageDesc(specular, PEL_FORMAT_RGB32F, EyeFrame::width, EyeFrame::height));
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
