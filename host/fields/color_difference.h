// Perceived difference of two colours.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace pel {

using Lab = std::array<double, 3>;

// CIE L*a*b* of linear sRGB, D65 white; negative components count as 0.
inline Lab labFromLinear(const std::array<double, 3>& rgb) {
    const double r = std::max(0.0, rgb[0]), g = std::max(0.0, rgb[1]), b = std::max(0.0, rgb[2]);
    auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
    const double x = f((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047);
    const double y = f(0.2126729 * r + 0.7151522 * g + 0.0721750 * b);
    const double z = f((0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.08883);
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

// CIEDE2000 (CIE 142-2001) with all parametric factors 1, as spelled out by Sharma, Wu & Dalal 2005. A
// difference of about 1 is just visible.
inline double deltaE2000(const Lab& one, const Lab& two) {
    constexpr double degree = std::numbers::pi / 180, pow25to7 = 6103515625.0;
    const double c1 = std::hypot(one[1], one[2]), c2 = std::hypot(two[1], two[2]);
    const double mean7 = std::pow((c1 + c2) / 2, 7), g = 0.5 * (1 - std::sqrt(mean7 / (mean7 + pow25to7)));
    const double a1 = (1 + g) * one[1], a2 = (1 + g) * two[1];
    const double C1 = std::hypot(a1, one[2]), C2 = std::hypot(a2, two[2]);
    auto hue = [&](double b, double a) {
        const double h = a == 0 && b == 0 ? 0 : std::atan2(b, a) / degree;
        return h < 0 ? h + 360 : h;
    };
    const double h1 = hue(one[2], a1), h2 = hue(two[2], a2);
    double dh = 0, meanH = h1 + h2;
    if (C1 * C2 > 0) {
        dh = h2 - h1;
        if (dh > 180) dh -= 360;
        if (dh < -180) dh += 360;
        meanH = std::abs(h1 - h2) <= 180 ? (h1 + h2) / 2
                                         : (h1 + h2 < 360 ? (h1 + h2 + 360) / 2 : (h1 + h2 - 360) / 2);
    }
    const double dL = two[0] - one[0], dC = C2 - C1, dH = 2 * std::sqrt(C1 * C2) * std::sin(dh / 2 * degree);
    const double meanL = (one[0] + two[0]) / 2, meanC = (C1 + C2) / 2;
    const double t = 1 - 0.17 * std::cos((meanH - 30) * degree) + 0.24 * std::cos(2 * meanH * degree) +
                     0.32 * std::cos((3 * meanH + 6) * degree) - 0.20 * std::cos((4 * meanH - 63) * degree);
    const double l50 = (meanL - 50) * (meanL - 50), mean7C = std::pow(meanC, 7);
    const double sL = 1 + 0.015 * l50 / std::sqrt(20 + l50), sC = 1 + 0.045 * meanC,
                 sH = 1 + 0.015 * meanC * t;
    const double turn = 30 * std::exp(-std::pow((meanH - 275) / 25, 2));
    const double rT = -2 * std::sqrt(mean7C / (mean7C + pow25to7)) * std::sin(2 * turn * degree);
    return std::sqrt(std::pow(dL / sL, 2) + std::pow(dC / sC, 2) + std::pow(dH / sH, 2) +
                     rT * dC / sC * dH / sH);
}

}  // namespace pel
