// Scattering alone against the surface integral of a head (mathematics, section 9), made by brute force
// elsewhere.
#include <gtest/gtest.h>

#include <algorithm>

#include "diffusion/scatter_scene.h"
#include "io/image/image_file.h"
#include "tolerances.h"

using namespace scatter_scene;

namespace {

constexpr size_t side = 1536, coarse = 512;
constexpr double albedo = 0.8;  // of the pictures that the tolerances are in

struct Head {
    Picture picture{side, side};
    std::vector<float> integral;
};

// Positions are in cm, the camera stands at (0, -60, 0); a pixel of the ruler is 3 x 3 of these.
Head load(const std::string& directory) {
    const pellucid::io::Image image = pellucid::io::readImage(directory + "/head_side_1536.exr");
    Head head;
    const std::string position[] = {"Position.X", "Position.Y", "Position.Z"};
    const std::string surface[] = {"Surface.R", "Surface.G", "Surface.B"};
    head.picture.positions = image.interleaved(position);
    head.integral = image.interleaved(surface);
    const auto &e = image.channel("Irradiance.Y").pixels, &ids = image.channel("IndexOB.X").pixels;
    for (size_t i = 0; i < head.picture.pixels(); ++i) {
        head.picture.ids[i] = ids[i] > 0 ? 1 : 0;
        std::fill_n(&head.picture.irradiance[3 * i], 3, e[i]);
    }
    // Of clip = (x, z, y + 60 - 1, y + 60): only where the camera stands matters.
    float* m = head.picture.params.inverseViewProjection;
    m[0] = m[9] = 1;
    m[6] = -60, m[7] = 0, m[14] = 1;
    return head;
}

// Root mean square per channel over the coarse pixels that are wholly covered, in 1e-4 of radiance.
std::array<double, 3> error(const Head& head, const std::vector<float>& result) {
    std::array<double, 3> sum{};
    size_t count = 0;
    for (size_t y = 0; y < coarse; ++y)
        for (size_t x = 0; x < coarse; ++x) {
            double mean[3] = {};
            bool covered = true;
            for (size_t k = 0; k < 9; ++k) {
                const size_t i = (3 * y + k / 3) * side + 3 * x + k % 3;
                covered &= head.picture.ids[i] != 0;
                for (int c = 0; c < 3; ++c) mean[c] += (result[3 * i + c] - head.integral[3 * i + c]) / 9;
            }
            if (!covered) continue;
            ++count;
            for (int c = 0; c < 3; ++c) sum[c] += mean[c] * mean[c];
        }
    for (double& s : sum) s = 1e4 * albedo * std::sqrt(s / double(count));
    return sum;
}

}  // namespace

TEST(ScatterRuler, HeadLitFromTheSide) {
    const char* directory = std::getenv("PELLUCID_RULER_DIR");
    if (!directory) GTEST_SKIP() << "PELLUCID_RULER_DIR is not set: no surface integral to compare with";
    const Head head = load(directory);
    // d of 0.29205, 0.10902 and 0.05411 mm: mean free path d s(A), s = 1.1 for the albedo 0.8 [Christensen
    // and Burley 2015, eq. 6].
    const float meanFreePath[] = {0.29205f * 1.1f, 0.10902f * 1.1f, 0.05411f * 1.1f},
                white[] = {0.8f, 0.8f, 0.8f};
    const Result result = run(head.picture, Profile::burley(meanFreePath, white), 0.1f);
    const auto ours = error(head, result.scattered), lambert = error(head, head.picture.irradiance);
    const double most[] = {tolerance::rulerHeadRed, tolerance::rulerHeadGreen, tolerance::rulerHeadBlue};
    for (int c = 0; c < 3; ++c) {
        RecordProperty("channel" + std::to_string(c),
                       std::to_string(ours[c]) + " of " + std::to_string(lambert[c]));
        EXPECT_LE(ours[c], most[c]);
        EXPECT_LT(ours[c], lambert[c]);
    }
    // Less than half of the pixels are worth a look.
    EXPECT_LT(result.stats.pixelsTapped, result.stats.pixelsCovered / 2);
}
