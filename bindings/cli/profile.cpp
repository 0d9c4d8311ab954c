// pellucid profile list|show|plot|fit: diffusion profiles, built in or from TOML files. Needs no device.
#include "command.h"
#include "io/atomic_file.h"
#include "io/image/image_file.h"
#include "io/image/picture.h"
#include "io/lut/profile_file.h"
#include "io/shortest.h"
#include "profile_fit/profile_fit.h"

namespace pellucid::cli {
namespace {

constexpr int nameWidth = 14;  // of what is printed

struct ProfileArguments {
    std::string name, output;
    int gaussians = 6;
    bool json = false;
};

nlohmann::ordered_json described(const io::ProfileFile& file) {
    const PelProfileInfo info = file.profile.info();
    nlohmann::ordered_json out;
    out["name"] = file.name;
    out["kind"] = file.kind;
    out["source"] = file.source;
    out["radius_mm"] = info.radius;
    out["width_mm"] = info.width;
    out["normal_blend"] = info.normalBlend;
    out["gaussians"] = info.gaussians;
    out["singular"] = info.singular != 0;
    return out;
}

void list(const ProfileArguments& a) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const std::string& name : Profile::libraryNames()) all.push_back(described(io::findProfile(name)));
    if (a.json) return printJson({{"profiles", all}});
    std::printf("%-12s %-8s %9s  %-26s %s\n", "name", "kind", "radius mm", "width mm (R, G, B)", "source");
    for (const auto& p : all)
        std::printf("%-12s %-8s %9.3f  %8.3f %8.3f %8.3f %s\n", p["name"].get<std::string>().c_str(),
                    p["kind"].get<std::string>().c_str(), p["radius_mm"].get<double>(),
                    p["width_mm"][0].get<double>(), p["width_mm"][1].get<double>(),
                    p["width_mm"][2].get<double>(), p["source"].get<std::string>().c_str());
}

void show(const ProfileArguments& a) {
    const io::ProfileFile file = io::findProfile(a.name);
    nlohmann::ordered_json report = described(file);
    const double radius = report["radius_mm"].get<double>();
    std::vector<double> at;
    for (double f : {0.01, 0.03, 0.1, 0.3, 1.0, 2.0, 4.0}) at.push_back(f * radius);
    const auto radial = file.profile.radial(at), lineSpread = file.profile.lineSpread(at);
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (size_t i = 0; i < at.size(); ++i)
        rows.push_back(
            {{"distance_mm", at[i]},
             {"radial_per_mm2", {radial[3 * i], radial[3 * i + 1], radial[3 * i + 2]}},
             {"line_spread_per_mm", {lineSpread[3 * i], lineSpread[3 * i + 1], lineSpread[3 * i + 2]}}});
    if (a.json) {
        report["values"] = rows;
        printJson(report);
        return;
    }
    printReport(report, false, nameWidth);
    std::printf("\n%12s  %-35s %s\n", "d mm", "R per mm^2", "P per mm");
    for (size_t i = 0; i < at.size(); ++i)
        std::printf("%12.4g  %11.4g %11.4g %11.4g %11.4g %11.4g %11.4g\n", at[i], radial[3 * i],
                    radial[3 * i + 1], radial[3 * i + 2], lineSpread[3 * i], lineSpread[3 * i + 1],
                    lineSpread[3 * i + 2]);
}

