// pellucid profile skin, and profile pigments: skin by what it is made of. Needs no device.

#include "command.h"
#include "fields/field_ranges.h"
#include "io/atomic_file.h"
#include "io/image/image_file.h"
#include "io/image/picture.h"
#include "io/shortest.h"

namespace pellucid::cli {
namespace {

constexpr int skinNameWidth = 26;  // of what is printed

struct SkinArguments {
    PelSkin skin = pelSkinDefaults();
    std::string output, plot, input;
    std::vector<std::string> channels{"R", "G", "B"};
    bool json = false;
};

// An option for each field; for melanin and blood only with `pigments`.
void addFields(CLI::App& command, SkinArguments& a, bool pigments) {
    const auto add = [&](std::string key, float& value, pel::FieldRange range, std::string unit,
                         std::string words) {
        if (!pigments && (key == "melanin" || key == "blood")) return;
        std::ranges::replace(key, '_', '-');
        option(command, ("--" + key).c_str(), value, words + (unit.empty() ? "" : ", " + unit),
               inRange(double(range.min), double(range.max)), shown);
    };
#define ADD(type, name, value, min, max, special, unit, key, slider, words) \
    add(key, a.skin.name, pel::range::skin::name, unit, words);
    PEL_EACH_SKIN_FIELD(ADD)
#undef ADD
}

std::string fileText(const SkinArguments& a) {
    std::string text = "name = \"skin\"\nkind = \"skin\"\nsource = \"pellucid profile skin\"\n";
    const auto add = [&](const char* key, float value) { text += io::printed("%s = %.9g\n", key, value); };
#define ADD(type, name, value, min, max, special, unit, key, ...) add(key, a.skin.name);
    PEL_EACH_SKIN_FIELD(ADD)
#undef ADD
    return text;
}

// Reflectance over wavelength, with the maxima of oxyhaemoglobin marked, beside the colour.
void plotSpectrum(const SkinArguments& a, const PelSkinInfo& info) {
    constexpr int width = 900, height = 560, left = 80, top = 50, right = 240, bottom = 60;
    constexpr float first = 380, last = 720;
    std::vector<float> at, values(width - left - right);
    for (size_t i = 0; i < values.size(); ++i)
        at.push_back(first + (last - first) * float(i) / float(values.size() - 1));
    check(pelSkinReflectance(&a.skin, at.data(), uint32_t(at.size()), values.data()));
    const float highest = std::ceil(10 * *std::ranges::max_element(values)) / 10;
    const io::Srgb8 white{230, 230, 230}, grey{110, 110, 110}, red{230, 90, 80};
    io::Picture picture(width, height, io::Srgb8{18, 18, 20});
    const auto across = [&](float nm) {
        return left + int((nm - first) / (last - first) * float(values.size() - 1));
    };
    const auto up = [&](float r) {
        return height - bottom - int(r / highest * float(height - top - bottom));
    };
    for (const float nm : {542.0f, 577.0f}) {
        for (int y = top; y < height - bottom; y += 4) picture.paint(across(nm), y, red);
        picture.write(across(nm) - 14, top - 20, std::to_string(int(nm)), red, 2);
    }
    for (int x = left; x < width - right; ++x) picture.paint(x, height - bottom, grey);
    for (int y = top; y <= height - bottom; ++y) picture.paint(left, y, grey);
    for (int nm = 400; nm <= 700; nm += 100)
        picture.write(across(float(nm)) - 18, height - bottom + 10, std::to_string(nm), grey, 2);
    for (int i = 0; i <= 4; ++i)
        picture.write(14, up(highest * float(i) / 4) - 8, io::printed("%.3g", double(highest) * i / 4), grey,
                      2);
    for (size_t i = 0; i + 1 < values.size(); ++i) {
        const int y = up(values[i]), next = up(values[i + 1]);
        for (int p = std::min(y, next); p <= std::max(y, next); ++p)
            for (int thick = 0; thick < 2; ++thick) picture.paint(left + int(i), p + thick, white);
    }
    picture.write(left, 8, "reflectance over wavelength, nm", white, 2);
    io::Srgb8 color{};
    for (int c = 0; c < 3; ++c)
        color[c] = uint8_t(std::lround(255 * std::clamp(io::encodeSrgb(info.albedo[c]), 0.0f, 1.0f)));
    for (int y = top; y < top + 160; ++y)
        for (int x = width - right + 20; x < width - 20; ++x) picture.paint(x, y, color);
    const auto line = [&](int row, const char* format, double value) {
        picture.write(width - right + 20, top + 180 + 24 * row, io::printed(format, value), white, 2);
    };
    line(0, "melanin %.3g", a.skin.melanin);
    line(1, "blood %.3g", a.skin.blood);
    line(2, "oxygenation %.3g", a.skin.oxygenation);
    line(3, "epidermis %.3g mm", a.skin.epidermis);
    line(5, "L* %.1f", info.lab[0]);
    line(6, "a* %.1f", info.lab[1]);
    line(7, "b* %.1f", info.lab[2]);
    line(8, "ITA %.0f degrees", info.typologyAngle);
    io::writeImage8(a.plot, width, height, 3, picture.rgb);
}

void skin(const SkinArguments& a) {
    if (!a.output.empty()) checkOutput(a.output, {"toml"});
    if (!a.plot.empty()) checkOutput(a.plot, {"png"});
    const PelSkinInfo info = skinInfo(a.skin);
    nlohmann::ordered_json out;
    out["albedo"] = info.albedo;
    out["mean_free_path_mm"] = info.meanFreePath;
    out["single_scattering_albedo"] = info.singleScatteringAlbedo;
    out["mean_distance_mm"] = info.meanDistance;
    out["profile_error"] = info.profileError;
    out["lab"] = info.lab;
    out["typology_angle_degrees"] = info.typologyAngle;
    if (!a.plot.empty()) {
        plotSpectrum(a, info);
        out["plot"] = a.plot;
    }
    if (!a.output.empty()) {
        io::writeWholeFile(a.output, fileText(a));
        out["output"] = a.output;
    }
    printReport(out, a.json, skinNameWidth);
}

void pigments(const SkinArguments& a) {
    checkOutput(a.output, {"exr"}, {a.input});
    Progress progress;
    const io::Image image = io::readImage(a.input);
    std::vector<float> albedo = image.interleaved(a.channels);
    // Files of 8 bits hold sRGB.
    if (io::extensionOf(a.input) != "exr")
        for (float& v : albedo) v = io::decodeSrgb(v);
    const size_t count = image.pixelCount();
    std::vector<float> maps[3];
    for (auto& map : maps) map.resize(count);
    constexpr size_t piece = 1 << 12;
    for (size_t i = 0; i < count; i += piece) {
        progress(double(i) / double(count), "pigments");
        check(pelSkinFromAlbedo(&a.skin, &albedo[3 * i], std::min(piece, count - i), &maps[0][i], &maps[1][i],
                                &maps[2][i]));
    }
    progress(1, "pigments");
    io::Image result;
    result.width = image.width;
    result.height = image.height;
    std::vector<float> differences = maps[2];
    std::ranges::sort(differences);
    const auto at = [&](double part) { return differences[size_t(part * double(count - 1))]; };
    const auto above = differences.end() - std::ranges::upper_bound(differences, 1.0f);
    constexpr const char* names[] = {"melanin", "blood", "difference"};
    for (int i = 0; i < 3; ++i)
        result.channels.push_back({names[i], io::ChannelType::Float, std::move(maps[i])});
    io::writeExr(a.output, result);
    printReport({{"output", a.output},
                 {"delta_e_median", at(0.5)},
                 {"delta_e_p90", at(0.9)},
                 {"delta_e_p99", at(0.99)},
                 {"delta_e_max", at(1)},
                 {"share_above_1", double(above) / double(count)}},
                a.json, skinNameWidth);
}

}  // namespace

void addSkin(CLI::App& profile) {
    auto [command, a] = subcommand<SkinArguments>(
        profile, "skin", "Skin by what it is made of: colour, lengths, spectrum", skin);
    addFields(command, a, true);
    option(command, "--plot", a.plot, "spectrum and colour as a picture (.png)");
    option(command, "-o,--output", a.output, "profile file (.toml) to write");
    option(command, "--json", a.json, "one JSON object on stdout");
    auto [maps, b] = subcommand<SkinArguments>(profile, "pigments",
                                               "Maps of melanin and blood from an albedo map", pigments);
    option(maps, "albedo", b.input, "picture: linear if .exr, else sRGB", required);
    option(maps, "--channels", b.channels, "of the albedo", Count{3}, Word{"NAME"}, shown);
    addFields(maps, b, false);
    option(maps, "-o,--output", b.output,
           ".exr to write: melanin, blood, and the difference that remains (CIEDE2000)", required);
    option(maps, "--json", b.json, "one JSON object on stdout");
}

}  // namespace pellucid::cli
