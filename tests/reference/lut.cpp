#include "reference/lut.h"

#include "reference/quadrature.h"

namespace reference {
namespace {

double sine(double u) {
    return std::sqrt((1 - u) * (1 + u));
}

// Where max0(cos(theta +- x)) has a kink, u = cos theta.
std::array<double, 4> terminators(double u) {
    const double rise = std::asin(u);
    return {rise, -rise, pi + rise, pi - rise};
}

// From 0 to `end`; a logarithm at 0 is tamed by x = t^3.
template <class Value, class F>
Value tamed(bool cubic, const F& f, double end, std::vector<double> borders, double absoluteError = 1e-13,
            double relativeError = 1e-12) {
    if (!cubic) return integrate<Value>(f, panelPoints(0, end, borders), absoluteError, relativeError);
    for (double& b : borders) b = std::cbrt(b);
    return integrate<Value>([&](double t) { return 3 * t * t * f(t * t * t); },
                            panelPoints(0, std::cbrt(end), borders), absoluteError, relativeError);
}

// The integral of light(s) over a line spread, both sides folded onto s > 0.
template <class Light>
Rgb overLine(const Profile& profile, const Light& light, double reach, const std::vector<double>& kinks) {
    auto borders = profile.lengths();
    borders.insert(borders.end(), kinks.begin(), kinks.end());
    return tamed<Rgb>(
        profile.singularAtZero(), [&](double s) { return (light(s) + light(-s)) * profile.lineSpread(s); },
        reach, borders);
}

// The mean of max0(cos(theta + x)) over a circle, as the kernel weighs it.
template <class Kernel>
Rgb overCircle(const Profile& profile, const Kernel& kernel, bool cubic, double u, double r,
               double halfAngle) {
    std::vector<double> borders;
    for (double l : profile.lengths())
        if (l < 2 * r) borders.push_back(2 * std::asin(l / (2 * r)));
    auto weight = [&](double x) { return kernel(2 * r * std::sin(0.5 * x)); };
    auto lit = [&, v = sine(u)](double x) { return max0(u * std::cos(x) - v * std::sin(x)); };
    for (double kink : terminators(u)) borders.push_back(kink);
    Rgb norm;
    for (int c = 0; c < 3; ++c)
        norm[c] = 2 * tamed<double>(
                          cubic, [&](double x) { return weight(x)[c]; }, halfAngle, borders, 0, 1e-13);
    return tamed<Rgb>(
        cubic, [&](double x) { return (lit(x) + lit(-x)) * (weight(x) / norm); }, halfAngle, borders);
}

Rgb sphere(const Profile& profile, double u, double r) {
    Rgb norm;
    for (int c = 0; c < 3; ++c)
        norm[c] = integrate<double>([&](double d) { return 2 * pi * d * profile.radial(d)[c]; },
                                    panelPoints(0, 2 * r, profile.lengths()), 0, 1e-13);
    return overSphere(profile, std::acos(u), r, norm);
}

}  // namespace

Rgb overSphere(const Profile& profile, double angle, double r, Rgb norm) {
    const double u = std::cos(angle), rise = std::abs(pi / 2 - angle);
    // Mean of max0(cos) over the circle at colatitude psi round the point.
    const auto mean = [&](double cosPsi, double sinPsi) {
        const double a = u * cosPsi, b = std::sin(angle) * sinPsi;
        if (a >= b) return a;
        if (a <= -b) return 0.0;
        return (a * std::acos(-a / b) + std::sqrt((b - a) * (b + a))) / pi;
    };
    auto borders = profile.lengths();
    borders.push_back(2 * r * std::sin(0.5 * rise));         // where the circle first touches the terminator
    borders.push_back(2 * r * std::sin(0.5 * (pi - rise)));  // and where it leaves it
    // Over the chord d = 2 r sin(psi/2): sin(psi) dpsi = d dd / r^2, and a profile's 1/d is cancelled.
    return integrate<Rgb>(
        [&](double d) {
            const double sinPsi = d / r * std::sqrt(max0(1 - d * d / (4 * r * r)));
            return 2 * pi * d * mean(1 - d * d / (2 * r * r), sinPsi) * (profile.radial(d) / norm);
        },
        panelPoints(0, 2 * r, borders));
}

Rgb curvatureD(Form form, const Profile& profile, double u, double r, double cut) {
    const auto radial = [&](double d) { return profile.radial(d); };
    const auto spread = [&](double d) { return profile.lineSpread(d); };
    switch (form) {
        case Form::arc: {
            std::vector<double> kinks;
            for (double kink : terminators(u)) kinks.push_back(r * kink);
            const auto lit = [&, v = sine(u)](double s) {
                return max0(u * std::cos(s / r) + v * std::sin(s / r));
            };
            return overLine(profile, lit, std::min(pi * r, cut > 0 ? cut : profileCut(profile)), kinks);
        }
        case Form::ring:
        case Form::halfRing:
            if (profile.singularAtZero()) return max0(u) * Rgb{1, 1, 1};
            return overCircle(profile, radial, false, u, r, form == Form::ring ? pi : pi / 2);
        case Form::pennerRing:
            return overCircle(profile, spread, profile.singularAtZero(), u, r, pi);
        case Form::sphere:
            return sphere(profile, u, r);
    }
    throw std::invalid_argument("unknown form of the curvature LUT");
}

Rgb curvatureTexel(const CurvatureLutSpec& spec, const Profile& profile, int x, int y) {
    return curvatureD(spec.form, profile, spec.u(x), spec.radius(y));
}

double shadowPosition(double w) {
    return 0.5 * (std::sqrt(w) - std::sqrt(1 - w)) + 0.5;
}

Rgb shadowT(const Profile& profile, double w, double q, double k) {
    const double p = shadowPosition(w);
    auto edge = [&](double s) { return smoothstep01(saturate((p + s * q) * k + 0.5 * (1 - k))); };
    std::vector<double> kinks;
    if (q > 0)
        for (double end : {-0.5, 0.5})  // the ramp runs where (p - 1/2) + s q lies within +-1/(2k)
            for (double sign : {1.0, -1.0}) kinks.push_back(sign * (end / k + 0.5 - p) / q);
    return overLine(profile, edge, profileCut(profile), kinks);
}

Rgb shadowTexel(const ShadowLutSpec& spec, const Profile& profile, int x, int y) {
    const double f = spec.diffusionRadius / profile.radius();
    return shadowT(profile, spec.w(x), spec.reciprocalWidth(y, f), spec.sharpening);
}

double shadowFade(int x, int width) {
    return 25 * x < width ? 25.0 * x / width : 1.0;
}

double beckmann(double cosine, double m) {
    if (!(cosine > 0) || !(m > 0)) return 0;
    const double c = std::min(1.0, cosine), slope = sine(c) / (c * m);
    // In logarithms: near grazing angles and for tiny m both factors leave the range of a double.
    return std::exp(-slope * slope - 2 * std::log(m) - 4 * std::log(c));
}

double beckmannEncoded(double cosine, double m) {
    return 0.5 * std::pow(beckmann(cosine, m), 0.1);
}

double srgbFromLinear(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double linearFromSrgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

Rgb faceworksCurvatureSteps(Rgb d, double u) {
    Rgb steps;
    for (int c = 0; c < 3; ++c) steps[c] = 255 * saturate(2 * (d[c] - max0(u)) + 0.5);
    return steps;
}

Rgb faceworksShadowSteps(Rgb t, int x, int width) {
    Rgb steps;
    for (int c = 0; c < 3; ++c) steps[c] = 255 * saturate(srgbFromLinear(shadowFade(x, width) * t[c]));
    return steps;
}

bool faceworksCurvatureClips(Rgb d, double u) {
    return magnitude(d - max0(u) * Rgb{1, 1, 1}) > 0.25;
}

Rgba8 roundedSteps(Rgb steps) {
    Rgba8 out{0, 0, 0, 255};
    for (int c = 0; c < 3; ++c) out[c] = uint8_t(std::floor(steps[c] + 0.5));
    return out;
}

}  // namespace reference
