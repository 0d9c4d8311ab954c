#include "diffusion/gather_taps.h"

#include <numbers>

namespace pel {
namespace {

// Cumulative shares of the light at rising positions, 0 at the first, for each channel.
class Shares {
  public:
    void add(double place, const Rgb& shares) {
        places_.push_back(place);
        shares_.push_back(shares);
    }
    // Scales the shares so that the last one is 1.
    void close() {
        const Rgb all = shares_.back();
        for (Rgb& s : shares_)
            for (int c = 0; c < 3; ++c) s[c] = all[c] > 0 ? s[c] / all[c] : 1;
    }
    // The radius within which the channel that scatters widest there has `part` of its light: few taps miss
    // mostly distant light. On the head of the reference scenes, at four times the radius, 32 taps are off
    // by 134 in red, and by 171 if channels count alike.
    double place(double part) const {
        const auto after = std::partition_point(shares_.begin(), shares_.end(),
                                                [&](const Rgb& s) { return smallest(s) < part; });
        const size_t i = std::clamp<size_t>(size_t(after - shares_.begin()), 1, shares_.size() - 1);
        const double low = smallest(shares_[i - 1]), high = smallest(shares_[i]);
        const double t = high > low ? std::clamp((part - low) / (high - low), 0.0, 1.0) : 0;
        return places_[i - 1] + t * (places_[i] - places_[i - 1]);
    }
    Rgb within(double place) const {
        const size_t i = std::clamp<size_t>(
            size_t(std::upper_bound(places_.begin(), places_.end(), place) - places_.begin()), 1,
            places_.size() - 1);
        const double t = std::clamp((place - places_[i - 1]) / (places_[i] - places_[i - 1]), 0.0, 1.0);
        return shares_[i - 1] + t * (shares_[i] - shares_[i - 1]);
    }

  private:
    std::vector<double> places_;
    std::vector<Rgb> shares_;
};

constexpr int steps = 2048;

// Fine near 0, where profiles are steep.
double stepAt(int i, double reach) {
    const double t = double(i) / steps;
    return reach * t * t * t;
}

// Shares of the profile's light within a distance.
Shares radialShares(const ProfileShape& shape, double reach) {
    Shares shares;
    for (int i = 0; i <= steps; ++i) {
        const double r = stepAt(i, reach);
        shares.add(r, i ? Rgb{1, 1, 1} - shape.transmission(r) : Rgb{});
    }
    shares.close();
    return shares;
}

// Shares of one half of the line spread; two Gauss points a step.
Shares lineShares(const ProfileShape& shape, double reach) {
    Shares shares;
    Rgb sum{};
    shares.add(0, sum);
    for (int i = 1; i <= steps; ++i) {
        const double a = stepAt(i - 1, reach), b = stepAt(i, reach);
        for (double side : {-1.0, 1.0}) {
            const Rgb p = shape.lineSpread((a + b) / 2 + side * (b - a) / (2 * std::sqrt(3.0)));
            sum += (b - a) * p / 2;
        }
        shares.add(b, sum);
    }
    shares.close();
    return shares;
}

}  // namespace

std::vector<PelGatherTap> diskTaps(const ProfileShape& shape, double scale, double reach, uint32_t count) {
    const Shares shares = radialShares(shape, reach / scale);
    const double goldenAngle = std::numbers::pi * (3 - std::sqrt(5.0));
    std::vector<PelGatherTap> taps;
    for (uint32_t set = 0; set < PEL_GATHER_TURNS; ++set)
        for (uint32_t i = 0; i < count; ++i) {
            const double r = scale * shares.place((i + (set + 0.5) / PEL_GATHER_TURNS) / count),
                         angle = goldenAngle * i;
            PelGatherTap tap{};
            tap.place[0] = float(r * std::cos(angle)), tap.place[1] = float(r * std::sin(angle));
            const Rgb inner = shares.within(shares.place(double(i) / count)),
                      outer = shares.within(shares.place((i + 1.0) / count));
            for (int c = 0; c < 3; ++c)
                tap.share[c] = float((i + 1 == count ? 1 : outer[c]) - (i ? inner[c] : 0));
            tap.place2 = float(r * r);
            taps.push_back(tap);
        }
    return taps;
}

std::vector<PelGatherTap> lineTaps(const ProfileShape& shape, double scale, double reach, uint32_t count) {
    const Shares shares = lineShares(shape, reach / scale);
    // Half of the pieces by light, half by length: by light alone, pieces in the tail would be long.
    const auto border = [&](uint32_t i) {  // from the middle of the line; of 0 and `count` the reach
        const double t = 2.0 * i / count - 1, part = std::abs(t);
        double low = 0, high = reach / scale;
        for (int k = 0; k < 60; ++k) {
            const double middle = (low + high) / 2;
            const Rgb s = shares.within(middle);
            const double light = (s[0] + s[1] + s[2]) / 3, length = std::sqrt(middle * scale / reach);
            (0.5 * light + 0.5 * length < part ? low : high) = middle;
        }
        return std::copysign((low + high) / 2, t);
    };
    std::vector<PelGatherTap> taps;
    const auto lightTo = [&](double place) {
        Rgb s = shares.within(std::abs(place));
        for (double& v : s) v = 0.5 + std::copysign(0.5 * v, place);
        return s;
    };
    for (uint32_t i = 0; i < count; ++i) {
        const double a = border(i), b = border(i + 1);
        const Rgb before = lightTo(a), after = lightTo(b);
        PelGatherTap tap{};
        tap.place[0] = float(a * scale), tap.place[1] = float(b * scale);
        for (int c = 0; c < 3; ++c) tap.share[c] = float(after[c] - before[c]);
        const double middle = (a + b) / 2 * scale;
        tap.place2 = float(middle * middle);
        taps.push_back(tap);
    }
    return taps;
}

}  // namespace pel
