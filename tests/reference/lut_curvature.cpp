#include <numbers>

#include "reference/lut.h"
#include "reference/quadrature.h"

namespace reference {
namespace {

constexpr double pi = std::numbers::pi;

double sine(double u) {
    return std::sqrt((1 - u) * (1 + u));
}

Rgb arc(const Profile& profile, double u, double r, double cut) {
    const double reach = std::min(pi * r, cut), sinTheta = sine(u);
    // max0(cos(theta - x))
    auto lit = [&](double x) { return max0(u * std::cos(x) + sinTheta * std::sin(x)); };
    // Both sides of the shaded point folded onto s > 0. A logarithm at s = 0 is tamed by s = t³.
    const bool cubic = profile.singularAtZero();
    auto integrand = [&](double t) {
        const double s = cubic ? t * t * t : t, jacobian = cubic ? 3 * t * t : 1;
        return jacobian * (lit(s / r) + lit(-s / r)) * profile.lineSpread(s);
    };
    auto borders = profile.lengths();
    const double rise = std::asin(u);  // pi/2 - theta, where the terminator is
    for (double kink : {rise, -rise, pi + rise, pi - rise}) borders.push_back(r * kink);
    if (cubic)
        for (double& b : borders) b = std::cbrt(b);
    return integrate<Rgb>(integrand, panelPoints(0, cubic ? std::cbrt(reach) : reach, borders));
}

// Over the line spread, which is no worse than a logarithm at the centre, substitute x = t^3.
Rgb pennerRing(const Profile& profile, double u, double r) {
    const bool cubic = profile.singularAtZero();
    auto angle = [&](double t) { return cubic ? t * t * t : t; };
    auto kernel = [&](double t) {
        return (cubic ? 3 * t * t : 1) * profile.lineSpread(2 * r * std::sin(0.5 * angle(t)));
    };
    std::vector<double> borders;
    for (double l : profile.lengths())
        if (l < 2 * r) borders.push_back(2 * std::asin(l / (2 * r)));
    const double rise = std::asin(u);
    for (double kink : {rise, -rise, pi + rise, pi - rise}) borders.push_back(kink);
    if (cubic)
        for (double& b : borders) b = std::cbrt(b);
    const auto panels = panelPoints(0, cubic ? std::cbrt(pi) : pi, borders);
    Rgb norm;
    for (int c = 0; c < 3; ++c)
        norm[c] = 2 * integrate<double>([&](double t) { return kernel(t)[c]; }, panels, 0, 1e-13);
    const double sinTheta = sine(u);
    auto lit = [&](double x) { return max0(u * std::cos(x) - sinTheta * std::sin(x)); };
    auto integrand = [&](double t) {
        const Rgb k = kernel(t);
        return (lit(angle(t)) + lit(-angle(t))) * Rgb{k.x / norm.x, k.y / norm.y, k.z / norm.z};
    };
    return integrate<Rgb>(integrand, panels);
}

Rgb ring(const Profile& profile, double u, double r, double halfAngle) {
    if (profile.singularAtZero()) return max0(u) * Rgb{1, 1, 1};
    auto kernel = [&](double x) { return profile.radial(2 * r * std::sin(0.5 * x)); };
    std::vector<double> borders;
    for (double l : profile.lengths())
        if (l < 2 * r) borders.push_back(2 * std::asin(l / (2 * r)));
    Rgb norm;
    for (int c = 0; c < 3; ++c)
        norm[c] = 2 * integrate<double>([&](double x) { return kernel(x)[c]; },
                                        panelPoints(0, halfAngle, borders), 0, 1e-13);
    const double sinTheta = sine(u), rise = std::asin(u);
    // max0(cos(theta + x))
    auto lit = [&](double x) { return max0(u * std::cos(x) - sinTheta * std::sin(x)); };
    auto integrand = [&](double x) {
        const Rgb k = kernel(x);
        return (lit(x) + lit(-x)) * Rgb{k.x / norm.x, k.y / norm.y, k.z / norm.z};
    };
    for (double kink : {rise, -rise, pi + rise, pi - rise}) borders.push_back(kink);
    return integrate<Rgb>(integrand, panelPoints(0, halfAngle, borders));
}

// Mean of max0(cos) over the circle at colatitude psi round a point whose normal is theta from the light;
// a = cos theta cos psi, b = sin theta sin psi.
double circleMean(double a, double b) {
    if (a >= b) return a;
    if (a <= -b) return 0;
    return (a * std::acos(-a / b) + std::sqrt((b - a) * (b + a))) / pi;
}

Rgb sphere(const Profile& profile, double u, double r) {
    // Over the chord d = 2 r sin(psi/2): sin(psi) dpsi = d dd / r², and a profile's 1/d is cancelled.
    auto borders = profile.lengths();
    Rgb norm;
    const auto plain = panelPoints(0, 2 * r, borders);
    for (int c = 0; c < 3; ++c)
        norm[c] = integrate<double>([&](double d) { return d * profile.radial(d)[c]; }, plain, 0, 1e-13);
    const double sinTheta = sine(u), rise = std::abs(std::asin(u));
    borders.push_back(2 * r * std::sin(0.5 * rise));         // where the circle first touches the terminator
    borders.push_back(2 * r * std::sin(0.5 * (pi - rise)));  // and where it leaves it
    auto integrand = [&](double d) {
        const double sinPsi = d / r * std::sqrt(max0(1 - d * d / (4 * r * r))),
                     cosPsi = 1 - d * d / (2 * r * r);
        const Rgb k = d * profile.radial(d);
        return circleMean(u * cosPsi, sinTheta * sinPsi) * Rgb{k.x / norm.x, k.y / norm.y, k.z / norm.z};
    };
    return integrate<Rgb>(integrand, panelPoints(0, 2 * r, borders));
}

}  // namespace

double profileCut(const Profile& profile) {
    return 10 * profile.radius() / 2.7;
}

Rgb curvatureD(Form form, const Profile& profile, double u, double r, double cut) {
    switch (form) {
        case Form::arc:
            return arc(profile, u, r, cut);
        case Form::ring:
            return ring(profile, u, r, pi);
        case Form::halfRing:
            return ring(profile, u, r, pi / 2);
        case Form::sphere:
            return sphere(profile, u, r);
        case Form::pennerRing:
            return pennerRing(profile, u, r);
    }
    throw std::invalid_argument("unknown form of the curvature LUT");
}

Rgb curvatureTexel(const CurvatureLutSpec& spec, const Profile& profile, int x, int y) {
    return curvatureD(spec.form, profile, spec.u(x), spec.radius(y));
}

}  // namespace reference
