// One view of the demo: what the stand-in host renders, as a G-buffer image and a scene file.
#pragma once
#include <string>

#include "demo/demo_head.h"
#include "sample/camera.h"
#include "sample/scene.h"
#include "scene/scene_frame.h"

namespace pellucid::cli {

using demo::DemoHead;

struct DemoView {
    std::string name;
    io::Image gbuffer;
    io::SceneFile scene;
    io::ShadowMaps shadowMaps;
    double gbufferMilliseconds = 0, shadowMapMilliseconds = 0, wideShadowMilliseconds = 0;
};

// A lamp round the head.
struct DemoLight {
    std::string name;
    double azimuth, elevation;  // degrees, as in sample::headDirection
    float color[3];             // irradiance / pi
    bool shadow = true;         // a soft lamp beside the camera needs none
};

struct DemoViewRequest {
    std::string name;
    sample::Framing framing;
    std::vector<DemoLight> lights;  // the first one's reflection is in the sky
    float skyScale = 1;             // of the ambient light
    uint32_t width = 1280, height = 720;
};

// A scene with only the two tables that the views use, curvature and shadow.
io::SceneFile standardLuts();

// Renders with the stand-in host.
DemoView renderDemoView(const sample::Scene& mesh, const DemoHead& head, const DemoViewRequest& request);

// The same scene shaded plainly, by Lambert, or by tables.
io::SceneFile withoutScattering(io::SceneFile scene);
io::SceneFile byTables(io::SceneFile scene);
// The view with its skin made of another material of the library, and its albedo multiplied by a tint.
DemoView madeOf(DemoView view, const std::string& profile, const float (&tint)[3]);

}  // namespace pellucid::cli
