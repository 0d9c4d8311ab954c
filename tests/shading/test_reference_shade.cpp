// The oracle's shading terms: hand-worked values, limits, and 20,000 pixels that FaceWorks shaded.
#include <gtest/gtest.h>

#include <random>

#include "npy.h"
#include "reference/lut.h"
#include "reference/shade.h"
#include "tolerances.h"

using namespace reference;
namespace {

Vec3 randomUnit(std::mt19937& random) {
    std::normal_distribution<double> gaussian;
    return normalized({gaussian(random), gaussian(random), gaussian(random)});
}

// A disk evenly covered by a spiral of the golden angle (Vogel 1979).
std::vector<Vec2> evenDisk(int count) {
    std::vector<Vec2> taps;
    for (int i = 0; i < count; ++i) {
        const double radius = std::sqrt((i + 0.5) / count), angle = i * pi * (3 - std::sqrt(5.0));
        taps.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    return taps;
}

TEST(ReferenceShade, BilinearIsExactAtCentresAndClamped) {
    const Table table{3, 2, {{0, 0, 0}, {1, 10, 0}, {2, 20, 0}, {3, 0, 1}, {4, 10, 1}, {5, 20, 1}}};
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x) {
            const Rgb at = bilinear(table, (x + 0.5) / 3, (y + 0.5) / 2);
            EXPECT_NEAR(at.x, 3 * y + x, tolerance::oracleExact);
            EXPECT_NEAR(at.y, 10 * x, tolerance::oracleExact);
        }
    EXPECT_NEAR(bilinear(table, 1.0 / 3, 0.5).x, 2, tolerance::oracleExact);
    EXPECT_NEAR(bilinear(table, -5, -5).x, 0, tolerance::oracleExact);
    EXPECT_NEAR(bilinear(table, 5, 5).x, 5, tolerance::oracleExact);
}

TEST(ReferenceShade, RowsMatchTheTablesTexelCentres) {
    const CurvatureLutSpec curvature;
    const ShadowLutSpec shadow;
    for (int y : {0, 7, 511}) {
        EXPECT_NEAR(curvatureRow(1 / curvature.radius(y), 1, 100, 1), (y + 0.5) / 512,
                    tolerance::oracleExact);
        EXPECT_NEAR(shadowRow(1, 1 / shadow.reciprocalWidth(y, 1), 8, 100, 1), (y + 0.5) / 512,
                    tolerance::oracleExact);
        // A material of twice the radius looks twice as curved: row of 1/(2r) as of 1/r.
        EXPECT_NEAR(curvatureRow(0.5 / curvature.radius(y), 1, 100, radiusRatio(2.7, 5.4)), (y + 0.5) / 512,
                    tolerance::oracleExact);
    }
    EXPECT_EQ(curvatureRow(0.3, 5, 5, 1), 0);
    EXPECT_NEAR(shadowRow(-0.5, 9, 8, 100, 1), shadowRow(0, 9, 8, 100, 1), tolerance::oracleExact);
    EXPECT_NEAR(blurredNormalMip(1024, 2.7, 672.45346), std::log2(1024 * 2.7 / 672.45346),
                tolerance::oracleExact);
    EXPECT_EQ(blurredNormalMip(64, 2.7, 672.45346), 0);
}

TEST(ReferenceShade, DirectWithoutBlurOrScatteringIsLambert) {
    std::mt19937 random(1);
    for (int i = 0; i < 100; ++i) {
        const Vec3 n = randomUnit(random), l = randomUnit(random);
        const Rgb lit = direct({}, n, n, l);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(lit[c], max0(dot(n, l)), tolerance::oracleExact);
    }
}

TEST(ReferenceShade, DirectBlendsNormalsPerChannel) {
    // N = z, Nb tilted by 60 degrees; light along Nb: s = 0. Green sees norm(0.7 N + 0.3 Nb), by hand.
    const Vec3 n{0, 0, 1}, nb{std::sqrt(0.75), 0, 0.5};
    const Rgb along = direct({0.1, 0.1, 0.9}, n, nb, nb);
    EXPECT_NEAR(along.x, 1, tolerance::oracleExact);
    const double gx = 0.3 * std::sqrt(0.75), gz = 0.7 + 0.15;
    EXPECT_NEAR(direct({}, n, nb, nb).y, (gx * std::sqrt(0.75) + gz * 0.5) / std::hypot(gx, gz),
                tolerance::oracleExact);
    EXPECT_NEAR(direct({}, n, nb, nb).z, 0.5, tolerance::oracleExact);
    EXPECT_EQ(along.z, 1);
    // Light level with Nb: s = 1 and every channel sees Nb.
    const Vec3 level{-0.5, 0, std::sqrt(0.75)};
    const Rgb dark = direct({0.2, 0.2, 0.2}, n, nb, level);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(dark[c], 0.2, tolerance::oracleExact);
}

TEST(ReferenceShade, SharpenedShadowIsASmoothstepOfAnEdge) {
    EXPECT_NEAR(sharpenedShadow(0.5, 10), 0.5, tolerance::oracleExact);
    EXPECT_EQ(sharpenedShadow(0.4, 10), 0);
    EXPECT_EQ(sharpenedShadow(0.6, 10), 1);
    const double t = 0.5 + 0.05 * 9;  // w = 0.55, k = 10: ramp of slope 9 round the middle
    EXPECT_NEAR(sharpenedShadow(0.55, 10), t * t * (3 - 2 * t), tolerance::oracleExact);
}

TEST(ReferenceShade, HarmonicsAreOrthonormal) {
    // Products of basis functions, offset so that the clamp at 0 never acts, averaged over an even sphere.
    const int n = 20000;
    double gram[9][9] = {};
    for (int i = 0; i < n; ++i) {
        const double z = 1 - (2 * i + 1.0) / n, angle = i * pi * (3 - std::sqrt(5.0)),
                     r = std::sqrt(1 - z * z);
        double value[9];
        for (int j = 0; j < 9; ++j) {
            Ambient one;
            one.constant = {9, 9, 9};
            one.harmonics[j] = {1, 0, 0};
            value[j] = irradiance(one, {r * std::cos(angle), r * std::sin(angle), z}).x - 9;
        }
        for (int j = 0; j < 9; ++j)
            for (int k = 0; k < 9; ++k) gram[j][k] += 4 * pi / n * value[j] * value[k];
    }
    for (int j = 0; j < 9; ++j)
        for (int k = 0; k < 9; ++k)
            EXPECT_NEAR(gram[j][k], j == k, tolerance::sampledSphere) << j << ' ' << k;
}

TEST(ReferenceShade, AmbientTakesEachChannelAtItsNormal) {
    const Vec3 n{0, 0, 1}, nb{1, 0, 0};
    Ambient ambient;
    ambient.constant = {1, 2, 3};
    ambient.harmonics[3] = {1, 1, 1};  // x
    const double band1 = std::sqrt(3 / (4 * pi));
    const Rgb light = ambientTerm(ambient, n, nb);
    EXPECT_NEAR(light.x, 1 + band1, tolerance::oracleExact);
    EXPECT_NEAR(light.y, 2 + band1 * 0.3 / std::hypot(0.3, 0.7), tolerance::oracleExact);
    EXPECT_NEAR(light.z, 3, tolerance::oracleExact);
    ambient.constant = {-5, 0, 0};
    EXPECT_EQ(irradiance(ambient, nb).x, 0);
}

TEST(ReferenceShade, ThicknessOfASlabIsItsDepthAlongTheLight) {
    const auto taps = evenDisk(32);
    const ShadowMap slab{4, 4, std::vector<double>(16, 0.25)};
    const DepthDecoding parallel{false, 300, 0, 1};
    EXPECT_NEAR(thickness(slab, {0.5, 0.5, 0.4}, taps, 0.02, parallel, MapFilter::bilinear), 45,
                tolerance::oracleClosedForm);
    EXPECT_EQ(thickness(slab, {0.5, 0.5, 0.2}, taps, 0.02, parallel, MapFilter::bilinear), 0);
    // A hard edge through the middle of the disk: half of the taps see it.
    ShadowMap edge{100, 1, std::vector<double>(100, 1.0)};
    for (int x = 0; x < 50; ++x) edge.depth[x] = 0.1;
    EXPECT_NEAR(thickness(edge, {0.5, 0.5, 0.5}, evenDisk(5000), 0.1, {}, MapFilter::nearest), 0.2,
                tolerance::sampledDisk);
}

TEST(ReferenceShade, ShadowCoordinatesDivideAndMoveInwards) {
    const Matrix4 m{{{1, 0, 0, 0.5}, {0, 2, 0, 0}, {0, 0, 3, 0}, {0, 0, 1, 1}}};
    const Vec3 at = shadowCoordinates(m, {1, 1, 2}, {0, 0, 1}, 1);
    EXPECT_NEAR(at.x, 0.75, tolerance::oracleExact);
    EXPECT_NEAR(at.y, 1, tolerance::oracleExact);
    EXPECT_NEAR(at.z, 1.5, tolerance::oracleExact);
}

TEST(ReferenceShade, SpecularIsReciprocalButForTheCosineAndZeroBehind) {
    std::mt19937 random(2);
    for (int i = 0; i < 200; ++i) {
        const Vec3 n{0, 0, 1}, l = randomUnit(random), v = randomUnit(random);
        const double there = specular(n, l, v, 0.3, 1.7), back = specular(n, v, l, 0.3, 1.7);
        if (l.z <= 0) {
            EXPECT_EQ(there, 0);
        }
        if (l.z > 0 && v.z > 0) {
            EXPECT_NEAR(there * v.z, back * l.z, tolerance::oracleClosedForm);
        }
    }
    // Mirror direction at normal incidence by hand: P = 1/m², F = F0, |L+V|² = 4.
    EXPECT_NEAR(specular({0, 0, 1}, {0, 0, 1}, {0, 0, 1}, 0.5, 2), 2 * 4 * 0.028 / 4, tolerance::oracleExact);
    EXPECT_EQ(specular({0, 0, 1}, {0, 0, 1}, {0, 0, -1}, 0.5, 2), 0);
    EXPECT_NEAR(schlick(0, 0.028), 1, tolerance::oracleExact);
    EXPECT_NEAR(schlick(0.5, 0.028), 0.028 + 0.972 / 32, tolerance::oracleExact);
}

TEST(ReferenceShade, SumIsOfItsTermsAndLights) {
    std::mt19937 random(4);
    ScatterTable curvature{{2, 2, {{.1, .1, .1}, {.9, .9, .9}, {.2, .1, .1}, {.8, .9, .9}}}, 1, 100, 2.7, 10};
    ScatterTable shadow{{2, 2, {{0, 0, 0}, {1, 1, 1}, {.1, .05, 0}, {.9, 1, 1}}}, 8, 100, 2.7, 10};
    Material material;
    material.albedo = {0.8, 0.6, 0.5};
    material.deepScatterColor = {0.6, 0.1, 0.05};
    material.specular = 0.5;
    material.curvatureLut = &curvature;
    material.shadowLut = &shadow;
    for (int i = 0; i < 50; ++i) {
        const Pixel pixel{
            randomUnit(random), randomUnit(random), randomUnit(random), randomUnit(random), 0.3, 0.5};
        const PixelLight one{randomUnit(random), {1, 2, 3}, 0.45, true, 2},
            two{randomUnit(random), {3, 1, 2}, 0.6, false, 2};
        Ambient ambient;
        ambient.constant = {0.1, 0.2, 0.3};
        const Shaded both = shadePixel(material, pixel, {one, two}, ambient);
        const Shaded dark = shadePixel(material, pixel, {}, ambient);
        const Rgb expected =
            shadeLight(material, pixel, one).sum() + shadeLight(material, pixel, two).sum() + dark.sum();
        // Term by term, from the functions of each term.
        const double u = dot(pixel.blurred, one.toLight);
        const Rgb delta =
            bilinear(curvature.table, (u + 1) / 2, (0.3 - 0.01) / 0.99) - max0(u) * Rgb{1, 1, 1};
        const double row = (saturate(dot(pixel.geometric, one.toLight)) / 8 - 0.01) / 0.115;
        const Rgb diffuse = material.albedo * one.color *
                            direct(delta, pixel.shading, pixel.blurred, one.toLight) *
                            bilinear(shadow.table, 0.45, row);
        const double through = std::exp(-4.0 / 72) * saturate(0.3 - u);
        const Shaded first = shadeLight(material, pixel, one);
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(both.sum()[c], expected[c], tolerance::oracleExact);
            EXPECT_NEAR(dark.sum()[c], 0.5 * material.albedo[c] * ambient.constant[c],
                        tolerance::oracleExact);
            EXPECT_NEAR(first.scattered[c], diffuse[c], tolerance::oracleExact);
            EXPECT_NEAR(first.deepScatter[c],
                        through * material.deepScatterColor[c] * material.albedo[c] * one.color[c],
                        tolerance::oracleExact);
            EXPECT_NEAR(first.specular[c],
                        sharpenedShadow(0.45, 10) * one.color[c] *
                            specular(pixel.shading, one.toLight, pixel.toViewer, 0.3, 0.5),
                        tolerance::oracleExact);
            EXPECT_EQ(shadeLight(material, pixel, two).deepScatter[c], 0);
        }
    }
}

