#include "diffusion/profile_table.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace pel {
namespace {

// 2 pi r R dr over [begin, end], integrated over the logarithm of r by Gauss-Legendre with four points.
// Within a sixteenth of an octave a profile is so close to a polynomial that the error is far below a
// float's.
Rgb lightBetween(const ProfileShape& shape, double begin, double end) {
    constexpr double points[] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                 0.8611363115940526};
    constexpr double weights[] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461, 0.3478548451374538};
    const double middle = std::log(begin * end) / 2, half = std::log(end / begin) / 2;
    Rgb sum{};
    for (int k = 0; k < 4; ++k) {
        const double r = std::exp(middle + half * points[k]);
        const Rgb density = shape.radial(r);
        for (int c = 0; c < 3; ++c) sum[c] += weights[k] * half * 2 * std::numbers::pi * r * r * density[c];
    }
    return sum;
}

// Mean of R over a square at a distance that is as wide as blocks of a ring are at theirs, by 3 x 3 points of Gauss
// (PEL_BLOCK_WIDTH). R bends upwards: its value at the middle would lose 2 to 4 % of the light.
Rgb densityOfBlock(const ProfileShape& shape, double distance) {
    constexpr double at[] = {-0.7745966692414834, 0, 0.7745966692414834},
                     weights[] = {5 / 18., 8 / 18., 5 / 18.};
    const double half = PEL_BLOCK_WIDTH / 2 * distance;
    Rgb sum{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const Rgb density = shape.radial(std::hypot(distance + at[i] * half, at[j] * half));
            for (int c = 0; c < 3; ++c) sum[c] += weights[i] * weights[j] * density[c];
        }
    return sum;
}

// Radii at equal steps in the bits of their squares, as the device finds nodes.
double radiusOfNode(uint32_t bits) {
    return std::sqrt(double(std::bit_cast<float>(bits)));
}

}  // namespace

ProfileNodes profileNodes(const ProfileShape& shape, double scale) {
    const Rgb width = shape.width();
    const double narrowest = std::min({width[0], width[1], width[2]}),
                 widest = std::max({width[0], width[1], width[2]});
    // A thousandth of the narrowest width: light within belongs to the pixel itself.
    const double first = 1e-3 * narrowest * scale, farthest = 64 * widest * scale;
    if (!(first * first > 1e-30) || !(farthest * farthest < 1e30))
        invalidArgument("a profile ", widest * scale,
                        " wide in the unit of positions cannot be tabulated; 1e-9 to 1e12 can");
    const auto nodeOf = [](double r) {
        return std::bit_cast<uint32_t>(float(r * r)) >> PEL_PROFILE_NODE_BITS << PEL_PROFILE_NODE_BITS;
    };
    constexpr uint32_t step = 1u << PEL_PROFILE_NODE_BITS;
    const uint32_t firstBits = nodeOf(first), lastBits = nodeOf(farthest) + step;
    Rgb within{};
    for (uint32_t octave = 24 * PEL_PROFILE_NODES; octave > 0; --octave) {  // 12 octaves of r below the first node
        const Rgb light = lightBetween(shape, radiusOfNode(firstBits - octave * step) / scale,
                                       radiusOfNode(firstBits - (octave - 1) * step) / scale);
        for (int c = 0; c < 3; ++c) within[c] += light[c];
    }
    std::vector<Rgb> shares{within};
    for (uint32_t bits = firstBits; bits < lastBits; bits += step) {
        const Rgb light = lightBetween(shape, radiusOfNode(bits) / scale, radiusOfNode(bits + step) / scale);
        for (int c = 0; c < 3; ++c) within[c] += light[c];
        shares.push_back(within);
    }
    size_t nodes = 1;
    const auto left = [&](size_t node) {
        double most = 0;
        for (int c = 0; c < 3; ++c) most = std::max(most, 1 - shares[node][c] / within[c]);
        return most;
    };
    while (nodes + 1 < shares.size() && left(nodes) > lightBeyondReach) ++nodes;
    ++nodes;  // the last one: no light is left

    ProfileNodes result;
    result.table = {0, uint32_t(nodes), firstBits, float(radiusOfNode(firstBits + uint32_t(nodes - 1) * step))};
    result.values.resize(12 * nodes);
    const Rgb all = shares[nodes - 1];
    for (size_t k = 0; k < nodes; ++k) {
        const double radius = radiusOfNode(firstBits + uint32_t(k) * step) / scale;
        const Rgb density = shape.radial(radius), blocks = densityOfBlock(shape, radius);
        for (int c = 0; c < 3; ++c) {
            const double unit = all[c] * scale * scale;
            if (k + 1 < nodes) {
                result.values[4 * k + c] = float(density[c] / unit);
                result.values[4 * (2 * nodes + k) + c] = float(blocks[c] / unit);
            }
            result.values[4 * (nodes + k) + c] = float(shares[k][c] / all[c]);
        }
    }
    return result;
}

}  // namespace pel
