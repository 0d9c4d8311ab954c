#include "io/scene/scene_file.h"

#include <cmath>
#include <filesystem>
#include <set>

#include "io/scene/scene_keys.h"
#include "io/toml_reader.h"

namespace pellucid::io {
namespace {

void readLut(TomlReader& reader, SceneFile& scene, PelLutKind kind, LutPreset preset) {
    SceneLut lut;
    lut.line = reader.line();
    reader.choice("preset", preset, lutPresets);
    lut.info = presetInfo(preset, kind);
    if (kind == PEL_LUT_CURVATURE)
        curvatureLutKeys(reader, lut);
    else
        shadowLutKeys(reader, lut);
    if (lut.name.empty()) reader.fail("name", "is missing; materials need it to refer to this table");
    if (scene.lut(lut.name, kind)) reader.fail("name", "is used twice; give each table a name of its own");
    for (const char* key : {"profile", "preset"})
        if (!lut.file.empty() && reader.has(key))
            reader.fail(key, "cannot stand beside 'file', which was made with its own; leave one out");
    if (!lut.file.empty())
        for (const char* key : {"form", "axis", "width", "height", "diffusion_radius", "radius_min",
                                "radius_max", "width_min", "width_max", "sharpening", "closed_ends"})
            if (reader.has(key)) lut.expected.push_back(key);
    const auto ordered = [](float least, float most) { return least == 0 || most == 0 || least < most; };
    if (lut.file.empty() && kind == PEL_LUT_CURVATURE &&
        !ordered(lut.info.curvature.radiusMin, lut.info.curvature.radiusMax))
        reader.fail("radius_min", "is not below radius_max");
    if (lut.file.empty() && kind == PEL_LUT_SHADOW &&
        !ordered(lut.info.shadow.widthMin, lut.info.shadow.widthMax))
        reader.fail("width_min", "is not below width_max");
    scene.luts.push_back(std::move(lut));
}

// Normalises a direction. Nearly unit ones keep their bits: a written scene reads back equal.
void makeUnit(TomlReader& reader, const char* key, float (&v)[3]) {
    const double length = std::hypot(double(v[0]), double(v[1]), double(v[2]));
    if (length == 0) reader.fail(key, "is (0, 0, 0); a direction is needed");
    if (!std::isfinite(length)) reader.fail(key, "is not finite; a direction is needed");
    if (std::abs(length - 1) < 1e-6) return;
    for (float& x : v) x = float(x / length);
}

void readLight(TomlReader& reader, SceneFile& scene) {
    SceneLight light;
    light.line = reader.line();
    lightKeys(reader, light);
    const auto needs = [&](const char* key, const char* type) {
        if (!reader.has(key)) reader.fail(key, std::string("is missing; a ") + type + " light needs it");
    };
    if (light.light.type == PEL_LIGHT_DIRECTIONAL) needs("to_light", "directional");
    if (light.light.type != PEL_LIGHT_DIRECTIONAL) needs("position", "positional");
    if (light.light.type == PEL_LIGHT_SPOT) needs("spot_direction", "spot");
    if (light.light.type == PEL_LIGHT_SPHERE) needs("radius", "sphere");
    if (light.light.type == PEL_LIGHT_RECTANGLE) needs("half_width", "rectangle");
    if (light.light.type == PEL_LIGHT_RECTANGLE) needs("half_height", "rectangle");
    if (light.light.type == PEL_LIGHT_DIRECTIONAL) makeUnit(reader, "to_light", light.light.toLight);
    if (light.light.type == PEL_LIGHT_SPOT) makeUnit(reader, "spot_direction", light.light.spotDirection);
    if (reader.has("shadow_map") && light.shadowMapFile.empty())
        reader.fail("shadow_map", "has no 'file'; name the image of depths seen from the light");
    scene.lights.push_back(std::move(light));
}

void readEye(TomlReader& reader, SceneFile& scene) {
    SceneEye eye;
    eye.line = reader.line();
    eyeKeys(reader, eye);
    for (const char* key : {"material", "center", "gaze"})
        if (!reader.has(key)) reader.fail(key, "is missing; an eye needs it");
    for (const SceneEye& other : scene.eyes)
        if (other.material == eye.material)
            reader.fail("material", "is that of another [[eye]] too; give each eye a material of its own");
    scene.eyes.push_back(std::move(eye));
}

// Names that must exist and numbers that must differ: checks that involve several keys.
void checkReferences(const SceneFile& scene, const TomlReader& channels) {
    if (scene.scatter && scene.channels[PEL_SLOT_IRRADIANCE].empty())
        channels.fail("irradiance", "is missing; it is what [scatter] scatters");
    if (!scene.scatter && scene.channels[PEL_SLOT_NORMAL_SHADING].empty())
        channels.fail("normal_shading", "is missing; nothing can be shaded without normals");
    std::set<uint32_t> ids;
    for (const SceneMaterial& m : scene.materials) {
        const auto refuse = [&](const auto&... why) {
            throw FileError(scene.source, concat(why...), m.line);
        };
        if (!ids.insert(m.id).second) refuse("material id ", m.id, " is used twice");
        if (m.material.thicknessTaps != 0 && m.material.thicknessTaps != 8 &&
            m.material.thicknessTaps != 16 && m.material.thicknessTaps != 32)
            refuse("'thickness_taps' is ", m.material.thicknessTaps, "; 0, 8, 16 or 32 would be right");
        if (!scene.scatter && m.scale >= 0) refuse("'scale' is for scenes with a [scatter] table");
        if (!m.normalMap.empty() && !m.normalMapLevels.empty())
            refuse("'normal_map_levels' cannot stand beside 'normal_map'; leave one out");
        // What is not read needs no coordinates.
        const bool unblurred = scene.channels[PEL_SLOT_NORMAL_BLURRED].empty(),
                   scatters = m.material.scattering == PEL_SCATTERING_TEXTURE;
        if (unblurred && (!m.normalMap.empty() || !m.normalMapLevels.empty()))
            for (const auto& [slot, key] : {std::pair{PEL_SLOT_UV, "uv"}, {PEL_SLOT_TANGENT, "tangent"}})
                if (scene.channels[slot].empty())
                    channels.fail(key, concat("is missing; the normal map of material ", m.id, " needs it"));
        if (m.material.scatterTaps > 0 && m.material.scatterTaps < 8)
            refuse("'scatter_taps' is ", m.material.scatterTaps, "; 0, or 8 to 256 would be right");
        if (scatters && !m.scatteredTexture.empty() && scene.channels[PEL_SLOT_UV].empty())
            channels.fail("uv", concat("is missing; the scattered texture of material ", m.id, " needs it"));
        for (PelLutKind kind : {PEL_LUT_CURVATURE, PEL_LUT_SHADOW}) {
            const std::string& name = kind == PEL_LUT_CURVATURE ? m.curvatureLut : m.shadowLut;
            if (name.empty() || scene.lut(name, kind)) continue;
            std::vector<std::string> names;
            for (const SceneLut& l : scene.luts)
                if (l.info.kind == kind) names.push_back(l.name);
            const std::string table = kind == PEL_LUT_CURVATURE ? "curvature_lut" : "shadow_lut";
            refuse("material ", m.id, " refers to the ", table, " '", name, "'; there is ",
                   names.empty() ? "no [[" + table + "]] table" : "only: " + joined(names));
        }
    }
}

// Checks the materials of eyes and the inputs that eyes need.
void checkEyes(const SceneFile& scene, const TomlReader& channels) {
    for (const SceneEye& eye : scene.eyes) {
        const auto isIts = [&](const SceneMaterial& m) { return m.id == eye.material; };
        if (std::none_of(scene.materials.begin(), scene.materials.end(), isIts))
            throw FileError(
                scene.source,
                concat("the eye refers to material ", eye.material,
                       ", which does not exist; a [[material]] of that id is needed for its sclera"),
                eye.line);
        if (scene.channels[PEL_SLOT_POSITION].empty() && scene.channels[PEL_SLOT_DEPTH].empty())
            channels.fail("position", "is missing, and so is depth; eyes need one of them");
    }
}

// The files that a scene reads, but for profiles.
std::vector<std::string*> imagesOf(SceneFile& scene) {
    std::vector<std::string*> files{&scene.gbuffer, &scene.ambientCube, &scene.reflectionCube,
                                    &scene.environment};
    for (SceneLight& l : scene.lights) {
        files.push_back(&l.shadowMapFile);
        for (SceneCascade& c : l.cascades) files.push_back(&c.file);
    }
    for (SceneMaterial& m : scene.materials) {
        files.insert(files.end(), {&m.scatteredTexture, &m.normalMap});
        for (std::string& level : m.normalMapLevels) files.push_back(&level);
    }
    for (SceneLut& l : scene.luts) files.push_back(&l.file);
    for (SceneEye& e : scene.eyes) files.insert(files.end(), {&e.irisTexture, &e.caustics});
    return files;
}

std::vector<std::string*> profilesOf(SceneFile& scene) {
    std::vector<std::string*> profiles;
    for (SceneMaterial& m : scene.materials) profiles.push_back(&m.profile);
    for (SceneLut& l : scene.luts) profiles.push_back(&l.profile);
    for (SceneEye& e : scene.eyes) profiles.push_back(&e.irisProfile);
    return profiles;
}

}  // namespace

std::vector<std::string*> filesOf(SceneFile& scene) {
    std::vector<std::string*> files = imagesOf(scene);
    std::ranges::copy(profilesOf(scene), std::back_inserter(files));
    return files;
}

const SceneLut* SceneFile::lut(const std::string& name, PelLutKind kind) const {
    for (const SceneLut& l : luts) {
        if (l.name == name && l.info.kind == kind) return &l;
    }
    return nullptr;
}

SceneFile readScene(const std::string& path) {
    return parseScene(path, readWholeFile(path, textLimit));
}

SceneFile parseScene(const std::string& path, const std::string& text) {
    const auto root = parseToml(path, text);
    SceneFile scene;
    scene.source = path;
    TomlReader reader(path, *root, "the scene");
    const LutPreset preset = presetOfVersion(reader.version(lutPresetVersions));
    optionKeys(reader, scene);
    reader.table("camera", true, [&](TomlReader& r) { cameraKeys(r, scene.camera); });
    reader.table("scatter", true,
                 [&](TomlReader& r) { scatterKeys(r, scene.scatter.emplace(pelScatterParamsDefaults())); });
    reader.table("ambient", true, [&](TomlReader& r) { ambientKeys(r, scene); });
    reader.table("outputs", true, [&](TomlReader& r) { outputFileKeys(r, scene); });
    reader.tables("curvature_lut", [&](TomlReader& r) { readLut(r, scene, PEL_LUT_CURVATURE, preset); });
    reader.tables("shadow_lut", [&](TomlReader& r) { readLut(r, scene, PEL_LUT_SHADOW, preset); });
    reader.tables("material", [&](TomlReader& r) {
        SceneMaterial material;
        material.line = r.line();
        materialKeys(r, material);
        scene.materials.push_back(std::move(material));
    });
    reader.tables("eye", [&](TomlReader& r) { readEye(r, scene); });
    reader.tables("light", [&](TomlReader& r) { readLight(r, scene); });
    if (!reader.has("channels"))
        reader.fail("channels", "is missing; it says which channels of the G-buffer are what");
    reader.table("channels", true, [&](TomlReader& r) {
        channelKeys(r, scene);
        r.finish();
        checkReferences(scene, r);
        checkEyes(scene, r);
    });
    reader.finish();

    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    const auto besideScene = [&](std::string& file) {
        if (!file.empty()) file = (folder / file).string();
    };
    for (std::string* file : imagesOf(scene)) besideScene(*file);
    for (std::string* profile : profilesOf(scene))
        if (extensionOf(*profile) == "toml") besideScene(*profile);
    for (std::string& output : scene.outputs) besideScene(output);
    return scene;
}

}  // namespace pellucid::io
