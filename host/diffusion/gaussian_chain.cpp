#include "diffusion/gaussian_chain.h"

#include <numeric>

namespace pel {
namespace {

constexpr int samples = 96;

// Non-negative weights for which the sum of the columns is nearest to `wanted`, by coordinate descent on the
// normal equations. Neighbouring Gaussians are nearly parallel, so that it takes many rounds.
std::vector<double> fitWeights(const std::vector<std::vector<double>>& columns,
                               const std::vector<double>& wanted) {
    const size_t count = columns.size();
    const auto product = [](const std::vector<double>& a, const std::vector<double>& b) {
        return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
    };
    std::vector<double> weights(count, 1.0 / double(count)), gram, right;
    for (const std::vector<double>& column : columns) {
        right.push_back(product(column, wanted));
        for (const std::vector<double>& other : columns) gram.push_back(product(column, other));
    }
    double change = 1;
    for (int round = 0; round < 4000 && change > 1e-9; ++round) {
        change = 0;
        for (size_t k = 0; k < count; ++k) {
            double left = right[k];
            for (size_t j = 0; j < count; ++j) left -= gram[k * count + j] * weights[j];
            const double length = gram[k * count + k],
                         next = length > 0 ? std::max(0.0, weights[k] + left / length) : 0;
            change = std::max(change, std::abs(next - weights[k]));
            weights[k] = next;
        }
    }
    return weights;
}

double within(const std::vector<GaussianTerm>& terms, int channel, double r) {
    double sum = 0;
    for (const GaussianTerm& t : terms) sum += t.weight[channel] * -std::expm1(-r * r / (2 * t.variance));
    return sum;
}

std::vector<double> distancesOf(const Profile& profile) {
    const Rgb width = profile.shape().width();
    const double low = 0.02 * smallest(width), high = 8 * largest(width);
    std::vector<double> distances;
    for (int i = 0; i < samples; ++i)
        distances.push_back(low * std::pow(high / low, double(i) / (samples - 1)));
    return distances;
}

double errorOf(const std::vector<GaussianTerm>& terms, const std::vector<double>& distances,
               const std::vector<Rgb>& shares) {
    double most = 0;
    for (size_t i = 0; i < distances.size(); ++i)
        for (int c = 0; c < 3; ++c)
            most = std::max(most, std::abs(within(terms, c, distances[i]) - shares[i][c]));
    return most;
}

}  // namespace

GaussianChain gaussianChain(const Profile& profile, uint32_t most) {
    const std::vector<double> distances = distancesOf(profile);
    std::vector<Rgb> shares;
    for (double r : distances) shares.push_back(Rgb{1, 1, 1} - profile.shape().transmission(r));
    GaussianChain best{profile.terms(), 0};
    if (!best.terms.empty() && best.terms.size() <= most) {
        std::ranges::sort(best.terms, {}, &GaussianTerm::variance);
        best.error = errorOf(best.terms, distances, shares);
        return best;
    }
    const Rgb width = profile.shape().width();
    const double narrowest = smallest(width), widest = largest(width);
    best.error = INFINITY;
    for (double low : {0.015, 0.03, 0.06, 0.12, 0.25, 0.5})
        for (double high : {1.0, 1.4, 2.0}) {
            std::vector<GaussianTerm> terms;
            std::vector<std::vector<double>> columns;
            for (uint32_t k = 0; k < most; ++k) {
                const double sigma =
                    low * narrowest * std::pow(high * widest / (low * narrowest), double(k) / (most - 1));
                terms.push_back({sigma * sigma, {}});
                std::vector<double> column;
                for (double r : distances) column.push_back(-std::expm1(-r * r / (2 * sigma * sigma)));
                columns.push_back(std::move(column));
            }
            for (int c = 0; c < 3; ++c) {
                std::vector<double> wanted;
                for (const Rgb& s : shares) wanted.push_back(s[c]);
                const std::vector<double> weights = fitWeights(columns, wanted);
                double sum = 0;
                for (double w : weights) sum += w;
                for (uint32_t k = 0; k < most; ++k) terms[k].weight[c] = sum > 0 ? weights[k] / sum : k == 0;
            }
            const double error = errorOf(terms, distances, shares);
            if (error < best.error) best = {std::move(terms), error};
        }
    return best;
}

}  // namespace pel
