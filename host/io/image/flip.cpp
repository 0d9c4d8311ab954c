#include "io/image/flip.h"

#include <numeric>
#include <stdexcept>
#include <vector>

#include "fields/color_difference.h"

namespace pellucid::io {
namespace {

using pel::Lab;

constexpr double pi = std::numbers::pi;

// The paper's screen: 0.7 m away, 0.7 m wide, 3840 columns; 67 pixels per degree.
const double pixelsPerDegree = 0.7 * 3840 / 0.7 * pi / 180;

// Separable weights around a pixel: those of -radius to radius.
using Weights = std::vector<double>;

// One channel of a picture. Beyond its border the nearest pixel counts.
struct Plane {
    int width, height;
    std::vector<double> values;

    Plane along(const Weights& weights, int stepX, int stepY) const {
        Plane sum{width, height, std::vector<double>(values.size())};
        const int radius = int(weights.size() / 2);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (int k = -radius; k <= radius; ++k) {
                    const int u = std::clamp(x + k * stepX, 0, width - 1),
                              v = std::clamp(y + k * stepY, 0, height - 1);
                    sum.values[size_t(y) * width + x] +=
                        weights[size_t(k + radius)] * values[size_t(v) * width + u];
                }
        return sum;
    }
    Plane filtered(const Weights& columns, const Weights& rows) const {
        return along(columns, 1, 0).along(rows, 0, 1);
    }
};

double sumOf(const Weights& weights) {
    return std::accumulate(weights.begin(), weights.end(), 0.0);
}

template <class Function>
Weights weightsOf(int radius, const Function& f) {
    Weights weights;
    for (int k = -radius; k <= radius; ++k) weights.push_back(f(double(k)));
    return weights;
}

// Contrast sensitivity of the eye: sums of two Gaussians a sqrt(pi/b) exp(-pi^2 x^2 / b), x in degrees
// (the paper's spatial filtering, after [Movshon and Kiorpes 1988] and [Mullen 1985]), for the channels
// achromatic, red-green and blue-yellow.
struct Gaussian {
    double a, b;
};
constexpr Gaussian sensitivity[3][2] = {
    {{1, 0.0047}, {0, 1e-5}}, {{1, 0.0053}, {0, 1e-5}}, {{34.1, 0.04}, {13.5, 0.025}}};

Plane asSeen(const Plane& plane, size_t channel) {
    // Three standard deviations of the widest Gaussian, in all channels.
    const int radius = int(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * pixelsPerDegree));
    Plane seen{plane.width, plane.height, std::vector<double>(plane.values.size())};
    double whole = 0;
    for (const auto& [a, b] : sensitivity[channel]) {
        const Weights weights = weightsOf(
            radius, [&, b = b](double k) { return std::exp(-std::pow(pi * k / pixelsPerDegree, 2) / b); });
        const double height = a * std::sqrt(pi / b);
        if (height == 0) continue;
        whole += height * std::pow(sumOf(weights), 2);
        const Plane part = plane.filtered(weights, weights);
        for (size_t i = 0; i < seen.values.size(); ++i) seen.values[i] += height * part.values[i];
    }
    for (double& v : seen.values) v /= whole;
    return seen;
}

// RGB to XYZ over those of white [IEC 61966-2-1, D65], and back.
constexpr double toXyz[3][3] = {{0.4124564 / 0.95047, 0.3575761 / 0.95047, 0.1804375 / 0.95047},
                                {0.2126729, 0.7151522, 0.0721750},
                                {0.0193339 / 1.08883, 0.1191920 / 1.08883, 0.9503041 / 1.08883}};
constexpr double toRgb[3][3] = {{3.2404542 * 0.95047, -1.5371385, -0.4985314 * 1.08883},
                                {-0.9692660 * 0.95047, 1.8760108, 0.0415560 * 1.08883},
                                {0.0556434 * 0.95047, -0.2040259, 1.0572252 * 1.08883}};

std::array<double, 3> times(const double (&m)[3][3], const std::array<double, 3>& v) {
    std::array<double, 3> product{};
    for (size_t r = 0; r < 3; ++r)
        for (size_t c = 0; c < 3; ++c) product[r] += m[r][c] * v[c];
    return product;
}

// Lab whose chroma fades with luminance (the Hunt effect).
Lab adjusted(const std::array<double, 3>& rgb) {
    const Lab lab = pel::labFromLinear(rgb);
    return {lab[0], 0.01 * lab[0] * lab[1], 0.01 * lab[0] * lab[2]};
}

// The distance HyAB [Abasi et al. 2020], compressed (the paper's color metric).
double colorDistance(const Lab& a, const Lab& b) {
    return std::pow(std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]), 0.7);
}

