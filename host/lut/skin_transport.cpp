#include "lut/skin_transport.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace pel {
namespace {

using Complex = std::complex<double>;
constexpr double index = skinIndex, critical = 0.69985421222376498;  // sqrt(1 - 1 / index^2)
// Nodes: depths in the lower layer, azimuths of a quarter turn, three cosines on each side of the critical
// one. With half as many of each the results differ by less than 2 %.
constexpr int depths = 14, azimuths = 2;

// Fresnel's reflectance from inside, the mean of both polarisations; 1 below the critical cosine.
double reflectedInside(double mu) {
    if (mu <= critical) return 1;
    const double outside = std::sqrt(std::max(0.0, 1 - index * index * (1 - mu * mu)));
    const double s = (index * mu - outside) / (index * mu + outside),
                 p = (index * outside - mu) / (index * outside + mu);
    return (s * s + p * p) / 2;
}

struct Node {
    double at, weight;
};

// Gauss-Legendre on [0, 1].
constexpr Node gauss[] = {{0.1127016653792583, 5.0 / 18}, {0.5, 4.0 / 9}, {0.8872983346207417, 5.0 / 18}};

// The decay of light deep in a medium, in units of its extinction: kappa / artanh kappa = albedo [vdH80].
double asymptoticDecay(double albedo) {
    double low = 0, high = 1;
    for (int i = 0; i < 50; ++i) {
        const double middle = (low + high) / 2;
        (middle / std::atanh(middle) > albedo ? low : high) = middle;
    }
    return low;
}

// For a source that is linear over a cell of optical length y: the share of light that passes the cell, and
// the weights of both ends of the source in the light that leaves it.
struct Cell {
    Complex through, near, far;
};
Cell cell(Complex y) {
    const Complex through = std::polar(std::exp(-y.real()), -y.imag());
    if (std::norm(y) < 1e-6) return {through, 0.5 - y / 6.0, 0.5 - y / 3.0};
    const double a = y.real() / std::norm(y), b = -y.imag() / std::norm(y);  // 1 / y
    const auto over = [&](double re, double im) { return Complex(re * a - im * b, re * b + im * a); };
    const Complex all = over(1 - through.real(), -through.imag()), near = over(1 - all.real(), -all.imag());
    return {through, near, all - near};
}

// Light at one depth as a linear function of the source at each depth.
struct Row {
    std::vector<double> re, im;
    explicit Row(int n) : re(n), im(n) {}
    // std::complex would check each product for infinities.
    void scale(int from, int to, Complex by) {
        const double a = by.real(), b = by.imag();
        for (int j = from; j < to; ++j) {
            const double x = re[j];
            re[j] = x * a - im[j] * b;
            im[j] = x * b + im[j] * a;
        }
    }
    void add(int j, Complex value) {
        re[j] += value.real();
        im[j] += value.imag();
    }
};

struct Directions {
    std::vector<Node> nodes;
    Directions() {
        for (const Node& node : gauss)
            nodes.push_back({critical * node.at * node.at, 2 * critical * node.at * node.weight});
        for (const Node& node : gauss) {
            const double mu = std::sqrt(1 - (1 - node.at * node.at) / (index * index));
            nodes.push_back({mu, node.at / (index * index * mu) * node.weight});
        }
    }
};

}  // namespace

double skinReflected(const SkinLayers& layers, double k) {
    static const Directions directions;
    const double upper = 1 + layers.upperAbsorption, lower = 1 + layers.lowerAbsorption;
    // Depths: dense at the surface and at the border of the layers, where light changes fastest.
    std::vector<double> depth{0};
    const double optical = layers.thickness * upper;
    const int thick = 4 + int(std::min(14.0, 3 * optical));
    for (int i = 1; i <= thick; ++i) {
        double x = i / double(thick);
        const double power = 1 + 0.4 * std::log1p(optical);
        x = std::pow(x, power) / (std::pow(x, power) + std::pow(1 - x, power));
        depth.push_back(layers.thickness * x);
    }
    const double reach = 5 / std::sqrt(lower * lower + k * k);
    for (int i = 1; i <= depths; ++i)
        depth.push_back(layers.thickness + reach * std::pow(i / double(depths), 2));
    const int n = int(depth.size());
    const double kappa = lower * asymptoticDecay(1 / lower), decay = std::sqrt(kappa * kappa + k * k);

    const int turns = k > 0 ? azimuths : 1;
    std::vector<double> matrix(size_t(n) * n), light(n), leaving(n);
    std::vector<Cell> cells(n - 1);
    for (const Node& node : directions.nodes) {
        const double mu = node.at, inside = reflectedInside(mu), slant = k * std::sqrt(1 - mu * mu);
        // Diffuse light of irradiance 1 from outside: radiance n^2 (1 - F) / pi inside.
        const double entering = index * index * (1 - inside) / std::numbers::pi;
        for (int turn = 0; turn < turns; ++turn) {
            const double weight = node.weight / (2 * turns);
            const Complex drift{0, slant * std::cos(std::numbers::pi * (turn + 0.5) / (2 * turns))};
            for (int i = 0; i + 1 < n; ++i) {
                const double step = depth[i + 1] - depth[i];
                cells[i] = cell(((i < thick ? upper : lower) + drift) * step / mu);
                cells[i].near *= step / mu;
                cells[i].far *= step / mu;
            }
            Row row(n);
            const auto add = [&](int i, double scale) {
                for (int j = 0; j < n; ++j) matrix[size_t(i) * n + j] += scale * row.re[j];
            };
            // Upwards: from below the last depth comes the asymptotic light.
            row.add(n - 1, 1.0 / (lower + drift + mu * decay));
            add(n - 1, weight);
            for (int i = n - 2; i >= 0; --i) {
                row.scale(i + 1, n, cells[i].through);
                row.add(i + 1, cells[i].far);
                row.add(i, cells[i].near);
                add(i, weight);
            }
            for (int j = 0; j < n; ++j)
                leaving[j] += 2 * std::numbers::pi * (1 - inside) * mu * node.weight / turns * row.re[j];
            // Downwards: light that the surface reflects, and light from outside.
            Complex direct = entering;
            row.scale(0, n, inside);
            for (int i = 0; i < n; ++i) {
                if (i > 0) {
                    row.scale(0, n, cells[i - 1].through);
                    row.add(i - 1, cells[i - 1].far);
                    row.add(i, cells[i - 1].near);
                    direct *= cells[i - 1].through;
                }
                add(i, weight);
                light[i] += weight * direct.real();
            }
        }
    }
    // (1 - matrix) source = light. The matrix has a spectral radius below 1, so no pivots are needed.
    for (double& value : matrix) value = -value;
    for (int i = 0; i < n; ++i) matrix[size_t(i) * n + i] += 1;
    for (int i = 0; i < n; ++i)
        for (int r = i + 1; r < n; ++r) {
            const double factor = matrix[size_t(r) * n + i] / matrix[size_t(i) * n + i];
            for (int j = i; j < n; ++j) matrix[size_t(r) * n + j] -= factor * matrix[size_t(i) * n + j];
            light[r] -= factor * light[i];
        }
    double sum = 0;
    for (int i = n - 1; i >= 0; --i) {
        for (int j = i + 1; j < n; ++j) light[i] -= matrix[size_t(i) * n + j] * light[j];
        light[i] /= matrix[size_t(i) * n + i];
        sum += leaving[i] * light[i];
    }
    return sum;
}

}  // namespace pel
