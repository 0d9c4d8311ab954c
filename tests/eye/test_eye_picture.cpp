// The whole picture of an eye against the tracer in double precision.
#include "eye/eye_picture.h"
#include "kept_sums.h"
#include "test.h"

using namespace pellucid;
using namespace eye_test;

namespace {

double errorOf(const EyeScene& scene) {
    const EyePicture picture(scene);
    return differenceOf(picture, picture.shade(), picture.trace()).rms;
}

}  // namespace

TEST(EyePicture, RefractsAsTheTracer) {
    EyeScene scene;
    // The tracer looks at points: texels as wide as pixels.
    scene.makeTexture(20);
    std::fill_n(scene.ambient.constant, 3, 1.0f);
    EXPECT_LT(errorOf(scene), tolerance::eyePictureRms) << "refraction";
    scene.eye.irisConcavity = 0.7f;
    scene.eye.pupilRadius = 3.2f;
    scene.eye.corneaConic = -1.1f;
    scene.camera = {1, -0.2, 7};
    EXPECT_LT(errorOf(scene), tolerance::eyePictureRms) << "concave iris, hyperboloid";
    scene.eye.corneaIndex = scene.eye.aqueousIndex = 1;
    EXPECT_LT(errorOf(scene), tolerance::eyePictureRms) << "index 1";
}

// From afar a pixel shows the mean of many texels. A texture whose detail has no place in the picture must
// not flicker in it.
TEST(EyePicture, SmallEyesShowTheMeanOfTheirTexture) {
    EyeScene fine;
    fine.ambient.constant[0] = fine.ambient.constant[1] = fine.ambient.constant[2] = 1;
    fine.eye.pupilRadius = 0;
    fine.eye.texturePupil = 0;
    const auto checks = [](int i, int j) { return (i / 3 + j / 3) % 2; };
    const auto columns = [](int i, int) { return i % 2; };
    const auto rows = [](int, int j) { return j % 2; };
    const struct {
        int (*pattern)(int, int);
        uint32_t texels;
        int pixels;
    } cases[] = {
        {checks, 512, 12}, {checks, 512, 20}, {checks, 512, 40}, {columns, 100, 12}, {rows, 100, 12}};
    for (const auto& c : cases) {
        fine.textureSize = c.texels, fine.size = c.pixels;
        fine.texture.clear();
        for (int j = 0; j < int(c.texels); ++j)
            for (int i = 0; i < int(c.texels); ++i)
                fine.texture.insert(fine.texture.end(), 3, float(c.pattern(i, j)));
        EyeScene grey = fine;
        grey.texture.assign(grey.texture.size(), 0.5f);
        const EyePicture seen(fine), known(grey);
        const std::vector<float> is = seen.shade(), should = known.shade();
        double sum = 0, iris = 0;
        for (size_t k = 0; k < seen.pixels.size(); ++k) {
            if (seen.pixels[k].hit.share < 1) continue;
            sum += (is[3 * k] - should[3 * k]) * (is[3 * k] - should[3 * k]);
            iris += should[3 * k] * should[3 * k];
        }
        ASSERT_GT(iris, 0);
        EXPECT_LT(std::sqrt(sum / iris), tolerance::eyeMinified) << c.pixels << " pixels, " << c.texels;
    }
}

// Without refraction, and in front of the limbus, the whole hemisphere lights each point of an iris.
TEST(EyePicture, AnIrisInTheOpenShowsItsColour) {
    EyeScene scene;
    scene.eye.irisRadius = 3, scene.eye.chamberDepth = 1.45f;
    scene.eye.corneaIndex = scene.eye.aqueousIndex = 1;
    scene.eye.pupilRadius = scene.eye.texturePupil = scene.eye.limbusDarkening = 0;
    scene.textureSize = 2;
    scene.texture.assign(2 * 2 * 3, 0.5f);
    std::fill_n(scene.ambient.constant, 3, 1.0f);
    const EyePicture picture(scene);
    const std::vector<float> is = picture.shade();
    size_t count = 0;
    for (size_t k = 0; k < picture.pixels.size(); ++k) {
        const auto& hit = picture.pixels[k].hit;
        if (hit.share < 1 || hit.radius > 2.5) continue;
        ASSERT_NEAR(is[3 * k], 0.5, 1e-3) << k;
        ++count;
    }
    EXPECT_GT(count, 100u);
}

