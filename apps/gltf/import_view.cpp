#include "gltf/import_view.h"

#include <Imath/ImathFun.h>

#include <numbers>

#include "io/image/color_map.h"
#include "sample/gbuffer.h"
#include "sample/shadow_map.h"

namespace pellucid::cli {
namespace {

constexpr int importedShadowMapSize = 1024;

template <class Triple>
sample::Vec3 vec(const Triple& t) {
    return {t[0], t[1], t[2]};
}

// Texels in linear light.
struct Texture {
    int width = 0, height = 0;
    std::vector<Imath::V3f> texels;

    // Bilinear, repeated; row 0 is at v = 0 [glTF 2.0, 3.8.3].
    io::Triple at(double u, double v) const {
        const double x = (u - std::floor(u)) * width - 0.5, y = (v - std::floor(v)) * height - 0.5;
        const int left = int(std::floor(x)), top = int(std::floor(y));
        const auto mixed = [&](int row) {
            const Imath::V3f* from = &texels[size_t(Imath::modp(row, height)) * size_t(width)];
            return Imath::lerp(io::Triple(from[Imath::modp(left, width)]),
                               io::Triple(from[Imath::modp(left + 1, width)]), x - left);
        };
        return Imath::lerp(mixed(top), mixed(top + 1), y - top);
    }
};

Texture textureOf(const io::GltfImage& image) {
    io::Image picture = io::decodeImage(image.name, image.bytes);
    Texture t{picture.width, picture.height, std::vector<Imath::V3f>(picture.pixelCount())};
    const bool grey = picture.channels.size() < 3;
    for (size_t i = 0; i < picture.pixelCount(); ++i)
        for (int c = 0; c < 3; ++c)
            t.texels[i][c] = io::decodeSrgb(picture.channels[grey ? 0 : size_t(c)].pixels[i]);
    return t;
}

sample::Camera cameraOf(const io::GltfCamera* given, const sample::Scene& scene, double aspect) {
    if (!given) return sample::frameHead(scene.bounds(), sample::poseWithUp('y'), {20, 8}, aspect);
    const io::GltfCamera& c = *given;
    sample::Camera camera;
    camera.eye = vec(c.position);
    // At the scale of the position, so that the difference keeps the direction.
    camera.target = camera.eye + vec(c.forward) * std::max(length(camera.eye), 1.0);
    camera.up = vec(c.up);
    camera.verticalFov = c.verticalFov * 180 / std::numbers::pi;
    double near = INFINITY, far = 0;
    for (int i = 0; i < 8; ++i) {
        const double depth = dot(scene.bounds().corner(i) - camera.eye, camera.forward());
        near = std::min(near, depth), far = std::max(far, depth);
    }
    camera.farPlane = std::max(far * 1.01, 1e-3);
    camera.nearPlane = std::clamp(near * 0.99, 1e-4 * camera.farPlane, 0.5 * camera.farPlane);
    return camera;
}

// Multiplies the albedo of pixels whose material has a texture, one texture after another to save memory.
void applyTextures(Run& run, const io::GltfScene& v, sample::GBuffer& g) {
    const size_t pixels = g.material.size();
    for (size_t i = 0; i < v.images.size() && !g.uv.data.empty(); ++i) {
        if (v.images[i].bytes.empty()) {
            run.warn(v.images[i].name + " is neither PNG nor JPEG, and left out");
            continue;
        }
        Texture texture;
        try {
            texture = textureOf(v.images[i]);
        } catch (const io::FileError& e) {
            run.warn(std::string(e.what()) + "; the texture is left out");
            continue;
        }
        for (size_t p = 0; p < pixels; ++p) {
            if (!g.material[p] || v.materials[g.material[p] - 1].baseColorImage != int(i)) continue;
            const io::Triple color = texture.at(g.uv.data[p], g.uv.data[pixels + p]);
            for (size_t c = 0; c < 3; ++c) g.albedo.data[c * pixels + p] *= float(color[int(c)]);
        }
    }
}

void addShadowMap(const std::string& folder, const sample::Scene& scene, size_t number,
                  io::SceneLight& light) {
    PelLight& p = light.light;
    const sample::Bounds bounds = scene.bounds();
    const double diagonal = bounds.empty() ? 0 : length(bounds.high - bounds.low);  // mm
    sample::ShadowMap map;
    if (p.type == PEL_LIGHT_DIRECTIONAL) {
        map = sample::renderShadowMap(scene, sample::DirectionalLight{vec(p.toLight)}, importedShadowMapSize,
                                      std::min(0.01 * diagonal, 1.0));
        p.shadowProjection = PEL_SHADOW_PARALLEL;
        p.shadowDepthRange = float(map.depthRange);
    } else if (p.type == PEL_LIGHT_SPOT) {
        const double angle = std::acos(double(p.spotCosOuter)) * 180 / std::numbers::pi;
        const sample::SpotLight spot{vec(p.position), vec(p.spotDirection), std::min(angle, 80.0)};
        map = sample::renderShadowMap(scene, spot, importedShadowMapSize);
        p.shadowProjection = PEL_SHADOW_PERSPECTIVE;
        p.shadowDepthA = float(map.depthA), p.shadowDepthB = float(map.depthB);
    } else {
        return;
    }
    std::ranges::copy(map.worldToUvz.toFloats(), p.worldToShadow);
    p.shadowFilterTexels = 64;
    light.shadowMapFile = io::concat("light_", number + 1, "_shadowmap.exr");
    light.shadowMapChannel = "Z";
    io::Image depth;
    depth.width = depth.height = map.size;
    depth.channels.push_back({"Z", io::ChannelType::Float, map.depth});
    io::writeExr(folder + "/" + light.shadowMapFile, depth);
}

}  // namespace

void drawImport(Run& run, const std::string& folder, io::ImportedGltf& imported, const ImportView& v) {
    const io::GltfScene& gltf = imported.gltf;
    io::SceneFile& scene = imported.scene;
    std::vector<uint32_t> ids;  // per triangle
    for (const uint32_t m : gltf.materialOf) ids.push_back(m + 1);
    const sample::Scene mesh(sample::MeshView{gltf.mesh.positions, gltf.mesh.normals, gltf.mesh.uvs,
                                              v.curvature, gltf.mesh.triangles, ids});
    sample::GBufferOptions options;
    options.detail.enabled = false;
    options.thickness = true;
    for (const io::GltfLook& look : imported.looks)
        options.looks.push_back({sample::Look::Kind::Plain,
                                 {float(look.albedo[0]), float(look.albedo[1]), float(look.albedo[2])}});
    const double aspect = double(v.width) / v.height;
    const sample::Camera camera =
        cameraOf(v.camera < 0 ? nullptr : &gltf.cameras[size_t(v.camera)], mesh, aspect);
    sample::GBuffer g = sample::renderGBuffer(mesh, camera, int(v.width), int(v.height), options);
    applyTextures(run, gltf, g);
    io::Image image;
    image.width = int(v.width), image.height = int(v.height);
    const auto add = [&](PelImageSlot slot, const char* name, const char* components,
                         std::span<const float> planes) {
        io::addPlanes(scene, image, slot, name, components, planes);
    };
    add(PEL_SLOT_POSITION, "Position", "XYZ", g.position.data);
    add(PEL_SLOT_NORMAL_SHADING, "Normal", "XYZ", g.geometricNormal.data);
    add(PEL_SLOT_CURVATURE, "Curvature", "V", g.curvature.data);
    add(PEL_SLOT_ALBEDO, "Albedo", "RGB", g.albedo.data);
    add(PEL_SLOT_THICKNESS, "Thickness", "V", g.thickness.data);
    add(PEL_SLOT_MATERIAL, "Material", "I", std::vector<float>(g.material.begin(), g.material.end()));
    size_t covered = 0;
    for (const uint32_t id : g.material) covered += id != 0;
    run.report["pixels_covered"] = covered;
    if (!covered)
        run.warn(
            "nothing of the scene is in the picture: choose another --camera, or --camera none to see all of "
            "it");
    io::writeExr(folder + "/gbuffer.exr", image);
    const sample::Vec3 eye = camera.eye;
    scene.camera.position[0] = float(eye.x), scene.camera.position[1] = float(eye.y),
    scene.camera.position[2] = float(eye.z);
    std::ranges::copy(camera.inverseViewProjection(aspect).toFloats(), scene.camera.inverseViewProjection);
    for (size_t i = 0; i < scene.lights.size(); ++i) addShadowMap(folder, mesh, i, scene.lights[i]);
}

}  // namespace pellucid::cli
