#include "io/atomic_file.h"
#include "io/scene/scene_keys.h"
#include "io/toml_writer.h"

namespace pellucid::io {

void addPlanes(SceneFile& scene, Image& gbuffer, PelImageSlot slot, const std::string& name,
               const std::string& components, std::span<const float> planes, ChannelType type) {
    scene.channels[slot].clear();
    const size_t pixels = gbuffer.pixelCount();
    for (size_t c = 0; c < components.size(); ++c) {
        scene.channels[slot].push_back(name + "." + components[c]);
        const auto from = planes.begin() + ptrdiff_t(c * pixels);
        Channel channel{scene.channels[slot].back(), type, {from, from + ptrdiff_t(pixels)}};
        if (type == ChannelType::Half)
            channel = Channel::halves(std::move(channel.name), std::move(channel.pixels));
        gbuffer.channels.push_back(std::move(channel));
    }
}

std::string sceneText(const SceneFile& scene) {
    std::string out =
        "# A scene of `pellucid shade`. Lengths are in the unit of the G-buffer's positions.\nversion = 2\n";
    // Options that are not the defaults.
    std::string options, defaults;
    TomlWriter optionWriter(options), defaultWriter(defaults);
    optionKeys(optionWriter, scene);
    const SceneFile standard;
    optionKeys(defaultWriter, standard);
    std::istringstream lines(options);
    for (std::string line; std::getline(lines, line);)
        if (("\n" + defaults).find("\n" + line + "\n") == std::string::npos) out += line + "\n";
    const auto table = [&](const std::string& header, const std::string& name, auto&& function) {
        out += "\n" + header + "\n";
        TomlWriter writer(out, name);
        function(writer);
    };
    table("[channels]", "channels", [&](TomlWriter& w) { channelKeys(w, scene); });
    table("[camera]", "camera", [&](TomlWriter& w) { cameraKeys(w, scene.camera); });
    table("[ambient]", "ambient", [&](TomlWriter& w) { ambientKeys(w, scene); });
    if (scene.scatter) table("[scatter]", "scatter", [&](TomlWriter& w) { scatterKeys(w, *scene.scatter); });
    if (std::any_of(scene.outputs.begin(), scene.outputs.end(), [](auto& o) { return !o.empty(); }))
        table("[outputs]", "outputs", [&](TomlWriter& w) { outputFileKeys(w, scene); });
    for (const SceneLight& light : scene.lights) {
        table("[[light]]", "light", [&](TomlWriter& w) { lightKeys(w, light); });
    }
    for (const SceneMaterial& material : scene.materials) {
        table("[[material]]", "material", [&](TomlWriter& w) { materialKeys(w, material); });
    }
    for (const SceneEye& eye : scene.eyes) {
        table("[[eye]]", "eye", [&](TomlWriter& w) { eyeKeys(w, eye); });
    }
    for (const SceneLut& lut : scene.luts) {
        const bool curvature = lut.info.kind == PEL_LUT_CURVATURE;
        const std::string name = curvature ? "curvature_lut" : "shadow_lut";
        table("[[" + name + "]]", name, [&](TomlWriter& w) {
            if (!lut.file.empty()) {
                w.text("name", lut.name);
                w.text("file", lut.file);
            } else if (curvature) {
                curvatureLutKeys(w, lut);
            } else {
                shadowLutKeys(w, lut);
            }
        });
    }
    return out;
}

void writeScene(const std::string& path, const SceneFile& scene) {
    const std::string text = sceneText(scene);
    parseScene(path, text);  // an unreadable scene must not replace a readable one
    writeWholeFile(path, text);
}

}  // namespace pellucid::io
