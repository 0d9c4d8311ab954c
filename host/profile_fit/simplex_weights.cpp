#include "profile_fit/simplex_weights.h"

#include <algorithm>
#include <cmath>

namespace pellucid::io {
namespace {

double dot(const double* a, const double* b, size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; ++i) sum += a[i] * b[i];
    return sum;
}

// Least squares over the columns of `free` alone, with weights that add up to 1: the last weight is 1 minus
// the others.
std::vector<double> onFreeColumns(const Columns& a, std::span<const double> b,
                                  const std::vector<size_t>& free) {
    const size_t last = free.size() - 1;
    Columns reduced{a.rows, last, std::vector<double>(a.rows * last)};
    const double* base = a.column(free[last]);
    for (size_t k = 0; k < last; ++k)
        for (size_t i = 0; i < a.rows; ++i) reduced.column(k)[i] = a.column(free[k])[i] - base[i];
    std::vector<double> target(b.begin(), b.end());
    for (size_t i = 0; i < a.rows; ++i) target[i] -= base[i];
    std::vector<double> x = leastSquares(reduced, target);
    double rest = 1;
    for (double value : x) rest -= value;
    x.push_back(rest);
    return x;
}

std::vector<double> residual(const Columns& a, std::span<const double> weights, std::span<const double> b) {
    std::vector<double> r(b.begin(), b.end());
    for (size_t k = 0; k < a.count; ++k)
        if (weights[k] != 0)
            for (size_t i = 0; i < a.rows; ++i) r[i] -= weights[k] * a.column(k)[i];
    return r;
}

}  // namespace

std::vector<double> leastSquares(Columns& a, std::vector<double>& b) {
    const size_t n = std::min(a.count, a.rows);
    std::vector<double> diagonal(a.count, 0.0);
    std::vector<bool> used(a.count, false);
    size_t row = 0;
    std::vector<size_t> rowOf(a.count, 0);
    for (size_t k = 0; k < n; ++k) {
        double* column = a.column(k);
        const double below = std::sqrt(dot(column + row, column + row, a.rows - row)),
                     all = std::sqrt(dot(column, column, a.rows));
        if (!(below > 1e-13 * all)) continue;
        const double alpha = column[row] > 0 ? -below : below;
        column[row] -= alpha;  // the reflection's vector, in place
        const double scale = dot(column + row, column + row, a.rows - row) / 2;
        const auto reflect = [&](double* v) {
            const double s = dot(column + row, v + row, a.rows - row) / scale;
            for (size_t i = row; i < a.rows; ++i) v[i] -= s * column[i];
        };
        for (size_t other = k + 1; other < a.count; ++other) reflect(a.column(other));
        reflect(b.data());
        diagonal[k] = alpha;
        used[k] = true;
        rowOf[k] = row++;
        if (row == a.rows) break;
    }
    std::vector<double> x(a.count, 0.0);
    for (size_t k = a.count; k-- > 0;) {
        if (!used[k]) continue;
        double value = b[rowOf[k]];
        for (size_t other = k + 1; other < a.count; ++other) value -= a.column(other)[rowOf[k]] * x[other];
        x[k] = value / diagonal[k];
    }
    return x;
}

std::vector<double> simplexWeights(const Columns& a, std::span<const double> b) {
    std::vector<double> w(a.count, 0.0);
    size_t best = 0;
    double least = -1;
    for (size_t k = 0; k < a.count; ++k) {
        double squares = 0;
        for (size_t i = 0; i < a.rows; ++i) squares += (a.column(k)[i] - b[i]) * (a.column(k)[i] - b[i]);
        if (least < 0 || squares < least) least = squares, best = k;
    }
    w[best] = 1;
    std::vector<size_t> free{best};
    double largest = 0;
    for (size_t k = 0; k < a.count; ++k) largest = std::max(largest, dot(a.column(k), a.column(k), a.rows));
    for (size_t round = 0; round < 4 * a.count + 8; ++round) {
        // At the optimum all free columns have the same slope, and no other has a steeper one.
        const std::vector<double> r = residual(a, w, b);
        double level = 0, steepest = 1e-14 * largest;
        for (size_t k : free) level += dot(a.column(k), r.data(), a.rows) / double(free.size());
        size_t entering = a.count;
        for (size_t k = 0; k < a.count; ++k) {
            if (std::find(free.begin(), free.end(), k) != free.end()) continue;
            const double gain = dot(a.column(k), r.data(), a.rows) - level;
            if (gain > steepest) steepest = gain, entering = k;
        }
        if (entering == a.count) break;
        free.push_back(entering);
        for (;;) {
            const std::vector<double> z = onFreeColumns(a, b, free);
            double share = 1;
            for (size_t f = 0; f < free.size(); ++f)
                if (z[f] <= 0) share = std::min(share, w[free[f]] / (w[free[f]] - z[f] + 1e-300));
            for (size_t f = 0; f < free.size(); ++f) w[free[f]] += share * (z[f] - w[free[f]]);
            if (share >= 1) break;
            std::erase_if(free, [&](size_t k) {
                if (w[k] > 1e-15) return false;
                w[k] = 0;
                return true;
            });
            if (free.size() <= 1) {
                if (free.size() == 1) w[free[0]] = 1;
                break;
            }
        }
    }
    return w;
}

double squaredResidual(const Columns& a, std::span<const double> weights, std::span<const double> b) {
    const std::vector<double> r = residual(a, weights, b);
    return dot(r.data(), r.data(), r.size());
}

}  // namespace pellucid::io
