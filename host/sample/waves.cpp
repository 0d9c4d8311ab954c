#include "sample/waves.h"

namespace pellucid::sample {
namespace {

constexpr double tau = 2 * std::numbers::pi;

// A 32-bit linear congruential generator, mixed; the standard's distributions differ between libraries.
class Random {
  public:
    explicit Random(uint32_t seed) : state_(seed * 2654435769u + 1u) {}
    double unit() {
        state_ = state_ * 1664525u + 1013904223u;
        uint32_t x = state_;
        x = (x ^ (x >> 16)) * 0x7feb352du;
        x = (x ^ (x >> 15)) * 0x846ca68bu;
        return (x ^ (x >> 16)) * 0x1p-32;
    }

  private:
    uint32_t state_;
};

// Log of how much a Gaussian footprint weakens wave k. Single precision is plenty for relief, and fast.
float attenuation(Vec3 k, const Footprint& f) {
    const double kn = dot(k, f.normal), ka = dot(k, f.along);
    const double tangential = dot(k, k) - kn * kn + ka * ka * (f.stretch * f.stretch - 1);
    return float(-0.5 * f.sigma * f.sigma * tangential);
}

// A wave weaker than this (e^-12) is left out.
constexpr float negligible = -12;

}  // namespace

WaveField::WaveField(double wavelength, int waves, uint32_t seed) {
    Random random(seed);
    for (int i = 0; i < waves; ++i) {
        const double z = 2 * (i + 0.5) / waves - 1, phi = tau * random.unit(), r = std::sqrt(1 - z * z);
        const double k = tau / wavelength * std::exp2(random.unit() - 0.5);
        waves_.push_back({Vec3{r * std::cos(phi), r * std::sin(phi), z} * k, tau * random.unit()});
    }
}

double WaveField::value(Vec3 p, const Footprint& footprint) const {
    double sum = 0;
    for (const Wave& wave : waves_) {
        const float weaker = attenuation(wave.k, footprint);
        if (weaker > negligible) sum += std::cos(float(dot(wave.k, p) + wave.phase)) * std::exp(weaker);
    }
    return sum * std::sqrt(2.0 / double(waves_.size()));
}

double WaveField::slope(Vec3 p, const Footprint* footprints, int count, Vec3* out) const {
    for (int i = 0; i < count; ++i) out[i] = {};
    double lost = 0;  // squared slopes that the first footprint blurs
    for (const Wave& wave : waves_) {
        float sine = 2;  // not computed yet
        for (int i = 0; i < count; ++i) {
            const float weaker = attenuation(wave.k, footprints[i]);
            const Vec3 n = footprints[i].normal;
            const double kn = dot(wave.k, n), share = weaker > negligible ? std::exp(weaker) : 0;
            if (i == 0) lost += (1 - kn * kn / dot(wave.k, wave.k)) * (1 - share * share);
            if (share == 0) continue;
            if (sine > 1) sine = std::sin(float(dot(wave.k, p) + wave.phase));
            out[i] = out[i] - (wave.k - n * kn) * (sine * share / length(wave.k));
        }
    }
    // sin^2 averages 1/2, the tangential part of a random direction 2/3.
    for (int i = 0; i < count; ++i) out[i] = out[i] * std::sqrt(3.0 / double(waves_.size()));
    return 1.5 * lost / double(waves_.size());
}

}  // namespace pellucid::sample
