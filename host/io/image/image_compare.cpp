#include "io/image/image_compare.h"

#include <limits>
#include <stdexcept>

namespace pellucid::io {

// The smallest value that 99 % of the values do not exceed.
static double percentile99(std::vector<float>& values) {
    if (values.empty()) return 0;
    const size_t rank = (values.size() * 99 + 99) / 100 - 1;
    std::nth_element(values.begin(), values.begin() + ptrdiff_t(rank), values.end());
    return values[rank];
}

static double dot3(const float* a, const float* b) {
    return double(a[0]) * b[0] + double(a[1]) * b[1] + double(a[2]) * b[2];
}

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
                // Neighbours across a silhouette belong to two surfaces.
                if (!(apart > 0) || apart > in.reach) continue;
                mark(x, y, apart);
                mark(u, v, apart);
            }
    for (size_t i = 0; i < count; ++i)
        if (in.covered[i] && !subsets[i]) subsets[i] = SUBSET_REST;
    return subsets;
}

}  // namespace pellucid::io
