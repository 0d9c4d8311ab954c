// Lines are fitted where the format interpolates: in the integers that halves are stored as. Each texel is
// weighted by how much a step there changes its value. Candidates are then compared by the squared error of
// the values that they decode to.
#include "io/lut/bc6h_block.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace pellucid::io::bc6h {
namespace {

constexpr int partitionsTried = 6, refinements = 3, polished = 3;
constexpr double never = std::numeric_limits<double>::infinity();

using Vec = std::array<double, 3>;
using Ends = std::array<Vec, 4>;  // before quantisation, 0 to 65535

struct Candidate {
    Block block;
    double cost = never;
};

const std::vector<float>& valueTable() {
    static const auto table = [] {
        std::vector<float> values(0x7C00);
        for (int bits = 0; bits < 0x7C00; ++bits) {
            const int exponent = bits >> 10, fraction = bits & 0x3FF;
            values[size_t(bits)] = exponent ? std::ldexp(float(fraction + 1024), exponent - 25)
                                            : std::ldexp(float(fraction), -24);
        }
        return values;
    }();
    return table;
}

class Search {
  public:
    explicit Search(const Target& target) : target_(target) {
        const std::vector<float>& value = valueTable();
        for (int i = 0; i < 16; ++i)
            for (int c = 0; c < 3; ++c) {
                const uint16_t half = target.texel[size_t(i)][size_t(c)];
                value_[i][c] = value[half];
                position_[i][c] = (half + 0.5) * 64 / 31;
                const int low = std::max(0, half - 1), high = std::min(0x7BFF, half + 1);
                const double step = (value[size_t(high)] - value[size_t(low)]) / (high - low);
                weight_[i][c] = counts(i) ? step * step : 0;
            }
        for (int c = 0; c < 3; ++c) {
            double sum = 0;
            for (int i = 0; i < 16; ++i) sum += weight_[i][c];
            scale_[size_t(c)] = std::sqrt(sum / 16);
        }
    }

    Block best() {
        for (int m = 10; m < modeCount; ++m) tryMode(m, 0, fitted(1, 0));
        std::array<std::pair<double, int>, partitionCount> ranked;
        for (int p = 0; p < partitionCount; ++p) ranked[size_t(p)] = {restOf(p), p};
        std::sort(ranked.begin(), ranked.end());
        for (int k = 0; k < partitionsTried; ++k) {
            const int p = ranked[size_t(k)].second;
            const Ends ends = fitted(2, p);
            for (int m = 0; m < 10; ++m) tryMode(m, p, ends);
        }
        for (Candidate& c : best_) polish(c);
        return std::min_element(best_.begin(), best_.end(), cheaper)->block;
    }

  private:
    static bool cheaper(const Candidate& a, const Candidate& b) { return a.cost < b.cost; }
    bool counts(int texel) const { return target_.counts >> texel & 1; }
    static int subsetOf(int subsets, int partition, int texel) {
        return subsets == 2 && inSecond(partition, texel);
    }

    struct Line {
        Vec mean{}, axis{};  // scaled
        double rest = 0;     // squared distances from the line
        bool any = false;
    };

    // The principal axis of a subset's texels.
    Line lineOf(int subsets, int partition, int subset) const {
        Line line;
        double count = 0;
        for (int i = 0; i < 16; ++i) {
            if (!counts(i) || subsetOf(subsets, partition, i) != subset) continue;
            ++count;
            for (size_t c = 0; c < 3; ++c) line.mean[c] += position_[i][c] * scale_[c];
        }
        if (count == 0) return line;
        line.any = true;
        for (double& m : line.mean) m /= count;
        double covariance[3][3] = {};
        for (int i = 0; i < 16; ++i) {
            if (!counts(i) || subsetOf(subsets, partition, i) != subset) continue;
            for (size_t a = 0; a < 3; ++a)
                for (size_t b = 0; b < 3; ++b)
                    covariance[a][b] += (position_[i][a] * scale_[a] - line.mean[a]) *
                                        (position_[i][b] * scale_[b] - line.mean[b]);
        }
        const double trace = covariance[0][0] + covariance[1][1] + covariance[2][2];
        line.rest = trace;
        size_t widest = 0;
        for (size_t c = 1; c < 3; ++c)
            if (covariance[c][c] > covariance[widest][widest]) widest = c;
        Vec axis{covariance[widest][0], covariance[widest][1], covariance[widest][2]};
        for (int step = 0; step < 8; ++step) {  // power iteration
            Vec next{};
            double length = 0;
            for (size_t a = 0; a < 3; ++a) {
                for (size_t b = 0; b < 3; ++b) next[a] += covariance[a][b] * axis[b];
                length += next[a] * next[a];
            }
            if (!(length > 0)) return line;  // all texels alike
            for (size_t a = 0; a < 3; ++a) axis[a] = next[a] / std::sqrt(length);
        }
        double along = 0;
        for (size_t a = 0; a < 3; ++a)
            for (size_t b = 0; b < 3; ++b) along += axis[a] * covariance[a][b] * axis[b];
        line.axis = axis;
        line.rest = trace - along;
        return line;
    }

