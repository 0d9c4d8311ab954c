#include "gltf/gltf_materials.h"

#include <algorithm>
#include <numbers>

namespace pellucid::io {
namespace {

void warnOnce(std::vector<std::string>& warnings, const std::string& text) {
    if (std::ranges::find(warnings, text) == warnings.end()) warnings.push_back(text);
}

}  // namespace

GltfMaterial readGltfMaterial(const GltfDocument& document, const GltfValue& material,
                              std::vector<std::string>& warnings) {
    GltfMaterial m;
    m.name = material.text("name", "");
    const auto texture = [&](const GltfValue& owner, const char* key) {
        if (owner.has(key))
            warnOnce(warnings, "textures other than the base colour's are left out; factors alone count");
    };
    if (material.has("pbrMetallicRoughness")) {
        const GltfValue pbr = material["pbrMetallicRoughness"];
        double color[4] = {1, 1, 1, 1};
        pbr.numbers("baseColorFactor", color, 4, 0, 1);
        m.baseColor = {color[0], color[1], color[2]};
        m.metallic = pbr.number("metallicFactor", 1, 0, 1);
        m.roughness = pbr.number("roughnessFactor", 1, 0, 1);
        texture(pbr, "metallicRoughnessTexture");
        if (pbr.has("baseColorTexture")) {
            const GltfValue info = pbr["baseColorTexture"], top = document.root();
            const GltfValue named =
                top["textures"][info.reference("index", "textures", top.count("textures"))];
            if (info.whole("texCoord", 0, 255) != 0 || info.hasExtension("KHR_texture_transform"))
                warnOnce(warnings,
                         "textures with coordinates of their own are left out: TEXCOORD_0 alone is read");
            else if (named.has("source"))
                m.baseColorImage = int(named.reference("source", "images", top.count("images")));
            else
                warnOnce(warnings, "textures that are neither PNG nor JPEG are left out");
        }
    }
    for (const char* key : {"normalTexture", "occlusionTexture", "emissiveTexture"}) texture(material, key);
    const auto with = [&](const char* name, auto&& read) {
        if (material.hasExtension(name)) read(material.extension(name));
    };
    with("KHR_materials_ior", [&](const GltfValue& e) {
        m.ior = e.number("ior", 1.5, 0, 100);
        if (m.ior != 0 && m.ior < 1) e["ior"].fail("is below 1");
    });
    with("KHR_materials_specular", [&](const GltfValue& e) {
        m.specular = e.number("specularFactor", 1, 0, 1);
        texture(e, "specularTexture");
    });
    with("KHR_materials_transmission", [&](const GltfValue& e) {
        m.transmission = e.number("transmissionFactor", 0, 0, 1);
        texture(e, "transmissionTexture");
    });
    with("KHR_materials_diffuse_transmission", [&](const GltfValue& e) {
        m.diffuseTransmission = e.number("diffuseTransmissionFactor", 0, 0, 1);
        e.numbers("diffuseTransmissionColorFactor", m.diffuseTransmissionColor.data(), 3, 0, 1);
        texture(e, "diffuseTransmissionTexture"), texture(e, "diffuseTransmissionColorTexture");
    });
    with("KHR_materials_volume", [&](const GltfValue& e) {
        m.thickness = e.number("thicknessFactor", 0, 0, 1e6);
        m.attenuationDistance = e.number("attenuationDistance", INFINITY, 1e-9, INFINITY);
        e.numbers("attenuationColor", m.attenuationColor.data(), 3, 0, 1);
        texture(e, "thicknessTexture");
    });
    for (const char* name :
         {"KHR_materials_scatter", "KHR_materials_volume_scatter"})  // the draft's name, the later one
        with(name, [&](const GltfValue& e) {
            Triple color{};
            e.numbers("multiscatterColor", color.data(), 3, 0, 1);
            e.numbers("multiscatterColorFactor", color.data(), 3, 0, 1);
            m.multiscatterColor = color;
            m.scatterAnisotropy = e.number("scatterAnisotropy", 0, -1, 1);
            texture(e, "multiscatterColorTexture");
        });
    if (material.hasExtension("KHR_materials_pbrSpecularGlossiness")) {
        const GltfValue e = material.extension("KHR_materials_pbrSpecularGlossiness");
        double color[4] = {1, 1, 1, 1};
        e.numbers("diffuseFactor", color, 4, 0, 1);
        m.baseColor = {color[0], color[1], color[2]};
        m.metallic = 0;
        m.roughness = 1 - e.number("glossinessFactor", 1, 0, 1);
        texture(e, "diffuseTexture");
    }
    return m;
}

GltfLight readGltfLight(const GltfValue& light) {
    GltfLight l;
    const std::string type = light["type"].text();
    if (type == "directional")
        l.kind = GltfLight::Kind::Directional;
    else if (type == "point")
        l.kind = GltfLight::Kind::Point;
    else if (type == "spot")
        l.kind = GltfLight::Kind::SpotLight;
    else
        light["type"].fail("is '" + type.substr(0, 20) + "'; directional, point or spot would be right");
    light.numbers("color", l.color.data(), 3, 0, 1e6);
    l.intensity = light.number("intensity", 1, 0, 1e12);
    l.range = light.number("range", 0, 0, 1e12);
    if (light.has("spot")) {
        const GltfValue spot = light["spot"];
        l.innerCone = spot.number("innerConeAngle", 0, 0, std::numbers::pi / 2);
        l.outerCone = spot.number("outerConeAngle", std::numbers::pi / 4, 0, std::numbers::pi / 2);
        if (l.innerCone > l.outerCone) spot.fail("has an inner cone wider than its outer one");
    } else {
        l.outerCone = std::numbers::pi / 4;
    }
    return l;
}

}  // namespace pellucid::io
