#include "profile_fit/profile_fit.h"

#include <Eigen/QR>
#include <algorithm>
#include <numbers>
#include <sstream>

namespace pellucid::io {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

// The weights of the columns `free` that add up to 1 and have the least |A w - b|: the last one is 1 minus
// the others.
VectorXd onFreeColumns(const MatrixXd& a, const VectorXd& b, const std::vector<Index>& free) {
    const VectorXd base = a.col(free.back());
    const Index others = Index(free.size()) - 1;
    MatrixXd reduced = a(Eigen::all, free);
    reduced.colwise() -= base;
    VectorXd w(others + 1);
    w.head(others) = reduced.leftCols(others).colPivHouseholderQr().solve(b - base);
    w[others] = 1 - w.head(others).sum();
    return w;
}

// The weights w >= 0 with sum 1 and the least |A w - b|: the active sets of Lawson and Hanson (Solving Least
// Squares Problems, 1974, chapter 23), on the simplex.
VectorXd simplexWeights(const MatrixXd& a, const VectorXd& b) {
    Index best = 0;
    (a.colwise() - b).colwise().squaredNorm().minCoeff(&best);
    VectorXd w = VectorXd::Unit(a.cols(), best);
    std::vector<Index> free{best};
    const double largest = a.colwise().squaredNorm().maxCoeff();
    for (Index round = 0; round < 4 * a.cols() + 8; ++round) {
        // At the optimum all free columns have the same slope, and no other has a steeper one.
        VectorXd gain = a.transpose() * (b - a * w);
        gain.array() -= gain(free).mean();
        gain(free).setZero();
        Index entering = 0;
        if (!(gain.maxCoeff(&entering) > 1e-14 * largest)) break;
        free.push_back(entering);
        for (;;) {
            const VectorXd z = onFreeColumns(a, b, free), from = w(free);
            double share = 1;
            for (Index f = 0; f < z.size(); ++f)
                if (z[f] <= 0) share = std::min(share, from[f] / (from[f] - z[f] + 1e-300));
            w(free) = from + share * (z - from);
            if (share >= 1) break;
            std::erase_if(free, [&](Index k) {
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

constexpr Index sampleCount = 400;
constexpr int candidates = 96;  // variances tried for a new Gaussian

// The line spread at logarithmic steps; root of the weight times a value, so that sums of squares are
// integrals over s.
struct Samples {
    Eigen::ArrayXd at, root;
    Eigen::MatrixX3d value;   // of each channel, times root, of norm 1
    Eigen::RowVector3d norm;  // root of int P^2 ds
};

// A column for each channel.
Eigen::MatrixX3d spreadAt(const Samples& s, const Profile& profile) {
    const std::vector<double> P = profile.lineSpread({s.at.begin(), s.at.end()});
    return Eigen::Map<const Eigen::Array3Xd>(P.data(), 3, sampleCount).transpose().colwise() * s.root;
}

Samples sampled(const Profile& profile) {
    Samples s;
    const double radius = profile.info().radius, first = std::log(1e-3 * radius),
                 last = std::log(15 * radius);
    s.at = Eigen::ArrayXd::LinSpaced(sampleCount, first, last).exp();
    s.root = (s.at * ((last - first) / (sampleCount - 1))).sqrt();
    s.value = spreadAt(s, profile);
    s.norm = s.value.colwise().norm();
    s.value.array().rowwise() /= s.norm.array();
    return s;
}

struct Mixture {
    std::vector<double> logVariance;
    VectorXd weights[3];
    double squares = 0;  // sum over the channels of the squared relative error
};

// The Gaussians as columns, in the units of a channel's samples.
MatrixXd columnsOf(const Samples& s, const std::vector<double>& logVariance, int channel) {
    MatrixXd a(sampleCount, logVariance.size());
    for (size_t g = 0; g < logVariance.size(); ++g) {
        const double variance = std::exp(logVariance[g]),
                     peak = 1 / std::sqrt(2 * std::numbers::pi * variance) / s.norm[channel];
        a.col(Index(g)) = s.root * peak * (-s.at.square() / (2 * variance)).exp();
    }
    return a;
}

Mixture weighted(const Samples& s, std::vector<double> logVariance) {
    Mixture m{std::move(logVariance), {}, 0};
    for (int c = 0; c < 3; ++c) {
        const MatrixXd a = columnsOf(s, m.logVariance, c);
        m.weights[c] = simplexWeights(a, s.value.col(c));
        m.squares += (a * m.weights[c] - s.value.col(c)).squaredNorm();
    }
    return m;
}

// One step of Levenberg and Marquardt over all variances and those weights that are not 0; the sum of weights
// is kept. Returns the new variances.
std::vector<double> stepOf(const Samples& s, const Mixture& m, double damping) {
    const auto n = Index(m.logVariance.size());
    std::vector<Index> free[3];
    Index firstVariance = 0;  // behind the weights' unknowns
    for (int c = 0; c < 3; ++c) {
        for (Index g = 0; g < n; ++g)
            if (m.weights[c][g] > 0) free[c].push_back(g);
        firstVariance += Index(free[c].size()) - 1;
    }
    MatrixXd jacobian = MatrixXd::Zero(3 * sampleCount + n, firstVariance + n);
    VectorXd target = VectorXd::Zero(jacobian.rows());
    Index next = 0;
    for (int c = 0; c < 3; ++c) {
        const MatrixXd a = columnsOf(s, m.logVariance, c);
        auto rows = jacobian.middleRows(c * sampleCount, sampleCount);
        for (size_t f = 0; f + 1 < free[c].size(); ++f)
            rows.col(next++) = a.col(free[c][f]) - a.col(free[c].back());
        for (Index g = 0; g < n; ++g)
            rows.col(firstVariance + g) = 0.5 * m.weights[c][g] * a.col(g).array() *
                                          (s.at.square() / std::exp(m.logVariance[size_t(g)]) - 1);
        target.segment(c * sampleCount, sampleCount) = s.value.col(c) - a * m.weights[c];
    }
    for (Index g = 0; g < n; ++g) {
        auto column = jacobian.col(firstVariance + g);
        column[3 * sampleCount + g] = std::sqrt(damping * (column.squaredNorm() + 1e-12));
    }
    const VectorXd x = jacobian.colPivHouseholderQr().solve(target);
    std::vector<double> moved = m.logVariance;
    for (Index g = 0; g < n; ++g) moved[size_t(g)] += std::clamp(x[firstVariance + g], -1.0, 1.0);
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
    const Eigen::MatrixX3d other = spreadAt(samples, fit);
    std::array<double, 3> error{};
    for (int c = 0; c < 3; ++c)
        error[size_t(c)] = (samples.value.col(c) - other.col(c) / samples.norm[c]).norm();
    return error;
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
