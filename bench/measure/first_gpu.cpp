// Judges the results of --first-gpu: pictures and operations by tolerances, passes by a roofline.
#include "measure.h"
#include "tolerances.h"

namespace pellucid::bench {
namespace {

using Json = nlohmann::ordered_json;

struct Tolerance {
    const char* part;  // of an operation's name
    double largest;    // error
};
// Of operations: those of the tests. The quadric is compared with the torus itself.
constexpr Tolerance operationTolerances[] = {{"normals", tolerance::normalComponent},
                                             {"uv-scale", tolerance::uvScale},
                                             {"curvature-edge", tolerance::edgeCurvature},
                                             {"curvature-tensor", tolerance::tensorCurvature},
                                             {"curvature-quadric", tolerance::torusExactNormals},
                                             {"table-arc", tolerance::lutTexelGaussians},
                                             {"table-ring", tolerance::lutTexelGaussians},
                                             {"table-half-ring", tolerance::lutTexelGaussians},
                                             {"table-sphere", tolerance::lutTexelGaussians},
                                             {"table-shadow", tolerance::lutTexelGaussians},
                                             {"table-specular", tolerance::lutTexelOther},
                                             {"shade-surface", tolerance::shadeSum},
                                             {"shade-32-taps", tolerance::shadeSum},
                                             {"shade-eye", tolerance::shadeSum}};
// Tolerances of pictures, share of white: at nine of ten drawn pixels, and RMS. Rounding may change which
// samples a pixel takes. Between the compilers of PoCL and Intel the largest error of all is 1.1e-6.
constexpr double pictureP90 = 3e-5, pictureRms = 5e-4;

// NAN: it is not judged.
double toleranceOf(const Json& e) {
    const std::string name = e.at("name"), group = e.at("group");
    if (group == "pictures") return pictureP90;
    if (group == "frames") return NAN;
    const auto* const found = std::ranges::find_if(
        operationTolerances, [&](const Tolerance& t) { return name.find(t.part) != name.npos; });
    return found == std::end(operationTolerances) ? NAN : found->largest;
}
bool isWithin(const Json& e, double tolerance) {
    const auto below = [&](const char* key, double limit) {
        return e.at(key).is_number() && e.at(key).get<double>() <= limit;
    };
    if (e.at("group") != "pictures") return below("error_max", tolerance);
    return below("error_p90", tolerance) && below("error_rms", pictureRms) && e.at("repeats").get<bool>();
}

// The factor on a kernel's counted work for `pixels` times the counted pixels, one light in place of two, and
// its map.
double workOf(const std::string& kernel, double pixels, double countedMap) {
    if (kernel == "light_texels" || kernel == "light_reduce") return std::pow(2048 / countedMap, 2) / 2;
    for (const char* ofLight : {"wide_shadow", "light_seen", "light_hidden", "light_classify"})
        if (kernel == ofLight) return pixels / 2;
    return pixels;
}

// Of a pass, by the name of its kernel; other kernels of a method are those of its own pass.
std::string passOf(const std::string& kernel, const std::string& method) {
    if (kernel == "make_irradiance") return "irradiance";
    for (const char* shared : {"classify_tiles", "wide_shadow", "mean_curvature", "shade"})
        if (kernel == shared) return kernel;
    return "scatter_" + (method == "auto" ? "screen" : method);
}

// Milliseconds that a pass of this name takes for so many pixels of skin under a light with a map, and what
// limits it.
void predict(Json& pass, const Json& row, const Json& device, const Json& warps) {
    constexpr double memoryShare = 0.8, arithmeticShare = 0.5;  // as docs/roofline.md
    // The share of a kernel's counted instructions that remains after compilation, estimated from the
    // operations that docs/roofline.md counts for two passes. A simulated V100 took 1.1 to 1.6 times as long
    // for wide_shadow, light_hidden and shade.
    constexpr double instructionsLeft = 0.3;
    const Json &copies = device.at("copy_bytes_per_second"), &peak = device.at("operations_per_second");
    const Json& methods = warps.at("methods");
    std::string method = row.at("method");
    pass["predicted_ms"] = nullptr;
    // Counted at full rate.
    const std::string name = pass.at("name"), setting = row.at("setting");
    if (name.starts_with("scatter_") && setting.ends_with("half rate")) return;
    if (method == "Lambert") method = "none";
    // The counts of `shade` by tables stand for all methods; passes before it are the same for all.
    if (!methods.contains(method)) {
        if (name == "shade" || name == "irradiance") return;
        method = "auto";
    }
    int width = 0, height = 0;
    std::sscanf(warps.at("part").get<std::string>().c_str(), "%dx%d", &width, &height);
    const double pixels = row.at("items").get<double>() / (double(width) * height);
    double bytes = 0, slots = 0;
    for (const auto& [kernel, counted] : methods.at(method).items()) {
        if (passOf(kernel, method) != name) continue;
        const double work = workOf(kernel, pixels, warps.at("map").get<double>());
        bytes += work * counted.at("moved").get<double>();
        slots += work * counted.at("slots").get<double>();
    }
    if (bytes == 0 || !copies.is_number() || !peak.is_number()) return;
    // An instruction is as long as a multiply-add, which is two operations.
    const double memory = bytes / (memoryShare * copies.get<double>()),
                 arithmetic = 2 * instructionsLeft * slots / (arithmeticShare * peak.get<double>());
    pass["predicted_ms"] = 1e3 * std::max(memory, arithmetic);
    pass["limited_by"] = memory > arithmetic ? "memory" : "arithmetic";
}

}  // namespace

std::vector<std::string> judgedCases() {
    std::vector<std::string> names;
    for (const Tolerance& t : operationTolerances) names.emplace_back(t.part);
    return names;
}

void judgeFirst(Json& device, const Json& warps) {
    size_t checked = 0;
    Json out = Json::array();
    for (Json& e : device.at("operations")) {
        if (e.contains("failed")) out.push_back(e.at("name"));
        if (e.contains("passes"))
            for (Json& pass : e["passes"]) predict(pass, e, device, warps);
        const double tolerance = toleranceOf(e);
        if (std::isnan(tolerance) || e.contains("failed")) continue;
        e["tolerance"] = tolerance;
        e["within"] = isWithin(e, tolerance);
        ++checked;
        if (!e["within"].get<bool>()) out.push_back(e.at("name"));
    }
    device["first_gpu"] = {{"checked", checked}, {"out", out}};
}

}  // namespace pellucid::bench
