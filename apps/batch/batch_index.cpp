// The file of an entry, and the index of all.
#include <filesystem>
#include <nlohmann/json.hpp>

#include "batch/batch_manifest.h"
#include "io/lut/lut_describe.h"
#include "io/lut/lut_exr.h"

namespace pellucid::io {
namespace {

Lut submitted(const Device& device, const PelLutInfo& info) {
    const PelSubmit queued{nullptr, 0, nullptr};
    if (info.kind == PEL_LUT_CURVATURE) return Lut(device, info.curvature, &queued);
    if (info.kind == PEL_LUT_SHADOW) return Lut(device, info.shadow, &queued);
    return Lut(device, info.specular, &queued);
}

// Floats are written as short as floats can be.
using Json =
    nlohmann::basic_json<nlohmann::ordered_map, std::vector, std::string, bool, int64_t, uint64_t, float>;

std::string written(const Json& value) {
    return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// "pellucid:diffusionRadius" is diffusion_radius, as in manifests.
std::string keyOf(std::string_view attribute) {
    std::string key;
    for (const char c : attribute.substr(attribute.find(':') + 1))
        (key += c >= 'A' && c <= 'Z' ? "_" : "") += c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
    return key;
}

std::string described(const BatchEntry& entry) {
    PelLutInfo info = entry.info;
    Json table{{"file", entry.file}};
    if (!entry.name.empty()) table["name"] = entry.name;
    table["line"] = entry.line;
    table["kind"] = lutKinds[info.kind];
    const auto [width, height] = lutSize(info);
    table["width"] = width;
    table["height"] = height;
    table["encoding"] = lutEncodings[entry.encoding];
    if (info.kind == PEL_LUT_SPECULAR) return written(table);
    const PelProfileInfo profile = entry.profile.info();
    info.curvature = pelCurvatureLutDescFilled(info.curvature, &profile);
    info.shadow = pelShadowLutDescFilled(info.shadow, &profile);
    table["profile"] = profile.name;
    if (info.kind == PEL_LUT_CURVATURE) {
        table["form"] = curvatureForms[info.curvature.form];
        table["axis"] = lutAxes[info.curvature.axis];
    } else {
        table["axis"] = lutAxes[info.shadow.axis];
        table["closed_ends"] = info.shadow.closedEnds;
    }
    visitLutNumbers(info, [&](std::string_view attribute, float value) { table[keyOf(attribute)] = value; });
    return written(table);
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
    Json head{{"version", 1},  // of this format
              {"manifest", std::filesystem::path(manifestPath).filename().string()},
              {"pellucid", concat(v / 10000, ".", v / 100 % 100, ".", v % 100)},
              {"missing", missing},
              {"tables", nullptr}};
    std::string all = written(head);
    return all.replace(all.rfind("null"), 4, "[" + tables + "\n]") + "\n";
}

}  // namespace pellucid::io