// Indirect light per pixel equals the same light from everywhere.
TEST(EyePicture, IndirectLightIsLikeAmbientLight) {
    EyeScene scene;
    std::fill_n(scene.ambient.constant, 3, 0.4f);
    const std::vector<float> ambient = EyePicture(scene).shade();
    scene.ambient = pelAmbientDefaults();
    scene.indirect.assign(3 * size_t(scene.size) * size_t(scene.size), 0.4f);
    const std::vector<float> indirect = EyePicture(scene).shade();
    EXPECT_GT(*std::ranges::max_element(ambient), 0.1f);
    for (size_t i = 0; i < ambient.size(); ++i) EXPECT_NEAR(indirect[i], ambient[i], 1e-6) << i;
}

// Without a texture fibres are drawn: round a circle they differ, and each seed has its own.
TEST(EyePicture, DrawnFibresDifferRoundTheIris) {
    EyeScene scene;
    for (int i = 0; i < 3; ++i) scene.eye.gaze[i] = float(scene.camera[i]) - scene.eye.center[i];
    scene.eye.corneaIndex = scene.eye.aqueousIndex = 1;
    std::fill_n(scene.ambient.constant, 3, 1.0f);
    const auto seen = [&](uint32_t seed) {
        scene.eye.irisSeed = seed;
        return EyePicture(scene).shade();
    };
    const std::vector<float> one = seen(1), other = seen(2);
    const EyePicture picture(scene);
    // Without fibres the iris, seen along its axis, would look alike after a quarter of a turn.
    double turned = 0, seeds = 0, mean = 0, count = 0;
    for (size_t k = 0; k < picture.pixels.size(); ++k) {
        const auto& hit = picture.pixels[k].hit;
        if (hit.share < 1 || hit.radius < 1.3 * scene.eye.pupilRadius || hit.radius > 5) continue;
        const auto size = size_t(scene.size), x = k % size, y = k / size;
        turned += std::abs(one[3 * k] - one[3 * (x * size + size - 1 - y)]);
        seeds += std::abs(one[3 * k] - other[3 * k]);
        mean += one[3 * k], ++count;
    }
    EXPECT_GT(count, 100);
    EXPECT_GT(turned, 0.04 * mean);
    EXPECT_GT(seeds, 0.04 * mean);
}

TEST(EyePicture, GlossAsTheTracer) {
    EyeScene scene;
    for (float& c : scene.sclera.albedo) c = 0;
    for (float& c : scene.eye.irisColor) c = 0;
    scene.makeTexture(4);
    std::fill(scene.texture.begin(), scene.texture.end(), 0.0f);
    scene.addLight({0.6, 0.5, 0.8}, {1, 0.9, 0.8});
    scene.addLight({-0.6, 0.2, 0.5}, {0.3, 0.4, 0.5});
    EXPECT_LT(errorOf(scene), tolerance::eyePictureRms) << "gloss";
    for (int k = 0; k < scene.size * scene.size; ++k)
        scene.wetness.push_back(float(k % scene.size) / float(scene.size - 1));
    EXPECT_LT(errorOf(scene), tolerance::eyePictureRms) << "gloss with a wet line";
}

TEST(EyePicture, CausticsAsTheTracer) {
    EyeScene scene;
    scene.makeTexture(160);
    scene.addLight({0.9, 0.3, 0.35}, {1, 0.9, 0.8});
    EXPECT_LT(errorOf(scene), tolerance::eyeCausticRms) << "light from the side";
    scene.lights.clear();
    scene.addLight({0.3, 0.9, 0.5}, {0.8, 0.8, 0.8});
    scene.addLight({-0.2, 0.1, 0.9}, {0.2, 0.3, 0.4});
    EXPECT_LT(errorOf(scene), tolerance::eyeCausticRms) << "two lights";
    for (int k = 0; k < scene.size * scene.size; ++k)
        scene.shadow.push_back(std::min(2 * float(k) / float(scene.size * scene.size), 1.0f));
    EXPECT_LT(errorOf(scene), tolerance::eyeCausticRms) << "under a lid";
}

