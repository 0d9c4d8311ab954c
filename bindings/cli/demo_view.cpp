#include "demo.h"

#include "command.h"
#include "demo/demo_hair.h"
#include "demo/dress_gbuffer.h"
#include "sample/occlusion.h"
#include "sample/shadow_map.h"

namespace pellucid::cli {
namespace {

constexpr const char *profileName = "skin", *curvatureLutName = "skin", *shadowLutName = "skin edges";
constexpr float skinRoughness = 0.4f;  // of the broad lobe
constexpr int shadowMapSize = 2048;    // texels a side: 0.15 mm each for a head

void copy(float (&to)[3], sample::Vec3 from) {
    to[0] = float(from.x), to[1] = float(from.y), to[2] = float(from.z);
}

PelMaterial glossy(float specular, float roughness) {
    PelMaterial m = pelMaterialDefaults();
    m.thicknessTaps = 0;
    m.specular = specular;
    m.roughness = roughness;
    return m;
}

PelMaterial skin() {
    PelMaterial m = pelMaterialDefaults();
    // The library's own choice, without a profile too.
    const PelProfileInfo info = Profile::named(profileName).info();
    m.shadowFilterWidth = 3 * std::max({info.width[0], info.width[1], info.width[2]});
    // Two lobes, of the skin's relief and of the film of oil on it.
    m.specularModel = PEL_SPECULAR_GGX;
    m.specular = 0.4f;
    m.roughness = skinRoughness, m.roughness2 = 0.2f, m.lobeMix = 0.3f;
    return m;
}

// Shows the head's frame; near and far plane enclose all of it.
sample::Camera framed(const sample::Scene& mesh, const DemoHead& head, const sample::Framing& framing,
                      double aspect) {
    sample::Camera camera =
        sample::frameHead(head.frame.empty() ? mesh.bounds() : head.frame, head.pose, framing, aspect);
    for (int i = 0; i < 8; ++i) {
        const double depth = dot(mesh.bounds().corner(i) - camera.eye, camera.forward());
        camera.nearPlane = std::max(std::min(camera.nearPlane, depth - 1), 1e-3 * camera.farPlane);
        camera.farPlane = std::max(camera.farPlane, depth + 1);
    }
    return camera;
}

void addShadow(DemoView& view, const sample::Scene& mesh, const DemoLight& lamp,
               const sample::DirectionalLight& direction, io::SceneLight& light) {
    sample::ShadowMap map;
    view.shadowMapMilliseconds +=
        milliseconds([&] { map = sample::renderShadowMap(mesh, direction, shadowMapSize); });
    std::ranges::copy(map.worldToUvz.toFloats(), light.light.worldToShadow);
    light.light.shadowProjection = PEL_SHADOW_PARALLEL;
    light.light.shadowDepthRange = float(map.depthRange);
    light.shadowMapFile = view.name + (lamp.name == "Key" ? "" : "_" + lamp.name) + "_shadowmap.exr";
    light.shadowMapChannel = "Z";
    io::Image& depth = view.images[light.shadowMapFile];
    depth.width = depth.height = map.size;
    depth.channels.push_back({"Z", io::ChannelType::Float, map.depth});
}

// A studio: the sky, soft boxes, and a window to the left of the camera.
sample::Sky studio(const DemoHead& head, const DemoViewRequest& request) {
    constexpr double boxRadiance = 2.4;  // over the lamp's light: 0.28 sr, which add a fifth of it
    sample::Sky sky;
    sky.up = head.pose.up;
    sky.scale = request.skyScale;
    sky.lamp = sample::headDirection(head.pose, request.lights[0].azimuth, request.lights[0].elevation);
    for (const DemoLight& lamp : request.lights)
        if (lamp.box)
            sky.panels.push_back(
                {sample::headDirection(head.pose, lamp.azimuth, lamp.elevation),
                 0.22,
                 0.35,
                 {boxRadiance * lamp.color[0], boxRadiance * lamp.color[1], boxRadiance * lamp.color[2]}});
    const double window = 70 * request.skyScale;
    sky.panels.push_back(
        {sample::headDirection(head.pose, -56, 18), 0.11, 0.15, {window, 1.04 * window, 1.15 * window}});
    return sky;
}

void addSurroundings(DemoView& view, const DemoHead& head, const sample::Sky& sky) {
    constexpr int height = 128;
    const std::vector<float> pixels = sample::equirectangular(sky, head.pose.front, height);
    view.scene.environment = view.name + "_studio.exr";
    io::Image& image = view.images[view.scene.environment];
    image.width = 2 * height, image.height = height;
    image.addInterleaved(std::array<std::string, 3>{"R", "G", "B"}, pixels);
    const sample::Vec3 axes[] = {cross(head.pose.up, head.pose.front), head.pose.up, head.pose.front};
    for (size_t i = 0; i < 3; ++i) {
        float row[3];
        copy(row, axes[i]);
        std::ranges::copy(row, view.scene.environmentAxes + 3 * i);
    }
}

std::vector<io::SceneMaterial> materialsOf(const DemoHead& head) {
    std::vector<io::SceneMaterial> materials(std::max<size_t>(1, head.looks.size()));
    for (size_t i = 0; i < materials.size(); ++i) materials[i].id = uint32_t(i + 1);
    materials[0].material = skin();
    materials[0].profile = profileName;
    if (materials.size() > 1) {
        // Their gloss is that of the film of tears.
        materials[demo::DEMO_EYES - 1].material = materials[demo::DEMO_RIGHT_EYE - 1].material = glossy(0, 1);
        // The sclera: white, and it scatters about as far.
        materials[demo::DEMO_EYES - 1].profile = materials[demo::DEMO_RIGHT_EYE - 1].profile = "cream";
        materials[demo::DEMO_TEETH - 1].material = materials[demo::DEMO_TONGUE - 1].material =
            glossy(0.05f, 0.2f);
        materials[demo::DEMO_CUT - 1].material = materials[demo::DEMO_LASHES - 1].material = glossy(0, 1);
        materials[demo::DEMO_TEARS - 1].material = glossy(0.6f, 0.25f);
        materials[demo::DEMO_TEARS - 1].material.specularModel = PEL_SPECULAR_GGX;
    }
    // As "auto" would choose, which leaves soft shadows of lamps with a shadow map aside.
    for (io::SceneMaterial& m : materials)
        m.material.scattering = m.profile.empty() ? PEL_SCATTERING_NONE : PEL_SCATTERING_SCREEN;
    return materials;
}

// Radiance behind the head: the same everywhere, so that files stay small and are read quickly.
constexpr float backdrop[] = {0.018f, 0.02f, 0.023f};

// Lays hair over the G-buffer: skin under it sends less light back, by albedo and specular, but scatters on.
// Returns what the scene's radiance holds before shading, which is added: the light of hair, the backdrop.
sample::Image layHair(sample::GBuffer& g, sample::Image hair) {
    for (int y = 0; y < g.height; ++y)
        for (int x = 0; x < g.width; ++x) {
            const float left = 1 - hair.at(3, x, y);
            uint32_t& id = g.material[size_t(y) * size_t(g.width) + size_t(x)];
            // An eye's gloss knows neither albedo nor specular.
            if (left < 0.5f && (id == demo::DEMO_EYES || id == demo::DEMO_RIGHT_EYE)) id = demo::DEMO_LASHES;
            for (int c = 0; c < 3; ++c) {
                g.albedo.at(c, x, y) *= left;
                if (id == 0) hair.at(c, x, y) += left * backdrop[c];
            }
            g.specular.at(0, x, y) *= left;
        }
    hair.data.resize(3 * hair.planeSize());
    return hair;
}

}  // namespace

io::SceneFile standardLuts() {
    io::SceneFile scene;
    scene.luts.resize(2);
    scene.luts[0].name = curvatureLutName;
    scene.luts[1].name = shadowLutName;
    scene.luts[0].info.curvature.form = PEL_FORM_SPHERE;
    scene.luts[1].info.kind = PEL_LUT_SHADOW;
    scene.luts[1].info.shadow.closedEnds = 1;
    return scene;
}

DemoView renderDemoView(const sample::Scene& mesh, const DemoHead& head, const DemoViewRequest& request) {
    DemoView view;
    view.name = request.name;
    const int width = int(request.width), height = int(request.height);
    const double aspect = double(width) / height;
    const sample::Camera camera = framed(mesh, head, request.framing, aspect);
    view.scene.luts = standardLuts().luts;
    view.scene.materials = materialsOf(head);

    sample::GBufferOptions look;
    look.looks = head.looks, look.zones = head.zones, look.eyes = head.eyes;
    look.detail.roughness = skinRoughness;
    view.scene.eyes = head.eyeModels;
    if (!head.looks.empty()) {  // a young face: fine pores, hardly a fold; the zones are enough
        look.detail.blotchAmount = 0.02;
        look.detail.poreWavelength = 0.6;
        look.detail.poreSlope = 0.045;
        look.detail.foldSlope = 0.008;
    }
    sample::GBuffer g;
    view.gbufferMilliseconds =
        milliseconds([&] { g = sample::renderGBuffer(mesh, camera, width, height, look); });
    std::vector<float> wetness;
    if (!head.eyeModels.empty()) {
        wetness = demo::dressEyes(g, head.pose.up);
        demo::shadeScalp(g, head.scalp);
    }
    demo::StrandLight onHair;
    onHair.occluders = &mesh;
    for (const DemoLight& lamp : request.lights) {
        const sample::DirectionalLight direction{
            sample::headDirection(head.pose, lamp.azimuth, lamp.elevation)};
        io::SceneLight light;
        light.light.type = PEL_LIGHT_DIRECTIONAL;
        copy(light.light.toLight, direction.toLight);
        std::ranges::copy(lamp.color, light.light.color);
        addShadow(view, mesh, lamp, direction, light);
        if (lamp.radius > 0) {
            light.wideShadow = lamp.name + "Shadow.V";
            view.gbuffer.channels.push_back(io::Channel::halves(
                light.wideShadow,
                sample::softShadow(mesh, g, direction.toLight, lamp.radius, request.rays / 2).data));
        }
        view.scene.lights.push_back(light);
        onHair.lamps.push_back({direction.toLight, {lamp.color[0], lamp.color[1], lamp.color[2]}});
    }

    const sample::Sky sky = studio(head, request);
    addSurroundings(view, head, sky);
    onHair.sky = sky, onHair.sky.panels.clear();
    const sample::Image before = layHair(g, demo::drawStrands(head.strands, onHair, camera, g));
    view.scene.options.accumulate = 1;
    view.gbuffer.width = width, view.gbuffer.height = height;
    // What has few values, or the same over large parts, takes a twentieth of the space as half floats, and
    // of the time to read.
    const auto add = [&](PelImageSlot slot, const char* name, const char* components,
                         std::span<const float> planes, io::ChannelType type = io::ChannelType::Float) {
        io::addPlanes(view.scene, view.gbuffer, slot, name, components, planes, type);
    };
    add(PEL_SLOT_POSITION, "Position", "XYZ", g.position.data);
    add(PEL_SLOT_NORMAL_GEOMETRIC, "NormalGeometric", "XYZ", g.geometricNormal.data);
    add(PEL_SLOT_NORMAL_SHADING, "NormalShading", "XYZ", g.shadingNormal.data);
    add(PEL_SLOT_NORMAL_BLURRED, "NormalBlurred", "XYZ", g.blurredNormal.data);
    add(PEL_SLOT_CURVATURE, "Curvature", "V", g.curvature.data);
    add(PEL_SLOT_ALBEDO, "Albedo", "RGB", g.albedo.data);
    add(PEL_SLOT_ROUGHNESS, "Roughness", "V", g.roughness.data);
    add(PEL_SLOT_SPECULAR, "Specular", "V", g.specular.data);
    add(PEL_SLOT_AMBIENT_OCCLUSION, "AmbientOcclusion", "V",
        sample::ambientOcclusion(mesh, g, request.rays).data, io::ChannelType::Half);
    add(PEL_SLOT_MATERIAL, "Material", "I", std::vector<float>(g.material.begin(), g.material.end()));
    if (!wetness.empty()) add(PEL_SLOT_WETNESS, "Wetness", "V", wetness);
    add(PEL_SLOT_RADIANCE, "Before", "RGB", before.data, io::ChannelType::Half);

    copy(view.scene.camera.position, camera.eye);
    std::ranges::copy(camera.inverseViewProjection(aspect).toFloats(),
                      view.scene.camera.inverseViewProjection);
    return view;
}

io::SceneFile byTables(io::SceneFile scene) {
    for (io::SceneMaterial& m : scene.materials) m.material.scattering = PEL_SCATTERING_PREINTEGRATED;
    return scene;
}

DemoView madeOf(DemoView view, const std::string& profile, const float (&tint)[3]) {
    const bool skin = profile.starts_with("skin");
    view.scene.materials[0].profile = profile;
    view.scene.materials[0].material.shadowFilterWidth = 0;  // the profile's own
    const auto pixelsOf = [&](PelImageSlot slot, size_t component) -> std::vector<float>& {
        return std::ranges::find(view.gbuffer.channels, view.scene.channels[slot][component],
                                 &io::Channel::name)
            ->pixels;
    };
    std::vector<float>& ids = pixelsOf(PEL_SLOT_MATERIAL, 0);
    if (!skin) {
        view.scene.eyes.clear();
        view.scene.channels[PEL_SLOT_WETNESS].clear();
        for (float& id : ids)
            if (id == float(demo::DEMO_EYES) || id >= float(demo::DEMO_RIGHT_EYE)) id = demo::DEMO_SKIN;
        std::ranges::fill(pixelsOf(PEL_SLOT_SPECULAR, 0), 1.0f);
    }
    for (size_t c = 0; c < 3; ++c) {
        std::vector<float>& albedo = pixelsOf(PEL_SLOT_ALBEDO, c);
        std::vector<float>& before = pixelsOf(PEL_SLOT_RADIANCE, c);
        for (size_t i = 0; i < ids.size(); ++i) {
            if (ids[i] == float(demo::DEMO_SKIN))
                albedo[i] = std::min(1.0f, (skin ? albedo[i] : sample::Look().albedo[c]) * tint[c]);
            if (!skin) before[i] = ids[i] ? 0 : backdrop[c];
        }
    }
    return view;
}

io::SceneFile withoutScattering(io::SceneFile scene) {
    for (io::SceneMaterial& m : scene.materials) m.profile.clear();
    scene = byTables(std::move(scene));  // of which there are none
    // One normal for all channels, as a renderer without scattering has.
    scene.channels[PEL_SLOT_NORMAL_BLURRED].clear();
    scene.channels[PEL_SLOT_NORMAL_GEOMETRIC] = scene.channels[PEL_SLOT_NORMAL_SHADING];
    return scene;
}

}  // namespace pellucid::cli
