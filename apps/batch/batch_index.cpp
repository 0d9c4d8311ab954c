#include "batch/batch_index.h"

#include <filesystem>

#include "io/lut/lut_describe.h"
#include "io/shortest.h"

namespace pellucid::io {
namespace {

constexpr int indexVersion = 1;

// One object of JSON, key by key.
class JsonObject {
  public:
    explicit JsonObject(std::string& out) : out_(out) { out_ += '{'; }
    ~JsonObject() { out_ += '}'; }

    void text(std::string_view key, std::string_view value) {
        begin(key);
        quoted(value);
    }
    template <class Number>
    void number(std::string_view key, Number value) {
        begin(key);
        out_ += shortest(value);
    }

  private:
    void begin(std::string_view key) {
        if (out_.back() != '{') out_ += ", ";
        quoted(key);
        out_ += ": ";
    }
    void quoted(std::string_view value) {
        constexpr char hex[] = "0123456789abcdef";
        out_ += '"';
        for (const char c : value) {
            const auto byte = static_cast<unsigned char>(c);
            if (c == '"' || c == '\\')
                (out_ += '\\') += c;
            else if (byte < 0x20)
                ((out_ += "\\u00") += hex[byte >> 4]) += hex[byte & 15];
            else
                out_ += c;
        }
        out_ += '"';
    }

    std::string& out_;
};

// "pellucid:diffusionRadius" is diffusion_radius, as in manifests.
std::string manifestKey(std::string_view attribute) {
    std::string key;
    for (const char c : attribute.substr(attribute.find(':') + 1)) {
        if (c >= 'A' && c <= 'Z') key += '_';
        key += c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
    }
    return key;
}

void describe(std::string& out, const BatchEntry& entry) {
    PelLutInfo info = entry.info;
    PelProfileInfo profile = pelProfileInfoDefaults();
    if (info.kind != PEL_LUT_SPECULAR) {
        profile = entry.profile.info();
        info.curvature = pelCurvatureLutDescFilled(info.curvature, &profile);
        info.shadow = pelShadowLutDescFilled(info.shadow, &profile);
    }
    JsonObject table(out);
    table.text("file", entry.file);
    if (!entry.name.empty()) table.text("name", entry.name);
    table.number("line", entry.line);
    table.text("kind", lutKinds[info.kind]);
    const auto [width, height] = lutSize(info);
    table.number("width", width);
    table.number("height", height);
    table.text("encoding", lutEncodings[entry.encoding]);
    if (info.kind == PEL_LUT_SPECULAR) return;
    table.text("profile", profile.name);
    if (info.kind == PEL_LUT_CURVATURE) {
        table.text("form", curvatureForms[info.curvature.form]);
        table.text("axis", lutAxes[info.curvature.axis]);
    }
    if (info.kind == PEL_LUT_SHADOW) {
        table.text("axis", lutAxes[info.shadow.axis]);
        table.number("closed_ends", info.shadow.closedEnds);
    }
    visitLutNumbers(
        info, [&](std::string_view attribute, float value) { table.number(manifestKey(attribute), value); });
}

}  // namespace

std::string batchIndexName(const std::string& manifestPath) {
    return std::filesystem::path(manifestPath).stem().string() + ".index.json";
}

std::string batchIndex(const BatchManifest& manifest, const std::string& manifestPath,
                       const std::vector<bool>& there) {
    size_t missing = manifest.errors.size();
    for (const bool present : there) missing += !present;
    std::string out;
    {
        JsonObject head(out);
        head.number("version", indexVersion);
        head.text("manifest", std::filesystem::path(manifestPath).filename().string());
        head.text("pellucid", std::to_string(pelVersion() / 10000) + "." +
                                  std::to_string(pelVersion() / 100 % 100) + "." +
                                  std::to_string(pelVersion() % 100));
        head.number("missing", missing);
    }
    out.back() = ',';
    out += " \"tables\": [";
    const char* between = "\n";
    for (size_t i = 0; i < there.size(); ++i) {
        if (!there[i]) continue;
        out += between;
        between = ",\n";
        describe(out, manifest.entries[i]);
    }
    return out += "\n]}\n";
}

}  // namespace pellucid::io
