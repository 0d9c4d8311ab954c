// Bodies under one hard light, with their ground truth: the scenes by which methods of scattering are
// measured.
#pragma once
#include "diffusion/lit_bodies.h"
#include "diffusion/scatter_scene.h"
#include "io/image/image_compare.h"
#include "sample/gbuffer.h"
#include "sample/lit_mesh.h"
#include "sample/shadow_map.h"

namespace lit_scenes {

using pellucid::Buffer;
using pellucid::Device;
using pellucid::Profile;

// Lengths in units of positions, which are `unit` mm long.
struct LitScene {
    double unit = 1;
    int width = 0, height = 0;
    sample::Vec3 toLight;  // of the first light
    sample::Vec3 eye;
    sample::Matrix4 viewProjection;
    sample::Lighting lighting;
    double ambient = 0;
    std::vector<scatter_scene::Lamp> lamps;
    sample::GBuffer gbuffer;
    std::vector<float> positions, normals;     // interleaved
    std::vector<float> irradiance;             // E with ray-traced visibility: RGB, all the same
    std::vector<float> truth;                  // S
    std::vector<uint8_t> covered;              // 1: a pixel of material 1
    std::vector<sample::SurfacePoint> places;  // of the covered pixels
    std::vector<uint8_t> subsets;
};

struct SceneRequest {
    double azimuth = 25, elevation = 5;             // of the camera, degrees
    double lightAzimuth = 80, lightElevation = 20;  // degrees
    double unit = 1;                                // mm per unit
    int size = 128, mapSize = 1024;
    int width = 0;  // of the picture; 0: a square of `size`
    double fill = 0.94;
    double profileScale = 1;
    // Beside the directional light; in units of positions.
    std::vector<sample::SurfaceLight> more = {};
    double ambient = 0;
};

// What a light and its map are to the library.
inline scatter_scene::Lamp lampOf(const sample::SurfaceLight& light, const sample::ShadowMap& map) {
    scatter_scene::Lamp lamp;
    const bool directional = light.type == sample::SurfaceLight::Type::Directional;
    const sample::Vec3 place = directional ? light.toLight : light.position;
    const double at[] = {place.x, place.y, place.z};
    lamp.light.type = directional ? PEL_LIGHT_DIRECTIONAL : PEL_LIGHT_POINT;
    std::copy_n(at, 3, directional ? lamp.light.toLight : lamp.light.position);
    std::ranges::copy(light.color, lamp.light.color);
    std::ranges::copy(map.worldToUvz.toFloats(), lamp.light.worldToShadow);
    lamp.light.shadowProjection = directional ? PEL_SHADOW_PARALLEL : PEL_SHADOW_PERSPECTIVE;
    lamp.light.shadowDepthRange = float(map.depthRange);
    lamp.light.shadowDepthA = float(map.depthA), lamp.light.shadowDepthB = float(map.depthB);
    lamp.maps = {map.depth};
    lamp.width = lamp.height = uint32_t(map.size);
    return lamp;
}

// Curvature of the mesh with default settings, in 1/unit.
inline std::vector<float> curvatureOf(const Device& device, const sample::Mesh& mesh) {
    PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
    const auto count = uint32_t(mesh.positions.size() / 3);
    desc.numVertices = count;
    desc.indices = mesh.triangles.data();
    desc.numIndices = mesh.triangles.size();
    const pellucid::MeshTopology topology(device, desc);
    const Buffer p(device, mesh.positions), n(device, mesh.normals), c(device, count * sizeof(float));
    topology.curvature(pelCurvatureParamsDefaults(), vertexView(p, count), vertexView(n, count),
                       vertexView(c, count));
    return c.readAll<float>();
}

// A body ready to be looked at and lit from anywhere.
class Stage {
  public:
    Stage(const Device& device, const Body& body, double unit) : body_(body), unit_(unit) {
        sample::Mesh mesh = body.mesh;
        for (float& v : mesh.positions) v /= float(unit);
        mesh.curvature = curvatureOf(device, mesh);
        body_.mesh = {};
        hasMaterials_ = !mesh.materials.empty();
        scene_ = std::make_unique<sample::Scene>(mesh.view());
        shown_ = scene_->bounds();
        if (!body.focus.empty()) {
            shown_ = sample::Bounds();
            for (const sample::Vec3& corner : {body.focus.low, body.focus.high})
                shown_.add(corner * (1 / unit));
        }
    }

