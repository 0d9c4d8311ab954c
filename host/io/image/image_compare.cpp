#include "io/image/image_compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace pellucid::io {
namespace {

// The smallest value that 99 % of the values do not exceed.
double percentile99(std::vector<float>& values) {
    if (values.empty()) return 0;
    const size_t rank = (values.size() * 99 + 99) / 100 - 1;
    std::nth_element(values.begin(), values.begin() + ptrdiff_t(rank), values.end());
    return values[rank];
}

double dot3(const float* a, const float* b) {
    return double(a[0]) * b[0] + double(a[1]) * b[1] + double(a[2]) * b[2];
}

}  // namespace

ImageDifference compareImages(std::span<const float> a, std::span<const float> b,
                              std::span<const uint8_t> mask, size_t* invalid,
                              std::span<const float> secondHalf) {
    if (a.size() != b.size() || a.size() % 3 != 0 || (!mask.empty() && mask.size() != a.size() / 3) ||
        (!secondHalf.empty() && secondHalf.size() != a.size()))
        throw std::invalid_argument("compareImages: the pictures and the mask have different sizes");
    ImageDifference d;
    std::array<std::vector<float>, 3> errors;
    std::vector<float> colors;
    std::array<double, 3> squares{}, noise{};
    for (size_t i = 0; i < a.size() / 3; ++i) {
        if (!mask.empty() && !mask[i]) continue;
        const float *p = &a[3 * i], *first = &b[3 * i],
                    *second = secondHalf.empty() ? first : &secondHalf[3 * i];
        std::array<double, 3> q;
        bool finite = true;
        for (int c = 0; c < 3; ++c) {
            q[c] = (double(first[c]) + second[c]) / 2;
            finite = finite && std::isfinite(p[c]) && std::isfinite(q[c]);
        }
        if (!finite) {
            if (invalid) ++*invalid;
            continue;
        }
        ++d.pixels;
        for (int c = 0; c < 3; ++c) {
            const double e = double(p[c]) - q[c];
            squares[c] += (double(p[c]) - first[c]) * (double(p[c]) - second[c]);
            noise[c] += std::pow((double(first[c]) - second[c]) / 2, 2);
            d.mean[c] += e;
            errors[c].push_back(float(std::abs(e)));
        }
        colors.push_back(float(deltaE2000(labFromLinear({p[0], p[1], p[2]}), labFromLinear(q))));
        d.deltaEMean += colors.back();
    }
    if (d.pixels == 0) {
        constexpr double nan = std::numeric_limits<double>::quiet_NaN();
        for (auto* values : {&d.rmse, &d.noise, &d.mean, &d.p99, &d.max}) values->fill(nan);
        for (double* value : {&d.rmseAll, &d.psnr, &d.deltaEMean, &d.deltaE99, &d.deltaEMax}) *value = nan;
        return d;
    }
    const double n = double(d.pixels);
    for (int c = 0; c < 3; ++c) {
        d.rmse[c] = std::sqrt(std::max(0.0, squares[c] / n));
        d.noise[c] = std::sqrt(noise[c] / n);
        d.mean[c] /= n;
        d.max[c] = *std::max_element(errors[c].begin(), errors[c].end());
        d.p99[c] = percentile99(errors[c]);
    }
    d.rmseAll = std::sqrt(std::max(0.0, (squares[0] + squares[1] + squares[2]) / (3 * n)));
    d.psnr = d.rmseAll > 0 ? -20 * std::log10(d.rmseAll) : std::numeric_limits<double>::infinity();
    d.deltaEMean /= n;
    d.deltaEMax = *std::max_element(colors.begin(), colors.end());
    d.deltaE99 = percentile99(colors);
    return d;
}

