#include <algorithm>
#include <span>

#include "io/atomic_file.h"
#include "io/scene/scene_keys.h"
#include "io/shortest.h"

namespace pellucid::io {
namespace {

// A visitor of scene_keys.h that writes the values.
class TomlWriter {
  public:
    explicit TomlWriter(std::string& out, std::string name = "") : out_(out), name_(std::move(name)) {}

    void number(std::string_view key, float value, Range range) {
        if (!(value == range.special && value < 0)) line(key, shortest(value));
    }
    // If all values are the special one they mean the default, and the key is left out.
    void numbers(std::string_view key, const float* values, size_t count, Range range) {
        if (!std::all_of(values, values + count, [&](float v) { return v == range.special; }))
            line(key, shown(values, count));
    }
    void rows(std::string_view key, const float* values, size_t rows, size_t columns) {
        std::string text = "[\n";
        for (size_t r = 0; r < rows; ++r) text += "    " + shown(values + r * columns, columns) + ",\n";
        line(key, text + "]");
    }
    void integer(std::string_view key, uint32_t value, Range) { line(key, std::to_string(value)); }
    void text(std::string_view key, const std::string& value) {
        if (!value.empty()) line(key, quoted(value));
    }
    void texts(std::string_view key, const std::vector<std::string>& values, size_t, size_t) {
        if (values.empty()) return;
        std::string list;
        for (const std::string& value : values) list += (list.empty() ? "" : ", ") + quoted(value);
        line(key, values.size() == 1 ? list : "[" + list + "]");
    }
    template <class Enum>
    void choice(std::string_view key, Enum value, std::span<const std::string_view> names) {
        line(key, quoted(names[static_cast<size_t>(value)]));
    }
    template <class Function>
    void table(std::string_view key, bool isPresent, Function&& function) {
        if (!isPresent) return;
        TomlWriter inner(out_, name_ + "." + std::string(key));
        out_ += "\n[" + inner.name_ + "]\n";
        function(inner);
    }

  private:
    void line(std::string_view key, const std::string& value) {
        out_.append(key).append(" = ").append(value) += '\n';
    }

    static std::string shown(const float* values, size_t count) {
        std::string list;
        for (size_t i = 0; i < count; ++i) list += (i ? ", " : "") + shortest(values[i]);
        return "[" + list + "]";
    }
    static std::string quoted(std::string_view text) {
        constexpr char hex[] = "0123456789ABCDEF";
        std::string out = "\"";
        for (const char c : text) {
            const auto byte = static_cast<unsigned char>(c);
            if (byte < 0x20 || byte == 0x7f) {
                ((out += "\\u00") += hex[byte >> 4]) += hex[byte & 15];
            } else {
                if (c == '"' || c == '\\') out += '\\';
                out += c;
            }
        }
        return out + "\"";
    }

    std::string& out_;
    std::string name_;
};

}  // namespace

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
    parseScene(path, text);  // a scene that cannot be read must not replace one that can
    writeWholeFile(path, text);
}

}  // namespace pellucid::io
