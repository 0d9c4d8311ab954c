// Light in two layers that scatter isotropically, the lower one infinitely thick, below a smooth surface.
#pragma once

namespace pel {

inline constexpr double skinIndex = 1.4;  // of both layers

// Lengths in units of the mean free path between scatterings, which is the same in both layers, and
// absorption in units of the scattering coefficient.
struct SkinLayers {
    double thickness;  // of the upper layer, > 0
    double upperAbsorption, lowerAbsorption;
};

// The Hankel transform of the light that leaves at a distance from where diffuse light enters, per light that
// arrives from outside: the integral of R(d) J0(k d) 2 pi d over d. At k = 0 it is the albedo; light that the
// surface itself reflects is not in it. Section 15 of the mathematics. Within 1 % of a random walk, and
// within 4 % where an upper layer of many free paths absorbs nearly all.
double skinReflected(const SkinLayers& layers, double k);

}  // namespace pel
