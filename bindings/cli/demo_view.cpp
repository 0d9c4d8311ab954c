#include "demo_view.h"

#include <algorithm>
#include <chrono>

#include "sample/gbuffer.h"
#include "sample/shadow_map.h"
#include "sample/sky.h"
#include "sample/wide_shadow.h"

namespace pellucid::cli {
namespace {

constexpr const char *curvatureLutName = "skin", *shadowLutName = "skin edges";
constexpr int shadowMapSize = 2048;  // texels a side: 0.15 mm each for a head

template <class Work>
double timed(Work&& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

// Adds an image's planes as channels "NAME.X" and so on, and tells the scene that they feed `slot`.
void addChannels(DemoView& view, const std::string& name, const std::string& components, const float* planes,
                 PelImageSlot slot) {
    std::vector<std::string>& names = view.scene.channels[slot];
    const size_t pixels = view.gbuffer.pixelCount();
    for (size_t c = 0; c < components.size(); ++c) {
        names.push_back(name + "." + components[c]);
        view.gbuffer.channels.push_back(
            {names.back(), io::ChannelType::Float, {planes + c * pixels, planes + (c + 1) * pixels}});
    }
}

void copy(float (&to)[3], sample::Vec3 from) {
    to[0] = float(from.x), to[1] = float(from.y), to[2] = float(from.z);
}

PelMaterial skin() {
    PelMaterial m = pelMaterialDefaults();
    // Blood and tissue let red through furthest.
    const float transmitted[3] = {0.7f, 0.16f, 0.05f};
    std::copy(transmitted, transmitted + 3, m.deepScatterColor);
    m.deepScatterRadius = 6.0f;
    m.specular = 0.35f;
    return m;
}

}  // namespace

io::SceneFile standardLuts() {
    io::SceneFile scene;
    scene.luts.resize(2);
    scene.luts[0].name = curvatureLutName;
    scene.luts[1].name = shadowLutName;
    scene.luts[1].info.kind = PEL_LUT_SHADOW;
    return scene;
}

DemoView renderDemoView(const sample::Scene& mesh, const DemoViewRequest& request) {
    DemoView view;
    view.name = request.name;
    const int width = int(request.width), height = int(request.height);
    const double aspect = double(width) / height;
    const sample::Camera camera = sample::frameHead(mesh.bounds(), request.pose, request.framing, aspect);
    const sample::DirectionalLight key{sample::keyLightDirection(request.pose, request.keyLight)};

    io::SceneMaterial material;
    material.material = skin();
    material.curvatureLut = curvatureLutName;
    material.shadowLut = shadowLutName;
    view.scene.luts = standardLuts().luts;

    sample::GBuffer g;
    view.gbufferMilliseconds = timed([&] { g = sample::renderGBuffer(mesh, camera, width, height); });
    sample::ShadowMap map;
    view.shadowMapMilliseconds = timed([&] { map = sample::renderShadowMap(mesh, key, shadowMapSize); });
    sample::Image wide;
    sample::WideShadowOptions filter;
    filter.filterWidth = material.material.shadowFilterWidth;
    view.wideShadowMilliseconds = timed([&] { wide = sample::filterWideShadow(g, map, filter); });

    view.gbuffer.width = width;
    view.gbuffer.height = height;
    addChannels(view, "Position", "XYZ", g.position.data.data(), PEL_SLOT_POSITION);
    addChannels(view, "NormalGeometric", "XYZ", g.geometricNormal.data.data(), PEL_SLOT_NORMAL_GEOMETRIC);
    addChannels(view, "NormalShading", "XYZ", g.shadingNormal.data.data(), PEL_SLOT_NORMAL_SHADING);
    addChannels(view, "NormalBlurred", "XYZ", g.blurredNormal.data.data(), PEL_SLOT_NORMAL_BLURRED);
    addChannels(view, "Curvature", "V", g.curvature.data.data(), PEL_SLOT_CURVATURE);
    addChannels(view, "Albedo", "RGB", g.albedo.data.data(), PEL_SLOT_ALBEDO);
    const std::vector<float> ids(g.material.begin(), g.material.end());
    addChannels(view, "Material", "I", ids.data(), PEL_SLOT_MATERIAL);
    view.gbuffer.channels.push_back({"KeyShadow.V", io::ChannelType::Float, wide.data});

    view.scene.materials.push_back(material);
    io::SceneLight light;
    light.light.type = PEL_LIGHT_DIRECTIONAL;
    copy(light.light.toLight, key.toLight);
    const float white[3] = {1.0f, 0.94f, 0.86f};
    for (int c = 0; c < 3; ++c) light.light.color[c] = white[c] * request.keyIrradiance;
    std::ranges::copy(map.worldToUvz.toFloats(), light.light.worldToShadow);
    light.light.shadowProjection = PEL_SHADOW_PARALLEL;
    light.light.shadowDepthRange = float(map.depthRange);
    light.wideShadow = "KeyShadow.V";
    light.shadowMapFile = request.name + "_shadowmap.exr";
    light.shadowMapChannel = "Z";
    view.scene.lights.push_back(light);

    io::Image& depth = view.shadowMaps[light.shadowMapFile];
    depth.width = depth.height = map.size;
    depth.channels.push_back({"Z", io::ChannelType::Float, map.depth});

    sample::Sky sky;
    sky.up = request.pose.up;
    sky.lamp = key.toLight;  // its reflection from the room
    const sample::Harmonics harmonics = sample::projectIrradiance(sky);
    for (int i = 0; i < 9; ++i)
        for (int c = 0; c < 3; ++c)
            view.scene.ambient.sh[i][c] = float(harmonics[size_t(i)][size_t(c)]) * request.skyScale;
    copy(view.scene.camera.position, camera.eye);
    std::ranges::copy(camera.inverseViewProjection(aspect).toFloats(),
                      view.scene.camera.inverseViewProjection);
    return view;
}

io::SceneFile withoutDeepScatter(io::SceneFile scene) {
    for (io::SceneMaterial& m : scene.materials) std::fill_n(m.material.deepScatterColor, 3, 0.0f);
    return scene;
}

io::SceneFile withoutScattering(io::SceneFile scene) {
    scene = withoutDeepScatter(std::move(scene));
    for (io::SceneMaterial& m : scene.materials) {
        m.curvatureLut.clear();
        m.shadowLut.clear();
    }
    // One normal for all channels, as a renderer without scattering has.
    scene.channels[PEL_SLOT_NORMAL_BLURRED].clear();
    scene.channels[PEL_SLOT_NORMAL_GEOMETRIC] = scene.channels[PEL_SLOT_NORMAL_SHADING];
    return scene;
}

}  // namespace pellucid::cli
