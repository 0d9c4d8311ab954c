// Profiles that follow from a medium's optical properties: Christensen-Burley and the classical dipole.
#include <numbers>
#include <stdexcept>

#include "reference/profile.h"

namespace reference {
namespace {

constexpr double pi = std::numbers::pi;
// exp(-45) is 3e-20: what lies beyond so many decay lengths is below double precision.
constexpr double negligibleDecay = 45;

std::vector<double> geometric(double first, double last, double ratio) {
    std::vector<double> all;
    for (double l = first; l < last; l *= ratio) all.push_back(l);
    all.push_back(last);
    return all;
}

class BurleyProfile : public Profile {
  public:
    explicit BurleyProfile(Rgb decay) : decay_(decay) { radius_ = magnitude(rmsWidth(*this)); }
    Rgb radial(double d) const override {
        Rgb value;
        for (int c = 0; c < 3; ++c)
            value[c] = (std::exp(-d / decay_[c]) + std::exp(-d / (3 * decay_[c]))) / (8 * pi * decay_[c] * d);
        return value;
    }
    std::vector<double> lengths() const override {
        const double narrow = std::min({decay_.x, decay_.y, decay_.z});
        return geometric(0.1 * narrow, 3 * negligibleDecay * magnitude(decay_), 3);
    }
    bool singularAtZero() const override { return true; }
    double radius() const override { return radius_; }

  private:
    Rgb decay_;  // d = l/s, the shorter of the two decay lengths
    double radius_;
};

struct Dipole {
    double real, virtualDepth;  // depth of the source below and of its mirror image above the surface
    double transport;           // effective transport coefficient sigma_tr, 1/length
    double energy;              // integral over the plane for reduced albedo 1
};

class DipoleProfile : public Profile {
  public:
    explicit DipoleProfile(const Dipole (&dipoles)[3]) {
        std::copy(dipoles, dipoles + 3, dipoles_);
        radius_ = magnitude(rmsWidth(*this));
    }
    Rgb radial(double d) const override {
        Rgb value;
        for (int c = 0; c < 3; ++c) {
            const Dipole& p = dipoles_[c];
            value[c] = (source(p, p.real, d) + source(p, p.virtualDepth, d)) / p.energy;
        }
        return value;
    }
    std::vector<double> lengths() const override {
        double first = dipoles_[0].real, last = 0;
        for (const Dipole& p : dipoles_) {
            first = std::min(first, p.real);
            last = std::max(last, p.virtualDepth + negligibleDecay / p.transport);
        }
        return geometric(0.3 * first, last, 3);
    }
    double radius() const override { return radius_; }

  private:
    static double source(const Dipole& p, double depth, double d) {
        const double s = std::hypot(depth, d);
        return depth * (1 + p.transport * s) * std::exp(-p.transport * s) / (4 * pi * s * s * s);
    }
    Dipole dipoles_[3];
    double radius_;
};

// Fit of the average diffuse Fresnel reflectance from inside, for eta > 1: Jensen et al. 2001, section 2.
double diffuseFresnelReflectance(double eta) {
    return -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta;
}

}  // namespace

double burleyScale(BurleyFit fit, double albedo) {
    switch (fit) {
        case BurleyFit::searchlight:
            return 1.85 - albedo + 7 * std::pow(std::abs(albedo - 0.8), 3);
        case BurleyFit::diffuseTransmission:
            return 1.9 - albedo + 3.5 * std::pow(albedo - 0.8, 2);
        case BurleyFit::diffuseMeanFreePath:
            return 3.5 + 100 * std::pow(albedo - 0.33, 4);
    }
    throw std::invalid_argument("unknown fit of s(A)");
}

ProfilePtr burleyProfile(Rgb meanFreePath, Rgb albedo, BurleyFit fit) {
    Rgb decay;
    for (int c = 0; c < 3; ++c) {
        decay[c] = meanFreePath[c] / burleyScale(fit, albedo[c]);
        if (!(decay[c] > 0)) throw std::invalid_argument("a mean free path must be above 0");
    }
    return std::make_shared<BurleyProfile>(decay);
}

ProfilePtr dipoleProfile(Rgb absorption, Rgb reducedScattering, double eta) {
    const double fresnel = diffuseFresnelReflectance(eta);
    const double mismatch = (1 + fresnel) / (1 - fresnel);  // A of the boundary condition
    Dipole dipoles[3];
    for (int c = 0; c < 3; ++c) {
        if (!(absorption[c] > 0 && reducedScattering[c] > 0))
            throw std::invalid_argument("absorption and reduced scattering must be above 0");
        const double extinction = absorption[c] + reducedScattering[c];
        const double diffusion = 1 / (3 * extinction);
        Dipole& p = dipoles[c];
        p.transport = std::sqrt(3 * absorption[c] * extinction);
        p.real = 1 / extinction;
        p.virtualDepth = p.real + 4 * mismatch * diffusion;
        p.energy = 0.5 * (std::exp(-p.transport * p.real) + std::exp(-p.transport * p.virtualDepth));
    }
    return std::make_shared<DipoleProfile>(dipoles);
}

}  // namespace reference
