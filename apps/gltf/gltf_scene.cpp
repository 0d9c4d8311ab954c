#include "gltf/gltf_import.h"

#include <algorithm>
#include <set>

#include "io/shortest.h"

namespace pellucid::io {
namespace {

constexpr double sheet = 0.5;  // mm: thickness that is given to walls without one

std::string triple(const Triple& values) {
    return concat("[", shortest(float(values.x)), ", ", shortest(float(values.y)), ", ",
                  shortest(float(values.z)), "]");
}

std::string profileFile(const std::string& name, const std::string& source, const std::string& keys) {
    return "version = 1\nname = \"" + name + "\"\nkind = \"burley\"\nunit = \"mm\"\nsource = \"" + source +
           "\"\n" + keys;
}

// The width b with which a slab of thickness s transmits T of light: T = exp(-s/b) / 4 + 3 exp(-s/3b) / 4.
double widthFor(double share, double thickness) {
    double low = 1e-4 * thickness, high = 1e4 * thickness;
    for (int i = 0; i < 200; ++i) {
        const double b = std::sqrt(low * high),
                     t = 0.25 * std::exp(-thickness / b) + 0.75 * std::exp(-thickness / (3 * b));
        (t < share ? low : high) = b;
    }
    return std::sqrt(low * high);
}

// A medium given by its extinction and the albedo of a half-space.
void volume(const GltfMaterial& m, const std::string& name, GltfLook& look) {
    Triple path;
    for (size_t c = 0; c < 3; ++c) {
        const double left = std::clamp(m.attenuationColor[c], 1e-6, 1 - 1e-6),
                     extinction = -std::log(left) / (1000 * m.attenuationDistance),  // 1/mm
            albedo = singleScatterAlbedo((*m.multiscatterColor)[c], m.scatterAnisotropy);
        // Similarity: the reduced mean free path of an isotropic medium that scatters alike.
        path[c] = std::clamp(1 / (extinction * std::max(1 - m.scatterAnisotropy * albedo, 1e-6)), 1e-5, 1e5);
    }
    look.how = "volume";
    look.profileText =
        profileFile(name, "glTF: KHR_materials_volume and its scatter extension",
                    "mean_free_path = " + triple(path) + "\nalbedo = " + triple(*m.multiscatterColor) +
                        "\nfit = \"diffuse-transmission\"\n");
    const double entering = std::max(m.transmission, m.diffuseTransmission);
    for (size_t c = 0; c < 3; ++c) {
        const double tint = m.diffuseTransmission > 0 ? m.diffuseTransmissionColor[c] : m.baseColor[c];
        look.albedo[c] = (1 - entering) * m.baseColor[c] + entering * tint * (*m.multiscatterColor)[c];
    }
}

// A wall that transmits light diffusely. The library adds T times the irradiance of the other side, then
// multiplies by the albedo: albedo is what is reflected, T transmitted over reflected light, at most 0.98.
void thinSheet(const GltfMaterial& m, const std::string& name, GltfLook& look) {
    const double thickness = m.thickness > 0 ? 1000 * m.thickness : sheet;
    Triple width;
    for (size_t c = 0; c < 3; ++c) {
        const double through = m.diffuseTransmission * m.diffuseTransmissionColor[c];
        look.albedo[c] = (1 - m.diffuseTransmission) * m.baseColor[c];
        width[c] = widthFor(std::clamp(through / std::max(look.albedo[c], 1e-9), 1e-3, 0.98), thickness);
    }
    look.how = "thin sheet";
    look.profileText =
        profileFile(name, "glTF: KHR_materials_diffuse_transmission", "distance = " + triple(width) + "\n");
    look.material.material.thinThickness = float(thickness);
    look.material.material.scattering = PEL_SCATTERING_SCREEN;
    look.material.material.thicknessTaps = 0;
}

}  // namespace

double singleScatterAlbedo(double multiscatter, double anisotropy) {
    const double c = std::clamp(multiscatter, 0.0, 1.0),
                 s = std::clamp(4.09712 + 4.20863 * c - std::sqrt(9.59217 + 41.6808 * c + 17.7126 * c * c),
                                0.0, 1.0);
    return std::clamp((1 - s * s) / std::max(1 - anisotropy * s * s, 1e-9), 0.0, 1.0);
}

GltfLook lookOf(GltfMaterial m, const std::string& name, uint32_t id, const std::string& profile) {
    GltfLook look;
    if (!profile.empty()) m.metallic = 0;  // 1 by default, even where the user says what it is
    look.how = m.metallic > 0.5 ? "metal" : m.transmission > 0.5 ? "clear" : "plain";
    for (size_t c = 0; c < 3; ++c) look.albedo[c] = m.baseColor[c] * (1 - m.metallic);
    PelMaterial& p = look.material.material;
    look.material.id = id;
    const bool enters = m.transmission > 0 || m.diffuseTransmission > 0;
    if (!profile.empty()) {
        look.how = "profile";
        look.material.profile = profile;
    } else if (m.metallic <= 0.5 && m.multiscatterColor && std::isfinite(m.attenuationDistance) && enters) {
        volume(m, name, look);
    } else if (m.metallic <= 0.5 && m.diffuseTransmission > 0) {
        thinSheet(m, name, look);
    } else {
        p.scattering = PEL_SCATTERING_NONE;
        p.thicknessTaps = 0;
    }
    if (!look.profileText.empty()) look.material.profile = name + ".toml";
    // The GGX width is the square of glTF's roughness. f0 is one number: the mean of a metal's base colour.
    const double ratio = m.ior > 0 ? (m.ior - 1) / (m.ior + 1) : 1,
                 metal = (m.baseColor[0] + m.baseColor[1] + m.baseColor[2]) / 3;
    p.specularModel = PEL_SPECULAR_GGX;
    p.lobeMix = 0;
    p.roughness = float(std::max(m.roughness * m.roughness, 0.01));
    // specularFactor scales all of a dielectric's gloss, also at grazing angles.
    const double strength = m.specular * (1 - m.metallic) + m.metallic;
    p.specular = float(strength);
    p.f0 = strength > 0
               ? float((ratio * ratio * m.specular * (1 - m.metallic) + metal * m.metallic) / strength)
               : 0;
    for (size_t c = 0; c < 3; ++c) p.albedo[c] = float(look.albedo[c]);
    return look;
}

std::vector<std::string> plainNames(const std::vector<GltfMaterial>& materials) {
    std::vector<std::string> names;
    std::set<std::string> taken{"scene"};  // scene.toml stands beside the profiles
    for (const GltfMaterial& m : materials) {
        std::string name;
        for (const char c : m.name.substr(0, 50))
            name += (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-'
                        ? c
                        : '_';
        std::string chosen = name;
        for (int i = 2; !taken.insert(chosen).second; ++i) chosen = concat(name, "_", i);
        names.push_back(chosen);
    }
    return names;
}

}  // namespace pellucid::io
