// The wide-filtered shadow that the shadow look-up table takes.
#pragma once
#include "sample/gbuffer.h"
#include "sample/shadow_map.h"

namespace pellucid::sample {

// The table reads position p across a penumbra from its value w as p = (sqrt(w) - sqrt(1 - w)) / 2 + 1/2.
// With q = 2p - 1 that is w = (1 + q sqrt(2 - q^2)) / 2: the response of a straight edge to a filter whose
// line spread is (1 - q^2) / sqrt(2 - q^2) on [-1, 1]. The round filter with that line spread (its inverse
// Abel transform) is
//     f(r) = (sqrt(T) / (1 + T) + atan(sqrt(T))) / pi,   T = 1 - r^2,   r in [0, 1],
// and the part of it outside of radius r is sqrt(T) + (T - 1) atan(sqrt(T)). A sharpened table makes a step
// of w ten times larger, so w is not sampled: every texel under the filter is weighed.
double wideFilterEdge(double p);  // w at position p across a straight edge, p in [0, 1], 0 in shadow

struct WideShadowOptions {
    double filterWidth =
        8;  // mm across the light: the whole penumbra, p from 0 to 1. As PelMaterial.shadowFilterWidth
    int maxTexels = 96;      // across the filter; of a finer map every 2nd, 3rd, ... texel a side is read
    double depthBias = 0.5;  // mm
    double softness =
        0.25;  // times filterWidth: an occluder starts to count at the bias and counts in full this much
               // closer to the light, so that round bodies do not shade themselves with a hard edge
    double coneSlope =
        0.5;  // an occluder counts when it stands this many times its sideways distance above the tangent
              // plane (measured as the plane's own tilt is), so that folds and facets do not shade themselves
};

// w per pixel: 0 shadow, 1 lit; 1 on background and outside of the map. For each texel the surface is taken
// to go on in its tangent plane, whose tilt against the light is limited.
Image filterWideShadow(const GBuffer& gbuffer, const ShadowMap& map, const WideShadowOptions& options = {});

}  // namespace pellucid::sample
