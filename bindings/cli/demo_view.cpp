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
    const sample::ShadowMap map = sample::renderShadowMap(mesh, direction, shadowMapSize);
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
    }
    return materials;
}

// Radiance behind the head: the same everywhere, so that files stay small and are read quickly.
constexpr float backdrop[] = {0.018f, 0.02f, 0.023f};

// Blends hair into the G-buffer: skin under it has a lower albedo and specular, but still scatters. Returns
// the initial content of the scene's radiance, to which shading adds: the light of hair, and the backdrop.
sample::Image layHair(sample::Image& albedo, sample::Image& specular, std::vector<float>& ids,
                      sample::Image hair) {
    for (size_t i = 0; i < ids.size(); ++i) {
        const float left = 1 - hair.plane(3)[i];
        // An eye's gloss depends on neither albedo nor specular.
        const bool eye = ids[i] == float(demo::DEMO_EYES) || ids[i] == float(demo::DEMO_RIGHT_EYE);
        if (left < 0.5f && eye) ids[i] = demo::DEMO_LASHES;
        for (int c = 0; c < 3; ++c) {
            albedo.plane(c)[i] *= left;
            if (ids[i] == 0) hair.plane(c)[i] += left * backdrop[c];
        }
        specular.plane(0)[i] *= left;
    }
    hair.data.resize(3 * hair.planeSize());
    return hair;
}