    double restOf(int partition) const { return lineOf(2, partition, 0).rest + lineOf(2, partition, 1).rest; }

    Ends fitted(int subsets, int partition) const {
        Ends ends{};
        for (int s = 0; s < subsets; ++s) {
            const Line line = lineOf(subsets, partition, s);
            double low = 0, high = 0;
            for (int i = 0; i < 16 && line.any; ++i) {
                if (!counts(i) || subsetOf(subsets, partition, i) != s) continue;
                double t = 0;
                for (size_t c = 0; c < 3; ++c)
                    t += (position_[i][c] * scale_[c] - line.mean[c]) * line.axis[c];
                low = std::min(low, t);
                high = std::max(high, t);
            }
            for (size_t c = 0; c < 3; ++c) {
                const double scale = scale_[c] > 0 ? scale_[c] : 1;
                ends[size_t(2 * s)][c] = (line.mean[c] + low * line.axis[c]) / scale;
                ends[size_t(2 * s + 1)][c] = (line.mean[c] + high * line.axis[c]) / scale;
            }
        }
        if (subsets == 2)  // a subset without texels takes the place of the other
            for (int s = 0; s < 2; ++s)
                if (!lineOf(2, partition, s).any)
                    for (size_t e = 0; e < 2; ++e) ends[size_t(2 * s) + e] = ends[size_t(2 * (1 - s)) + e];
        return ends;
    }

    static EndPoints quantised(const Mode& m, const Ends& ends) {
        EndPoints q{};
        const int top = (1 << m.bits) - 1;
        for (size_t e = 0; e < size_t(2 * m.subsets); ++e)
            for (size_t c = 0; c < 3; ++c) {
                const double x = std::clamp(ends[e][c], 0.0, 65535.0);
                int guess = std::clamp(int(x * (top + 1) / 65536), 0, top), closest = guess;
                for (int v = std::max(0, guess - 1); v <= std::min(top, guess + 1); ++v)
                    if (std::abs(unquantised(v, m.bits) - x) < std::abs(unquantised(closest, m.bits) - x))
                        closest = v;
                if (m.transformed && e > 0) {
                    const int limit = 1 << (m.stored[c] - 1);
                    closest =
                        std::clamp(closest, std::max(0, q[0][c] - limit), std::min(top, q[0][c] + limit - 1));
                }
                q[e][c] = closest;
            }
        return q;
    }

    // The best indices for these end points, and the error of the block.
    Candidate judged(int modeIndex, int partition, const EndPoints& ends) const {
        const Mode& m = mode(modeIndex);
        const std::vector<float>& value = valueTable();
        const std::span<const uint8_t> weight = weights(m.subsets);
        const int steps = int(weight.size());
        float palette[2][16][3];
        for (int s = 0; s < m.subsets; ++s)
            for (size_t c = 0; c < 3; ++c) {
                const int a = unquantised(ends[size_t(2 * s)][c], m.bits),
                          b = unquantised(ends[size_t(2 * s + 1)][c], m.bits);
                for (int k = 0; k < steps; ++k)
                    palette[s][k][c] = value[halfOf(interpolated(a, b, weight[size_t(k)]))];
            }
        Candidate result;
        result.block.mode = modeIndex;
        result.block.partition = partition;
        result.block.ends = ends;
        result.cost = 0;
        const int second = m.subsets == 2 ? secondAnchor(partition) : 0;
        for (int i = 0; i < 16; ++i) {
            const int s = subsetOf(m.subsets, partition, i);
            const int allowed = i == 0 || (s == 1 && i == second) ? steps / 2 : steps;
            float cheapest = std::numeric_limits<float>::infinity();
            for (int k = 0; k < allowed; ++k) {
                float cost = 0;
                for (int c = 0; c < 3; ++c) {
                    const float d = palette[s][k][c] - value_[i][c];
                    cost += d * d;
                }
                if (cost < cheapest) {
                    cheapest = cost;
                    result.block.index[size_t(i)] = uint8_t(k);
                }
            }
            if (counts(i)) result.cost += cheapest;
        }
        return result;
    }

