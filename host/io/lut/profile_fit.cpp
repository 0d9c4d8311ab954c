#include "io/lut/profile_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

namespace pellucid::io {
namespace {

constexpr int sampleCount = 400;

// The line spread at logarithmic steps; weight makes sums over samples integrals over s.
struct Samples {
    std::vector<double> at, weight, value;  // value: RGB per sample
    double norm[3] = {};                    // int P^2 ds
};

Samples sampled(const Profile& profile) {
    Samples s;
    const double radius = profile.info().radius, first = 1e-3 * radius, last = 15 * radius;
    const double step = std::log(last / first) / (sampleCount - 1);
    for (int i = 0; i < sampleCount; ++i) {
        s.at.push_back(first * std::exp(i * step));
        s.weight.push_back(s.at.back() * step);
    }
    s.value = profile.lineSpread(s.at);
    for (int i = 0; i < sampleCount; ++i)
        for (int c = 0; c < 3; ++c) s.norm[c] += s.weight[i] * s.value[3 * i + c] * s.value[3 * i + c];
    return s;
}

struct Fitted {
    std::vector<double> weights;  // RGB per Gaussian
    double error[3];
    double total() const { return error[0] * error[0] + error[1] * error[1] + error[2] * error[2]; }
};

// Non-negative least squares by coordinate descent on the normal equations.
Fitted solve(const Samples& s, const std::vector<double>& logVariance) {
    const size_t n = logVariance.size();
    std::vector<double> basis(n * sampleCount), gram(n * n), target(n * 3);
    for (size_t g = 0; g < n; ++g) {
        const double variance = std::exp(logVariance[g]);
        for (int i = 0; i < sampleCount; ++i)
            basis[g * sampleCount + i] =
                std::exp(-s.at[i] * s.at[i] / (2 * variance)) / std::sqrt(2 * std::numbers::pi * variance);
    }
    for (int i = 0; i < sampleCount; ++i)
        for (size_t g = 0; g < n; ++g) {
            const double b = s.weight[i] * basis[g * sampleCount + i];
            for (size_t h = 0; h < n; ++h) gram[g * n + h] += b * basis[h * sampleCount + i];
            for (int c = 0; c < 3; ++c) target[g * 3 + c] += b * s.value[3 * i + c];
        }
    Fitted f{std::vector<double>(n * 3, 1.0 / double(n)), {}};
    for (int c = 0; c < 3; ++c) {
        for (int sweep = 0; sweep < 300; ++sweep) {
            double moved = 0;
            for (size_t g = 0; g < n; ++g) {
                double rest = target[g * 3 + c];
                for (size_t h = 0; h < n; ++h)
                    if (h != g) rest -= gram[g * n + h] * f.weights[h * 3 + c];
                const double next = std::max(0.0, rest / gram[g * n + g]);
                moved = std::max(moved, std::abs(next - f.weights[g * 3 + c]));
                f.weights[g * 3 + c] = next;
            }
            if (moved < 1e-10) break;
        }
        double squares = 0;
        for (int i = 0; i < sampleCount; ++i) {
            double difference = s.value[3 * i + c];
            for (size_t g = 0; g < n; ++g) difference -= f.weights[g * 3 + c] * basis[g * sampleCount + i];
            squares += s.weight[i] * difference * difference;
        }
        f.error[c] = std::sqrt(squares / s.norm[c]);
    }
    return f;
}

}  // namespace

ProfileFit fitGaussians(const Profile& profile, int count) {
    if (count < 1 || count > 12)
        throw std::invalid_argument("a fit has 1 to 12 Gaussians, not " + std::to_string(count));
    const Samples samples = sampled(profile);
    const PelProfileInfo info = profile.info();
    const double widest = 1.3 * std::max({info.width[0], info.width[1], info.width[2]});
    const double narrowest = 0.15 * std::min({info.width[0], info.width[1], info.width[2]});
    std::vector<double> logVariance;
    for (int g = 0; g < count; ++g) {
        const double t = count == 1 ? 0.5 : double(g) / (count - 1);
        logVariance.push_back(2 * std::log(narrowest * std::pow(widest / narrowest, t)));
    }
    Fitted best = solve(samples, logVariance);
    for (double step = 0.5; step > 0.005; step *= 0.6) {
        bool improved = true;
        for (int round = 0; improved && round < 20; ++round) {
            improved = false;
            for (double& value : logVariance)
                for (double change : {step, -step}) {
                    value += change;
                    Fitted next = solve(samples, logVariance);
                    if (next.total() < best.total() * (1 - 1e-6)) {
                        best = std::move(next);
                        improved = true;
                    } else {
                        value -= change;
                    }
                }
        }
    }
    ProfileFit fit{};
    for (int g = 0; g < count; ++g) {
        PelGaussian gaussian{float(std::exp(logVariance[g])), {}};
        for (int c = 0; c < 3; ++c) gaussian.weight[c] = float(best.weights[g * 3 + c]);
        fit.gaussians.push_back(gaussian);
    }
    std::sort(fit.gaussians.begin(), fit.gaussians.end(),
              [](const auto& a, const auto& b) { return a.variance < b.variance; });
    std::copy(best.error, best.error + 3, fit.error);
    return fit;
}

std::string profileText(const ProfileFit& fit, const std::string& name, const std::string& source) {
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out.precision(9);
    out << "name = \"" << name << "\"\nkind = \"gaussians\"\nunit = \"mm\"\nsource = \"" << source << "\"\n";
    for (const PelGaussian& g : fit.gaussians)
        out << "[[gaussian]]\nvariance = " << std::showpoint << g.variance << "\nweight = [" << g.weight[0]
            << ", " << g.weight[1] << ", " << g.weight[2] << "]\n";
    return out.str();
}

}  // namespace pellucid::io