    // The picture, its map and its irradiance, without the ground truth.
    LitScene look(const SceneRequest& request, const Profile& profile) const {
        LitScene s;
        s.unit = unit_;
        s.height = request.size;
        s.width = request.width > 0 ? request.width : request.size;
        s.toLight = headDirection(body_.pose, request.lightAzimuth, request.lightElevation);
        sample::GBufferOptions plain;
        plain.detail.enabled = false;
        plain.diffusionRadius = profile.info().radius * request.profileScale / unit_;
        const sample::Camera camera = cameraOf(request);
        s.eye = camera.eye;
        s.viewProjection = camera.viewProjection(double(s.width) / s.height);
        s.gbuffer = renderGBuffer(*scene_, camera, s.width, s.height, plain);
        s.lighting.lights = request.more;
        s.lighting.lights.insert(s.lighting.lights.begin(), {.toLight = s.toLight});
        s.ambient = request.ambient;
        if (s.ambient > 0) s.lighting.ambient = [a = s.ambient](sample::Vec3) { return std::array{a, a, a}; };
        s.lamps = lampsOf(s.lighting, request.mapSize);
        const size_t pixels = size_t(s.width) * s.height;
        std::vector<size_t> where;
        s.covered.resize(pixels);
        std::vector<float> toLight(3 * pixels), visible(pixels);
        const float direction[] = {float(s.toLight.x), float(s.toLight.y), float(s.toLight.z)};
        s.positions.resize(3 * pixels), s.normals.resize(3 * pixels), s.irradiance.resize(3 * pixels);
        for (size_t i = 0; i < pixels; ++i) {
            s.covered[i] = s.gbuffer.material[i] == 1;
            for (int c = 0; c < 3; ++c) {
                s.positions[3 * i + c] = s.gbuffer.position.plane(c)[i];
                s.normals[3 * i + c] = s.gbuffer.geometricNormal.plane(c)[i];
                toLight[3 * i + c] = direction[c];
            }
            if (!s.covered[i]) continue;
            const float* p = &s.positions[3 * i];
            const sample::Hit hit = scene_->nearest({p[0], p[1], p[2]});
            s.places.push_back({hit.triangle, hit.weights});
            where.push_back(i);
        }
        const std::vector<float> E = irradianceAt(*scene_, s.lighting, s.places);
        for (size_t k = 0; k < where.size(); ++k) {
            std::copy_n(&E[3 * k], 3, &s.irradiance[3 * where[k]]);
            visible[where[k]] = E[3 * k] > 0;
        }
        s.subsets = io::subsetsOf(
            {s.width, s.height, s.positions, s.normals, toLight, visible, s.covered, float(1 / unit_)});
        return s;
    }

    // Adds the ground truth: the surface integral.
    void addTruth(const Device& device, LitScene& s, const Profile& profile, double profileScale) const {
        const PelProfileInfo info = profile.info();
        const double scale = profileScale / unit_,
                     narrowest = scale * *std::min_element(info.width, info.width + 3),
                     widest = scale * *std::max_element(info.width, info.width + 3);
        sample::LitMeshOptions options;
        // Half a pixel suffices if a pixel is wider than the profile.
        options.finest = narrowest / 2;
        options.coarsest = std::max(widest, 2 * options.finest);
        options.material = material();
        const sample::LitMesh lit = lightMesh(*scene_, s.lighting, options);
        std::vector<float> points;
        for (size_t i = 0; i < s.covered.size(); ++i)
            if (s.covered[i]) points.insert(points.end(), &s.positions[3 * i], &s.positions[3 * i] + 3);
        PelSurfaceIntegralDesc desc = pelSurfaceIntegralDescDefaults();
        desc.profile = profile.get();
        desc.diffusionRadius = float(info.radius * profileScale);
        desc.millimetresPerUnit = float(unit_);
        const std::vector<float> S = sample::scatteredAt(device, lit, points, desc);
        s.truth.assign(3 * s.covered.size(), 0);
        for (size_t i = 0, k = 0; i < s.covered.size(); ++i)
            if (s.covered[i]) std::copy_n(&S[3 * k++], 3, &s.truth[3 * i]);
    }

    // The lights of a scene with maps of `mapSize` texels a side.
    std::vector<scatter_scene::Lamp> lampsOf(const sample::Lighting& lighting, int mapSize) const {
        std::vector<scatter_scene::Lamp> lamps;
        for (const sample::SurfaceLight& light : lighting.lights)
            lamps.push_back(lampOf(light, mapOf(light, mapSize)));
        return lamps;
    }

    const sample::Scene& scene() const { return *scene_; }
    uint32_t material() const { return hasMaterials_ ? 1 : 0; }

