#include "gltf/gltf_import.h"

#include <Imath/ImathBox.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "io/atomic_file.h"
#include "io/concat.h"
#include "io/lut/profile_file.h"
#include "io/shortest.h"

namespace pellucid::io {
namespace {

struct LitArea {
    double radiance, area;
};

// The brightest channel that a diffuse surface reflects: PelLight.color is irradiance / pi, of lamps at 1 mm.
double reflected(const std::vector<SceneLight>& lights, const Triple& at, const Triple& normal,
                 const Triple& albedo) {
    Triple sum(0);
    for (const SceneLight& scene : lights) {
        const PelLight& l = scene.light;
        Triple toLight = vectorOf(l.toLight);
        double strength = 1;
        if (l.type != PEL_LIGHT_DIRECTIONAL) {
            toLight = vectorOf(l.position) - at;
            const double distance = toLight.length();
            if (!(distance > 0) || (l.range > 0 && distance > l.range)) continue;
            toLight /= distance;
            strength = 1 / (distance * distance);
            if (l.type == PEL_LIGHT_SPOT && -toLight.dot(vectorOf(l.spotDirection)) < l.spotCosOuter)
                continue;
        }
        sum += strength * std::max(normal.dot(toLight), 0.0) * vectorOf(l.color) * albedo;
    }
    return std::max({sum.x, sum.y, sum.z});
}

// A sample of a few thousand triangles under the lights as the file has them, without shadows and scattering.
std::vector<LitArea> litSurface(const ImportedGltf& made) {
    const MeshData& mesh = made.gltf.mesh;
    std::vector<LitArea> lit;
    const size_t step = std::max<size_t>(mesh.triangleCount() / 8192, 1);
    for (size_t t = 0; t < mesh.triangleCount(); t += step) {
        Triple corner[3], normal(0);
        for (size_t k = 0; k < 3; ++k) {
            const size_t vertex = mesh.triangles[3 * t + k];
            corner[k] = vectorOf(&mesh.positions[3 * vertex]);
            normal += vectorOf(&mesh.normals[3 * vertex]);
        }
        const double area = (corner[1] - corner[0]).cross(corner[2] - corner[1]).length() / 2;
        if (!(normal.length() > 0) || !(area > 0) || !std::isfinite(area)) continue;
        const double radiance = reflected(made.gltf.lights, (corner[0] + corner[1] + corner[2]) / 3,
                                          normal.normalized(), made.looks[made.gltf.materialOf[t]].albedo);
        if (radiance > 0) lit.push_back({radiance, area});
    }
    return lit;
}

double areaOf(const std::vector<LitArea>& surface, double brighterThan) {
    double area = 0;
    for (const LitArea& s : surface)
        if (s.radiance > brighterThan) area += s.area;
    return area;
}

// How bright the lights make the surface, before anything is drawn. A factor of their brightness: 1 if the
// bright parts of the scene are between 2 % and 100 % of white, and otherwise one that makes them 80 %.
// Cameras have an exposure; glTF files do not say which.
double chosenLightFactor(std::vector<LitArea> lit) {
    constexpr double dimmest = 0.02, wanted = 0.8, brightShare = 0.1;
    if (lit.empty()) return 1;
    std::ranges::sort(lit, std::ranges::greater{}, &LitArea::radiance);
    // The radiance that a tenth of the lit area exceeds.
    double left = brightShare * areaOf(lit, 0);
    size_t i = 0;
    while (i + 1 < lit.size() && (left -= lit[i].area) > 0) ++i;
    const double bright = lit[i].radiance;
    if (bright >= dimmest && bright <= 1) return 1;
    const double factor = wanted / bright, digit = std::pow(10.0, std::floor(std::log10(factor)) - 1);
    return std::round(factor / digit) * digit;  // two digits, for messages
}

constexpr size_t mostLights = 64;

// Profiles by the names of materials.
std::map<std::string, std::string> profilesOf(const std::vector<std::string>& words,
                                              const std::vector<GltfMaterial>& materials) {
    std::map<std::string, std::string> chosen;
    std::string known;
    for (const GltfMaterial& m : materials) known += (known.empty() ? "" : ", ") + printable(m.name);
    for (const std::string& word : words) {
        const size_t at = word.rfind('=');
        const std::string profile = at == std::string::npos ? word : word.substr(at + 1);
        findProfile(profile);  // or an error that lists them
        bool found = at == std::string::npos;
        for (const GltfMaterial& m : materials)
            if (at == std::string::npos)
                chosen.try_emplace(m.name, profile);  // one that names the material wins, in any order
            else if (m.name == word.substr(0, at))
                chosen[m.name] = profile, found = true;
        if (!found)
            throw std::invalid_argument("profile " + word + ": there is no such material; there are " +
                                        known);
    }
    return chosen;
}

// A directional light and weak ambient light for scenes without lights.
void addLamp(SceneFile& scene) {
    SceneLight lamp;
    lamp.light = directionalLight({0.5f, 0.6f, 0.62f}, {1, 1, 1});
    scene.lights.push_back(lamp);
    for (float& c : scene.ambient.constant) c = 0.08f;
}

void addMaterials(ImportedGltf& made, const std::vector<std::string>& words) {
    const std::vector<GltfMaterial>& materials = made.gltf.materials;
    const auto profiles = profilesOf(words, materials);
    made.names = plainNames(materials);
    for (size_t i = 0; i < materials.size(); ++i) {
        const auto given = profiles.find(materials[i].name);
        std::string profile = given == profiles.end() ? "" : given->second;
        if (extensionOf(profile) == "toml") profile = std::filesystem::absolute(profile).string();
        made.looks.push_back(lookOf(materials[i], made.names[i], uint32_t(i + 1), profile));
        made.scene.materials.push_back(made.looks.back().material);
    }
}

void toMillimetres(GltfScene& gltf, double unitMm) {
    for (GltfMaterial& m : gltf.materials)  // in metres
        m.thickness *= unitMm / 1000, m.attenuationDistance *= unitMm / 1000;
    for (float& p : gltf.mesh.positions) {
        p = float(p * unitMm);
        if (!std::isfinite(p))
            throw FileError(gltf.mesh.source, "has vertices too far away for a float, in mm");
    }
    for (GltfCamera& camera : gltf.cameras) camera.position *= unitMm;
    for (SceneLight& light : gltf.lights) {
        for (float& p : light.light.position) p = float(p * unitMm);
        light.light.range = float(std::min(light.light.range * unitMm, 1e18));
    }
}

// Rays start at the camera in single precision: from far away they would miss a small scene, or hit noise.
void dropDistantCameras(GltfScene& gltf) {
    constexpr double most = 1e5;  // of the scene's size
    Imath::Box3d box;
    for (size_t i = 0; i < gltf.mesh.positions.size(); i += 3)
        box.extendBy(vectorOf(&gltf.mesh.positions[i]));
    const size_t dropped = std::erase_if(gltf.cameras, [&](const GltfCamera& camera) {
        return !((camera.position - box.center()).length() <= most * box.size().length());
    });
    if (dropped)
        gltf.mesh.warnings.push_back(concat(
            dropped, " cameras are left out: their distance is over 100,000 times the size of the scene"));
}

void addLights(ImportedGltf& made, const GltfImportOptions& options) {
    std::vector<SceneLight>& lights = made.gltf.lights;
    std::vector<std::string>& warnings = made.gltf.mesh.warnings;
    if (lights.size() > mostLights) {
        warnings.push_back(
            concat("the scene has ", lights.size(), " lights; the first ", mostLights, " are taken"));
        lights.resize(mostLights);
    }
    const size_t dropped = std::erase_if(lights, [](const SceneLight& light) {
        return std::ranges::any_of(light.light.position, [](float p) { return !(std::abs(p) <= 1e30f); });
    });
    if (dropped)
        warnings.push_back(concat(dropped, " lights are left out: they are too far away for a float"));
    if (lights.empty() && options.lights)
        warnings.push_back("the scene has no lights, so their factor is without effect");
    made.lampAdded = lights.empty();
    made.lightFactor = 1;
    if (made.lampAdded) return addLamp(made.scene);
    const std::vector<LitArea> lit = litSurface(made);
    made.lightFactor = options.lights ? *options.lights : chosenLightFactor(lit);
    made.scene.lights = lights;
    for (SceneLight& light : made.scene.lights)
        for (float& c : light.light.color) c = float(std::min(c * made.lightFactor, 1e18));
    const double share = areaOf(lit, 1 / made.lightFactor) / std::max(areaOf(lit, 0), 1e-30);
    if (share > 0.1)
        warnings.push_back(concat("the lights are too bright: an estimated ", int(100 * share),
                                  " % of the lit surface is brighter than white"));
}

// An OBJ file with a group per material. Its v axis points up; that of glTF points down.
void writeObj(const std::string& folder, const ImportedGltf& made) {
    const MeshData& mesh = made.gltf.mesh;
    std::string obj = "mtllib mesh.mtl\n", mtl;
    const auto line = [&](const char* word, const float* values, size_t count) {
        obj += word;
        for (size_t i = 0; i < count; ++i) (obj += ' ') += shortest(values[i]);
        obj += '\n';
    };
    for (size_t v = 0; v < mesh.vertexCount(); ++v) line("v", &mesh.positions[3 * v], 3);
    for (size_t v = 0; v < mesh.uvs.size() / 2; ++v) {
        const float uv[2] = {mesh.uvs[2 * v], 1 - mesh.uvs[2 * v + 1]};
        line("vt", uv, 2);
    }
    for (size_t v = 0; v < mesh.vertexCount(); ++v) line("vn", &mesh.normals[3 * v], 3);
    std::vector<std::vector<size_t>> parts(made.names.size());
    for (size_t t = 0; t < mesh.triangleCount(); ++t) parts[made.gltf.materialOf[t]].push_back(t);
    for (size_t m = 0; m < parts.size(); ++m) {
        obj += "g " + made.names[m] + "\nusemtl " + made.names[m] + "\n";
        for (const size_t t : parts[m]) {
            obj += 'f';
            for (size_t k = 0; k < 3; ++k) {
                const std::string at = std::to_string(mesh.triangles[3 * t + k] + 1);
                obj += " " + at + "/" + (mesh.uvs.empty() ? "" : at) + "/" + at;
            }
            obj += '\n';
        }
        mtl += "newmtl " + made.names[m] + "\nKd";
        for (int c = 0; c < 3; ++c) mtl += " " + shortest(float(made.looks[m].albedo[c]));
        mtl += "\n";
    }
    writeWholeFile(folder + "/mesh.obj", obj);
    writeWholeFile(folder + "/mesh.mtl", mtl);
}

}  // namespace

ImportedGltf importGltf(const std::string& path, const GltfImportOptions& options) {
    return importScene(readGltf(path), options);
}

ImportedGltf importScene(GltfScene scene, const GltfImportOptions& options) {
    ImportedGltf made;
    made.gltf = std::move(scene);
    toMillimetres(made.gltf, options.unitMm);
    addMaterials(made, options.profiles);
    dropDistantCameras(made.gltf);
    addLights(made, options);
    if (!made.gltf.cameras.empty())
        std::copy_n(&made.gltf.cameras[0].position.x, 3, made.scene.camera.position);
    // The channels that a G-buffer of the mesh should have.
    made.scene.channels[PEL_SLOT_NORMAL_SHADING] = {"Normal.X", "Normal.Y", "Normal.Z"};
    made.scene.channels[PEL_SLOT_POSITION] = {"Position.X", "Position.Y", "Position.Z"};
    made.scene.channels[PEL_SLOT_CURVATURE] = {"Curvature.V"};
    made.scene.channels[PEL_SLOT_MATERIAL] = {"Material.I"};
    return made;
}

void writeImported(const std::string& folder, const ImportedGltf& made) {
    for (size_t i = 0; i < made.looks.size(); ++i)
        if (!made.looks[i].profileText.empty())
            writeWholeFile(folder + "/" + made.names[i] + ".toml", made.looks[i].profileText);
    writeObj(folder, made);
    writeScene(folder + "/scene.toml", made.scene);
}

}  // namespace pellucid::io
