#include "reference/lut.h"
#include "reference/quadrature.h"

namespace reference {

double shadowPosition(double w) {
    return 0.5 * (std::sqrt(w) - std::sqrt(1 - w)) + 0.5;
}

Rgb shadowT(const Profile& profile, double w, double q, double k) {
    const double p = shadowPosition(w), reach = profileCut(profile);
    auto edge = [&](double s) { return smoothstep01(saturate((p + s * q) * k + 0.5 * (1 - k))); };
    // Both sides folded onto s > 0; a logarithm at s = 0 is tamed by s = t³.
    const bool cubic = profile.singularAtZero();
    auto integrand = [&](double t) {
        const double s = cubic ? t * t * t : t, jacobian = cubic ? 3 * t * t : 1;
        return jacobian * (edge(s) + edge(-s)) * profile.lineSpread(s);
    };
    auto borders = profile.lengths();
    if (q > 0)
        for (double end : {-0.5, 0.5}) {  // the ramp runs where (p - 1/2) + s q lies within +-1/(2k)
            const double kink = (end / k + 0.5 - p) / q;
            borders.push_back(kink);
            borders.push_back(-kink);
        }
    if (cubic)
        for (double& b : borders) b = std::cbrt(b);
    return integrate<Rgb>(integrand, panelPoints(0, cubic ? std::cbrt(reach) : reach, borders));
}

Rgb shadowTexel(const ShadowLutSpec& spec, const Profile& profile, int x, int y) {
    const double f = spec.diffusionRadius / profile.radius();
    return shadowT(profile, spec.w(x), spec.reciprocalWidth(y, f), spec.sharpening);
}

double shadowFade(int x, int width) {
    return 25 * x < width ? 25.0 * x / width : 1.0;
}

}  // namespace reference
