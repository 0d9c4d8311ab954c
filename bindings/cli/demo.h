// The demo: the images that the sample renderer makes for each view, and its pictures.
#pragma once
#include "demo/demo_head.h"
#include "io/image/picture.h"
#include "sample/gbuffer.h"
#include "scene/scene_frame.h"

namespace pellucid::cli {

using demo::DemoHead;

struct DemoView {
    std::string name;
    io::SceneFile scene;
    io::ShadowMaps images;  // by the names of their files in the scene: shadow maps, surroundings
    io::Image gbuffer;
};

// A lamp round the head.
struct DemoLight {
    std::string name;
    double azimuth, elevation;  // degrees, as in sample::headDirection
    float color[3];             // irradiance / pi
    bool box = true;            // it is seen in reflections, as a soft box
    double radius = 0.05;       // at a distance of 1
};

struct DemoViewRequest {
    std::string name;
    sample::Framing framing;
    std::vector<DemoLight> lights;  // the first one's reflection is in the sky
    float skyScale = 1;             // of the ambient light
    uint32_t width = 1280, height = 720;
    int rays = 8;  // a pixel, for the light of the sky; half of them to each lamp
};

// A scene with only the two tables that the views use, curvature and shadow.
io::SceneFile standardLuts();

// The images of the head that do not depend on its lights.
struct DemoSurface {
    sample::Camera camera;
    sample::GBuffer gbuffer;
    sample::Image occlusion;     // of ambient light
    std::vector<float> wetness;  // of eyes, or empty
};

// The ray-traced lighting of a view.
struct DemoLightImages {
    std::vector<sample::Image> shadows;  // of each lamp
    sample::Image indirect;
};

// The head made ready for rays.
struct DemoBody {
    const DemoHead& head;
    const sample::Scene &mesh, &hair;
};

// `coarse`: a smaller surface of the same view, whose occlusion is enlarged instead of traced again.
DemoSurface renderDemoSurface(const DemoBody& body, const DemoViewRequest& request,
                              const DemoSurface* coarse = nullptr);
// `surface`: of the same size and framing.
DemoLightImages renderDemoLight(const DemoBody& body, const DemoSurface& surface,
                                const DemoViewRequest& request);
DemoView renderDemoView(const DemoBody& body, const DemoSurface& surface, const DemoLightImages& light,
                        const DemoViewRequest& request);
// The G-buffer alone, whose channels the view's scene names.
void addPixels(DemoView& view, const DemoBody& body, const DemoSurface& surface, const DemoLightImages& light,
               const DemoViewRequest& request);

io::SceneFile byTables(io::SceneFile scene);
// The three ways in which each view is shaded, and the variants of its scene for them.
enum DemoVariant { DEMO_LAMBERT, DEMO_TABLES, DEMO_COMPLETE };
constexpr const char* demoVariants[] = {"Lambert", "by tables", "on the screen"};
std::array<io::SceneFile, 3> scenesOf(const DemoView& view);
// The view with its skin made of another material of the library, and its albedo multiplied by a tint.
DemoView madeOf(DemoView view, const std::string& profile, const float (&tint)[3]);

struct ShadedView {
    DemoView view;
    DemoLightImages light;
    std::array<std::vector<float>, 3> radiance;  // RGB per pixel, by variant
    // Twice as large, before the backdrop, by variant. Empty for views that are large already.
    std::vector<io::Picture> fine;
};

io::Picture developed(const DemoView& view, const std::vector<float>& radiance);

// The complete picture of a view, NAME.png in `folder`, and NAME_lambert.png without scattering. Returns the
// name of the first, as do the next two.
std::string writePicture(const std::string& folder, const ShadedView& view);

// The contact sheet, demo.png: a row per view, the spot with most transmission, tables, and `materials`.
std::string writeSheet(const std::string& folder, const std::vector<ShadedView>& views,
                       const std::vector<io::Tile>& materials, const Lut& curvatureLut, const Lut& shadowLut);

// The parts of a view's radiance, and its thickness: NAME_parts.png. `frame`: shaded with all outputs.
std::string writeParts(const std::string& folder, const DemoView& view, const io::SceneFrame& frame);

}  // namespace pellucid::cli