    // The end point that is nearer to the anchor must come first, since the anchor's index has one bit less.
    void orient(Ends& ends, int subsets, int partition) const {
        for (int s = 0; s < subsets; ++s) {
            Vec &a = ends[size_t(2 * s)], &b = ends[size_t(2 * s + 1)];
            const int anchor = s == 0 ? 0 : secondAnchor(partition);
            double t = 0, length = 0;
            for (size_t c = 0; c < 3; ++c) {
                const double d = (b[c] - a[c]) * scale_[c];
                t += (position_[anchor][c] - a[c]) * scale_[c] * d;
                length += d * d;
            }
            if (t > 0.5 * length) std::swap(a, b);
        }
    }

    // The end points that are best for the indices, by least squares.
    Ends refitted(const Candidate& from, const Ends& before) const {
        const Mode& m = mode(from.block.mode);
        const std::span<const uint8_t> weight = weights(m.subsets);
        Ends ends = before;
        for (int s = 0; s < m.subsets; ++s)
            for (size_t c = 0; c < 3; ++c) {
                double aa = 0, ab = 0, bb = 0, ax = 0, bx = 0;
                for (int i = 0; i < 16; ++i) {
                    if (subsetOf(m.subsets, from.block.partition, i) != s) continue;
                    const double t = weight[from.block.index[size_t(i)]] / 64.0, w = weight_[i][c];
                    aa += w * (1 - t) * (1 - t);
                    ab += w * t * (1 - t);
                    bb += w * t * t;
                    ax += w * (1 - t) * position_[i][c];
                    bx += w * t * position_[i][c];
                }
                const double determinant = aa * bb - ab * ab;
                if (determinant > 1e-9 * aa * bb && determinant > 0) {
                    ends[size_t(2 * s)][c] = (ax * bb - bx * ab) / determinant;
                    ends[size_t(2 * s + 1)][c] = (bx * aa - ax * ab) / determinant;
                }
            }
        return ends;
    }

    void tryMode(int modeIndex, int partition, Ends ends) {
        const Mode& m = mode(modeIndex);
        Candidate found;
        for (int round = 0; round < refinements; ++round) {
            orient(ends, m.subsets, partition);
            const Candidate now = judged(modeIndex, partition, quantised(m, ends));
            if (now.cost < found.cost) found = now;
            ends = refitted(now, ends);
        }
        Candidate& worst = *std::max_element(best_.begin(), best_.end(), cheaper);
        if (found.cost < worst.cost) worst = found;
    }

    // Steps of one in each end point, and in both end points of a line together, while the error decreases.
    void polish(Candidate& candidate) const {
        if (candidate.cost == never) return;
        const Mode& m = mode(candidate.block.mode);
        const int top = (1 << m.bits) - 1;
        const auto tried = [&](EndPoints ends) {
            for (const auto& end : ends)
                for (int v : end)
                    if (v < 0 || v > top) return false;
            if (!fitsMode(m, ends)) return false;
            const Candidate next = judged(candidate.block.mode, candidate.block.partition, ends);
            if (!(next.cost < candidate.cost)) return false;
            candidate = next;
            return true;
        };
        bool better = candidate.cost > 0;
        for (int round = 0; better && round < 8; ++round) {
            better = false;
            for (size_t e = 0; e < size_t(2 * m.subsets); ++e)
                for (size_t c = 0; c < 3; ++c)
                    for (int step : {-1, 1}) {
                        EndPoints ends = candidate.block.ends;
                        ends[e][c] += step;
                        better |= tried(ends);
                        if (e % 2 == 0) {
                            ends = candidate.block.ends;
                            ends[e][c] += step;
                            ends[e + 1][c] += step;
                            better |= tried(ends);
                        }
                    }
        }
    }

    const Target& target_;
    float value_[16][3];
    double position_[16][3], weight_[16][3];
    Vec scale_{};
    std::array<Candidate, polished> best_;
};

}  // namespace

float linearValue(uint16_t half) {
    return valueTable()[half];
}

Block bestBlock(const Target& target) {
    return Search(target).best();
}

}  // namespace pellucid::io::bc6h
