// The file of an entry, and the index of all.
#include <filesystem>
#include <nlohmann/json.hpp>

#include "batch/batch_manifest.h"
#include "io/lut/lut_describe.h"
#include "io/lut/lut_exr.h"

namespace pellucid::io {
namespace {

Lut tableOf(const Device& device, const PelLutInfo& info) {
    const PelSubmit queued{nullptr, 0, nullptr};  // reading waits
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

// Adds what differs between the tables of a stack.
void describe(Json& table, PelLutInfo info, const Profile& of) {
    const PelProfileInfo profile = of.info();
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
}

std::string described(const BatchEntry& entry) {
    const BatchTable& first = entry.tables.front();
    Json file{{"file", entry.file}};
    if (!entry.name.empty()) file["name"] = entry.name;
    file["line"] = entry.line;
    file["kind"] = lutKinds[first.info.kind];
    const auto [width, height] = lutSize(first.info);
    file["width"] = width;
    file["height"] = height;
    file["encoding"] = lutEncodings[entry.encoding];
    if (entry.tables.size() > 1)
        for (const BatchTable& table : entry.tables) {
            Json one;
            describe(one, table.info, table.profile.get());
            file["stack"].push_back(one);
        }
    else if (first.profile.valid())
        describe(file, first.info, first.profile.get());
    return written(file);
}

}  // namespace

PelLutInfo BatchTable::filled() const {
    PelLutInfo all = info;
    if (profile.valid()) all.curvature.profile = all.shadow.profile = profile.get().get();
    return all;
}

std::string makeEntryFile(const Device& device, const BatchEntry& entry) {
    std::vector<PelLutInfo> tables;
    for (const BatchTable& table : entry.tables) tables.push_back(table.filled());
    PelLutInfo first = tables[0];
    std::string texels;
    if (tables.size() == 1) {
        const Lut lut = tableOf(device, first);
        first = lut.info();
        size_t bytes = 0;
        check(pelLutGetSize(lut.get(), entry.encoding, &bytes));
        texels.resize(bytes);
        check(pelLutRead(lut.get(), entry.encoding, texels.data(), bytes, nullptr));
    } else {
        const auto [width, height] = lutSize(first);
        texels.resize(tables.size() * width * height * (entry.encoding == PEL_LUT_HALF ? 6 : 12));
        Lut::readStack(device, tables, entry.encoding, texels.data(), texels.size());
    }
    return encodeLutExr(first, entry.encoding, texels, entry.key, uint32_t(tables.size()));
}

std::string batchIndexName(const std::string& manifestPath) {
    return std::filesystem::path(manifestPath).stem().string() + ".index.json";
}

std::string batchIndex(const BatchManifest& manifest, const std::string& manifestPath,
                       const std::vector<bool>& there) {
    size_t missing = 0;
    for (const BatchError& error : manifest.errors) missing += error.files;
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
