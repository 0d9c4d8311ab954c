#include "profile_fit/profile_fit.h"

#include <numbers>

#include "io/toml_writer.h"

namespace pellucid::io {
namespace {

// Columns of `rows` numbers each, stored one after another.
struct Columns {
    size_t rows = 0, count = 0;
    std::vector<double> values;
    double* column(size_t i) { return values.data() + i * rows; }
    const double* column(size_t i) const { return values.data() + i * rows; }
};

double dot(const double* a, const double* b, size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; ++i) sum += a[i] * b[i];
    return sum;
}

// The x with the least |A x - b|, by Householder reflections. A column that depends on others gets 0. `a` and
// `b` are overwritten.
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

// The weights w >= 0 with sum 1 and the least |A w - b|: the active sets of Lawson and Hanson (Solving Least
// Squares Problems, 1974, chapter 23), on the simplex.
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

// The sum of squares of A w - b.
double squaredResidual(const Columns& a, std::span<const double> weights, std::span<const double> b) {
    const std::vector<double> r = residual(a, weights, b);
    return dot(r.data(), r.data(), r.size());
}

constexpr size_t sampleCount = 400;
constexpr int candidates = 96;  // variances tried for a new Gaussian

// The line spread at logarithmic steps; root of the weight times a value, so that sums of squares are
// integrals over s.
struct Samples {
    std::vector<double> at, root;
    std::vector<double> value[3];  // of a channel, times root, of norm 1
    double norm[3] = {};           // root of int P^2 ds
};

Samples sampled(const Profile& profile) {
    Samples s;
    const double radius = profile.info().radius, first = 1e-3 * radius, last = 15 * radius;
    const double step = std::log(last / first) / (sampleCount - 1);
    for (size_t i = 0; i < sampleCount; ++i) {
        s.at.push_back(first * std::exp(double(i) * step));
        s.root.push_back(std::sqrt(s.at.back() * step));
    }
    const std::vector<double> P = profile.lineSpread(s.at);
    for (int c = 0; c < 3; ++c) {
        for (size_t i = 0; i < sampleCount; ++i) s.value[c].push_back(s.root[i] * P[3 * i + size_t(c)]);
        s.norm[c] = std::sqrt(dot(s.value[c].data(), s.value[c].data(), sampleCount));
        for (double& v : s.value[c]) v /= s.norm[c];
    }
    return s;
}

struct Mixture {
    std::vector<double> logVariance;
    std::vector<double> weights[3];
    double squares = 0;  // sum over the channels of the squared relative error
};

// The Gaussians as columns, in the units of a channel's samples.
Columns columnsOf(const Samples& s, const std::vector<double>& logVariance, int channel) {
    Columns a{sampleCount, logVariance.size(), std::vector<double>(sampleCount * logVariance.size())};
    for (size_t g = 0; g < logVariance.size(); ++g) {
        const double variance = std::exp(logVariance[g]);
        const double peak = 1 / std::sqrt(2 * std::numbers::pi * variance) / s.norm[channel];
        for (size_t i = 0; i < sampleCount; ++i)
            a.column(g)[i] = s.root[i] * peak * std::exp(-s.at[i] * s.at[i] / (2 * variance));
    }
    return a;
}

Mixture weighted(const Samples& s, std::vector<double> logVariance) {
    Mixture m{std::move(logVariance), {}, 0};
    for (int c = 0; c < 3; ++c) {
        const Columns a = columnsOf(s, m.logVariance, c);
        m.weights[c] = simplexWeights(a, s.value[c]);
        m.squares += squaredResidual(a, m.weights[c], s.value[c]);
    }
    return m;
}

// One step of Levenberg and Marquardt over all variances and those weights that are not 0; the sum of weights
// is kept. Returns the new variances.
std::vector<double> stepOf(const Samples& s, const Mixture& m, double damping) {
    const size_t n = m.logVariance.size();
    std::vector<size_t> free[3];
    size_t unknowns = n;
    for (int c = 0; c < 3; ++c) {
        for (size_t g = 0; g < n; ++g)
            if (m.weights[c][g] > 0) free[c].push_back(g);
        unknowns += free[c].size() - 1;
    }
    const size_t rows = 3 * sampleCount + n;
    Columns jacobian{rows, unknowns, std::vector<double>(rows * unknowns)};
    std::vector<double> target(rows, 0.0);
    // The weights' columns come first: those of the variances then hold only changes that weights cannot make
    size_t next = 0;
    const size_t firstVariance = unknowns - n;
    for (size_t c = 0; c < 3; ++c) {
        const Columns a = columnsOf(s, m.logVariance, int(c));
        const size_t last = free[c].back();
        for (size_t f = 0; f + 1 < free[c].size(); ++f, ++next)
            for (size_t i = 0; i < sampleCount; ++i)
                jacobian.column(next)[c * sampleCount + i] = a.column(free[c][f])[i] - a.column(last)[i];
        for (size_t i = 0; i < sampleCount; ++i) {
            double r = s.value[c][i];
            for (size_t g = 0; g < n; ++g) {
                const double part = m.weights[c][g] * a.column(g)[i],
                             x = s.at[i] * s.at[i] / std::exp(m.logVariance[g]);
                r -= part;
                jacobian.column(firstVariance + g)[c * sampleCount + i] = part * 0.5 * (x - 1);
            }
            target[c * sampleCount + i] = r;
        }
    }
    for (size_t g = 0; g < n; ++g) {
        double* column = jacobian.column(firstVariance + g);
        column[3 * sampleCount + g] = std::sqrt(damping * (dot(column, column, 3 * sampleCount) + 1e-12));
    }
    const std::vector<double> x = leastSquares(jacobian, target);
    std::vector<double> moved = m.logVariance;
    for (size_t g = 0; g < n; ++g) moved[g] += std::clamp(x[firstVariance + g], -1.0, 1.0);
    return moved;
}

Mixture downhill(const Samples& s, Mixture m) {
    double damping = 1e-3;
    for (int round = 0; round < 200 && damping < 1e8 && m.squares > 1e-26; ++round) {
        Mixture moved = weighted(s, stepOf(s, m, damping));
        const bool better = moved.squares < m.squares;
        const bool little = better && moved.squares > m.squares * (1 - 1e-7) && damping <= 1e-3;
        damping = better ? std::max(damping * 0.1, 1e-15) : damping * 10;
        if (better) m = std::move(moved);
        if (little) break;
    }
    return m;
}

// Adds one Gaussian where it helps most.
Mixture joined(const Samples& s, const std::vector<double>& logVariance, double narrowest, double widest) {
    Mixture best;
    for (int i = 0; i < candidates; ++i) {
        std::vector<double> with = logVariance;
        with.push_back(2 * std::log(narrowest) + 2 * std::log(widest / narrowest) * i / (candidates - 1));
        Mixture m = weighted(s, std::move(with));
        if (i == 0 || m.squares < best.squares) best = std::move(m);
    }
    return downhill(s, std::move(best));
}

}  // namespace

