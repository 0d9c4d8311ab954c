#include "shading/time_budget.h"

#include <bit>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

#include "shading/features.h"
#include "shading/image_slots.h"

namespace pel {
namespace {

// Two cores of an AMD EPYC with PoCL (bench/results/pocl-3.1-amd-epyc.json). Errors: over all scenes. Times:
// with these, 77 of that report's 80 frames kept their budget; for light, the 90th percentile of scenes.
constexpr TunedSetting guessed[] = {{PEL_SCATTERING_NONE, 0, 0, 0, 0.14},
                                    {PEL_SCATTERING_PREINTEGRATED, 0, 79, 0, 0.09},
                                    {PEL_SCATTERING_AUTO, 0.002, 122, 0, 0.0194},
                                    {PEL_SCATTERING_LIGHT, 0, 2612, 0, 0.0183, true},
                                    {PEL_SCATTERING_LIGHT, 0, 8508, 0, 0.0184}};
// Speed of that device: cores, lanes, and MHz from bench/results/pocl-3.1-amd-epyc.json.
constexpr double guessedLanes = 2 * 16 * 2596.0;

constexpr size_t mostSettings = 64;
constexpr const char* halfRateLight = "light-half";  // in records

// Number of lanes that compute at once, times their clock.
double lanesOf(const PelDeviceInfo& device) {
    const double width = device.type == PEL_DEVICE_GPU ? 64 : std::max(1u, device.mathWidth);
    return width * std::max(1u, device.computeUnits) * std::max(1u, device.clockMhz);
}

std::string readTuning(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::string bytes(mostTuningBytes + 1, '\0');
    file.read(bytes.data(), std::streamsize(bytes.size()));
    if (file.bad() || file.gcount() <= 0) invalidArgument("PELLUCID_TUNING: ", path, " cannot be read");
    bytes.resize(size_t(file.gcount()));
    if (bytes.size() > mostTuningBytes)
        invalidArgument("PELLUCID_TUNING: ", path, " has more than ", mostTuningBytes, " bytes");
    return bytes;
}

}  // namespace

Tuning tuningOf(const PelDeviceInfo& device) {
    Tuning tuning;
    const char* const variable = std::getenv("PELLUCID_TUNING");
    const char* const path = variable && std::strcmp(variable, "off") != 0 ? variable : nullptr;
    bool here = false;
    std::istringstream file(path && *path ? readTuning(path) : tuningHeader);
    size_t number = 0;
    for (std::string line; std::getline(file, line);) {
        const auto damaged = [&](auto&&... why) {
            invalidArgument("PELLUCID_TUNING: ", path, ", line ", number, ": ", why...);
        };
        ++number;
        if (line.ends_with('\r')) line.pop_back();
        if (number == 1 && line != tuningHeader)
            damaged("\"", tuningHeader, "\" must be here: `pellucid bench` writes such records");
        if (number == 1 || line.empty() || line[0] == '#' || line.starts_with("launch ")) continue;
        if (line.starts_with("device ")) {
            here = !tuning.own && line == deviceLine(device);
            tuning.own |= here;
            continue;
        }
        std::istringstream words(line);
        words.imbue(std::locale::classic());
        std::string method, rest;
        TunedSetting s{};
        if (!(words >> method >> s.targetError >> s.perPixel >> s.perFrame >> s.error) || words >> rest)
            damaged("a method and four numbers are needed");
        constexpr PelScattering known[] = {PEL_SCATTERING_NONE, PEL_SCATTERING_PREINTEGRATED,
                                           PEL_SCATTERING_AUTO, PEL_SCATTERING_LIGHT};
        s.halfRate = method == halfRateLight;
        if (s.halfRate) method = scatteringName(PEL_SCATTERING_LIGHT);
        const auto* const named = std::ranges::find(known, method, scatteringName);
        if (named == std::end(known))
            damaged("\"", method, "\" is not one of none, preintegrated, auto, light and ", halfRateLight);
        s.method = *named;
        for (const double v : {s.targetError, s.perPixel, s.perFrame, s.error})
            if (!(v >= 0 && v <= 1e9)) damaged(v, " is not between 0 and 1e9");
        if (s.targetError > 1 || s.error > 1) damaged("errors are shares of white, from 0 to 1");
        if (here) tuning.settings.push_back(s);
        if (tuning.settings.size() > mostSettings) damaged("more than ", mostSettings, " settings");
    }
    if (!tuning.settings.empty()) return tuning;
    tuning.own = false;
    tuning.settings.assign(std::begin(guessed), std::end(guessed));
    for (TunedSetting& s : tuning.settings)
        s.perPixel *= guessedLanes / lanesOf(device), s.perFrame *= guessedLanes / lanesOf(device);
    return tuning;
}

// The id as kernels read it (lib/image/image.clh, loadId); 0 for values that are not ids.
static uint32_t idOf(const unsigned char* pixel, const FormatInfo& format) {
    uint32_t bits = 0;
    for (uint32_t b = 0; b < format.componentBytes; ++b) bits |= uint32_t(pixel[b]) << 8 * b;
    if (format.kind != FormatKind::FLOAT) return bits;
    double value;
    if (format.componentBytes == sizeof(float)) {
        value = std::bit_cast<float>(bits);
    } else {
        const int exponent = int(bits >> 10);  // with the sign
        value = exponent ? std::ldexp(1024 + (bits & 1023), exponent - 25) : 0;
    }
    return value >= 0 && value <= 255 ? uint32_t(value) : 0;
}

// Number of pixels of these materials; all pixels of the frame if the image shows none of them yet.
static uint64_t pixelsOf(const std::vector<uint32_t>& ids, const ShaderState& state, Device& device) {
    const ImageView& frame = state.images[PEL_SLOT_RADIANCE];
    const uint64_t all = uint64_t(frame.width) * frame.height;
    const ImageView& image = state.images[PEL_SLOT_MATERIAL];
    if (!image) return all;
    std::vector<unsigned char> bytes(image.byteEnd() - image.byteOffset);
    device.read(image.memory().get(), image.byteOffset, bytes.size(), bytes.data(), true);
    uint64_t count = 0;
    for (uint32_t y = 0; y < image.height; ++y)
        for (uint32_t x = 0; x < image.width; ++x) {
            const unsigned char* const pixel = &bytes[y * image.rowStride + x * image.pixelStride];
            count += std::ranges::binary_search(ids, idOf(pixel, image.info()));
        }
    return count ? count : all;
}

TakenSetting keepToBudget(ShaderState& state, uint32_t methods, Device& device, uint64_t& pixels,
                          std::string& warnings) {
    std::vector<uint32_t> ids;
    bool thin = false, full = false;  // materials whose method is given as light keep their rate
    for (const auto& [id, m] : state.materials) {
        full |= m.given.scattering == PEL_SCATTERING_LIGHT;
        if (m.given.scattering == PEL_SCATTERING_AUTO && m.params.scattering == PEL_SCATTERING_SCREEN &&
            m.params.scatterTaps == 0)
            ids.push_back(id), thin |= m.params.thinThickness > 0;
    }
    if (ids.empty()) return {};
    const ImageView& frame = state.images[PEL_SLOT_RADIANCE];
    const Tuning tuning = tuningOf(device.info());
    const bool given = bool(state.images[PEL_SLOT_IRRADIANCE]);
    const auto possible = [&](const TunedSetting& s) {
        if (s.method == PEL_SCATTERING_LIGHT)
            return (methods >> s.method & 1) && lightIsMapped(state) && !given &&
                   (s.halfRate ? !full || state.options.halfRate : !state.options.halfRate);
        return s.method != PEL_SCATTERING_PREINTEGRATED || (!thin && !given);
    };
    if (!pixels) pixels = pixelsOf(ids, state, device);
    const double all = double(frame.width) * double(frame.height), budget = state.options.timeBudget;
    const auto time = [&](const TunedSetting& s) {
        return 1e-6 * (s.perPixel * double(pixels) + s.perFrame * all);
    };
    const auto faster = [&](const TunedSetting& a, const TunedSetting& b) { return time(a) < time(b); };
    std::vector<TunedSetting> open;
    std::ranges::copy_if(tuning.settings, std::back_inserter(open), possible);
    if (open.empty()) open.push_back({PEL_SCATTERING_NONE, 0, 0, 0, 1});
    TunedSetting taken = *std::ranges::min_element(open, faster);
    if (time(taken) > budget) {
        warnings += text(warnings.empty() ? "" : "\n", "PelShaderOptions.timeBudget is ", budget,
                         " ms, but the fastest possible method takes ", time(taken), " ms");
    } else {
        // The fastest of the settings whose error cannot be told from the smallest.
        constexpr double alike = 1.02;
        std::erase_if(open, [&](const TunedSetting& s) { return time(s) > budget; });
        const double best = std::ranges::min(open, {}, &TunedSetting::error).error;
        std::erase_if(open, [&](const TunedSetting& s) { return s.error > alike * best; });
        taken = *std::ranges::min_element(open, faster);
    }
    for (const uint32_t id : ids) {
        PelMaterial& m = state.materials.at(id).params;
        m.scattering = taken.method == PEL_SCATTERING_AUTO ? PEL_SCATTERING_SCREEN : taken.method;
    }
    if (taken.method == PEL_SCATTERING_AUTO)
        state.options.targetError = std::max(state.options.targetError, float(taken.targetError));
    return {state.options.targetError, time(taken), taken.error, tuning.own, taken.halfRate};
}

}  // namespace pel
