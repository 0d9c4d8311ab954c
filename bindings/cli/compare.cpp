// pellucid compare: how far two pictures are apart. Needs no device.

#include "command.h"
#include "io/atomic_file.h"
#include "io/image/flip.h"
#include "io/image/image_compare.h"
#include "io/image/picture.h"
#include "io/image/tone_map.h"
#include "io/scene/scene_file.h"

namespace pellucid::cli {
namespace {

struct CompareArguments {
    std::string a, b, secondHalf, channelsA, channelsB, gbuffer, scene, picture;
    float scaleA = 1, scaleB = 1, exposure = 1, maxRmse = INFINITY, unit = 0;
    uint32_t light = 0;
    bool json = false;
};

// RGB per pixel, linear; or per vertex of a mesh, in one row.
struct Rgb {
    int width = 0, height = 0;
    bool vertices = false;
    std::vector<float> values;
    // Empty unless the file has them. secondHalf: another estimate of `values`, as noisy.
    std::vector<float> secondHalf, alpha, irradiance, meanCurvature, thickness, meanFreePath;
};

// Of both halves, if there are two.
void takeMean(Rgb& picture) {
    for (size_t i = 0; i < picture.secondHalf.size(); ++i)
        picture.values[i] = (picture.values[i] + picture.secondHalf[i]) / 2;
    picture.secondHalf.clear();
}

std::vector<std::string> layerOf(const std::string& layer) {
    if (layer.empty()) return {"R", "G", "B"};
    return {layer + ".R", layer + ".G", layer + ".B"};
}

// The halves of a walk are read of a `reference`; of another picture, their mean.
Rgb readRgb(const std::string& path, const std::string& layer, float scale, bool reference) {
    Rgb out;
    const std::string extension = io::extensionOf(path);
    if (extension == "npy") {
        const io::NpyArray array = io::readNpy(path);
        auto s = array.shape;
        // As `reference` writes them: (vertices, 3), and of a walk (2, vertices, 3).
        const bool walk = s.size() == 3 && s[0] == 2 && s[2] == 3;
        out.vertices = walk || (s.size() == 2 && s[1] == 3);
        if (out.vertices) s = {1, s[walk], 3};
        if (!(s.size() == 2 || (s.size() == 3 && (s[2] == 1 || s[2] == 3))) || s[0] * s[1] == 0)
            throw io::FileError(
                path,
                "is not a picture: an array of height x width, or with 1 or 3 channels, is needed; or "
                "of values at vertices, n x 3");
        out.height = int(s[0]), out.width = int(s[1]);
        const size_t channels = s.size() == 3 ? s[2] : 1;
        for (size_t i = 0; i < s[0] * s[1]; ++i)
            for (size_t c = 0; c < 3; ++c)
                out.values.push_back(array.values[i * channels + (channels == 3 ? c : 0)]);
        if (walk) {
            out.secondHalf.assign(array.values.end() - ptrdiff_t(out.values.size()), array.values.end());
            if (!reference) takeMean(out);
        }
    } else {
        const io::Image image = io::readImage(path);
        out.width = image.width, out.height = image.height;
        std::vector<std::string> names = layerOf(layer);
        if (layer.empty() && !image.has("R"))
            names.assign(3, image.channels.size() == 1 ? image.channels[0].name : image.has("Y") ? "Y" : "R");
        if (reference && layer.empty() && image.has("First.R") && image.has("Second.R")) {
            names = layerOf("First");
            out.secondHalf = image.interleaved(layerOf("Second"));
        }
        out.values = image.interleaved(names);
        if (image.has("A")) out.alpha = image.channel("A").pixels;
        if (image.has("Irradiance.R")) out.irradiance = image.interleaved(layerOf("Irradiance"));
        if (image.has("MeanCurvature") && image.has("Thickness") && image.has("MeanFreePath.R")) {
            out.meanCurvature = image.channel("MeanCurvature").pixels;
            out.thickness = image.channel("Thickness").pixels;
            const std::vector<float> paths = image.interleaved(layerOf("MeanFreePath"));
            for (size_t i = 0; i < paths.size(); i += 3)
                out.meanFreePath.push_back(std::max({paths[i], paths[i + 1], paths[i + 2]}));
        }
        if (extension != "exr")  // 8-bit files hold what a screen shows
            for (float& v : out.values) v = io::decodeSrgb(v);
    }
    for (auto* values : {&out.values, &out.secondHalf})
        for (float& v : *values) v *= scale;
    return out;
}

// The shape of an NPY array has the height first, so "8 x 9" would be ambiguous.
std::string sizeText(const auto& picture) {
    return io::concat(picture.width, " wide and ", picture.height, " high");
}

void requireSameSize(const std::string& pathA, const Rgb& a, const std::string& pathB, const Rgb& b) {
    if (a.width == b.width && a.height == b.height) return;
    throw InputError(pathA + " is " + sizeText(a) + ", " + pathB + " is " + sizeText(b) +
                     "; only pictures of the same size can be compared");
}

// The sub-sets of each pixel, for the light that --light names. Clears `mask` where there is no material.
std::vector<uint8_t> subsets(const CompareArguments& a, const Rgb& one, const Rgb& two,
                             std::vector<uint8_t>& mask) {
    const io::SceneFile scene = io::readScene(a.scene);
    const io::Image gbuffer = io::readImage(a.gbuffer);
    if (gbuffer.width != one.width || gbuffer.height != one.height)
        throw io::FileError(a.gbuffer, "is " + sizeText(gbuffer) + ", the pictures are " + sizeText(one));
    if (scene.channels[PEL_SLOT_POSITION].empty())
        throw io::FileError(a.scene, "[channels] position is missing; sub-sets need it");
    if (a.light >= scene.lights.size())
        throw UsageError(io::concat("--light ", a.light, ": the scene has ", scene.lights.size(),
                                    " lights, counted from 0"));
    const io::SceneLight& light = scene.lights[a.light];
    const std::vector<float> positions = gbuffer.interleaved(scene.channels[PEL_SLOT_POSITION]);
    const auto& geometric = scene.channels[PEL_SLOT_NORMAL_GEOMETRIC];
    const std::vector<float> normals =
        gbuffer.interleaved(geometric.empty() ? scene.channels[PEL_SLOT_NORMAL_SHADING] : geometric);
    if (!scene.channels[PEL_SLOT_MATERIAL].empty()) {
        const std::vector<float> ids = gbuffer.interleaved(scene.channels[PEL_SLOT_MATERIAL]);
        for (size_t i = 0; i < mask.size(); ++i) mask[i] = mask[i] && ids[i] > 0;
    }
    std::vector<float> toLight(normals.size()), visible;
    for (size_t i = 0; i < mask.size(); ++i) {
        float d[3];
        for (int c = 0; c < 3; ++c)
            d[c] = light.light.type == PEL_LIGHT_DIRECTIONAL ? light.light.toLight[c]
                                                             : light.light.position[c] - positions[3 * i + c];
        const float length = std::hypot(d[0], d[1], d[2]);
        for (int c = 0; c < 3; ++c) toLight[3 * i + c] = length > 0 ? d[c] / length : 0;
    }
    // Visibility comes from the reference's irradiance, else from the host's own shadow.
    const std::vector<float>& irradiance = two.irradiance.empty() ? one.irradiance : two.irradiance;
    if (!irradiance.empty() && scene.lights.size() == 1 && !isLit(scene.ambient))
        for (size_t i = 0; i < mask.size(); ++i)
            visible.push_back(irradiance[3 * i] + irradiance[3 * i + 1] + irradiance[3 * i + 2] > 0);
    else if (!light.wideShadow.empty())
        visible = gbuffer.interleaved(std::vector<std::string>{light.wideShadow});
    else
        std::fprintf(stderr,
                     "warning: penumbra is empty: shadows are known of a reference's irradiance by one light "
                     "alone, without ambient light, or of the light's wide_shadow\n");
    return io::subsetsOf({one.width, one.height, positions, normals, toLight, visible, mask,
                          1 / (a.unit > 0 ? a.unit : scene.options.millimetresPerUnit), two.meanCurvature,
                          two.thickness, two.meanFreePath});
}

nlohmann::ordered_json toJson(const io::ImageDifference& d) {
    // JSON has neither Inf, the PSNR of equal pictures, nor NaN, statistics of no pixels: both are null.
    return {{"pixels", d.pixels},
            {"rmse", d.rmse},
            {"rmse_all", d.rmseAll},
            {"noise", d.noise},
            {"psnr", d.psnr},
            {"mean", d.mean},
            {"p99", d.p99},
            {"max", d.max},
            {"delta_e_mean", d.deltaEMean},
            {"delta_e_p99", d.deltaE99},
            {"delta_e_max", d.deltaEMax}};
}

void print(const std::string& name, const io::ImageDifference& d) {
    if (d.pixels == 0) {
        std::printf("%-11s        0 pixels   empty, nothing to compare\n", name.c_str());
        return;
    }
    std::printf(
        "%-11s %8zu pixels   RMSE %.6f %.6f %.6f   P99 %.5f %.5f %.5f   PSNR %.1f dB   CIEDE2000 mean %.3f, "
        "P99 %.2f\n",
        name.c_str(), d.pixels, d.rmse[0], d.rmse[1], d.rmse[2], d.p99[0], d.p99[1], d.p99[2], d.psnr,
        d.deltaEMean, d.deltaE99);
    if (d.noise[0] + d.noise[1] + d.noise[2] > 0)
        std::printf("%-11s                   noise of the reference, not in RMSE: %.6f %.6f %.6f\n", "",
                    d.noise[0], d.noise[1], d.noise[2]);
}

// Both pictures, and the largest difference of a pixel's channels on a scale.
void writePicture(const CompareArguments& a, const Rgb& one, const Rgb& two, const std::vector<uint8_t>& mask,
                  double p99) {
    std::vector<float> error(mask.size()), shown(mask.begin(), mask.end());
    for (size_t i = 0; i < mask.size(); ++i)
        for (size_t c = 0; c < 3; ++c)
            error[i] = std::max(error[i], std::abs(one.values[3 * i + c] - two.values[3 * i + c]));
    const float high = float(p99 > 0 ? p99 : 1e-3);
    const io::ToneMap tone{a.exposure};
    const auto rgb = [&](const Rgb& p) {
        return io::Picture(p.width, p.height, io::toSrgb8(p.values, tone));
    };
    io::Picture difference(one.width, one.height + 40, io::Srgb8{20, 20, 20});
    difference.paste(0, 0, io::colored(one.width, one.height, error, 0, high, shown));
    if (one.width >= 160)
        difference.paste(0, one.height, io::colorBar(one.width, 0, high, "largest channel", 1));
    const io::Tile tiles[] = {{"A", rgb(one)}, {"B", rgb(two)}, {"|A - B|", difference}};
    const io::Picture sheet = io::contactSheet(tiles, 3);
    io::writeImage8(a.picture, sheet.width, sheet.height, 3, sheet.rgb);
}

void runCompare(const CompareArguments& a) {
    if (a.gbuffer.empty() != a.scene.empty())
        throw UsageError(
            "--gbuffer and --scene go together: the scene file names the channels of the G-buffer");
    if (!a.picture.empty()) checkOutput(a.picture, {"png"}, {a.a, a.b, a.secondHalf, a.gbuffer});
    const Rgb one = readRgb(a.a, a.channelsA, a.scaleA, false);
    Rgb two = readRgb(a.b, a.channelsB, a.scaleB, true);
    requireSameSize(a.a, one, a.b, two);
    if (one.vertices && !a.picture.empty()) throw UsageError("--picture: values at vertices make none");
    if (!a.secondHalf.empty()) {
        const Rgb half = readRgb(a.secondHalf, a.channelsB, a.scaleB, true);
        requireSameSize(a.b, two, a.secondHalf, half);
        two.secondHalf = half.values;
    }
    std::vector<uint8_t> mask(one.values.size() / 3, 1);
    // Two renderers filter partly covered pixels differently, so these do not count.
    for (const Rgb* picture : {&one, static_cast<const Rgb*>(&two)})
        for (size_t i = 0; i < picture->alpha.size(); ++i) mask[i] = mask[i] && picture->alpha[i] >= 0.999f;
    std::vector<uint8_t> parts;
    if (!a.scene.empty()) parts = subsets(a, one, two, mask);
    size_t invalid = 0;
    const io::ImageDifference all = io::compareImages(one.values, two.values, mask, &invalid, two.secondHalf);
    nlohmann::ordered_json report{{"a", a.a}, {"b", a.b}, {"width", one.width}, {"height", one.height}};
    report["all"] = toJson(all);
    if (!a.json) print("all", all);
    if (!parts.empty()) {
        std::vector<std::pair<const char*, uint8_t>> names{{"unlit", io::SUBSET_UNLIT},
                                                           {"terminator", io::SUBSET_TERMINATOR},
                                                           {"penumbra", io::SUBSET_PENUMBRA}};
        if (!two.meanFreePath.empty())
            names.insert(names.end(), {{"hollows", io::SUBSET_HOLLOWS}, {"thin", io::SUBSET_THIN}});
        names.emplace_back("rest", io::SUBSET_REST);
        for (const auto& [name, bit] : names) {
            std::vector<uint8_t> within(mask.size());
            for (size_t i = 0; i < mask.size(); ++i) within[i] = mask[i] && (parts[i] & bit);
            const io::ImageDifference d =
                io::compareImages(one.values, two.values, within, nullptr, two.secondHalf);
            report["subsets"][name] = toJson(d);
            if (!a.json) print(name, d);
        }
    }
    takeMean(two);
    // Pixels that do not count would change those around them.
    if (all.pixels == mask.size() && !one.vertices) {
        const double visible = io::flip(one.values, two.values, one.width);
        report["all"]["flip"] = visible;
        if (!a.json) std::printf("%-11s %8zu pixels   FLIP %.5f\n", "all", all.pixels, visible);
    }
    report["invalid_pixels"] = invalid;
    if (invalid > 0) std::fprintf(stderr, "warning: %zu pixels with NaN or Inf were left out\n", invalid);
    if (!a.picture.empty()) {
        writePicture(a, one, two, mask, std::max({all.p99[0], all.p99[1], all.p99[2]}));
        report["picture"] = a.picture;
    }
    const bool bound = std::isfinite(a.maxRmse),
               worse = bound && (invalid > 0 || all.pixels == 0 || !(all.rmseAll <= a.maxRmse));
    if (bound) report["within"] = !worse;
    if (a.json) printJson(report);
    if (!worse) return;
    if (all.pixels == 0)
        std::fprintf(stderr, "pellucid: no pixel could be compared with --max-rmse\n");
    else if (all.rmseAll <= a.maxRmse)
        std::fprintf(stderr, "pellucid: --max-rmse allows no pixel with NaN or Inf\n");
    else
        std::fprintf(stderr, "pellucid: the RMSE is %.6g over %zu pixels, more than --max-rmse %.6g allows\n",
                     all.rmseAll, all.pixels, double(a.maxRmse));
    throw ExitWith(exitWorse);
}

}  // namespace

void addCompare(CLI::App& app) {
    auto [command, a] = subcommand<CompareArguments>(
        app, "compare", "How far two pictures are apart: RMSE, PSNR, P99, CIEDE2000, FLIP", runCompare);
    option(command, "a", a.a, "EXR, NPY, or an 8-bit picture, which is decoded from sRGB", required);
    option(command, "b", a.b, "reference to compare A with", required);
    option(command, "--second-half", a.secondHalf,
           "if B is noisy: an independent estimate with the same noise, which is then left out of the RMSE "
           "(default: the layer Second of B, beside First)");
    option(command, "--layer-a", a.channelsA, "layer of A: its .R, .G and .B instead of R, G, B",
           Word{"NAME"});
    option(command, "--layer-b", a.channelsB, "layer of B, such as Surface", Word{"NAME"});
    option(command, "--scale-a", a.scaleA, "multiplies A", isPositive(), shown);
    option(command, "--scale-b", a.scaleB, "multiplies B, such as by an albedo", isPositive(), shown);
    CLI::Option* gbuffer =
        option(command, "--gbuffer", a.gbuffer,
               "multi-layer EXR: only pixels of a material count; errors are given for each sub-set of them");
    option(command, "--scene", a.scene, "its scene file (TOML)");
    option(command, "--light", a.light, "number of the light that defines the sub-sets", shown,
           Needs{gbuffer});
    option(command, "--unit-mm", a.unit, "millimetres per unit of positions (default: the scene's unit_mm)",
           isPositive(), Needs{gbuffer});
    CLI::Option* picture = option(command, "--picture", a.picture,
                                  "PNG to write: both pictures, and their difference in colours");
    option(command, "--exposure", a.exposure, "multiplies both pictures in it", isPositive(), shown,
           Needs{picture});
    option(command, "--max-rmse", a.maxRmse,
           "exit with 1 if the RMSE over all channels is larger, or a value is NaN or Inf", isNotNegative());
    jsonOption(command, a.json);
}

}  // namespace pellucid::cli
