// Adaptive Gauss-Kronrod quadrature in double precision, for a number or an RGB triple.
#pragma once

#include <array>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <stdexcept>
#include <vector>

#include "reference/vec.h"

namespace reference {

template <class Value>
struct Panel {
    double begin, end, error;
    Value value;
};

// The rule of 15 points, and for its error the 7-point Gauss rule inside of it.
template <class Value, class F>
Panel<Value> kronrodPanel(const F& f, double begin, double end) {
    using Kronrod = boost::math::quadrature::gauss_kronrod<double, 15>;
    using Gauss = boost::math::quadrature::gauss<double, 7>;
    const double centre = 0.5 * (begin + end), half = 0.5 * (end - begin);
    std::array<Value, 15> samples;
    Value kronrod{}, gauss{};
    for (int i = -7; i <= 7; ++i) {
        const size_t node = size_t(std::abs(i));
        const Value v = samples[size_t(i + 7)] =
            f(centre + std::copysign(half * Kronrod::abscissa()[node], double(i)));
        kronrod = kronrod + Kronrod::weights()[node] * v;
        if (node % 2 == 0) gauss = gauss + Gauss::weights()[node / 2] * v;
    }
    // QUADPACK's estimate: the difference of the two rules, sharpened where the integrand varies little.
    double spread = 0, error = half * magnitude(kronrod - gauss);
    for (int i = -7; i <= 7; ++i)
        spread += half * Kronrod::weights()[size_t(std::abs(i))] *
                  magnitude(samples[size_t(i + 7)] - 0.5 * kronrod);
    if (spread > 0 && error > 0) error = spread * std::min(1.0, std::pow(200 * error / spread, 1.5));
    return {begin, end, error, half * kronrod};
}

// Integrates f over [points.front(), points.back()]; the points between are kinks or changes of scale and
// become panel borders. f is never evaluated at a panel's border. Throws if the requested error cannot be
// reached or a sample is not finite: an oracle must not be silently wrong.
template <class Value, class F>
Value integrate(const F& f, const std::vector<double>& points, double absoluteError = 1e-13,
                double relativeError = 1e-12) {
    std::vector<Panel<Value>> open;
    Value rough{}, total{};
    for (size_t i = 0; i + 1 < points.size(); ++i) {
        if (!(points[i + 1] > points[i])) continue;
        open.push_back(kronrodPanel<Value>(f, points[i], points[i + 1]));
        rough = rough + open.back().value;
    }
    const double wanted = std::max(absoluteError, relativeError * magnitude(rough));
    double error = 0;
    for (int panels = 0; !open.empty(); ++panels) {
        const auto [begin, end, off, value] = open.back();
        open.pop_back();
        if (!std::isfinite(magnitude(value)) || panels > 40000)
            throw std::runtime_error("reference::integrate: not finite, or no convergence");
        if (off > wanted / 10 && end - begin > 1e-14 * (std::abs(begin) + std::abs(end))) {
            const double middle = 0.5 * (begin + end);
            open.push_back(kronrodPanel<Value>(f, begin, middle));
            open.push_back(kronrodPanel<Value>(f, middle, end));
            continue;
        }
        total = total + value, error += off;
    }
    if (error > 100 * std::max(absoluteError, relativeError * magnitude(total)))
        throw std::runtime_error("reference::integrate: no convergence");
    return total;
}

// begin, end and those candidates that lie strictly between, ascending.
inline std::vector<double> panelPoints(double begin, double end, std::vector<double> candidates) {
    std::vector<double> points{begin};
    std::sort(candidates.begin(), candidates.end());
    for (double candidate : candidates)
        if (candidate > points.back() && candidate < end) points.push_back(candidate);
    points.push_back(end);
    return points;
}

}  // namespace reference
