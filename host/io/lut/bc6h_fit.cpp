// A line is fitted where the format interpolates: in the integers that halves are stored as. Each texel is
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

constexpr int refinements = 3;

using Vec = std::array<double, 3>;
using Ends = std::array<Vec, 2>;  // before quantisation, 0 to 65535

struct Candidate {
    Block block;
    double cost = std::numeric_limits<double>::infinity();
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

    Block best() const {
        Candidate best;
        for (int m = 0; m < int(std::size(modes)); ++m) {
            Candidate found = fitted(m);
            polish(found);
            if (found.cost < best.cost) best = found;
        }
        return best.block;
    }

  private:
    bool counts(int texel) const { return target_.counts >> texel & 1; }

    // The ends of the line along the principal axis of the texels.
    Ends principalLine() const {
        Vec mean{};
        double count = 0;
        for (int i = 0; i < 16; ++i) {
            if (!counts(i)) continue;
            ++count;
            for (size_t c = 0; c < 3; ++c) mean[c] += position_[i][c] * scale_[c];
        }
        for (double& m : mean) m /= count;
        const auto away = [&](int i, size_t c) { return position_[i][c] * scale_[c] - mean[c]; };
        double covariance[3][3] = {};
        for (int i = 0; i < 16; ++i)
            for (size_t a = 0; a < 3 && counts(i); ++a)
                for (size_t b = 0; b < 3; ++b) covariance[a][b] += away(i, a) * away(i, b);
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
            if (!(length > 0)) {  // all texels alike
                axis = {};
                break;
            }
            for (size_t a = 0; a < 3; ++a) axis[a] = next[a] / std::sqrt(length);
        }
        double low = 0, high = 0;
        for (int i = 0; i < 16; ++i) {
            if (!counts(i)) continue;
            const double t = away(i, 0) * axis[0] + away(i, 1) * axis[1] + away(i, 2) * axis[2];
            low = std::min(low, t);
            high = std::max(high, t);
        }
        Ends ends;
        for (size_t c = 0; c < 3; ++c) {
            const double scale = scale_[c] > 0 ? scale_[c] : 1;
            ends[0][c] = (mean[c] + low * axis[c]) / scale;
            ends[1][c] = (mean[c] + high * axis[c]) / scale;
        }
        return ends;
    }

    static EndPoints quantised(const Mode& m, const Ends& ends) {
        EndPoints q{};
        const int top = (1 << m.bits) - 1;
        for (size_t e = 0; e < 2; ++e)
            for (size_t c = 0; c < 3; ++c) {
                const double x = std::clamp(ends[e][c], 0.0, 65535.0);
                const int guess = std::clamp(int(x * (top + 1) / 65536), 0, top);
                int closest = guess;
                for (int v = std::max(0, guess - 1); v <= std::min(top, guess + 1); ++v)
                    if (std::abs(unquantised(v, m.bits) - x) < std::abs(unquantised(closest, m.bits) - x))
                        closest = v;
                if (m.transformed() && e > 0) {
                    const int limit = 1 << (m.stored - 1);
                    closest =
                        std::clamp(closest, std::max(0, q[0][c] - limit), std::min(top, q[0][c] + limit - 1));
                }
                q[e][c] = closest;
            }
        return q;
    }

    // The best indices for these end points, and the error of the block.
    Candidate judged(int mode, const EndPoints& ends) const {
        const std::vector<float>& value = valueTable();
        float palette[16][3];
        for (size_t c = 0; c < 3; ++c) {
            const int a = unquantised(ends[0][c], modes[mode].bits),
                      b = unquantised(ends[1][c], modes[mode].bits);
            for (int k = 0; k < 16; ++k) palette[k][c] = value[halfOf(interpolated(a, b, weights[k]))];
        }
        Candidate result{{mode, ends, {}}, 0};
        for (int i = 0; i < 16; ++i) {
            float cheapest = std::numeric_limits<float>::infinity();
            for (int k = 0; k < (i == 0 ? 8 : 16); ++k) {  // texel 0 has an index of three bits
                float cost = 0;
                for (int c = 0; c < 3; ++c) {
                    const float d = palette[k][c] - value_[i][c];
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

    // The end point that is nearer to texel 0 must come first, since its index has one bit less.
    void orient(Ends& ends) const {
        double t = 0, length = 0;
        for (size_t c = 0; c < 3; ++c) {
            const double d = (ends[1][c] - ends[0][c]) * scale_[c];
            t += (position_[0][c] - ends[0][c]) * scale_[c] * d;
            length += d * d;
        }
        if (t > 0.5 * length) std::swap(ends[0], ends[1]);
    }

    // The end points that are best for the indices, by least squares.
    void refit(const Candidate& from, Ends& ends) const {
        for (size_t c = 0; c < 3; ++c) {
            double aa = 0, ab = 0, bb = 0, ax = 0, bx = 0;
            for (int i = 0; i < 16; ++i) {
                const double t = weights[from.block.index[size_t(i)]] / 64.0, w = weight_[i][c];
                aa += w * (1 - t) * (1 - t);
                ab += w * t * (1 - t);
                bb += w * t * t;
                ax += w * (1 - t) * position_[i][c];
                bx += w * t * position_[i][c];
            }
            const double determinant = aa * bb - ab * ab;
            if (determinant > 1e-9 * aa * bb && determinant > 0) {
                ends[0][c] = (ax * bb - bx * ab) / determinant;
                ends[1][c] = (bx * aa - ax * ab) / determinant;
            }
        }
    }

    Candidate fitted(int mode) const {
        Ends ends = principalLine();
        Candidate found;
        for (int round = 0; round < refinements; ++round) {
            orient(ends);
            const Candidate now = judged(mode, quantised(modes[mode], ends));
            if (now.cost < found.cost) found = now;
            refit(now, ends);
        }
        return found;
    }

    // Steps of one in each end point, and in both together, while the error decreases.
    void polish(Candidate& candidate) const {
        const Mode& m = modes[candidate.block.mode];
        const int top = (1 << m.bits) - 1;
        const auto improves = [&](const EndPoints& ends) {
            for (const auto& end : ends)
                for (int v : end)
                    if (v < 0 || v > top) return false;
            if (!fitsMode(m, ends)) return false;
            const Candidate next = judged(candidate.block.mode, ends);
            if (!(next.cost < candidate.cost)) return false;
            candidate = next;
            return true;
        };
        bool better = candidate.cost > 0;
        for (int round = 0; better && round < 8; ++round) {
            better = false;
            for (size_t c = 0; c < 3; ++c)
                for (const auto& [first, second] : {std::pair{1, 0}, {0, 1}, {1, 1}})
                    for (int step : {-1, 1}) {
                        EndPoints ends = candidate.block.ends;
                        ends[0][c] += first * step;
                        ends[1][c] += second * step;
                        better |= improves(ends);
                    }
        }
    }

    const Target& target_;
    float value_[16][3];
    double position_[16][3], weight_[16][3];
    Vec scale_{};
};

}  // namespace

float linearValue(uint16_t half) {
    return valueTable()[half];
}

Block bestBlock(const Target& target) {
    return Search(target).best();
}

}  // namespace pellucid::io::bc6h
