// Differences between two pictures, as numbers.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "fields/color_difference.h"

namespace pellucid::io {

// All statistics are NaN when no pixel was compared.
struct ImageDifference {
    size_t pixels = 0;              // compared pixels
    std::array<double, 3> rmse{};   // per channel
    std::array<double, 3> noise{};  // standard error of the reference, per channel; 0 without a second half
    std::array<double, 3> mean{};   // of a - b, signed
    std::array<double, 3> p99{};    // of |a - b|, per channel
    std::array<double, 3> max{};    // of |a - b|, per channel
    double rmseAll = 0;             // over all channels
    double psnr = 0;                // dB, of a white of 1 over rmseAll; infinite for equal pictures
    double deltaEMean = 0, deltaE99 = 0, deltaEMax = 0;  // CIEDE2000, values as linear sRGB
};

// `a`, `b`: RGB per pixel, interleaved, of equal length. Only pixels whose `mask` is not 0 count (empty:
// all). Pixels with NaN or Inf in any picture do not count; they are added to `invalid`. Throws
// std::invalid_argument for lengths that do not match.
//
// `secondHalf`: if b is noisy, an independent estimate with the same noise. The mean of both is the reference
// then, and RMSE and PSNR are without its noise: the mean of (a - b)(a - secondHalf) is the squared error.
ImageDifference compareImages(std::span<const float> a, std::span<const float> b,
                              std::span<const uint8_t> mask = {}, size_t* invalid = nullptr,
                              std::span<const float> secondHalf = {});

// Sub-sets of a picture of a lit surface; bits that may be combined. Scattering errs least in the rest.
enum Subset : uint8_t {
    SUBSET_UNLIT = 1,
    SUBSET_TERMINATOR = 2,
    SUBSET_PENUMBRA = 4,
    SUBSET_REST = 8,
    SUBSET_HOLLOWS = 16,
    SUBSET_THIN = 32
};

struct SubsetInputs {
    int width = 0, height = 0;
    std::span<const float> positions;  // xyz per pixel
    std::span<const float> normals;    // unit xyz per pixel
    std::span<const float> toLight;    // unit xyz per pixel
    // 1 lit, 0 in a cast shadow; any value where N.L <= 0. Empty: penumbrae are unknown
    std::span<const float> visible;
    std::span<const uint8_t> covered;  // 0: background
    float reach = 1;  // length, 1 mm: distance of a penumbra's border from the edge of its shadow
    // These three are all given, or all empty.
    std::span<const float> meanCurvature = {};  // 1/length, signed: convex is positive
    std::span<const float> thickness = {};      // length of the body below the pixel, along its normal
    std::span<const float> meanFreePath = {};   // length, of the channel that scatters most
};

// Unlit: N.L < 0. Terminator: |N.L| < 0.2. Penumbra: within `reach` of an edge between neighbouring pixels
// that both face the light, one lit and one not. Hollows: the product of mean curvature and mean free path is
// below `hollow`. Thin: thinner than `thin` mean free paths. Rest: covered and in no other sub-set.
constexpr float hollow = -0.1f, thin = 4;
std::vector<uint8_t> subsetsOf(const SubsetInputs& in);

using pel::deltaE2000, pel::Lab, pel::labFromLinear;

}  // namespace pellucid::io
