// Bodies under one hard light, with what light does on them: the scenes by which methods of scattering are
// measured.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <pellucid/pellucid.hpp>
#include <string>
#include <vector>

#include "io/image/image_compare.h"
#include "io/mesh/mesh_parts.h"
#include "sample/camera.h"
#include "sample/gbuffer.h"
#include "sample/lit_mesh.h"
#include "sample/shadow_map.h"
#include "sample/surface_light.h"

namespace lit_scenes {

using pellucid::Buffer;
using pellucid::Device;
using pellucid::Profile;
using pellucid::sample::Vec3;
namespace sample = pellucid::sample;
namespace io = pellucid::io;

struct Body {
    std::string name;
    sample::Mesh mesh;  // mm
    sample::HeadPose pose;
    sample::Bounds focus = {};  // what a picture shows; empty: all of it
};

inline Body ball(double radius, int rings) {
    return {"ball", sample::makeSphere(radius, rings, 2 * rings), {}};
}

// Walls and a floor for a square of (cells + 1)^2 vertices: without them light from below would come through a
// body that has no thickness.
inline void closeBelow(sample::Mesh& mesh, int cells, float floor) {
    const auto top = [&](int k) {  // counter-clockwise round the square, seen from above
        const int side = k / cells % 4, i = k % cells, n = cells + 1;
        return uint32_t(side == 0   ? i
                        : side == 1 ? i * n + cells
                        : side == 2 ? cells * n + cells - i
                                    : (cells - i) * n);
    };
    const Vec3 outward[] = {{0, -1, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
    const auto add = [&](uint32_t from, bool low, Vec3 normal) {
        for (int c = 0; c < 3; ++c)
            mesh.positions.push_back(low && c == 2 ? floor : mesh.positions[3 * size_t(from) + size_t(c)]);
        for (double n : {normal.x, normal.y, normal.z}) mesh.normals.push_back(float(n));
        return uint32_t(mesh.positions.size() / 3 - 1);
    };
    for (int k = 0; k < 4 * cells; ++k) {
        const uint32_t a = top(k), b = top(k + 1);
        const Vec3 n = outward[k / cells];
        const uint32_t corners[] = {add(a, true, n), add(b, true, n), add(b, false, n), add(a, false, n)};
        for (int i : {0, 1, 2, 0, 2, 3}) mesh.triangles.push_back(corners[i]);
    }
    const uint32_t a = add(top(0), true, {0, 0, -1}), b = add(top(cells), true, {0, 0, -1}),
                   c = add(top(2 * cells), true, {0, 0, -1}), d = add(top(3 * cells), true, {0, 0, -1});
    for (uint32_t v : {a, c, b, a, d, c}) mesh.triangles.push_back(v);
}

// A square of relief: a monkey saddle with a ridge and a pit in it, curved both ways at every scale down to 1
// mm.
inline Body relief(int cells) {
    Body body{"relief", {}, {{0, 1, 0}, {0, 0, 1}}};
    const double half = 15;
    const auto height = [](double x, double y) {
        const double u = x / 12, v = y / 12;
        return 3 * (u * u * u - 3 * u * v * v) + 2.5 * std::exp(-(x - 4) * (x - 4) / 2.5) -
               3 * std::exp(-((x + 5) * (x + 5) + (y - 3) * (y - 3)) / 5);
    };
    for (int j = 0; j <= cells; ++j)
        for (int i = 0; i <= cells; ++i) {
            const double x = half * (2.0 * i / cells - 1), y = half * (2.0 * j / cells - 1), e = 1e-4;
            const Vec3 n = normalize(Vec3{-(height(x + e, y) - height(x - e, y)) / (2 * e),
                                          -(height(x, y + e) - height(x, y - e)) / (2 * e), 1});
            for (double p : {x, y, height(x, y)}) body.mesh.positions.push_back(float(p));
            for (double p : {n.x, n.y, n.z}) body.mesh.normals.push_back(float(p));
        }
    for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
            const uint32_t a = uint32_t(j * (cells + 1) + i), b = a + uint32_t(cells) + 1;
            for (uint32_t v : {a, a + 1, b, b, a + 1, b + 1}) body.mesh.triangles.push_back(v);
        }
    closeBelow(body.mesh, cells, -12);
    return body;
}

// One of data/heads, subdivided: skin is material 1, all else only throws shadows (2).
inline Body head(const std::string& path, const std::string& name, int levels) {
    io::PartedMesh parted = io::loadParts(path, levels);
    Body body{name, {}, {{0, 1, 0}, {0, 0, 1}}};
    if (parted.mesh.normals.empty()) io::computeNormals(parted.mesh);
    body.mesh.positions = parted.mesh.positions;
    body.mesh.normals = parted.mesh.normals;
    body.mesh.triangles = parted.mesh.triangles;
    for (uint32_t part : parted.partOf)
        body.mesh.materials.push_back(part == uint32_t(parted.part("skin")) ? 1 : 2);
    return body;
}

// The part of a body round one of its vertices, `size` mm a side.
inline Body closeUp(Body body, const std::string& name, const std::function<double(Vec3)>& foremost, double size) {
    Vec3 best{};
    for (size_t v = 0; 3 * v < body.mesh.positions.size(); ++v) {
        const float* p = &body.mesh.positions[3 * v];
        const Vec3 at{p[0], p[1], p[2]};
        if (v == 0 || foremost(at) > foremost(best)) best = at;
    }
    const Vec3 half = Vec3{1, 1, 1} * (size / 2);
    body.focus = sample::Bounds();
    body.focus.add(best - half);
    body.focus.add(best + half);
    body.name += " " + name;
    return body;
}

// Lengths in units of positions, which are `unit` mm long.
struct LitScene {
    std::string name;
    double unit = 1;
    int width = 0, height = 0;
    Vec3 toLight;
    sample::GBuffer gbuffer;
    sample::ShadowMap map;
    std::vector<float> positions, normals;  // interleaved
    std::vector<float> irradiance;          // E with ray-traced visibility: RGB, all the same
    std::vector<float> truth;               // S
    std::vector<uint8_t> covered;           // 1: a pixel of material 1
    std::vector<uint8_t> subsets;
};

struct SceneRequest {
    double azimuth = 25, elevation = 5;             // of the camera, degrees
    double lightAzimuth = 80, lightElevation = 20;  // degrees
    double unit = 1;                                // mm per unit
    int size = 128, mapSize = 1024;
    double fill = 0.94;
    double profileScale = 1;
};

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

inline LitScene make(const Device& device, const Body& body, const SceneRequest& request, const Profile& profile) {
    LitScene s;
    s.name = body.name;
    s.unit = request.unit;
    s.width = s.height = request.size;
    sample::Mesh mesh = body.mesh;
    for (float& v : mesh.positions) v /= float(request.unit);
    mesh.curvature = curvatureOf(device, mesh);
    const sample::Scene scene(mesh.view());
    s.toLight = headDirection(body.pose, request.lightAzimuth, request.lightElevation);
    sample::Framing framing;
    framing.azimuth = request.azimuth;
    framing.elevation = request.elevation;
    framing.fill = request.fill;
    sample::GBufferOptions plain;
    plain.detail.enabled = false;
    plain.diffusionRadius = profile.info().radius * request.profileScale / request.unit;
    sample::Bounds shown = scene.bounds();
    if (!body.focus.empty()) {
        shown = sample::Bounds();
        for (const Vec3& corner : {body.focus.low, body.focus.high}) shown.add(corner * (1 / request.unit));
    }
    sample::Camera camera = frameHead(shown, body.pose, framing, 1);
    for (int i = 0; i < 8; ++i) {  // near and far plane enclose all of it
        const double depth = dot(scene.bounds().corner(i) - camera.eye, camera.forward());
        camera.nearPlane = std::max(std::min(camera.nearPlane, depth), 1e-3 * camera.farPlane);
        camera.farPlane = std::max(camera.farPlane, 1.01 * depth);
    }
    s.gbuffer = renderGBuffer(scene, camera, s.width, s.height, plain);
    s.map = renderShadowMap(scene, sample::DirectionalLight{s.toLight}, request.mapSize, 1 / request.unit);

    const size_t pixels = size_t(s.width) * s.height;
    std::vector<sample::SurfacePoint> places;
    std::vector<size_t> where;
    s.covered.resize(pixels);
    std::vector<float> toLight(3 * pixels), visible(pixels);
    s.positions.resize(3 * pixels), s.normals.resize(3 * pixels), s.irradiance.resize(3 * pixels),
        s.truth.resize(3 * pixels);
    for (size_t i = 0; i < pixels; ++i) {
        s.covered[i] = s.gbuffer.material[i] == 1;
        for (int c = 0; c < 3; ++c) {
            s.positions[3 * i + c] = s.gbuffer.position.plane(c)[i];
            s.normals[3 * i + c] = s.gbuffer.geometricNormal.plane(c)[i];
            toLight[3 * i + c] = float(c == 0 ? s.toLight.x : c == 1 ? s.toLight.y : s.toLight.z);
        }
        if (!s.covered[i]) continue;
        const float* p = &s.positions[3 * i];
        const sample::Hit hit = scene.nearest({p[0], p[1], p[2]});
        places.push_back({hit.triangle, {hit.weights[0], hit.weights[1], hit.weights[2]}});
        where.push_back(i);
    }
    sample::Lighting lighting;
    lighting.lights.push_back({});
    lighting.lights[0].toLight = s.toLight;
    const std::vector<float> E = irradianceAt(scene, lighting, places);
    const PelProfileInfo info = profile.info();
    const double scale = request.profileScale / request.unit,
                 narrowest = scale * *std::min_element(info.width, info.width + 3),
                 widest = scale * *std::max_element(info.width, info.width + 3);
    sample::LitMeshOptions options;
    // Half a pixel will do where a pixel is wider than the profile.
    options.finest = narrowest / 2;
    options.coarsest = std::max(widest, 2 * options.finest);
    options.material = mesh.materials.empty() ? 0 : 1;
    const sample::LitMesh lit = lightMesh(scene, lighting, options);
    std::vector<float> points;
    for (size_t i : where) points.insert(points.end(), &s.positions[3 * i], &s.positions[3 * i] + 3);
    PelSurfaceIntegralDesc desc = pelSurfaceIntegralDescDefaults();
    desc.profile = profile.get();
    desc.diffusionRadius = float(info.radius * request.profileScale);
    desc.millimetresPerUnit = float(request.unit);
    const std::vector<float> S = sample::scatteredAt(device, lit, points, desc);
    for (size_t k = 0; k < where.size(); ++k) {
        for (size_t c = 0; c < 3; ++c) {
            s.irradiance[3 * where[k] + c] = E[3 * k + c];
            s.truth[3 * where[k] + c] = S[3 * k + c];
        }
        visible[where[k]] = E[3 * k] > 0;
    }
    s.subsets = io::subsetsOf(
        {s.width, s.height, s.positions, s.normals, toLight, visible, s.covered, float(1 / request.unit)});
    return s;
}

// A way to shade a scene: RGB per pixel, for an albedo of 1. `seconds`, if not NULL, is what it takes beyond
// plain lighting.
using Method = std::function<std::vector<float>(const Device&, const LitScene&, const Profile&,
                                                double profileScale, double* seconds)>;

struct ShadeRequest {
    PelScattering scattering = PEL_SCATTERING_AUTO;
    uint32_t scatterTaps = 0;
    uint32_t tableSize = 0;  // 0: the tables that the profile brings
    float targetError = pelShaderOptionsDefaults().targetError;
    bool traced = false;     // irradiance with ray-traced shadows is given
    bool curvature = true;   // the mesh's is given
    bool faceworks = false;  // tables and filter as FaceWorks makes them, of the profile; with a tableSize
    int repeats = 7;         // of what is timed
};

// By the shader, all else at its default, shadows from the map.
inline std::vector<float> shade(const Device& device, const LitScene& s, const Profile& profile,
                                double profileScale, double* seconds, const ShadeRequest& request) {
    const uint32_t tableSize = request.tableSize;
    const auto radius = float(profile.info().radius * profileScale / s.unit);
    PelMaterial material = pelMaterialDefaults();
    std::fill(material.albedo, material.albedo + 3, 1.0f);
    material.profile = profile.get();
    material.scattering = request.scattering;
    material.scatterTaps = request.scatterTaps;
    if (profileScale != 1) material.diffusionRadius = radius;
    pellucid::Lut curvatureLut, shadowLut;
    if (tableSize) {
        PelCurvatureLutDesc curvatureDesc = pelCurvatureLutDescDefaults();
        PelShadowLutDesc shadowDesc = pelShadowLutDescDefaults();
        curvatureDesc.profile = shadowDesc.profile = profile.get();
        curvatureDesc.width = curvatureDesc.height = shadowDesc.width = shadowDesc.height = tableSize;
        curvatureDesc.form = request.faceworks ? PEL_FORM_ARC : PEL_FORM_SPHERE;
        shadowDesc.closedEnds = !request.faceworks;
        if (request.faceworks) material.shadowFilterWidth = float(8 / s.unit);
        curvatureDesc.diffusionRadius = shadowDesc.diffusionRadius = radius;
        for (float* v :
             {&curvatureDesc.radiusMin, &curvatureDesc.radiusMax, &shadowDesc.widthMin, &shadowDesc.widthMax})
            *v /= float(s.unit);
        curvatureLut = pellucid::Lut(device, curvatureDesc);
        shadowLut = pellucid::Lut(device, shadowDesc);
    }
    PelShaderOptions options = pelShaderOptionsDefaults();
    options.millimetresPerUnit = float(s.unit);
    options.targetError = request.targetError;
    PelLight light = pelLightDefaults();
    const double direction[3] = {s.toLight.x, s.toLight.y, s.toLight.z};
    for (int c = 0; c < 3; ++c) light.toLight[c] = float(direction[c]);
    std::ranges::copy(s.map.worldToUvz.toFloats(), light.worldToShadow);
    light.shadowDepthRange = float(s.map.depthRange);
    light.shadowFilterTexels = 64;
    pellucid::Shader shader(device);
    shader.set(options);
    const auto w = uint32_t(s.width), h = uint32_t(s.height);
    const Buffer positions(device, s.positions), normals(device, s.normals),
        curvature(device, s.gbuffer.curvature.data), ids(device, s.gbuffer.material), map(device, s.map.depth),
        irradiance(device, s.irradiance), radiance(device, s.positions.size() * sizeof(float));
    shader.set(PEL_SLOT_POSITION, imageDesc(positions, PEL_FORMAT_RGB32F, w, h));
    shader.set(PEL_SLOT_NORMAL_SHADING, imageDesc(normals, PEL_FORMAT_RGB32F, w, h));
    shader.set(PEL_SLOT_NORMAL_GEOMETRIC, imageDesc(normals, PEL_FORMAT_RGB32F, w, h));
    if (request.curvature) shader.set(PEL_SLOT_CURVATURE, imageDesc(curvature, PEL_FORMAT_R32F, w, h));
    if (request.traced) shader.set(PEL_SLOT_IRRADIANCE, imageDesc(irradiance, PEL_FORMAT_RGB32F, w, h));
    shader.set(PEL_SLOT_MATERIAL, imageDesc(ids, PEL_FORMAT_R32_UINT, w, h));
    shader.set(PEL_SLOT_RADIANCE, imageDesc(radiance, PEL_FORMAT_RGB32F, w, h));
    shader.setMaterial(1, material, curvatureLut, shadowLut);
    shader.set(std::vector<PelLight>{light});
    shader.set(0, PEL_LIGHT_SHADOW_MAP,
               imageDesc(map, PEL_FORMAT_R32F, uint32_t(s.map.size), uint32_t(s.map.size)));
    shader.commit();
    shader.execute();
    if (seconds) {
        std::vector<double> times;
        for (int i = 0; i < request.repeats; ++i) {
            shader.execute();
            times.push_back(shader.stats().deviceMilliseconds * 1e-3);
        }
        const auto middle = times.begin() + request.repeats / 2;
        std::nth_element(times.begin(), middle, times.end());
        *seconds = *middle;
    }
    return radiance.readAll<float>();
}

// The pre-integrated method, its wide shadow filtered from the map.
inline std::vector<float> shadePreintegrated(const Device& device, const LitScene& s, const Profile& profile,
                                             double profileScale, double* seconds, uint32_t tableSize = 0) {
    ShadeRequest request;
    request.scattering = PEL_SCATTERING_PREINTEGRATED;
    request.tableSize = tableSize;
    return shade(device, s, profile, profileScale, seconds, request);
}

// Irradiance as it is: no scattering, and shadows traced by ray.
inline std::vector<float> shadeLambert(const Device&, const LitScene& s, const Profile&, double, double* seconds) {
    if (seconds) *seconds = 0;
    return s.irradiance;
}

}  // namespace lit_scenes
