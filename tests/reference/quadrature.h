// Globally adaptive Gauss-Kronrod quadrature in double precision, for a number or an RGB triple.
#pragma once

#include <queue>
#include <stdexcept>
#include <vector>

#include "reference/vec.h"

namespace reference {

// Nodes in (0, 1] order from the end of [-1, 1] to its centre, Kronrod weights, and the weights of the
// embedded 7-point Gauss rule (0 where a node is Kronrod's only). R. Piessens et al., QUADPACK (1983), rule
// qk15.
struct KronrodNode {
    double position, kronrod, gauss;
};
inline constexpr KronrodNode kronrod15[8] = {
    {0.991455371120812639206854697526329, 0.022935322010529224963732008058970, 0},
    {0.949107912342758524526189684047851, 0.063092092629978553290700663189204,
     0.129484966168869693270611432679082},
    {0.864864423359769072789712788640926, 0.104790010322250183839876322541518, 0},
    {0.741531185599394439863864773280788, 0.140653259715525918745189590510238,
     0.279705391489276667901467771423780},
    {0.586087235467691130294144838258730, 0.169004726639267902826583426598550, 0},
    {0.405845151377397166906606412076961, 0.190350578064785409913256402421014,
     0.381830050505118944950369775488975},
    {0.207784955007898467600689403773245, 0.204432940075298892414161999234649, 0},
    {0, 0.209482141084727828012999174891714, 0.417959183673469387755102040816327},
};

template <class Value>
struct Panel {
    double begin, end, error;
    Value value;
    bool operator<(const Panel& other) const { return error < other.error; }
};

template <class Value, class F>
Panel<Value> kronrodPanel(const F& f, double begin, double end) {
    const double centre = 0.5 * (begin + end), half = 0.5 * (end - begin);
    Value samples[15];
    for (int i = 0; i < 7; ++i) {
        samples[i] = f(centre - half * kronrod15[i].position);
        samples[14 - i] = f(centre + half * kronrod15[i].position);
    }
    samples[7] = f(centre);
    Value kronrod{}, gauss{};
    for (int i = 0; i < 15; ++i) {
        const KronrodNode& node = kronrod15[std::min(i, 14 - i)];
        kronrod = kronrod + node.kronrod * samples[i];
        gauss = gauss + node.gauss * samples[i];
    }
    // QUADPACK's estimate: the difference of the two rules, sharpened where the integrand varies little.
    double spread = 0;
    for (int i = 0; i < 15; ++i)
        spread += kronrod15[std::min(i, 14 - i)].kronrod * magnitude(samples[i] - 0.5 * kronrod);
    spread *= half;
    double error = half * magnitude(kronrod - gauss);
    if (spread > 0 && error > 0) error = spread * std::min(1.0, std::pow(200 * error / spread, 1.5));
    return {begin, end, error, half * kronrod};
}

// Integrates f over [points.front(), points.back()]; the points between are kinks or changes of scale and
// become panel borders. f is never evaluated at a panel's border. Throws when the wanted error is out of
// reach or a sample is not finite: an oracle must not be quietly wrong.
template <class Value, class F>
Value integrate(const F& f, const std::vector<double>& points, double absoluteError = 1e-13,
                double relativeError = 1e-12) {
    std::priority_queue<Panel<Value>> panels;
    double error = 0;
    Value total{};
    for (size_t i = 0; i + 1 < points.size(); ++i) {
        if (!(points[i + 1] > points[i])) continue;
        panels.push(kronrodPanel<Value>(f, points[i], points[i + 1]));
        error += panels.top().error;
    }
    const int panelLimit = 20000;
    Panel<Value> settled{};  // panels too narrow to split again
    const auto sum = [&] {
        Value value = settled.value;
        error = settled.error;
        for (auto copy = panels; !copy.empty(); copy.pop()) {
            value = value + copy.top().value;
            error += copy.top().error;
        }
        return value;
    };
    total = sum();
    for (int count = 0; !panels.empty() && count <= panelLimit; ++count) {
        if (!std::isfinite(magnitude(total)))
            throw std::runtime_error("reference::integrate: an integrand is not finite");
        if (error <= std::max(absoluteError, relativeError * magnitude(total))) return sum();
        const Panel<Value> worst = panels.top();
        panels.pop();
        if (worst.end - worst.begin < 1e-14 * (std::abs(worst.begin) + std::abs(worst.end))) {
            settled.value = settled.value + worst.value;
            settled.error += worst.error;
            continue;
        }
        const double middle = 0.5 * (worst.begin + worst.end);
        for (const auto& half :
             {kronrodPanel<Value>(f, worst.begin, middle), kronrodPanel<Value>(f, middle, worst.end)}) {
            total = total + half.value;
            error += half.error;
            panels.push(half);
        }
        total = total - worst.value;
        error -= worst.error;
    }
    total = sum();
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
