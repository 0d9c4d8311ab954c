// Tabulated profiles: R is linear between distances. Its line integral has a closed form per piece.

#include "lut/profile.h"

namespace pel {
namespace {

// R = offset + slope d on [begin, end].
struct Piece {
    double begin, end;  // length
    Rgb offset, slope;
};

class TableShape final : public ProfileShape {
  public:
    explicit TableShape(std::vector<Piece> pieces) : pieces_(std::move(pieces)) {
        // integrals of R 2 pi d dd and of R d^2 2 pi d dd / 2 over a piece
        Rgb energy{}, moment{};
        for (const Piece& p : pieces_)
            for (int c = 0; c < 3; ++c) {
                auto power = [&](int n) { return (std::pow(p.end, n) - std::pow(p.begin, n)) / n; };
                energy[c] += 2 * pi * (p.offset[c] * power(2) + p.slope[c] * power(3));
                moment[c] += pi * (p.offset[c] * power(4) + p.slope[c] * power(5));
            }
        for (int c = 0; c < 3; ++c) {
            if (!(energy[c] > 0) || !std::isfinite(energy[c]))
                invalidArgument("the table's ", channelNames[c],
                                " channel holds no energy; a value above 0 is needed");
            for (Piece& p : pieces_) {
                p.offset[c] /= energy[c];
                p.slope[c] /= energy[c];
            }
            width_[c] = std::sqrt(moment[c] / energy[c]);
        }
    }
    Rgb radial(double d) const override {
        const auto piece = std::ranges::lower_bound(pieces_, d, {}, &Piece::end);
        if (piece == pieces_.end()) return {};
        return threeOf([&](int c) { return std::max(0.0, piece->offset[c] + piece->slope[c] * d); });
    }
    Rgb lineSpread(double distance) const override {
        const double s = std::abs(distance);
        Rgb sum{};
        for (const Piece& p : pieces_) {
            if (p.end <= s) continue;
            // 2 int R d / sqrt(d^2 - s^2) dd
            const double a = std::max(p.begin, s), b = p.end;
            const double qa = std::sqrt((a - s) * (a + s)), qb = std::sqrt((b - s) * (b + s));
            const double linear = b * qb - a * qa + (s > 0 ? s * s * std::log((b + qb) / (a + qa)) : 0.0);
            for (int c = 0; c < 3; ++c) sum[c] += 2 * p.offset[c] * (qb - qa) + p.slope[c] * linear;
        }
        return threeOf([&](int c) { return std::max(0.0, sum[c]); });
    }
    Rgb width() const override { return width_; }
    Rgb transmission(double s) const override {
        Rgb sum{};
        for (const Piece& p : pieces_) {
            if (p.end <= s) continue;
            const double a = std::max(p.begin, s), b = p.end;
            const double linear = (a * a + a * b + b * b) * 2 / 3;
            for (int c = 0; c < 3; ++c)
                sum[c] += pi * (b - a) * (p.offset[c] * (a + b) + p.slope[c] * linear);
        }
        return threeOf([&](int c) { return std::max(0.0, sum[c]); });
    }
    std::vector<double> knots() const override {
        std::vector<double> all;
        for (const Piece& p : pieces_) all.push_back(p.end);
        return all;
    }

  private:
    std::vector<Piece> pieces_;  // from 0 on, without gaps
    Rgb width_{};                // length
};

}  // namespace

Ref<Profile> Profile::table(const float* distances, const float* values, uint32_t count) {
    constexpr uint32_t most = 4096;
    if (!distances || !values || count < 2 || count > most)
        invalidArgument("a table needs 2 to ", most, " distances with values, not ",
                        distances && values ? count : 0);
    for (uint32_t i = 0; i < count; ++i) {
        if (!std::isfinite(distances[i]) || distances[i] < 0 || (i > 0 && distances[i] <= distances[i - 1]))
            invalidArgument("distance ", i, " of the table is ", distances[i],
                            "; finite distances from 0 up that rise are needed");
        for (int c = 0; c < 3; ++c)
            if (!std::isfinite(values[3 * i + c]) || values[3 * i + c] < 0)
                invalidArgument("the ", channelNames[c], " value at distance ", distances[i], " is ",
                                values[3 * i + c], "; a finite value of 0 or more is needed");
    }
    std::vector<Piece> pieces;
    if (distances[0] > 0) pieces.push_back({0, distances[0], {values[0], values[1], values[2]}, {}});
    for (uint32_t i = 1; i < count; ++i) {
        Piece p{distances[i - 1], distances[i], {}, {}};
        for (int c = 0; c < 3; ++c) {
            const double low = values[3 * i - 3 + c], high = values[3 * i + c];
            p.slope[c] = (high - low) / (p.end - p.begin);
            p.offset[c] = low - p.slope[c] * p.begin;
        }
        pieces.push_back(p);
    }
    Ref<Profile> profile = make<Profile>(PEL_PROFILE_TABLE, std::make_unique<TableShape>(std::move(pieces)));
    for (uint32_t i = 0; i < count; ++i)
        profile->recipe_.rows.push_back({distances[i], values[3 * i], values[3 * i + 1], values[3 * i + 2]});
    return profile;
}

}  // namespace pel