ProfileFit fitGaussians(const Profile& profile, int count) {
    if (count < 1 || count > 12)
        throw std::invalid_argument("a fit has 1 to 12 Gaussians, not " + std::to_string(count));
    const Samples samples = sampled(profile);
    const PelProfileInfo info = profile.info();
    const double widest = 4 * std::max({info.width[0], info.width[1], info.width[2]});
    const double narrowest = 0.02 * std::min({info.width[0], info.width[1], info.width[2]});
    Mixture best;
    for (int n = 0; n < count; ++n) best = joined(samples, best.logVariance, narrowest, widest);
    for (bool improved = true; improved && count > 1 && best.squares > 1e-20;) {
        improved = false;
        for (size_t g = 0; g < best.logVariance.size() && !improved; ++g) {
            std::vector<double> without = best.logVariance;
            without.erase(without.begin() + long(g));
            Mixture other = joined(samples, without, narrowest, widest);
            if (other.squares < best.squares * (1 - 1e-3)) {
                best = std::move(other);
                improved = true;
            }
        }
    }
    ProfileFit fit{};
    for (size_t g = 0; g < best.logVariance.size(); ++g) {
        PelGaussian gaussian{float(std::exp(best.logVariance[g])), {}};
        for (int c = 0; c < 3; ++c) gaussian.weight[c] = float(best.weights[c][g]);
        fit.gaussians.push_back(gaussian);
    }
    std::sort(fit.gaussians.begin(), fit.gaussians.end(),
              [](const auto& a, const auto& b) { return a.variance < b.variance; });
    const std::array<double, 3> error = fitError(profile, Profile::gaussians(fit.gaussians));
    std::copy(error.begin(), error.end(), fit.error);
    return fit;
}

std::array<double, 3> fitError(const Profile& profile, const Profile& fit) {
    const Samples samples = sampled(profile);
    const std::vector<double> P = fit.lineSpread(samples.at);
    std::array<double, 3> error{};
    for (size_t c = 0; c < 3; ++c) {
        for (size_t i = 0; i < sampleCount; ++i) {
            const double difference = samples.value[c][i] - samples.root[i] * P[3 * i + c] / samples.norm[c];
            error[c] += difference * difference;
        }
        error[c] = std::sqrt(error[c]);
    }
    return error;
}

std::string profileText(const ProfileFit& fit, const std::string& name, const std::string& source) {
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out.precision(9);
    out << "name = " << TomlWriter::quoted(name)
        << "\nkind = \"gaussians\"\nunit = \"mm\"\nsource = " << TomlWriter::quoted(source) << '\n';
    for (const PelGaussian& g : fit.gaussians)
        out << "[[gaussian]]\nvariance = " << std::showpoint << g.variance << "\nweight = [" << g.weight[0]
            << ", " << g.weight[1] << ", " << g.weight[2] << "]\n";
    return out.str();
}

}  // namespace pellucid::io
