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
    constexpr size_t ahead = 16;  // tables on the queue before the thread waits: of more, queues grow slow
    const size_t count = entry.tables.size();
    PelLutInfo first{};
    std::string texels;
    std::vector<Lut> luts;
    for (size_t i = 0; i < count; ++i) {
        luts.push_back(submitted(device, entry.tables[i].filled()));
        if (luts.size() < ahead && i + 1 < count) continue;
        size_t bytes = 0;
        check(pelLutGetSize(luts[0].get(), entry.encoding, &bytes));
        if (texels.empty()) first = luts[0].info(), texels.resize(bytes * count);
        Event last;  // the queue is in order
        PelError failed = PEL_SUCCESS;
        for (size_t k = 0; k < luts.size() && !failed; ++k) {
            PelEvent done = nullptr;
            const PelSubmit reading{nullptr, 0, &done};
            failed = pelLutRead(luts[k].get(), entry.encoding, &texels[bytes * (i + 1 - luts.size() + k)],
                                bytes, &reading);
            if (!failed) last = Event(done);
        }
        if (last) last.wait();  // also where one failed, for the others write to the texels
        check(failed);
        luts.clear();
    }
    return encodeLutExr(first, entry.encoding, texels, entry.key, uint32_t(count));
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