TEST(ReferenceShade, LampsFallOff) {
    Lamp lamp{{0, 0, 2}, {4, 8, 12}, 0, false, {0, 0, -1}, 0.9, 0.8};
    EXPECT_NEAR(lampAt(lamp, {0, 0, 0}).color.x, 1, tolerance::oracleExact);
    EXPECT_NEAR(lampAt(lamp, {0, 0, 0}).toLight.z, 1, tolerance::oracleExact);
    lamp.range = 1.9;
    EXPECT_EQ(lampAt(lamp, {0, 0, 0}).color.x, 0);
    lamp.range = 10;
    lamp.spot = true;
    EXPECT_NEAR(lampAt(lamp, {0, 0, 0}).color.x, 1, tolerance::oracleExact);
    const double sine = std::sqrt(1 - 0.85 * 0.85);
    EXPECT_NEAR(lampAt(lamp, Vec3{0, 0, 2} + 2 * Vec3{sine, 0, -0.85}).color.x, 0.5,
                tolerance::oracleClosedForm);
    EXPECT_EQ(lampAt(lamp, {2, 0, 1}).color.x, 0);
}

class FaceWorksPixels : public testing::Test {
  protected:
    void SetUp() override {
        REQUIRE_ORACLE_DIRECTORY(directory);
        in_ = npy::read<float>(directory / "oracle_inputs_f32.npy");
        out_ = npy::read<float>(directory / "oracle_out_A_f32.npy");
        const auto depth = npy::read<float>(directory / "oracle_depth256_f32.npy");
        map_ = {256, 256, {depth.data.begin(), depth.data.end()}};
        const auto curvature = npy::read<uint8_t>(directory / "fw_lut_curv_A_u8.npy");
        const auto shadow = npy::read<uint8_t>(directory / "fw_lut_shadow_A_u8.npy");
        delta_ = {512, 512, std::vector<Rgb>(512 * 512)};
        shadow_ = {512, 512, std::vector<Rgb>(512 * 512)};
        for (size_t i = 0; i < delta_.texels.size(); ++i)
            for (int c = 0; c < 3; ++c) {
                delta_.texels[i][c] = curvature.data[4 * i + c] / 255.0 / 2 - 0.25;
                shadow_.texels[i][c] = linearFromSrgb(shadow.data[4 * i + c] / 255.0);
            }
    }
    Vec3 input(int pixel, int first) const {
        const float* p = in_.row(pixel) + first;
        return {p[0], p[1], p[2]};
    }
    // Largest difference over all pixels from FaceWorks' outputs first, first + 1, ...
    template <class F>
    double worst(int first, int count, const F& ours) const {
        double largest = 0;
        for (size_t pixel = 0; pixel < in_.shape[0]; ++pixel) {
            const Vec3 value = ours(int(pixel));
            for (int c = 0; c < count; ++c)
                largest = std::max(largest, std::abs(value[c] - out_.row(pixel)[first + c]));
        }
        return largest;
    }
    npy::Array<float> in_, out_;
    ShadowMap map_;
    Table delta_, shadow_;
};