std::vector<uint8_t> subsetsOf(const SubsetInputs& in) {
    constexpr double terminator = 0.2,
                     facing = 0.02;  // N.L; below the latter an edge is the terminator's, not a cast shadow's
    const size_t count = size_t(in.width) * size_t(in.height);
    std::vector<uint8_t> subsets(count);
    std::vector<float> cosine(count);
    for (size_t i = 0; i < count; ++i) {
        if (!in.covered[i]) continue;
        cosine[i] = float(dot3(&in.normals[3 * i], &in.toLight[3 * i]));
        subsets[i] = uint8_t((cosine[i] < 0 ? SUBSET_UNLIT : 0) |
                             (std::abs(cosine[i]) < terminator ? SUBSET_TERMINATOR : 0));
        if (in.meanFreePath.empty()) continue;
        if (in.meanCurvature[i] * in.meanFreePath[i] < hollow) subsets[i] |= SUBSET_HOLLOWS;
        if (in.thickness[i] < thin * in.meanFreePath[i]) subsets[i] |= SUBSET_THIN;
    }
    const auto distance = [&](size_t i, size_t j) {
        double sum = 0;
        for (int c = 0; c < 3; ++c)
            sum += std::pow(double(in.positions[3 * i + c]) - in.positions[3 * j + c], 2);
        return std::sqrt(sum);
    };
    const auto mark = [&](int x, int y, double pixel) {
        const size_t centre = size_t(y) * in.width + x;
        const int reach = int(std::min(double(std::max(in.width, in.height)), std::ceil(in.reach / pixel)));
        for (int v = std::max(0, y - reach); v <= std::min(in.height - 1, y + reach); ++v)
            for (int u = std::max(0, x - reach); u <= std::min(in.width - 1, x + reach); ++u) {
                const size_t i = size_t(v) * in.width + u;
                if (in.covered[i] && distance(i, centre) <= in.reach) subsets[i] |= SUBSET_PENUMBRA;
            }
    };
    for (int y = 0; !in.visible.empty() && y < in.height; ++y)
        for (int x = 0; x < in.width; ++x)
            for (int k = 0; k < 2; ++k) {
                const int u = x + (k == 0), v = y + (k == 1);
                if (u >= in.width || v >= in.height) continue;
                const size_t i = size_t(y) * in.width + x, j = size_t(v) * in.width + u;
                if (!in.covered[i] || !in.covered[j] || cosine[i] < facing || cosine[j] < facing) continue;
                if ((in.visible[i] > 0.5f) == (in.visible[j] > 0.5f)) continue;
                const double apart = distance(i, j);
                // Neighbours of a silhouette are pixels of two surfaces.
                if (!(apart > 0) || apart > in.reach) continue;
                mark(x, y, apart);
                mark(u, v, apart);
            }
    for (size_t i = 0; i < count; ++i)
        if (in.covered[i] && !subsets[i]) subsets[i] = SUBSET_REST;
    return subsets;
}

Lab labFromLinear(const std::array<double, 3>& rgb) {
    const double r = std::max(0.0, rgb[0]), g = std::max(0.0, rgb[1]), b = std::max(0.0, rgb[2]);
    auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
    const double x = f((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047);
    const double y = f(0.2126729 * r + 0.7151522 * g + 0.0721750 * b);
    const double z = f((0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.08883);
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

double deltaE2000(const Lab& one, const Lab& two) {
    constexpr double degree = std::numbers::pi / 180, pow25to7 = 6103515625.0;
    const double c1 = std::hypot(one[1], one[2]), c2 = std::hypot(two[1], two[2]);
    const double mean7 = std::pow((c1 + c2) / 2, 7), g = 0.5 * (1 - std::sqrt(mean7 / (mean7 + pow25to7)));
    const double a1 = (1 + g) * one[1], a2 = (1 + g) * two[1];
    const double C1 = std::hypot(a1, one[2]), C2 = std::hypot(a2, two[2]);
    auto hue = [&](double b, double a) {
        const double h = a == 0 && b == 0 ? 0 : std::atan2(b, a) / degree;
        return h < 0 ? h + 360 : h;
    };
    const double h1 = hue(one[2], a1), h2 = hue(two[2], a2);
    double dh = 0, meanH = h1 + h2;
    if (C1 * C2 > 0) {
        dh = h2 - h1;
        if (dh > 180) dh -= 360;
        if (dh < -180) dh += 360;
        meanH = std::abs(h1 - h2) <= 180 ? (h1 + h2) / 2
                                         : (h1 + h2 < 360 ? (h1 + h2 + 360) / 2 : (h1 + h2 - 360) / 2);
    }
    const double dL = two[0] - one[0], dC = C2 - C1, dH = 2 * std::sqrt(C1 * C2) * std::sin(dh / 2 * degree);
    const double meanL = (one[0] + two[0]) / 2, meanC = (C1 + C2) / 2;
    const double t = 1 - 0.17 * std::cos((meanH - 30) * degree) + 0.24 * std::cos(2 * meanH * degree) +
                     0.32 * std::cos((3 * meanH + 6) * degree) - 0.20 * std::cos((4 * meanH - 63) * degree);
    const double l50 = (meanL - 50) * (meanL - 50), mean7C = std::pow(meanC, 7);
    const double sL = 1 + 0.015 * l50 / std::sqrt(20 + l50), sC = 1 + 0.045 * meanC,
                 sH = 1 + 0.015 * meanC * t;
    const double turn = 30 * std::exp(-std::pow((meanH - 275) / 25, 2));
    const double rT = -2 * std::sqrt(mean7C / (mean7C + pow25to7)) * std::sin(2 * turn * degree);
    return std::sqrt(std::pow(dL / sL, 2) + std::pow(dC / sC, 2) + std::pow(dH / sH, 2) +
                     rT * dC / sC * dH / sH);
}

}  // namespace pellucid::io
