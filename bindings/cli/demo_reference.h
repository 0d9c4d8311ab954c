// The demo's reference: what every method approximates, on each second pixel of each second row.
#pragma once
#include <vector>

#include "demo_view.h"

namespace pellucid::cli {

constexpr int referenceStride = 2;  // pixels, as much as the sheet shrinks pictures

struct DemoReference {
    int width = 0, height = 0;    // of the picture over the stride
    std::vector<float> radiance;  // RGB, diffuse, by the mesh's own normals; 0 where there is no skin
    double rms = 0;               // of `auto` without gloss and pores, over skin, of the brightest
    std::vector<float> error;     // RGB, auto - reference
};

// `smooth`: the view shaded by auto with the mesh's own normals and without gloss, at full size.
DemoReference demoReference(const Device& device, const sample::Scene& mesh, const DemoHead& head,
                            const DemoView& view, const std::vector<float>& smooth);

}  // namespace pellucid::cli