TEST_F(FaceWorksPixels, DirectEqualsOurs) {
    EXPECT_LE(worst(0, 3,
                    [&](int i) {
                        const Vec3 nb = input(i, 6), l = input(i, 9);
                        const Rgb delta =
                            bilinear(delta_, 0.5 * dot(nb, l) + 0.5, curvatureRow(in_.row(i)[12], 1, 100, 1));
                        return direct(delta, input(i, 3), nb, l);
                    }),
              tolerance::faceWorksTerm);
}

TEST_F(FaceWorksPixels, ShadowsEqualOurs) {
    EXPECT_LE(worst(3, 3,
                    [&](int i) {
                        return bilinear(shadow_, in_.row(i)[13],
                                        shadowRow(dot(input(i, 0), input(i, 9)), 9, 8, 100, 1));
                    }),
              tolerance::faceWorksTerm);
    EXPECT_LE(worst(6, 1,
                    [&](int i) {
                        return Vec3{sharpenedShadow(in_.row(i)[13], in_.row(i)[14]), 0, 0};
                    }),
              tolerance::faceWorksSharpened);
}

TEST_F(FaceWorksPixels, AmbientNormalsEqualOurs) {
    for (int n = 0; n < 3; ++n)
        EXPECT_LE(worst(7 + 3 * n, 3, [&](int i) { return ambientNormals(input(i, 3), input(i, 6))[n]; }),
                  tolerance::faceWorksTerm);
    EXPECT_LE(worst(16, 3,
                    [&](int i) {
                        return Vec3{in_.row(i)[19], in_.row(i)[23], in_.row(i)[27]};
                    }),
              tolerance::faceWorksTerm);
}

