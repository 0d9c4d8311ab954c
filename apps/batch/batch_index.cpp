// The file of an entry, and the index of all.
#include <filesystem>

#include "batch/batch_manifest.h"
#include "io/lut/lut_describe.h"
#include "io/lut/lut_exr.h"
#include "io/shortest.h"

namespace pellucid::io {
namespace {

Lut submitted(const Device& device, const PelLutInfo& info) {
    const PelSubmit queued{nullptr, 0, nullptr};
    if (info.kind == PEL_LUT_CURVATURE) return Lut(device, info.curvature, &queued);
    if (info.kind == PEL_LUT_SHADOW) return Lut(device, info.shadow, &queued);
    return Lut(device, info.specular, &queued);
}

std::string quoted(std::string_view value) {
    constexpr char hex[] = "0123456789abcdef";
    std::string out = "\"";
    for (const char c : value) {
        if (static_cast<unsigned char>(c) < 0x20)
            ((out += "\\u00") += hex[c >> 4]) += hex[c & 15];
        else
            (out += c == '"' || c == '\\' ? "\\" : "") += c;
    }
    return out += '"';
}

// One object of JSON, key by key. "pellucid:diffusionRadius" is diffusion_radius, as in manifests.
struct JsonObject {
    std::string out = "{";

    void text(std::string_view attribute, std::string_view value) { raw(attribute, quoted(value)); }
    template <class Number>
    void number(std::string_view attribute, Number value) {
        raw(attribute, shortest(value));
    }
    void raw(std::string_view attribute, const std::string& value) {
        if (out.size() > 1) out += ", ";
        out += '"';
        for (const char c : attribute.substr(attribute.find(':') + 1))
            (out += c >= 'A' && c <= 'Z' ? "_" : "") += c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
        (out += "\": ") += value;
    }
};

std::string described(const BatchEntry& entry) {
    PelLutInfo info = entry.info;
    JsonObject table;
    table.text("file", entry.file);
    if (!entry.name.empty()) table.text("name", entry.name);
    table.number("line", entry.line);
    table.text("kind", lutKinds[info.kind]);
    const auto [width, height] = lutSize(info);
    table.number("width", width);
    table.number("height", height);
    table.text("encoding", lutEncodings[entry.encoding]);
    if (info.kind == PEL_LUT_SPECULAR) return table.out + "}";
    const PelProfileInfo profile = entry.profile.info();
    info.curvature = pelCurvatureLutDescFilled(info.curvature, &profile);
    info.shadow = pelShadowLutDescFilled(info.shadow, &profile);
    table.text("profile", profile.name);
    if (info.kind == PEL_LUT_CURVATURE) {
        table.text("form", curvatureForms[info.curvature.form]);
        table.text("axis", lutAxes[info.curvature.axis]);
    } else {
        table.text("axis", lutAxes[info.shadow.axis]);
        table.number("closed_ends", info.shadow.closedEnds);
    }
    visitLutNumbers(info, [&](std::string_view attribute, float value) { table.number(attribute, value); });
    return table.out + "}";
}

}  // namespace

std::string makeEntryFile(const Device& device, const BatchEntry& entry) {
    const Lut lut = submitted(device, entry.info);
    size_t bytes = 0;
    check(pelLutGetSize(lut.get(), entry.encoding, &bytes));
    std::string texels(bytes, '\0');
    PelEvent done = nullptr;
    const PelSubmit reading{nullptr, 0, &done};
    check(pelLutRead(lut.get(), entry.encoding, texels.data(), bytes, &reading));
    Event(done).wait();
    return encodeLutExr(lut.info(), entry.encoding, texels, entry.key);
}

std::string batchIndexName(const std::string& manifestPath) {
    return std::filesystem::path(manifestPath).stem().string() + ".index.json";
}

std::string batchIndex(const BatchManifest& manifest, const std::string& manifestPath,
                       const std::vector<bool>& there) {
    size_t missing = manifest.errors.size();
    std::string tables;
    for (size_t i = 0; i < there.size(); ++i) {
        missing += !there[i];
        if (there[i]) tables += (tables.empty() ? "\n" : ",\n") + described(manifest.entries[i]);
    }
    const uint32_t v = pelVersion();
    JsonObject head;
    head.number("version", 1);  // of this format
    head.text("manifest", std::filesystem::path(manifestPath).filename().string());
    head.text("pellucid", std::to_string(v / 10000) + "." + std::to_string(v / 100 % 100) + "." +
                              std::to_string(v % 100));
    head.number("missing", missing);
    head.raw("tables", "[" + tables + "\n]");
    return head.out + "}\n";
}

}  // namespace pellucid::io