  private:
    sample::Camera cameraOf(const SceneRequest& request) const {
        sample::Framing framing;
        framing.azimuth = request.azimuth;
        framing.elevation = request.elevation;
        framing.fill = request.fill;
        const double aspect = request.width > 0 ? double(request.width) / request.size : 1;
        sample::Camera camera = frameHead(shown_, body_.pose, framing, aspect);
        for (int i = 0; i < 8; ++i) {  // near and far plane enclose all of it
            const double depth = dot(scene_->bounds().corner(i) - camera.eye, camera.forward());
            camera.nearPlane = std::max(std::min(camera.nearPlane, depth), 1e-3 * camera.farPlane);
            camera.farPlane = std::max(camera.farPlane, 1.01 * depth);
        }
        return camera;
    }
    sample::ShadowMap mapOf(const sample::SurfaceLight& light, int size) const {
        if (light.type == sample::SurfaceLight::Type::Directional)
            return renderShadowMap(*scene_, sample::DirectionalLight{light.toLight}, size, 1 / unit_);
        const sample::Vec3 way = shown_.centre() - light.position;
        return renderShadowMap(*scene_, sample::SpotLight{light.position, normalize(way), 60}, size);
    }

    Body body_;  // without its mesh
    double unit_;
    bool hasMaterials_ = false;
    std::unique_ptr<sample::Scene> scene_;
    sample::Bounds shown_;
};

inline LitScene make(const Device& device, const Body& body, const SceneRequest& request,
                     const Profile& profile) {
    const Stage stage(device, body, request.unit);
    LitScene s = stage.look(request, profile);
    stage.addTruth(device, s, profile, request.profileScale);
    return s;
}

// The same scene with positions in another unit, which is `unit` mm long. The ground truth does not change.
inline LitScene inUnit(LitScene s, double unit) {
    const double by = unit / s.unit;
    s.unit = unit;
    for (float& v : s.positions) v = float(v / by);
    for (float& v : s.gbuffer.curvature.data) v = float(v * by);
    s.eye = s.eye * (1 / by);
    for (PelLight* light = nullptr; scatter_scene::Lamp & lamp : s.lamps) {
        light = &lamp.light;
        for (int k = 0; k < 12; ++k)
            if (k % 4 < 3) light->worldToShadow[k] *= float(by);
        light->shadowDepthRange /= float(by);
    }
    return s;
}

struct ShadeRequest {
    PelScattering scattering = PEL_SCATTERING_AUTO;
    uint32_t scatterTaps = 0;
    uint32_t tableSize = 0;  // 0: the tables that the profile brings
    float targetError = pelShaderOptionsDefaults().targetError;
    bool traced = false;     // irradiance with ray-traced shadows is given
    float gain = 0;          // PelMaterial.curvatureGain; 0: as the surface integral, which has no volume
    bool curvature = true;   // the mesh's is given
    bool faceworks = false;  // tables and filter as FaceWorks makes them, of the profile; with a tableSize
    uint32_t materials = 1;  // ids that have the material, from 1
    bool count = true;       // PelShaderOptions.countPixels
    bool everyPixel = false, halfRate = false;
    float timeBudget = 0;
    float historyWeight = 0;
    uint32_t frameIndex = 0;
    std::vector<float> motion = {};     // PEL_SLOT_MOTION, two floats a pixel
    std::vector<float> texture = {};    // a scattered one, square; the body has texture coordinates
    std::vector<float> thickness = {};  // PEL_SLOT_THICKNESS
};

inline scatter_scene::Picture pictureOf(const LitScene& s) {
    scatter_scene::Picture p(uint32_t(s.width), uint32_t(s.height));
    p.positions = s.positions, p.irradiance = s.irradiance;
    p.ids.assign(s.gbuffer.material.begin(), s.gbuffer.material.end());
    return p;
}

// Where pixels of a frame were in the one before, if only the camera has moved.
inline std::vector<float> motionBetween(const LitScene& before, const LitScene& now) {
    std::vector<float> motion;
    for (int y = 0; y < now.height; ++y)
        for (int x = 0; x < now.width; ++x) {
            const float* p = &now.positions[3 * (size_t(y) * size_t(now.width) + size_t(x))];
            const sample::Vec3 clip = before.viewProjection.project({p[0], p[1], p[2]});
            motion.push_back(float((clip.x + 1) / 2 * now.width - 0.5 - x));
            motion.push_back(float((1 - clip.y) / 2 * now.height - 0.5 - y));
        }
    return motion;
}

// How thick the body is below each covered pixel, along the normal.
inline std::vector<float> thicknessOf(const Stage& stage, const LitScene& s) {
    std::vector<float> thickness(s.covered.size(), INFINITY);
    for (size_t i = 0; i < thickness.size(); ++i) {
        if (!s.covered[i]) continue;
        const float *p = &s.positions[3 * i], *n = &s.normals[3 * i];
        const sample::Vec3 inwards{-n[0], -n[1], -n[2]},
            from = sample::Vec3{p[0], p[1], p[2]} + inwards * 1e-2;
        thickness[i] = float(stage.scene().intersect({from, inwards}).distance);
    }
    return thickness;
}

// The result of a shader for a scene; `shader` makes the same frame again.
struct Shot {
    std::vector<float> light;
    PelShaderStats stats;
    pellucid::Shader shader;
    pellucid::Buffer out;
};

// By the shader for an albedo of 1, all else at its default, shadows from the map.
inline Shot shoot(const Device& device, const LitScene& s, const Profile& profile, double profileScale,
                  const ShadeRequest& request, scatter_scene::ShownImages shown) {
    const uint32_t tableSize = request.tableSize;
    const auto radius = float(profile.info().radius * profileScale / s.unit);
    scatter_scene::Frame f(pictureOf(s), request.scattering);
    f.profile = profile;
    f.materials = request.materials;
    f.giveIrradiance = request.traced;
    f.images[PEL_SLOT_NORMAL_SHADING] = f.images[PEL_SLOT_NORMAL_GEOMETRIC] = s.normals;
    if (request.curvature) f.images[PEL_SLOT_CURVATURE] = s.gbuffer.curvature.data;
    f.options.millimetresPerUnit = float(s.unit);
    f.options.targetError = request.targetError;
    f.options.halfRate = request.halfRate;
    f.options.timeBudget = request.timeBudget;
    f.options.historyWeight = request.historyWeight, f.options.frameIndex = request.frameIndex;
    if (!request.thickness.empty()) f.images[PEL_SLOT_THICKNESS] = request.thickness;
    if (!request.motion.empty()) f.images[PEL_SLOT_MOTION] = request.motion;
    f.texture = request.texture;
    for (size_t i = 0; !f.texture.empty() && i < s.covered.size(); ++i)
        for (int c = 0; c < 2; ++c) f.images[PEL_SLOT_UV].push_back(s.gbuffer.uv.plane(c)[i]);
    f.options.countPixels = request.count, f.options.everyPixel = request.everyPixel;
    f.lamps = s.lamps;
    for (scatter_scene::Lamp& lamp : f.lamps) lamp.light.shadowFilterTexels = 64;
    f.material.curvatureGain = request.gain;
    f.material.scatterTaps = request.scatterTaps;
    if (profileScale != 1) f.material.diffusionRadius = radius;
    if (tableSize) {
        PelCurvatureLutDesc curvatureDesc = pelCurvatureLutDescFaceWorks();
        PelShadowLutDesc shadowDesc = pelShadowLutDescFaceWorks();
        curvatureDesc.profile = shadowDesc.profile = profile.get();
        curvatureDesc.width = curvatureDesc.height = shadowDesc.width = shadowDesc.height = tableSize;
        curvatureDesc.form = request.faceworks ? PEL_FORM_ARC : PEL_FORM_SPHERE;
        shadowDesc.closedEnds = !request.faceworks;
        if (request.faceworks) f.material.shadowFilterWidth = float(8 / s.unit);
        curvatureDesc.diffusionRadius = shadowDesc.diffusionRadius = radius;
        for (float* v :
             {&curvatureDesc.radiusMin, &curvatureDesc.radiusMax, &shadowDesc.widthMin, &shadowDesc.widthMax})
            *v /= float(s.unit);
        f.curvatureLut = pellucid::Lut(device, curvatureDesc);
        f.shadowLut = pellucid::Lut(device, shadowDesc);
    }
    shown.shader.set(scatter_scene::standingAt({s.eye.x, s.eye.y, s.eye.z}));
    PelAmbient ambient = pelAmbientDefaults();
    std::fill_n(ambient.constant, 3, float(s.ambient));
    shown.shader.set(ambient);
    scatter_scene::Shown made = f.shade(shown);
    return {std::move(made.light), made.stats, shown.shader, shown.out};
}
inline Shot shoot(const Device& device, const LitScene& s, const Profile& profile, double profileScale,
                  const ShadeRequest& request) {
    return shoot(device, s, profile, profileScale, request, {device, uint32_t(s.width), uint32_t(s.height)});
}

inline std::vector<float> shade(const Device& device, const LitScene& s, const Profile& profile,
                                double profileScale, const ShadeRequest& request) {
    return shoot(device, s, profile, profileScale, request).light;
}

}  // namespace lit_scenes