// Light from between the angles of two slices of its table, of which the others are dark.
TEST(EyePicture, CausticsAreInterpolatedBetweenSlices) {
    EyeScene scene;
    scene.size = 48;
    scene.eye.gaze[0] = scene.eye.gaze[1] = 0;
    const auto picture = [&](std::array<float, 4> slices, double at) {
        PelEyeLutDesc desc = pelEyeLutDescOf(&scene.eye);
        desc.width = desc.height = 8, desc.depth = 4;
        std::vector<float> texels;
        for (const float slice : slices) texels.insert(texels.end(), 8 * 8 * 3, slice);
        const double angle = reference::largestAngle(referenceOf(scene.eye)) * at / 3;
        scene.lights.clear();
        scene.addLight({std::sin(angle), 0, std::cos(angle)}, {1, 1, 1});
        const EyePicture made(scene);
        return made.shade(nullptr, Lut(made.device, Lut(made.device, desc).info(), texels));
    };
    for (const double at : {0.5, 1.25}) {
        const float second = float(1 - std::abs(at - 1));
        const std::vector<float> none = picture({0, 0, 0, 0}, at), all = picture({1, 1, 1, 1}, at),
                                 one = picture({0, 1, 0, 0}, at);
        size_t lit = 0;
        for (size_t i = 0; i < all.size(); ++i) {
            ASSERT_NEAR(one[i] - none[i], second * (all[i] - none[i]), 1e-4) << at;
            lit += all[i] > none[i] + 0.01f;
        }
        EXPECT_GT(lit, 100u);
    }
}

TEST(EyePicture, SkippingChangesNothing) {
    EyeScene scene;
    scene.makeTexture(64);
    scene.addLight({0.9, 0.3, 0.35}, {1, 0.9, 0.8});
    scene.ambient.constant[0] = 0.2f;
    scene.shadow.assign(size_t(scene.size) * size_t(scene.size), 1.0f);
    std::fill_n(scene.shadow.begin(), scene.shadow.size() / 3, 0.0f);
    PelShaderStats stats;
    const std::vector<float> skipped = EyePicture(scene).shade(&stats);
    // The pupil reads no table, and neither does what lies in shadow or is sclera.
    EXPECT_GT(stats.pixelsIris, 0u);
    EXPECT_LT(stats.pixelsIris, stats.pixelsEye / 2);
    EXPECT_LT(stats.pixelsCaustic, stats.pixelsIris);
    EXPECT_GT(stats.pixelsCaustic, 0u);
    scene.skipping = false;
    EXPECT_EQ(EyePicture(scene).shade(), skipped);
}

// Fields at random, beside kept pictures.
TEST(EyePicture, EyesWithFieldsAtRandomAreTheKeptOnes) {
    if (testsAreSmall()) GTEST_SKIP() << "for whole pictures";
    KeptSums kept("eyes.dat");
    for (uint32_t index = 0; index < 12; ++index) {
        Draw draw(index);
        EyeScene scene;
        scene.size = 48;
        PelEye& eye = scene.eye;
        eye.corneaRadius = draw.in(7.5f, 9), eye.corneaConic = draw.in(-0.8f, 0);
        eye.scleraRadius = draw.in(11, 13), eye.limbusRadius = draw.in(5, 6);
        eye.limbusWidth = draw.in(0, 2), eye.limbusDarkening = draw.in(0, 1);
        eye.corneaIndex = draw.in(1.2f, 1.5f), eye.aqueousIndex = draw.in(1.2f, 1.45f);
        eye.chamberDepth = draw.in(3.1f, 4), eye.irisConcavity = draw.in(0, 0.8f);
        eye.pupilRadius = draw.in(0, 3.5f), eye.texturePupil = draw.in(0, 0.6f);
        eye.tearRoughness = draw.in(0.02f, 0.3f), eye.tearIndex = draw.in(1, 1.5f);
        eye.irisSeed = draw.below(9);
        for (float& color : eye.irisColor) color = draw.oneOf(2) ? draw.in(0, 1) : 1;
        if (draw.oneOf(2)) scene.makeTexture(24);
        for (uint32_t light = 0; light <= draw.below(3); ++light)
            scene.addLight({draw.in(-1, 1), draw.in(-1, 1), draw.in(0.1f, 1)},
                           {draw.in(0, 2), draw.in(0, 2), draw.in(0, 2)});
        for (float& color : scene.ambient.constant) color = draw.in(0, 0.5f);
        if (draw.oneOf(3)) scene.wetness = draw.values(48 * 48, 0, 1);
        if (draw.oneOf(3)) scene.shadow = draw.values(48 * 48, 0, 1);
        if (draw.oneOf(3)) scene.indirect = draw.values(3 * 48 * 48, 0, 1);
        kept.expect(EyePicture(scene).shade(), tolerance::keptResults, "eye " + std::to_string(index));
    }
}
