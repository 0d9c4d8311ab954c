// Profiles from a medium's optical properties: Christensen-Burley and the classical dipole. Both are exact
// mixtures of Gaussians, exp(-b d)/d = 2/sqrt(pi) int_0^inf exp(-d^2 t^2 - b^2/4t^2) dt. The trapezoid rule
// in log t turns that into sums that converge faster than any power of the step; the device uses these sums.

#include "lut/profile.h"

namespace pel {
namespace {

// The modified Bessel function K0 as the integral of exp(-x cosh t) over t from 0 on [DLMF 10.32.9], by the
// trapezoidal rule: with these steps its error is below that of double precision. (Not every C++ library has
// std::cyl_bessel_k.)
double besselK0(double x) {
    if (x > 700) return 0;
    if (x <= 0) return INFINITY;
    const double step = 1 / std::sqrt(16 + 2 * x);
    double sum = 0.5;
    for (double t = step, term = 1; term > 1e-18 * sum; t += step) {
        const double s = std::sinh(t / 2);
        sum += term = std::exp(-2 * x * s * s);
    }
    return step * sum * std::exp(-x);
}

// Step of the trapezoid rule in log t: the error is of the order of exp(-pi^2 / 2 step) = 3e-9.
constexpr double mixtureStep = 0.25;

void checkPositive(const float* values, const char* what) {
    if (!values) invalidArgument("three values are needed for ", what, ", not NULL");
    for (int c = 0; c < 3; ++c)
        if (!std::isfinite(values[c]) || values[c] <= 0)
            invalidArgument("the ", channelNames[c], " ", what, " is ", values[c],
                            "; a finite value above 0 is needed");
}

// weight(channel, t) dt/t over t from `first` to `last`, as terms of variance 1/2t^2.
template <class Weight>
std::vector<GaussianTerm> mixture(double first, double last, Weight&& weight) {
    std::vector<GaussianTerm> terms;
    for (double y = std::log(first); y < std::log(last) + mixtureStep; y += mixtureStep) {
        const double t = std::exp(y);
        terms.push_back({1 / (2 * t * t), {weight(0, t), weight(1, t), weight(2, t)}});
    }
    return terms;
}

class BurleyShape final : public ProfileShape {
  public:
    BurleyShape(const Rgb& decay, const Rgb& meanFreePath, const Rgb& mediumPath)
        : decay_(decay),
          meanFreePath_(meanFreePath),
          mediumPath_(mediumPath),
          terms_(GaussianShape(mixtureOf(decay)).gaussians()) {}
    Rgb radial(double d) const override {
        return threeOf([&](int c) {
            return (std::exp(-d / decay_[c]) + std::exp(-d / (3 * decay_[c]))) / (8 * pi * decay_[c] * d);
        });
    }
    Rgb lineSpread(double s) const override {  // the line integral of exp(-b d)/d is 2 K0(b s)
        return threeOf([&](int c) {
            return (besselK0(s / decay_[c]) + besselK0(s / (3 * decay_[c]))) / (4 * pi * decay_[c]);
        });
    }
    Rgb width() const override { return std::sqrt(7.0) * decay_; }
    std::vector<GaussianTerm> gaussians() const override { return terms_; }
    bool singular() const override { return true; }
    Rgb transmission(double s) const override {
        return threeOf(
            [&](int c) { return 0.25 * std::exp(-s / decay_[c]) + 0.75 * std::exp(-s / (3 * decay_[c])); });
    }
    Rgb meanFreePath() const override { return meanFreePath_; }
    Rgb mediumPath() const override { return mediumPath_; }

  private:
    static std::vector<GaussianTerm> mixtureOf(const Rgb& decay) {
        // Below the first t, exp(-b^2/4t^2) vanishes. Above the last one 1e-6 of the energy is left out, and
        // the rest is scaled to make up for it.
        return mixture(1 / (3 * largest(decay)) / 12, 1.5e5 / smallest(decay), [&](int c, double t) {
            const double b = 1 / decay[c], x = b / (2 * t);
            return (std::exp(-x * x) + std::exp(-x * x / 9)) * b / t;
        });
    }
    Rgb decay_;                      // length, the shorter of the two decay lengths
    Rgb meanFreePath_, mediumPath_;  // length; 0: unknown
    std::vector<GaussianTerm> terms_;
};

struct Dipole {
    double depth[2];   // length, of the source below and of its mirror image above the surface
    double transport;  // effective transport coefficient sigma_tr, 1/length
    double energy;     // integral over the plane for reduced albedo 1
};

class DipoleShape final : public ProfileShape {
  public:
    DipoleShape(const std::array<Dipole, 3>& dipoles, const Rgb& meanFreePath)
        : dipoles_(dipoles), meanFreePath_(meanFreePath), sum_(mixtureOf(dipoles)) {}
    Rgb radial(double d) const override {
        Rgb value{};
        for (int c = 0; c < 3; ++c)
            for (double depth : dipoles_[c].depth) {
                const double s = std::hypot(depth, d), x = dipoles_[c].transport * s;
                value[c] += depth * (1 + x) * std::exp(-x) / (4 * pi * s * s * s) / dipoles_[c].energy;
            }
        return value;
    }
    Rgb lineSpread(double s) const override { return sum_.lineSpread(s); }
    Rgb width() const override { return sum_.width(); }
    std::vector<GaussianTerm> gaussians() const override { return sum_.gaussians(); }
    Rgb transmission(double s) const override { return sum_.transmission(s); }
    Rgb meanFreePath() const override { return meanFreePath_; }