// Six decades of R and P against distance up to four radii, with a logarithmic vertical axis.
void plot(const ProfileArguments& a) {
    checkOutput(a.output, {"png"});
    const io::ProfileFile file = io::findProfile(a.name);
    constexpr int width = 900, height = 560, left = 70, top = 40, right = 20, bottom = 60;
    constexpr double decades = 6;
    io::Picture picture(width, height, io::Srgb8{18, 18, 20});
    const double radius = file.profile.info().radius, furthest = 4 * radius;
    std::vector<double> at;
    for (int x = left; x < width - right; ++x)
        at.push_back(furthest * (x - left + 0.5) / (width - right - left));
    const io::Srgb8 colors[3] = {{230, 90, 80}, {90, 200, 110}, {90, 140, 240}}, grey{110, 110, 110},
                    white{230, 230, 230};
    for (int view = 0; view < 2; ++view) {
        const auto values = view ? file.profile.lineSpread(at) : file.profile.radial(at);
        const double peak = *std::max_element(values.begin(), values.end());
        for (int c = 0; c < 3; ++c) {
            int before = -1;
            for (size_t i = 0; i < at.size(); ++i) {
                const double level = std::log10(std::max(values[3 * i + c], 1e-300) / peak) / decades;
                const int y = top + int(std::min(1.0, -level) * (height - top - bottom));
                const int from = before < 0 ? y : std::min(before, y),
                          to = before < 0 ? y : std::max(before, y);
                // R as a full line, P as a dashed one
                if (level > -1 && (view == 0 || i / 8 % 2 == 0))
                    for (int p = from; p <= to; ++p) picture.paint(left + int(i), p, colors[c]);
                before = y;
            }
        }
    }
    for (int y = top; y <= height - bottom; ++y) picture.paint(left, y, grey);
    for (int x = left; x < width - right; ++x) picture.paint(x, height - bottom, grey);
    for (int d = 0; d <= int(decades); ++d)
        picture.write(10, top + d * (height - top - bottom) / int(decades) - 7, io::concat("1e-", d), grey,
                      2);
    for (int i = 0; i <= 4; ++i)
        picture.write(left + i * (width - right - left) * 24 / 100, height - bottom + 10,
                      io::printed("%.3g", i * radius), grey, 2);
    picture.write(left, 12, file.name + ": R full, P dashed, of their peaks; distance in mm", white, 2);
    io::writeImage8(a.output, width, height, 3, picture.rgb);
    printReport({{"name", file.name}, {"output", a.output}}, a.json, nameWidth);
}

void fit(const ProfileArguments& a) {
    if (!a.output.empty()) checkOutput(a.output, {"toml"}, {a.name});
    const io::ProfileFile file = io::findProfile(a.name);
    const io::ProfileFit best = io::fitGaussians(file.profile, a.gaussians);
    nlohmann::ordered_json report{{"name", file.name}, {"gaussians", nlohmann::ordered_json::array()}};
    for (const PelGaussian& g : best.gaussians)
        report["gaussians"].push_back({{"variance_mm2", g.variance}, {"weight", g.weight}});
    report["relative_error"] = best.error;
    const std::string text = io::profileText(
        best, io::concat(file.name, "-", a.gaussians, "-gaussians"),
        io::concat("sum of ", a.gaussians, " Gaussians fitted to the line spread of ", file.name));
    if (!a.output.empty()) {
        io::writeWholeFile(a.output, text);
        report["output"] = a.output;
    }
    if (a.json)
        printJson(report);
    else
        std::printf("%s# relative error of the line spread, R G B: %.3g %.3g %.3g\n", text.c_str(),
                    best.error[0], best.error[1], best.error[2]);
}

}  // namespace

void addProfile(CLI::App& app) {
    CLI::App* profile =
        app.add_subcommand("profile", "Diffusion profiles: what materials there are and how they scatter");
    profile->require_subcommand(1);
    auto a = std::make_shared<ProfileArguments>();
    auto add = [&](const char* name, const char* what, void (*run)(const ProfileArguments&), bool named) {
        CLI::App* command = profile->add_subcommand(name, what);
        if (named)
            option(*command, "name", a->name, "a material of the library or a .toml file", Word{profileWord},
                   required);
        option(*command, "--json", a->json, "one JSON object on stdout");
        command->callback([a, run] { run(*a); });
        return command;
    };
    add("list", "The library of materials", list, false);
    add("show", "Widths, normal blend factors and values of one profile", show, true);
    add("plot", "Draws R and P", plot, true)
        ->add_option("-o,--output", a->output, ".png to write")
        ->required();
    CLI::App* fitting = add("fit", "The best sum of K Gaussians", fit, true);
    option(*fitting, "--gaussians", a->gaussians, "how many", inRange(1, 12), shown);
    option(*fitting, "-o,--output", a->output, "profile file (.toml) to write");
    addSkin(*profile);
}

}  // namespace pellucid::cli
