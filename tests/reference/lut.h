// Look-up tables (sections 2 to 4 of the mathematics) in double precision, texel by texel, by adaptive
// quadrature.
#pragma once

#include <array>
#include <cstdint>

#include "reference/profile.h"

namespace reference {

// --- curvature ---

enum class Form { arc, ring, halfRing, sphere, pennerRing };

// Truncation of arc and of the shadow integral in a profile's own lengths: 10 mm for the 2.7 mm of skin
// [FaceWorks].
inline double profileCut(const Profile& profile) {
    return 10 * profile.radius() / 2.7;
}

// D for u = N.L in [-1, 1] and radius of curvature r > 0, in the profile's unit of length. arc is cut at
// min(pi r, cut) on either side, cut 0: at profileCut, and not renormalised; the other forms ignore cut.
// A profile that is singular at its centre has no ring: both integrals diverge there and D is their ratio's
// limit, max0(u).
Rgb curvatureD(Form form, const Profile& profile, double u, double r, double cut = 0);

// The integral of the form `sphere` over `norm`: on a sphere of radius r, at an angle from the light. D is
// over the same integral where light is 1 everywhere.
Rgb overSphere(const Profile& profile, double angle, double r, Rgb norm);

struct CurvatureLutSpec {
    Form form = Form::arc;
    int width = 512, height = 512;
    double radiusMin = 1, radiusMax = 100;  // of curvature
    double u(int x) const { return -1 + (x + 0.5) * 2 / width; }
    double radius(int y) const {  // rows are linear in curvature, the smallest first
        const double least = 1 / radiusMax, most = 1 / radiusMin;
        return 1 / (least + (y + 0.5) * (most - least) / height);
    }
};
// The profile is already scaled to the LUT's diffusion radius (profileForRadius).
Rgb curvatureTexel(const CurvatureLutSpec& spec, const Profile& profile, int x, int y);

// --- shadow ---

// Light carried across a shadow edge: w the wide-filtered shadow in [0, 1], q the reciprocal width per length
// of the profile, k >= 1 the sharpening. profile is in its own lengths (skin: millimetres), not scaled.
Rgb shadowT(const Profile& profile, double w, double q, double k);
double shadowPosition(double w);  // p, position across the edge

struct ShadowLutSpec {
    int width = 512, height = 512;
    double widthMin = 8, widthMax = 100;  // of the penumbra, length
    double diffusionRadius = 2.7;         // length
    double sharpening = 10;
    double w(int x) const { return (x + 0.5) / width; }
    double reciprocalWidth(int y, double f) const {
        return f / widthMax + (y + 0.5) * (f / widthMin - f / widthMax) / height;
    }
};
Rgb shadowTexel(const ShadowLutSpec& spec, const Profile& profile, int x, int y);
double shadowFade(int x, int width);  // FaceWorks': columns with 25x < W times 25x/W

// --- specular ---

// Beckmann's distribution; cosine = n.h, m the root mean square slope. At m = 0 the lobe has no width: 0.
double beckmann(double cosine, double m);
double beckmannEncoded(double cosine, double m);  // P^0.1 / 2 [d'Eon & Luebke]

// --- FaceWorks' 8-bit encodings ---

using Rgba8 = std::array<uint8_t, 4>;
// Before rounding, in 8-bit steps: near a rounding boundary, a float may return either value.
Rgb faceworksCurvatureSteps(Rgb d, double u);       // 255 sat(2 (D - max0(u)) + 1/2)
Rgb faceworksShadowSteps(Rgb t, int x, int width);  // 255 sRGB(fade * T)
bool faceworksCurvatureClips(Rgb d, double u);      // a channel's residual lies beyond +-1/4
Rgba8 roundedSteps(Rgb steps);                      // to nearest, alpha 255
double srgbFromLinear(double linear);               // IEC 61966-2-1
double linearFromSrgb(double encoded);

}  // namespace reference