  private:
    static std::vector<GaussianTerm> mixtureOf(const std::array<Dipole, 3>& dipoles) {
        double first = 1e300, last = 0;
        for (const Dipole& p : dipoles) {
            first = std::min(first, p.transport / 12);
            last = std::max(last, 6 / p.depth[0]);
        }
        return mixture(first, last, [&](int c, double t) {
            const Dipole& p = dipoles[c];
            const double x = p.transport / (2 * t);
            double sum = 0;
            for (double depth : p.depth) sum += depth * t * std::exp(-depth * depth * t * t - x * x);
            return sum;
        });
    }
    std::array<Dipole, 3> dipoles_;
    Rgb meanFreePath_;  // length
    GaussianShape sum_;
};

double burleyScale(PelBurleyFit fit, double albedo) {
    switch (fit) {
        case PEL_BURLEY_SEARCHLIGHT:
            return 1.85 - albedo + 7 * std::pow(std::abs(albedo - 0.8), 3);
        case PEL_BURLEY_DIFFUSE_TRANSMISSION:
            return 1.9 - albedo + 3.5 * (albedo - 0.8) * (albedo - 0.8);
        case PEL_BURLEY_DIFFUSE_MEAN_FREE_PATH:
            return 3.5 + 100 * std::pow(albedo - 0.33, 4);
    }
    invalidArgument("fit ", int(fit), " of the Burley profile is unknown; it must be 0, 1 or 2");
}

// s = sqrt(1 - albedo) of the medium whose half-space has this reflectance [van de Hulst, Multiple Light
// Scattering, 1980]: reflectance = (1 - s) (1 - 0.139 s) / (1 + 1.17 s).
double absorptionAt(double reflectance) {
    const double p = 0.139, q = 1.139 + 1.17 * reflectance;
    return (q - std::sqrt(q * q - 4 * p * (1 - reflectance))) / (2 * p);
}

}  // namespace

double mediumPathOver(double s) {
    return 0.6663 + s * (4.7276 + s * (-4.9721 + s * (7.2062 - s * 3.3091)));
}

Ref<Profile> Profile::burley(const float* meanFreePath, const float* albedo, PelBurleyFit fit) {
    checkPositive(meanFreePath, "mean free path");
    if (!albedo) invalidArgument("three albedos are needed, not NULL");
    Rgb decay, mediumPath;
    for (int c = 0; c < 3; ++c) {
        if (!(albedo[c] >= 0 && albedo[c] <= 1))
            invalidArgument("the ", channelNames[c], " albedo is ", albedo[c], "; 0 to 1 is needed");
        decay[c] = meanFreePath[c] / burleyScale(fit, albedo[c]);
        mediumPath[c] = mediumPathOver(absorptionAt(albedo[c])) * decay[c];
    }
    const Rgb path{meanFreePath[0], meanFreePath[1], meanFreePath[2]};
    Ref<Profile> profile =
        make<Profile>(PEL_PROFILE_BURLEY, std::make_unique<BurleyShape>(decay, path, mediumPath));
    std::copy_n(meanFreePath, 3, profile->recipe_.first);
    std::copy_n(albedo, 3, profile->recipe_.second);
    profile->recipe_.fit = fit;
    return profile;
}

Ref<Profile> Profile::burleyDistance(const float* distance) {
    checkPositive(distance, "distance");
    const Rgb decay{distance[0], distance[1], distance[2]};
    Ref<Profile> profile =
        make<Profile>(PEL_PROFILE_BURLEY, std::make_unique<BurleyShape>(decay, Rgb{}, Rgb{}));
    std::copy_n(distance, 3, profile->recipe_.first);
    profile->recipe_.byDistance = true;
    return profile;
}

Ref<Profile> Profile::dipole(const float* absorption, const float* reducedScattering, float eta) {
    checkPositive(absorption, "absorption");
    checkPositive(reducedScattering, "reduced scattering");
    if (!(eta > 1) || !std::isfinite(eta))
        invalidArgument("eta is ", eta,
                        "; the index of a medium against air, above 1, is needed (1.3 for most)");
    // Average Fresnel reflectance from inside, fitted for eta > 1 (Jensen et al. 2001, section 2).
    const double n = eta;
    const double fresnel = -1.440 / (n * n) + 0.710 / n + 0.668 + 0.0636 * n;
    if (!(fresnel < 1))
        invalidArgument("eta is ", eta,
                        ", beyond what the fit of the Fresnel reflectance covers; below about 3 is right");
    const double mismatch = (1 + fresnel) / (1 - fresnel);
    std::array<Dipole, 3> dipoles;
    Rgb meanFreePath;
    for (int c = 0; c < 3; ++c) {
        const double extinction = double(absorption[c]) + reducedScattering[c];
        Dipole& p = dipoles[c];
        meanFreePath[c] = 1 / extinction;  // of the equivalent isotropic medium
        p.transport = std::sqrt(3 * absorption[c] * extinction);
        p.depth[0] = 1 / extinction;
        p.depth[1] = p.depth[0] + 4 * mismatch / (3 * extinction);
        p.energy = 0.5 * (std::exp(-p.transport * p.depth[0]) + std::exp(-p.transport * p.depth[1]));
    }
    Ref<Profile> profile =
        make<Profile>(PEL_PROFILE_DIPOLE, std::make_unique<DipoleShape>(dipoles, meanFreePath));
    std::copy_n(absorption, 3, profile->recipe_.first);
    std::copy_n(reducedScattering, 3, profile->recipe_.second);
    profile->recipe_.eta = eta;
    return profile;
}

}  // namespace pel
