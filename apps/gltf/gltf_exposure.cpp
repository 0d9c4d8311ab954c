#include "gltf/gltf_exposure.h"

#include <algorithm>
#include <cmath>

namespace pellucid::io {
namespace {

struct LitArea {
    double radiance, area;
};

double dot(const Triple& a, const Triple& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// The brightest channel that a diffuse surface reflects: PelLight.color is irradiance / pi, of lamps at 1 mm.
double reflected(const std::vector<SceneLight>& lights, const Triple& at, const Triple& normal,
                 const Triple& albedo) {
    Triple sum{};
    for (const SceneLight& scene : lights) {
        const PelLight& l = scene.light;
        Triple toLight{l.toLight[0], l.toLight[1], l.toLight[2]};
        double strength = 1;
        if (l.type != PEL_LIGHT_DIRECTIONAL) {
            for (size_t c = 0; c < 3; ++c) toLight[c] = l.position[c] - at[c];
            const double distance = std::sqrt(dot(toLight, toLight));
            if (!(distance > 0) || (l.range > 0 && distance > l.range)) continue;
            for (double& x : toLight) x /= distance;
            strength = 1 / (distance * distance);
            const Triple axis{l.spotDirection[0], l.spotDirection[1], l.spotDirection[2]};
            if (l.type == PEL_LIGHT_SPOT && -dot(toLight, axis) < l.spotCosOuter) continue;
        }
        const double cosine = std::max(dot(normal, toLight), 0.0);
        for (size_t c = 0; c < 3; ++c) sum[c] += l.color[c] * strength * cosine * albedo[c];
    }
    return std::ranges::max(sum);
}

// A sample of a few thousand triangles that light reaches.
std::vector<LitArea> litSurface(const ImportedGltf& made, const std::vector<SceneLight>& lights) {
    const MeshData& mesh = made.gltf.mesh;
    std::vector<LitArea> lit;
    const size_t step = std::max<size_t>(mesh.triangleCount() / 8192, 1);
    for (size_t t = 0; t < mesh.triangleCount(); t += step) {
        Triple corner[3], centre{}, normal{};
        for (size_t k = 0; k < 3; ++k)
            for (size_t c = 0; c < 3; ++c) {
                const size_t at = 3 * size_t(mesh.triangles[3 * t + k]) + c;
                corner[k][c] = mesh.positions[at];
                centre[c] += mesh.positions[at] / 3.0;
                normal[c] += mesh.normals[at];
            }
        Triple cross;
        for (size_t c = 0; c < 3; ++c) {
            const size_t d = (c + 1) % 3, e = (c + 2) % 3;
            cross[c] = (corner[1][d] - corner[0][d]) * (corner[2][e] - corner[0][e]) -
                       (corner[1][e] - corner[0][e]) * (corner[2][d] - corner[0][d]);
        }
        const double length = std::sqrt(dot(normal, normal)), area = std::sqrt(dot(cross, cross)) / 2;
        if (!(length > 0) || !(area > 0) || !std::isfinite(area)) continue;
        for (double& x : normal) x /= length;
        const double radiance = reflected(lights, centre, normal, made.looks[made.gltf.materialOf[t]].albedo);
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

}  // namespace

double chosenLightFactor(const ImportedGltf& made) {
    constexpr double dimmest = 0.02, wanted = 0.8, brightShare = 0.1;
    std::vector<SceneLight> lights;
    for (const GltfLight& light : made.gltf.lights) lights.push_back(sceneLight(light, 1));
    std::vector<LitArea> lit = litSurface(made, lights);
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

double clippedShare(const ImportedGltf& made) {
    const std::vector<LitArea> lit = litSurface(made, made.scene.lights);
    return lit.empty() ? 0 : areaOf(lit, 1) / areaOf(lit, 0);
}

}  // namespace pellucid::io
