// The oracle's shading terms: hand-worked values, limits, and 20,000 pixels that FaceWorks shaded; and the
// disks of taps, which it shares with the kernels.
#include "npy.h"
#include "reference/lut.h"
#include "shade_scene.h"
#include "test.h"

namespace shading_integrals {

using namespace reference;

namespace {

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

TEST(ReferenceShade, GgxIsReciprocalAndLosesWhatMaskingTakes) {
    const Vec3 n{0, 0, 1};
    const auto direction = [](double cosine, double angle) {
        const double s = std::sqrt(1 - cosine * cosine);
        return Vec3{s * std::cos(angle), s * std::sin(angle), cosine};
    };
    // The energy after one bounce, by another method: the mean of G2 (V.H) / ((N.V) (N.H)) over half vectors
    // drawn from D cos.
    for (const auto& [a, left] : {std::pair{0.1, 0.9867}, {0.3, 0.8678}, {0.8, 0.4441}}) {
        const Vec3 l = direction(0.7, 0.3), v = direction(0.4, 2.1);
        EXPECT_NEAR(ggxLobe(n, l, v, a), ggxLobe(n, v, l, a), tolerance::oracleExact);
        double out = 0;
        const int steps = 600;
        for (int i = 0; i < steps; ++i)
            for (int j = 0; j < steps; ++j) {
                const Vec3 to = direction((i + 0.5) / steps, 2 * pi * (j + 0.5) / steps);
                out += specularGgx(n, to, direction(0.9, 0), a, a, 0, 1, 1) * 2 / (double(steps) * steps);
            }
        EXPECT_NEAR(out, left, tolerance::ggxEnergy) << a;
    }
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
    // Over all pixels, of FaceWorks' outputs first, first + 1, ...
    template <class F>
    void expectEqual(int first, int count, const F& ours, double within = tolerance::faceWorksTerm) const {
        double largest = 0;
        for (size_t pixel = 0; pixel < in_.shape[0]; ++pixel) {
            const Vec3 value = ours(int(pixel));
            for (int c = 0; c < count; ++c)
                largest = std::max(largest, std::abs(value[c] - out_.row(pixel)[first + c]));
        }
        EXPECT_LE(largest, within) << "from output " << first << " on";
    }
    npy::Array<float> in_, out_;
    ShadowMap map_;
    Table delta_, shadow_;
};

TEST_F(FaceWorksPixels, DirectEqualsOurs) {
    expectEqual(0, 3, [&](int i) {
        const Vec3 nb = input(i, 6), l = input(i, 9);
        const Rgb delta = bilinear(delta_, 0.5 * dot(nb, l) + 0.5, curvatureRow(in_.row(i)[12], 1, 100, 1));
        return direct(delta, input(i, 3), nb, l);
    });
}

TEST_F(FaceWorksPixels, ShadowsEqualOurs) {
    expectEqual(3, 3, [&](int i) {
        return bilinear(shadow_, in_.row(i)[13], shadowRow(dot(input(i, 0), input(i, 9)), 9, 8, 100, 1));
    });
    const auto sharpened = [&](int i) { return Vec3{sharpenedShadow(in_.row(i)[13], in_.row(i)[14]), 0, 0}; };
    expectEqual(6, 1, sharpened, tolerance::faceWorksSharpened);
}

TEST_F(FaceWorksPixels, AmbientNormalsEqualOurs) {
    for (int n = 0; n < 3; ++n)
        expectEqual(7 + 3 * n, 3, [&](int i) { return ambientNormals(input(i, 3), input(i, 6))[n]; });
    expectEqual(16, 3, [&](int i) { return Vec3{in_.row(i)[19], in_.row(i)[23], in_.row(i)[27]}; });
}

TEST_F(FaceWorksPixels, DeepScatterEqualsOurs) {
    expectEqual(23, 1, [&](int i) {
        return Vec3{deepScatter(in_.row(i)[15], 6, input(i, 6), input(i, 9)), 0, 0};
    });
}

// FaceWorks' taps lie elsewhere in the same disk than the kernels'.
TEST_F(FaceWorksPixels, ThicknessAgreesOnAverage) {
    const DepthDecoding decodings[2] = {{false, 300, 0, 1}, {true, 1, -0.0075, 0.01}};
    for (int kind = 0; kind < 2; ++kind)
        for (const bool many : {false, true}) {
            const auto taps = shade_test::diskTaps(many ? 32 : 8);
            double ours = 0, theirs = 0, apart = 0;
            for (size_t i = 0; i < in_.shape[0]; ++i) {
                const double t = thickness(map_, input(int(i), 16), taps, 0.02, decodings[kind]),
                             other = out_.row(i)[19 + 2 * kind + many];
                ours += t, theirs += other, apart += std::pow(t - other, 2);
            }
            const double rms = std::sqrt(apart * double(in_.shape[0])) / theirs;
            EXPECT_NEAR(ours / theirs, 1, tolerance::faceWorksTapsMean) << taps.size();
            EXPECT_LT(rms, tolerance::faceWorksTapsRms) << taps.size();
        }
}

// The disks of thickness taps: centred, as wide as the disk, and better than random points for their purpose,
// the area of the disk on one side of an edge.
class PoissonDisk : public testing::TestWithParam<uint32_t> {};

TEST_P(PoissonDisk, IsCentredInTheUnitDisk) {
    double x = 0, y = 0, r2 = 0;
    const auto taps = shade_test::diskTaps(GetParam());
    for (const auto& tap : taps) {
        x += tap.x, y += tap.y;
        r2 += (tap.x * tap.x + tap.y * tap.y) / double(taps.size());
        EXPECT_LE(std::hypot(tap.x, tap.y), 1);
    }
    EXPECT_NEAR(x, 0, 1e-6);
    EXPECT_NEAR(y, 0, 1e-6);
    EXPECT_NEAR(r2, 0.5, tolerance::diskMoment);
}

TEST_P(PoissonDisk, SeesEdgesBetterThanRandomTaps) {
    const auto taps = shade_test::diskTaps(GetParam());
    const double count = double(taps.size());
    double ours = 0, random = 0;
    for (int angle = 0; angle < 180; ++angle)
        for (int step = 0; step < 100; ++step) {
            const double a = angle * pi / 180, offset = (step + 0.5) / 50 - 1;
            double beyond = 0;
            for (const auto& tap : taps) beyond += std::cos(a) * tap.x + std::sin(a) * tap.y > offset;
            const double area = (std::acos(offset) - offset * std::sqrt(1 - offset * offset)) / pi;
            ours += std::pow(beyond / count - area, 2);
            random += area * (1 - area) / count;
        }
    EXPECT_LE(std::sqrt(ours / random), tolerance::diskEdge);
}

INSTANTIATE_TEST_SUITE_P(Disks, PoissonDisk, testing::Values(8u, 16u, 32u),
                         [](const auto& info) { return std::to_string(info.param); });

}  // namespace

}  // namespace shading_integrals