TEST_F(FaceWorksPixels, DeepScatterEqualsOurs) {
    EXPECT_LE(worst(23, 1,
                    [&](int i) {
                        return Vec3{deepScatter(in_.row(i)[15], 6, input(i, 6), input(i, 9)), 0, 0};
                    }),
              tolerance::faceWorksTerm);
}

// FaceWorks' taps lie elsewhere in the same disk: means agree, and each pixel more closely the more taps it
// took.
TEST_F(FaceWorksPixels, ThicknessAgreesOnAverage) {
    const auto taps = evenDisk(64);
    const DepthDecoding decodings[2] = {{false, 300, 0, 1}, {true, 1, -0.0075, 0.01}};
    for (int kind = 0; kind < 2; ++kind) {
        double ours = 0, theirs = 0, apart[2] = {};
        for (size_t i = 0; i < in_.shape[0]; ++i) {
            const double t =
                thickness(map_, input(int(i), 16), taps, 0.02, decodings[kind], MapFilter::bilinear);
            ours += t;
            theirs += out_.row(i)[20 + 2 * kind];
            for (int j = 0; j < 2; ++j) apart[j] += std::pow(t - out_.row(i)[19 + 2 * kind + j], 2);
        }
        EXPECT_NEAR(ours / theirs, 1, tolerance::faceWorksThicknessMean);
        EXPECT_LT(apart[1], apart[0]);
        EXPECT_LT(std::sqrt(apart[1] / in_.shape[0]),
                  tolerance::faceWorksThicknessRms * theirs / in_.shape[0]);
    }
}

}  // namespace
