#include "diffusion/profile_table.h"

#include <bit>
#include <numbers>

#include "shading/material.h"

namespace pel {
namespace {

// The factor 1 + k t of R (docs/mathematics.md, section 12) has the k for which uniform light on a sphere
// gains this times mean free path and curvature, to first order: k = 0.92 at a reflectance of 0.8.
constexpr double gainPerCurvature = 1.06;

// 2 pi r R dr over [begin, end], integrated over the logarithm of r by Gauss-Legendre with four points.
// Within a sixteenth of an octave a profile is so close to a polynomial that the error is far below a
// float's.
Rgb lightBetween(const ProfileShape& shape, double begin, double end) {
    constexpr double points[] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                 0.8611363115940526};
    constexpr double weights[] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                  0.3478548451374538};
    const double middle = std::log(begin * end) / 2, half = std::log(end / begin) / 2;
    Rgb sum{};
    for (int k = 0; k < 4; ++k) {
        const double r = std::exp(middle + half * points[k]);
        sum += weights[k] * half * 2 * std::numbers::pi * r * r * shape.radial(r);
    }
    return sum;
}

// Mean of R over a square at a distance that is as wide as blocks of a ring are at theirs, by 3 x 3 points
// of Gauss (PEL_BLOCK_WIDTH). R is convex: its value at the middle would lose 2 to 4 % of the light.
template <class Density>
Rgb meanOfBlock(const Density& density, double distance) {
    constexpr double at[] = {-0.7745966692414834, 0, 0.7745966692414834},
                     weights[] = {5 / 18., 8 / 18., 5 / 18.};
    const double half = PEL_BLOCK_WIDTH / 2 * distance;
    Rgb sum{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            sum += weights[i] * weights[j] * density(std::hypot(distance + at[i] * half, at[j] * half));
    return sum;
}

Rgb densityOfBlock(const ProfileShape& shape, double distance) {
    return meanOfBlock([&](double r) { return shape.radial(r); }, distance);
}

// Radii at equal steps in the bits of their squares, as the device finds nodes.
double radiusOfNode(uint32_t bits) {
    return std::sqrt(double(std::bit_cast<float>(bits)));
}

// Mean excess of look-ups between two nodes: chords of a convex curve lie above it.
template <class Density>
Rgb aboveCurve(const Density& density, uint32_t bits, uint32_t step) {
    const Rgb a = density(radiusOfNode(bits)), b = density(radiusOfNode(bits + step)),
              middle = density(radiusOfNode(bits + step / 2));
    return 2 / 3. * ((a + b) / 2 - middle);
}

// The value of a node from which look-ups on both sides of it are right in the mean.
template <class Density>
Rgb valueOfNode(const Density& density, uint32_t bits, uint32_t step, bool isFirst) {
    const Rgb after = aboveCurve(density, bits, step),
              before = isFirst ? after : aboveCurve(density, bits - step, step);
    return density(radiusOfNode(bits)) - (before + after) / 2;
}

// Solves A x = b for a symmetric positive definite A (Cholesky), three right sides at a time.
void solve(std::vector<double>& a, std::vector<Rgb>& b) {
    const size_t n = b.size();
    for (size_t j = 0; j < n; ++j)
        for (size_t i = j; i < n; ++i) {
            double sum = a[i * n + j];
            for (size_t k = 0; k < j; ++k) sum -= a[i * n + k] * a[j * n + k];
            a[i * n + j] = i == j ? std::sqrt(sum) : sum / a[j * n + j];
        }
    for (size_t i = 0; i < n; ++i) {
        for (size_t k = 0; k < i; ++k) b[i] = b[i] - a[i * n + k] * b[k];
        b[i] = b[i] / a[i * n + i];
    }
    for (size_t i = n; i-- > 0;) {
        for (size_t k = i + 1; k < n; ++k) b[i] = b[i] - a[k * n + i] * b[k];
        b[i] = b[i] / a[i * n + i];
    }
}

// Least squares of the light in each part of an octave, from the reach down to a 2^8th of it. The terms are
// nearly dependent, so a small multiple of the unit matrix is added.
template <class Density>
std::vector<Rgb> gaussiansOf(const Density& density, double widest, double reach) {
    constexpr int perTerm = 16, n = PEL_PROFILE_TERMS;
    std::vector<double> a(n * n), columns[n];
    std::vector<Rgb> b(n), light;
    for (int s = 0; s <= perTerm * n; ++s) {
        const double r = reach * std::exp2(-0.5 * s / perTerm), lightPerLog = 2 * std::numbers::pi * r * r;
        light.push_back(lightPerLog * density(r));
        for (int i = 0; i < n; ++i)
            columns[i].push_back(lightPerLog * std::exp2(-widest * std::exp2(i) * r * r));
    }
    // A compromise between absolute and relative error: tails have little light, but all of the light through
    // an ear.
    double most = 0;
    for (const Rgb& l : light) most = std::max(most, largest(l));
    for (size_t s = 0; s < light.size(); ++s) {
        const double weight = 1 / std::sqrt(largest(light[s]) + 3e-3 * most);
        light[s] = weight * light[s];
        for (int i = 0; i < n; ++i) columns[i][s] *= weight;
    }
    double lengths[n];
    for (int i = 0; i < n; ++i) {
        double square = 0;
        for (double v : columns[i]) square += v * v;
        lengths[i] = std::sqrt(square);
    }
    for (int i = 0; i < n; ++i)
        for (int j = 0; j <= i; ++j) {
            double sum = 0;
            for (size_t s = 0; s < light.size(); ++s) sum += columns[i][s] * columns[j][s];
            a[size_t(i * n + j)] = a[size_t(j * n + i)] =
                sum / (lengths[i] * lengths[j]) + (i == j ? 1e-6 : 0);
        }
    for (int i = 0; i < n; ++i) {
        for (size_t s = 0; s < light.size(); ++s) b[i] += columns[i][s] * light[s];
        b[i] = b[i] / lengths[i];
    }
    solve(a, b);
    for (int i = 0; i < n; ++i) b[i] = b[i] / lengths[i];
    return b;
}

// Transmittance of a slab for diffuse light on its far side, over the reflectance of a half-space, by
// diffusion theory with an extrapolated boundary (docs/mathematics.md, section 12, "Slabs").
class Slab {
  public:
    // `s`: sqrt(1 - albedo of a single scattering)
    explicit Slab(double s) {
        const double absorbed = s * s;
        decay_ = std::sqrt(3 * absorbed) * (1 - 0.4 * absorbed - 0.075 * absorbed * absorbed);
        strength_ = 4 / 3. * decay_ * (1 + 1.3 * absorbed) * (1 + 1.17 * s) / ((1 - s) * (1 - 0.139 * s));
    }
    // `thickness`: in mean free paths.
    double transmitted(double thickness) const { return strength_ / std::sinh(at(thickness)); }

  private:
    double at(double thickness) const { return decay_ * (thickness + 1.42); }
    double decay_, strength_;
};

// V(s): light through a slab of thickness s, from a point on its far side straight to the other, scaled so
// that the sum within `reach`, over surfaces that count there (PEL_SLAB_COSINE), is that of a random walk.
template <class Density>
Rgb densityThrough(const Density& density, const Rgb& path, const Rgb& meanDistance, double directed,
                   double reach, double s) {
    constexpr int steps = 64;
    const double first = s / PEL_SLAB_COSINE, step = std::max(std::log(reach / first), 0.0) / steps;
    Rgb along{};  // from r = s / cosine on
    for (int i = 0; i < steps; ++i) {
        const double r = first * std::exp((i + 0.5) * step),
                     far = std::max(s / r - PEL_SLAB_FROM, 0.0) / (PEL_SLAB_COSINE - PEL_SLAB_FROM),
                     weight = 2 * std::numbers::pi * r * r * (1 - far) * (1 + directed * s / r) * step;
        along += weight * density(r);
    }
    Rgb through{};
    for (int c = 0; c < 3; ++c) {
        if (!(path[c] > 0)) continue;
        const double t = s / path[c], q = PEL_SLAB_FIRST + PEL_SLAB_SPREAD * std::sqrt(t), b = s / q,
                     left = Slab(std::min(mediumAbsorption(2.5 * path[c] / meanDistance[c]), 0.68))
                                .transmitted(t) -
                            along[c],
                     area = s + b - (reach + b) * std::exp((s - reach) / b);  // 1 / 2 pi b of what counts
        through[c] = std::max(left, 0.0) / (2 * std::numbers::pi * b * std::max(area, 0.6 * (s + b)));
    }
    return through;
}

}  // namespace

