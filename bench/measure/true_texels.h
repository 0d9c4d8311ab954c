// Texels of look-up tables by adaptive quadrature in double precision.
#pragma once
#include "reference/lut.h"
#include "tools.h"

namespace pellucid::bench {

using TexelAt = std::function<reference::Rgb(int x, int y)>;

// Of the table that `d` describes. `profile`: before it is scaled to the table's radius.
inline TexelAt trueTexels(const PelCurvatureLutDesc& d, const reference::ProfilePtr& profile) {
    const auto scaled = reference::profileForRadius(profile, d.diffusionRadius);
    const reference::CurvatureLutSpec spec{reference::Form(d.form), int(d.width), int(d.height), d.radiusMin,
                                           d.radiusMax};
    return [=](int x, int y) {
        if (d.axis == PEL_AXIS_LINEAR) return reference::curvatureTexel(spec, *scaled, x, y);
        const double s = -1 + 2.0 * x / (d.width - 1), low = std::sqrt(1 / double(d.radiusMax)),
                     high = std::sqrt(1 / double(d.radiusMin)),
                     root = low + y / (d.height - 1.0) * (high - low);
        return reference::curvatureD(spec.form, *scaled, s * std::abs(s), 1 / (root * root));
    };
}

// Widths and sharpening refer to the diffusion radius of `d`, lengths of the profile to its own.
inline TexelAt trueTexels(const PelShadowLutDesc& d, const reference::ProfilePtr& profile) {
    const reference::ShadowLutSpec spec{int(d.width), int(d.height),     d.widthMin,
                                        d.widthMax,   d.diffusionRadius, d.sharpening};
    return [=](int x, int y) { return reference::shadowTexel(spec, *profile, x, y); };
}

inline TexelAt trueTexels(const PelSpecularLutDesc& d, const reference::ProfilePtr&) {
    return [=](int x, int y) {
        const double v = reference::beckmannEncoded((x + 0.5) / d.width, (y + 0.5) / d.height);
        return reference::Rgb{v, v, v};
    };
}

}  // namespace pellucid::bench
