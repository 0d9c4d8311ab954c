// Least squares under the constraints of a mixture.
#pragma once
#include <span>
#include <vector>

namespace pellucid::io {

// Columns of `rows` numbers each, stored one after another.
struct Columns {
    size_t rows = 0, count = 0;
    std::vector<double> values;
    double* column(size_t i) { return values.data() + i * rows; }
    const double* column(size_t i) const { return values.data() + i * rows; }
};

// The x with the least |A x - b|, by Householder reflections. A column that depends on others gets 0. `a` and
// `b` are overwritten.
std::vector<double> leastSquares(Columns& a, std::vector<double>& b);

// The weights w >= 0 with sum 1 and the least |A w - b|: the active sets of Lawson and Hanson (Solving Least
// Squares Problems, 1974, chapter 23), on the simplex.
std::vector<double> simplexWeights(const Columns& a, std::span<const double> b);

// The sum of squares of A w - b.
double squaredResidual(const Columns& a, std::span<const double> weights, std::span<const double> b);

}  // namespace pellucid::io
