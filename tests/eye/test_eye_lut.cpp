// Tables of caustics: against photons in double precision, and exact invariants.
#include "eye/eye_picture.h"
#include "test.h"

using namespace pellucid;
using namespace eye_test;

namespace {

PelEyeLutDesc descOf(const PelEye& eye) {
    return pelEyeLutDescOf(&eye);
}

std::vector<float> tableOf(const PelEyeLutDesc& desc) {
    return Lut(Device(""), desc).read<float>(PEL_LUT_FLOAT);
}

// Against photons in some slices, each of which takes more than a whole table would, whose noise were 1.2 %
// of its mean with 10^8.
void expectPhotons(const PelEye& eye, std::initializer_list<uint32_t> slices) {
    const PelEyeLutDesc desc = descOf(eye);
    const std::vector<float> texels = tableOf(desc);
    const reference::Eye exact = referenceOf(eye);
    const double area = 2 * exact.iris / desc.width * exact.iris / desc.height;
    double squares = 0, sum = 0, count = 0, flux = 0, trueFlux = 0;
    for (const uint32_t z : slices) {
        const reference::Caustic truth =
            tracePhotons(exact, reference::largestAngle(exact) * z / (desc.depth - 1), int(desc.width),
                         int(desc.height), 8'000'000, 17 + z);
        for (uint32_t j = 0; j < desc.height; ++j)
            for (uint32_t i = 0; i < desc.width; ++i) {
                const double is = texels[3 * ((size_t(z) * desc.height + j) * desc.width + i)],
                             should = truth.texels[size_t(j) * desc.width + i];
                const double x = ((i + 0.5) / desc.width * 2 - 1) * exact.iris,
                             y = (j + 0.5) / desc.height * exact.iris,
                             slope = 2 * exact.concavity * std::hypot(x, y) / (exact.iris * exact.iris);
                squares += (is - should) * (is - should), sum += should, ++count;
                flux += is * area * std::sqrt(1 + slope * slope);
            }
        trueFlux += truth.flux;
    }
    EXPECT_LT(std::sqrt(squares * count) / sum, tolerance::eyeLutRms) << "of the mean";
    EXPECT_NEAR(flux / trueFlux, 1, tolerance::eyeLutFlux);
}

}  // namespace

TEST(EyeLut, MatchesPhotons) {
    PelEye eyes[4] = {pelEyeDefaults(), pelEyeDefaults(), pelEyeDefaults(), pelEyeDefaults()};
    eyes[1].irisConcavity = 0.6f, eyes[1].irisRadius = 5.6f;
    eyes[2].corneaConic = 0, eyes[2].chamberDepth = 3.6f;
    eyes[3].corneaIndex = eyes[3].aqueousIndex = 1.5f, eyes[3].corneaConic = -1.2f;
    expectPhotons(eyes[0], {0, 7, 13, 19, 24, 28});
    for (const PelEye& eye : std::span(eyes).subspan(1)) expectPhotons(eye, {2, 14, 22});
}

TEST(EyeLut, HasNoScaleAndTheSameBits) {
    PelEyeLutDesc desc = descOf(pelEyeDefaults());
    const std::vector<float> texels = tableOf(desc);
    EXPECT_EQ(tableOf(desc), texels);
    for (float* length : {&desc.scleraRadius, &desc.corneaRadius, &desc.limbusRadius, &desc.chamberDepth,
                          &desc.irisRadius, &desc.irisConcavity})
        *length *= 4;
    EXPECT_EQ(tableOf(desc), texels);
}

// Texels that hold a large part of all light: their sums must not overflow.
TEST(EyeLut, AFewTexelsHoldTheSameLight) {
    PelEyeLutDesc desc = descOf(pelEyeDefaults());
    const auto mean = [&](const std::vector<float>& texels, uint32_t z) {
        const size_t all = size_t(desc.width) * desc.height;
        double sum = 0;
        for (size_t i = 0; i < all; ++i) sum += texels[3 * (z * all + i)];
        return sum / double(all);
    };
    desc.depth = 3;
    const std::vector<float> fine = tableOf(desc);
    const double known[] = {mean(fine, 0), mean(fine, 1)};
    for (uint32_t side : {32u, 8u, 4u, 2u}) {
        desc.width = desc.height = side;
        const std::vector<float> texels = tableOf(desc);
        for (uint32_t z : {0u, 1u}) EXPECT_NEAR(mean(texels, z) / known[z], 1, 0.1) << side << ' ' << z;
        EXPECT_EQ(mean(texels, 2), 0) << "from the horizon";
    }
}

TEST(EyeLut, ScattersByTheProfile) {
    PelEyeLutDesc desc = descOf(pelEyeDefaults());
    const std::vector<float> plain = tableOf(desc);
    const std::vector<PelGaussian> terms{{0.09f, {1, 0.5f, 0}}, {0.01f, {0, 0.5f, 1}}};
    const Profile profile = Profile::gaussians(terms);
    desc.profile = profile.get();
    const std::vector<float> scattered = tableOf(desc);
    // The sum over the plane, from the plain table by brute force; sub-texels stand for the profile's narrow
    // part.
    const double dx = 12.0 / 64, dy = 6.0 / 64;
    for (const auto& [z, j, i] :
         {std::array{8, 0, 40}, std::array{8, 13, 20}, std::array{16, 30, 33}, std::array{3, 5, 60}})
        for (int c = 0; c < 3; ++c) {
            double sum = 0;
            for (int v = -64; v < 64; ++v)
                for (int u = 0; u < 64; ++u) {
                    const int row = v < 0 ? -1 - v : v;
                    if (std::hypot((u + 0.5) / 32 - 1, (row + 0.5) / 64) > 1) continue;
                    double r = 0;
                    for (int b = 0; b < 8; ++b)
                        for (int a = 0; a < 8; ++a) {
                            const double d2 = std::pow((u - i + (a + 0.5) / 8 - 0.5) * dx, 2) +
                                              std::pow((v - j + (b + 0.5) / 8 - 0.5) * dy, 2);
                            for (const PelGaussian& g : terms)
                                r += g.weight[c] * std::exp(-d2 / (2 * g.variance)) /
                                     (2 * std::acos(-1.0) * g.variance) / 64;
                        }
                    sum += r * dx * dy * plain[3 * ((size_t(z) * 64 + size_t(row)) * 64 + size_t(u))];
                }
            EXPECT_NEAR(scattered[3 * ((size_t(z) * 64 + size_t(j)) * 64 + size_t(i)) + size_t(c)], sum,
                        tolerance::eyeLutScattered)
                << z << ", " << j << ", " << i << ", " << c;
        }
}

TEST(EyeLut, TexelsComeBack) {
    const Device device("");
    PelEyeLutDesc desc = descOf(pelEyeDefaults());
    desc.width = 16, desc.height = 8, desc.depth = 5;
    const Lut lut(device, desc);
    const std::vector<float> texels = lut.read<float>(PEL_LUT_FLOAT);
    ASSERT_EQ(texels.size(), 16u * 8 * 5 * 3);
    EXPECT_EQ(Lut(device, lut.info(), texels).read<float>(PEL_LUT_FLOAT), texels);
    EXPECT_EQ(lut.info().eye.irisRadius, 6);
    EXPECT_EQ(lut.read<uint16_t>(PEL_LUT_HALF).size(), texels.size());
    EXPECT_THROW(lut.read<uint8_t>(PEL_LUT_FACEWORKS8), Error);
}