sample::DirectionalLight directionOf(const DemoHead& head, const DemoLight& lamp) {
    return {sample::headDirection(head.pose, lamp.azimuth, lamp.elevation)};
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

DemoSurface renderDemoSurface(const DemoBody& body, const DemoViewRequest& request,
                              const DemoSurface* coarse) {
    const DemoHead& head = body.head;
    const int width = int(request.width), height = int(request.height);
    DemoSurface out;
    out.camera = framed(body.mesh, head, request.framing, double(width) / height);
    sample::GBufferOptions look;
    look.looks = head.looks, look.zones = head.zones, look.eyes = head.eyes;
    look.detail.roughness = skinRoughness;
    look.detail.enabled = !head.bust;
    if (!head.looks.empty()) {  // a young face: fine pores, hardly a fold; the zones are enough
        look.detail.blotchAmount = 0.02;
        look.detail.poreWavelength = 0.6;
        look.detail.poreSlope = 0.045;
        look.detail.foldSlope = 0.008;
    }
    out.gbuffer = sample::renderGBuffer(body.mesh, out.camera, width, height, look);
    out.occlusion = coarse ? sample::enlarged(coarse->occlusion, coarse->gbuffer, out.gbuffer)
                           : sample::ambientOcclusion(body.mesh, out.gbuffer, request.rays, &body.hair);
    if (head.bust)
        for (uint32_t& id : out.gbuffer.material) id = std::min<uint32_t>(id, demo::DEMO_SKIN);
    if (!head.eyeModels.empty()) {
        out.wetness = demo::dressEyes(out.gbuffer, head.pose.up);
        demo::darkenFolds(out.gbuffer, out.occlusion, out.wetness);
    }
    return out;
}

DemoLightImages renderDemoLight(const DemoBody& body, const DemoSurface& surface,
                                const DemoViewRequest& request) {
    DemoLightImages out;
    sample::Bounces bounces;
    bounces.sky = studio(body.head, request), bounces.sky.panels.clear();
    std::ranges::copy(sample::Look().albedo, bounces.albedo.begin());
    bounces.rays = request.rays;
    bounces.hair = &body.hair;
    for (const DemoLight& lamp : request.lights) {
        sample::SurfaceLight& bounced = bounces.lamps.emplace_back();
        bounced.toLight = directionOf(body.head, lamp).toLight;
        std::ranges::copy(lamp.color, bounced.color.begin());
        out.shadows.push_back(sample::softShadow(body.mesh, surface.gbuffer, bounced.toLight, lamp.radius,
                                                 request.rays / 2, &body.hair));
    }
    out.indirect = sample::bouncedLight(body.mesh, surface.gbuffer, bounces);
    return out;
}

void addPixels(DemoView& view, const DemoBody& body, const DemoSurface& surface, const DemoLightImages& light,
               const DemoViewRequest& request) {
    const sample::GBuffer& g = surface.gbuffer;
    demo::StrandLight onHair;
    onHair.occluders = &body.mesh;
    onHair.sky = studio(body.head, request), onHair.sky.panels.clear();
    for (size_t i = 0; i < request.lights.size(); ++i) {
        const DemoLight& lamp = request.lights[i];
        onHair.lamps.push_back(
            {directionOf(body.head, lamp).toLight, {lamp.color[0], lamp.color[1], lamp.color[2]}});
        view.gbuffer.channels.push_back(
            io::Channel::halves(view.scene.lights[i].wideShadow, light.shadows[i].data));
    }
    sample::Image albedo = g.albedo, specular = g.specular;
    std::vector<float> ids(g.material.begin(), g.material.end());
    const sample::Image before =
        layHair(albedo, specular, ids, demo::drawStrands(body.head.strands, onHair, surface.camera, g));
    view.gbuffer.width = g.width, view.gbuffer.height = g.height;
    // Channels with few values, or constant over large areas, take a twentieth of the space as half floats,
    // and of the time to read.
    const auto add = [&](PelImageSlot slot, const char* name, const char* components,
                         std::span<const float> planes, io::ChannelType type = io::ChannelType::Float) {
        io::addPlanes(view.scene, view.gbuffer, slot, name, components, planes, type);
    };
    add(PEL_SLOT_POSITION, "Position", "XYZ", g.position.data);
    add(PEL_SLOT_NORMAL_GEOMETRIC, "NormalGeometric", "XYZ", g.geometricNormal.data);
    add(PEL_SLOT_NORMAL_SHADING, "NormalShading", "XYZ", g.shadingNormal.data);
    add(PEL_SLOT_NORMAL_BLURRED, "NormalBlurred", "XYZ", g.blurredNormal.data);
    add(PEL_SLOT_CURVATURE, "Curvature", "V", g.curvature.data);
    add(PEL_SLOT_ALBEDO, "Albedo", "RGB", albedo.data);
    add(PEL_SLOT_ROUGHNESS, "Roughness", "V", g.roughness.data);
    add(PEL_SLOT_SPECULAR, "Specular", "V", specular.data);
    add(PEL_SLOT_AMBIENT_OCCLUSION, "AmbientOcclusion", "V", surface.occlusion.data, io::ChannelType::Half);
    add(PEL_SLOT_INDIRECT, "Indirect", "RGB", light.indirect.data, io::ChannelType::Half);
    add(PEL_SLOT_MATERIAL, "Material", "I", ids);
    if (!surface.wetness.empty()) add(PEL_SLOT_WETNESS, "Wetness", "V", surface.wetness);
    add(PEL_SLOT_RADIANCE, "Before", "RGB", before.data, io::ChannelType::Half);
}

DemoView renderDemoView(const DemoBody& body, const DemoSurface& surface, const DemoLightImages& light,
                        const DemoViewRequest& request) {
    DemoView view;
    view.name = request.name;
    view.scene.luts = standardLuts().luts;
    view.scene.materials = materialsOf(body.head);
    view.scene.eyes = body.head.eyeModels;
    view.scene.options.accumulate = 1;
    for (const DemoLight& lamp : request.lights) {
        const sample::DirectionalLight direction = directionOf(body.head, lamp);
        io::SceneLight& added = view.scene.lights.emplace_back();
        copy(added.light.toLight, direction.toLight);
        std::ranges::copy(lamp.color, added.light.color);
        addShadow(view, body.mesh, lamp, direction, added);
        added.wideShadow = lamp.name + "Shadow.V";
        added.light.plainShadow = 1;
    }
    addSurroundings(view, body.head, studio(body.head, request));
    copy(view.scene.camera.position, surface.camera.eye);
    std::ranges::copy(surface.camera.inverseViewProjection(double(request.width) / request.height).toFloats(),
                      view.scene.camera.inverseViewProjection);
    addPixels(view, body, surface, light, request);
    return view;
}

io::SceneFile byTables(io::SceneFile scene) {
    for (io::SceneMaterial& m : scene.materials) m.material.scattering = PEL_SCATTERING_PREINTEGRATED;
    return scene;
}

DemoView madeOf(DemoView view, const std::string& profile, const float (&tint)[3]) {
    view.scene.materials[0].profile = profile;
    const auto pixelsOf = [&](PelImageSlot slot, size_t component) -> std::vector<float>& {
        return std::ranges::find(view.gbuffer.channels, view.scene.channels[slot][component],
                                 &io::Channel::name)
            ->pixels;
    };
    const std::vector<float>& ids = pixelsOf(PEL_SLOT_MATERIAL, 0);
    for (size_t c = 0; c < 3; ++c) {
        for (float& v : pixelsOf(PEL_SLOT_INDIRECT, c)) v *= tint[c];  // most of it was reflected once
        std::vector<float>& albedo = pixelsOf(PEL_SLOT_ALBEDO, c);
        for (size_t i = 0; i < ids.size(); ++i)
            if (ids[i] == float(demo::DEMO_SKIN)) albedo[i] = std::min(1.0f, albedo[i] * tint[c]);
    }
    return view;
}

std::array<io::SceneFile, 3> scenesOf(const DemoView& view) {
    io::SceneFile plain = byTables(view.scene);
    for (io::SceneMaterial& m : plain.materials) m.profile.clear();  // so that there are no tables
    // One normal for all channels, as a renderer without scattering has.
    plain.channels[PEL_SLOT_NORMAL_BLURRED].clear();
    plain.channels[PEL_SLOT_NORMAL_GEOMETRIC] = plain.channels[PEL_SLOT_NORMAL_SHADING];
    return {plain, byTables(view.scene), view.scene};
}

}  // namespace pellucid::cli