// A picture as colours that the eye resolves, and its edges and points.
struct Seen {
    std::vector<Lab> colors;
    std::vector<double> edges, points;
};

Seen see(std::span<const float> rgb, int width) {
    const int height = int(rgb.size() / 3 / size_t(width));
    const size_t pixels = rgb.size() / 3;
    const Plane black{width, height, std::vector<double>(pixels)};
    Plane opponent[3] = {black, black, black}, luminance = black;
    for (size_t i = 0; i < pixels; ++i) {
        std::array<double, 3> linear;
        for (size_t c = 0; c < 3; ++c) linear[c] = std::clamp(double(rgb[3 * i + c]), 0.0, 1.0);
        const auto [x, y, z] = times(toXyz, linear);
        // YCxCz without scale and offset, which the filters preserve.
        opponent[0].values[i] = luminance.values[i] = y;
        opponent[1].values[i] = x - y, opponent[2].values[i] = y - z;
    }
    for (size_t c = 0; c < 3; ++c) opponent[c] = asSeen(opponent[c], c);
    Seen seen;
    for (size_t i = 0; i < pixels; ++i) {
        const double y = opponent[0].values[i];
        std::array<double, 3> back = times(toRgb, {y + opponent[1].values[i], y, y - opponent[2].values[i]});
        for (double& v : back) v = std::clamp(v, 0.0, 1.0);
        seen.colors.push_back(adjusted(back));
    }
    // Detectors 0.082 degrees wide (the paper's feature detection): a Gaussian's first and second derivative.
    const double sigma = 0.5 * 0.082 * pixelsPerDegree;
    const int radius = int(std::ceil(3 * sigma));
    const auto gaussian = [&](double k) { return std::exp(-0.5 * std::pow(k / sigma, 2)); };
    Weights smooth = weightsOf(radius, gaussian);
    const double whole = sumOf(smooth);
    for (double& w : smooth) w /= whole;
    const auto magnitude = [&](const auto& shape) {
        Weights weights = weightsOf(radius, [&](double k) { return shape(k) * gaussian(k); });
        double sums[2] = {};  // of negative weights and of the others
        for (const double w : weights) sums[w > 0] += std::abs(w);
        for (double& w : weights) w /= sums[w > 0];
        const Plane x = luminance.filtered(weights, smooth), y = luminance.filtered(smooth, weights);
        std::vector<double> lengths;
        for (size_t i = 0; i < pixels; ++i) lengths.push_back(std::hypot(x.values[i], y.values[i]));
        return lengths;
    };
    seen.edges = magnitude([](double k) { return -k; });
    seen.points = magnitude([&](double k) { return std::pow(k / sigma, 2) - 1; });
    return seen;
}

}  // namespace

double flip(std::span<const float> a, std::span<const float> b, int width) {
    if (a.size() != b.size() || width <= 0 || a.size() % (3 * size_t(width)) != 0)
        throw std::invalid_argument("flip: the pictures have different sizes");
    const Seen one = see(a, width), two = see(b, width);
    // The paper's error redistribution: up to 0.4 of the largest distance, that of green and blue, 0 to 0.95.
    const double largest = colorDistance(adjusted({0, 1, 0}), adjusted({0, 0, 1})), knee = 0.4 * largest;
    double sum = 0;
    for (size_t i = 0; i < one.colors.size(); ++i) {
        const double distance = colorDistance(one.colors[i], two.colors[i]),
                     color = distance < knee ? 0.95 * distance / knee
                                             : 0.95 + 0.05 * (distance - knee) / (largest - knee),
                     feature = std::sqrt(std::max(std::abs(one.edges[i] - two.edges[i]),
                                                  std::abs(one.points[i] - two.points[i])) /
                                         std::sqrt(2.0));
        sum += std::pow(color, 1 - feature);
    }
    return sum / double(one.colors.size());
}

}  // namespace pellucid::io
