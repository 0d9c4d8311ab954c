// Diffusion profiles (section 1 of the mathematics) in double precision: radial R(d) and line spread P(s) per
// channel.
#pragma once

#include <memory>
#include <vector>

#include "reference/vec.h"

namespace reference {

// All lengths in one unit, millimetres for the built-in skin; inputs are not checked. Both views are
// normalised: the integral of radial(d) 2 pi d over d > 0 and that of lineSpread(s) over all s are 1 in every
// channel.
class Profile {
  public:
    virtual ~Profile() = default;
    virtual Rgb radial(double distance) const = 0;  // energy per area
    // Energy per length. Unless a profile has a closed form this is the quadrature of radial along a line.
    virtual Rgb lineSpread(double offset) const;
    // Distances at which radial changes scale or has a kink, ascending: panel borders for a quadrature.
    virtual std::vector<double> lengths() const = 0;
    // radial grows like 1/d: integrable over a disk, not along a line through the centre.
    virtual bool singularAtZero() const { return false; }
    // Length that diffusion_radius refers to: a profile for radius rho is this one with lengths times
    // rho/radius().
    double radius() const { return radius_; }

  protected:
    double radius_ = 0;
};
using ProfilePtr = std::shared_ptr<const Profile>;

struct Gaussian {
    double variance;  // length²
    Rgb weight;
};

// Six Gaussians of d'Eon & Luebke, GPU Gems 3 ch. 14, weights as in the mathematics; radius() is 2.7.
ProfilePtr skinProfile();
// Weights are normalised per channel; radius() is the sigma of the widest Gaussian of non-zero weight.
ProfilePtr gaussiansProfile(std::vector<Gaussian> gaussians);

// The three fits of s(A) in Christensen & Burley, Approximate Reflectance Profiles for Efficient Subsurface
// Scattering (Pixar 15-04, 2015), named by what the length given is and how light enters.
enum class BurleyFit {
    searchlight,          // eq. 5: volume mean free path, perpendicular beam
    diffuseTransmission,  // eq. 6: volume mean free path, diffuse transmission into the surface
    diffuseMeanFreePath,  // eq. 8: diffuse mean free path on the surface, perpendicular beam
};
double burleyScale(BurleyFit fit, double albedo);

// The mean free path of the medium whose half-space has this reflectance (docs/mathematics.md, section 14).
double mediumPath(double burleyLength, double reflectance);

// The gain of a curved body (docs/mathematics.md, section 12, "On the screen"). x: mean free path times mean
// curvature; pathOverLength: mean free path over Burley's length.
double curvatureGain(double x, double pathOverLength);
// Radius: the root mean square of the widest channel's line spread, here and in the next two.
ProfilePtr burleyProfile(Rgb meanFreePath, Rgb albedo, BurleyFit fit = BurleyFit::diffuseTransmission);

// Classical dipole of Jensen et al. 2001; coefficients per length, eta of the medium relative to outside (>
// 1).
ProfilePtr dipoleProfile(Rgb absorption, Rgb reducedScattering, double eta);

// Measured radial values: linear between the distances, constant before the first, zero after the last.
ProfilePtr tableProfile(std::vector<double> distances, std::vector<Rgb> values);

// The same profile with all lengths stretched alike, so that its radius() is `diffusionRadius`.
ProfilePtr profileForRadius(ProfilePtr profile, double diffusionRadius);

// Standard deviation of the line spread per channel, by quadrature of radial: sqrt(1/2 * integral of R d² 2
// pi d).
Rgb rmsWidth(const Profile& profile);
// Integral of radial over the disk of the given radius, by quadrature.
Rgb enclosedEnergy(const Profile& profile, double discRadius);

}  // namespace reference