ProfileNodes profileNodes(const ProfileShape& shape, double scale, const Rgb& meanFreePath, double strength) {
    const Rgb width = shape.width();
    const double narrowest = smallest(width), widest = largest(width);
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
    // 12 octaves of r below the first node
    for (uint32_t octave = 24 * PEL_PROFILE_NODES; octave > 0; --octave)
        within += lightBetween(shape, radiusOfNode(firstBits - octave * step) / scale,
                               radiusOfNode(firstBits - (octave - 1) * step) / scale);
    std::vector<Rgb> shares{within};
    Rgb distance{};
    for (uint32_t bits = firstBits; bits < lastBits; bits += step) {
        const Rgb light = lightBetween(shape, radiusOfNode(bits) / scale, radiusOfNode(bits + step) / scale);
        within += light;
        distance += radiusOfNode(bits + step / 2) * light;
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
    const double reach = radiusOfNode(firstBits + uint32_t(nodes - 1) * step);
    const double fall = 4 / (reach * reach);  // of the widest Gaussian, which is 1/16 at the reach
    result.table = {0, uint32_t(nodes), firstBits, float(reach), float(fall), 0, {}, 0, {}, 1};
    result.values.resize(12 * nodes);
    for (int c = 0; c < 3; ++c) result.meanDistance[c] = distance[c] / within[c];
    const Rgb all = shares[nodes - 1];
    for (size_t k = 0; k < nodes; ++k) {
        const uint32_t bits = firstBits + uint32_t(k) * step;
        const Rgb density =
                      valueOfNode([&](double r) { return shape.radial(r / scale); }, bits, step, k == 0),
                  blocks = valueOfNode([&](double r) { return densityOfBlock(shape, r / scale); }, bits, step,
                                       k == 0);
        for (int c = 0; c < 3; ++c) {
            const double unit = all[c] * scale * scale;
            if (k + 1 < nodes) {
                result.values[4 * k + c] = float(density[c] / unit);
                result.values[4 * (2 * nodes + k) + c] = float(blocks[c] / unit);
            }
            result.values[4 * (nodes + k) + c] = float(shares[k][c] / all[c]);
        }
    }
    const auto append = [&](const auto& density) {
        for (const Rgb& term : gaussiansOf(density, fall, reach))
            for (int c = 0; c < 4; ++c) result.values.push_back(c < 3 ? float(term[c]) : 0.0f);
    };
    const auto perArea = [&](const Rgb& density) {
        return threeOf([&](int c) { return density[c] / (all[c] * scale * scale); });
    };
    append([&](double r) { return perArea(shape.radial(r / scale)); });
    append([&](double r) { return perArea(densityOfBlock(shape, r / scale)); });
    const Rgb& mean = result.meanDistance;
    const double directed = 2 * gainPerCurvature * strength *
                            (meanFreePath[0] + meanFreePath[1] + meanFreePath[2]) /
                            (mean[0] + mean[1] + mean[2]);
    result.table.directed = float(directed);
    if (directed == 0) return result.values.resize(result.values.size() + 4 * PEL_PROFILE_TERMS), result;
    result.table.slab = float(std::min(strength, 1.0));
    for (int c = 0; c < 3; ++c)
        result.table.spread[c] =
            meanFreePath[c] > 0 ? float(PEL_SLAB_SPREAD / std::sqrt(meanFreePath[c])) : 0.0f;
    append([&](double s) {
        return densityThrough([&](double x) { return perArea(shape.radial(x / scale)); }, meanFreePath, mean,
                              directed, reach, s);
    });
    return result;
}

}  // namespace pel
