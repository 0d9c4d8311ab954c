// pellucid shade: a host's G-buffer and a scene file in, radiance out.
#include <condition_variable>
#include <mutex>
#include <thread>

#include "command.h"
#include "io/atomic_file.h"
#include "io/image/picture.h"
#include "io/image/tone_map.h"
#include "io/scene/scene_keys.h"
#include "scene/scene_frame.h"

namespace pellucid::cli {
namespace {

// After one second, reports on standard error that kernels are being built.
class BuildNotice {
  public:
    BuildNotice()
        : teller_([this](const std::stop_token& stop) {
              std::unique_lock lock(mutex_);
              if (!changed_.wait_for(lock, stop, std::chrono::seconds(1), [] { return false; }) &&
                  !stop.stop_requested())
                  std::fputs("building this scene's kernels; later runs take them from a cache folder\n",
                             stderr);
          }) {}

  private:
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::jthread teller_;
};

constexpr float longest = 30;  // mm of thickness; hardly anything comes through more of skin

// The values of --show: "final", then the output slots by their keys.
std::vector<std::string> showableParts() {
    std::vector<std::string> parts{"final"};
    for (const io::OutputKey& output : io::outputKeys) parts.emplace_back(output.key);
    return parts;
}

// The slot of a part; PEL_SLOT_RADIANCE of "final".
PelImageSlot slotOfPart(const std::string& part) {
    for (const io::OutputKey& output : io::outputKeys)
        if (part == output.key) return output.slot;
    return PEL_SLOT_RADIANCE;
}

// The parts side by side, labelled where there is more than one, lengths as colours with a bar. `frame` was
// shaded with their slots as outputs. `unit`: mm of a length.
void writeShadePicture(const std::string& path, const io::Image& gbuffer, const io::SceneFrame& frame,
                       float unit, const std::vector<std::string>& parts, const io::ToneMap& tone) {
    const int width = gbuffer.width, height = gbuffer.height;
    const float most = longest / unit;
    std::vector<io::Tile> tiles;
    for (const std::string& part : parts) {
        const PelImageSlot slot = slotOfPart(part);
        const std::vector<float> values = slot == PEL_SLOT_RADIANCE ? frame.radiance() : frame.output(slot);
        if (slot == PEL_SLOT_OUT_THICKNESS) {
            const io::Picture map = io::colored(width, height, values, 0, most, values);
            tiles.push_back({part, io::withColorBar(map, 0, most, "length", 1)});
        } else {
            tiles.push_back({part, io::Picture(width, height, io::toSrgb8(values, tone))});
        }
    }
    const io::Picture whole =
        tiles.size() == 1 ? tiles[0].picture : io::contactSheet(tiles, int(tiles.size()));
    io::writeImage8(path, whole.width, whole.height, 3, whole.rgb);
}

void addToneOptions(CLI::App& command, io::ToneMap& tone) {
    option(command, "--exposure", tone.exposure, "multiplies radiance in pictures", isPositive(), shown);
    command
        .add_option_function<std::string>(
            "--tonemap",
            [&tone](const std::string& curve) { tone.curve = chosen<io::ToneCurve>(io::toneCurves, curve); },
            "of pictures: soft (true to radiance up to 0.8, then a soft highlight roll-off), none (cut at "
            "1), filmic or agx-like (default: soft)")
        ->transform(isOneOf(io::toneCurves));
}

struct ShadeArguments {
    Run::Options run;
    std::string gbuffer, scene, output, picture;
    std::vector<std::string> parts, show{"final"};
    io::ToneMap tone;
    bool stats = false;
    uint64_t scratchMib = 0;
    float timeBudget = 0;
};

// The files to write beside radiance: those of the scene, and those of --outputs, named after -o.
std::vector<std::pair<PelImageSlot, std::string>> outputFiles(const ShadeArguments& a,
                                                              const io::SceneFile& scene) {
    std::vector<std::pair<PelImageSlot, std::string>> files;
    const std::string stem = a.output.substr(0, a.output.rfind('.'));
    for (const auto& [slot, key] : io::outputKeys) {
        if (!scene.outputs[slot].empty()) files.emplace_back(slot, scene.outputs[slot]);
        if (std::ranges::any_of(a.parts,
                                [key = key](const auto& part) { return part == key || part == "all"; }))
            files.emplace_back(slot, stem + "_" + std::string(key) + ".exr");
    }
    return files;
}

struct Inputs {
    io::Image gbuffer;  // without pixels if there is a frame
    std::optional<io::DeviceImages> images;
    std::optional<io::SceneFrame> frame;
};

// Reads the scene's images into the device's memory. A second thread prepares the frame meanwhile. If that
// fails, the images are read again, and the frame is made with them and reports the error.
Inputs frameOf(const std::string& gbuffer, const Device& device, const io::SceneFile& scene,
               io::LutStore& luts, const PelShaderOptions& options,
               const std::vector<PelImageSlot>& outputs) {
    Inputs inputs;
    io::ShadowMaps maps;
    {
        const auto build = [&] {
            try {
                const BuildNotice notice;
                inputs.frame.emplace(io::prepareFrame(device, scene, luts, options, outputs));
            } catch (const std::exception&) {
            }
        };
        std::jthread building;
        if (std::string_view(device.info().platform) == "Oclgrind")
            build();  // it stops where kernels of two threads overlap
        else
            building = std::jthread(build);
        inputs.images.emplace(device);
        inputs.gbuffer = inputs.images->read(gbuffer, io::gbufferGroups(scene));
        maps = io::readShadowMaps(scene, *inputs.images);
    }
    if (inputs.frame) {
        inputs.frame->show(inputs.gbuffer, scene, maps, &*inputs.images);
        return inputs;
    }
    inputs.images.reset();
    const std::set<std::string> names = io::namesOf(io::gbufferGroups(scene));
    inputs.gbuffer = io::readChannels(gbuffer, {names.begin(), names.end()});
    inputs.frame.emplace(device, inputs.gbuffer, scene, luts, io::readShadowMaps(scene), options, outputs);
    return inputs;
}

// Warns of settings that have no effect.
void warnOfNothing(Run& run, const io::SceneFile& scene, const std::vector<PelImageSlot>& outputs,
                   uint32_t features) {
    for (const io::SceneMaterial& m : scene.materials)
        if (m.material.deepScatterAmbient > 0 && scene.channels[PEL_SLOT_THICKNESS].empty())
            run.warn(io::concat(
                "deep_scatter_ambient of material ", m.id,
                " does nothing without a thickness channel: shadow maps tell how thick a body is along "
                "their light alone"));
    if (std::ranges::count(outputs, PEL_SLOT_OUT_THICKNESS) && scene.channels[PEL_SLOT_THICKNESS].empty() &&
        !(features & PEL_FEATURE_THICKNESS_TAPS))
        run.warn(
            "the thickness output is 0 everywhere: there is neither a thickness channel, nor a light with a "
            "shadow map and a material with thickness_taps and a deep_scatter_color");
}

void warnOfInvalid(Run& run, uint64_t invalid, uint64_t all, const char* they) {
    if (invalid == 0) return;
    run.warn(io::concat(invalid == all ? "all " : io::concat(invalid, " of "), all,
                        " pixels of a material have NaN or Inf in an input or in their result; they are ",
                        they));
}

nlohmann::ordered_json byMethod(const uint64_t (&counts)[std::size(io::scatterings)]) {
    nlohmann::ordered_json methods;
    for (size_t k = 0; k < std::size(counts); ++k) methods[std::string(io::scatterings[k])] = counts[k];
    return methods;
}

// The counters as an object of the report, under the names of pellucid.ShaderStats in Python.
nlohmann::ordered_json toJson(const PelShaderStats& s) {
    nlohmann::ordered_json features = nlohmann::ordered_json::array();
    for (const auto& [bit, name] : io::featureKeys)
        if (s.features & bit) features.push_back(name);
    return {{"features", features},
            {"programs_built", s.programsBuilt},
            {"launches", s.launches},
            {"scratch_bytes", s.scratchBytes},
            {"bytes_uploaded", s.bytesUploaded},
            {"tiles_total", s.tilesTotal},
            {"tiles_shaded", s.tilesShaded},
            {"pixels_total", s.pixelsTotal},
            {"pixels_shaded", s.pixelsShaded},
            {"pixels_shadow_lut", s.pixelsShadowLut},
            {"pixels_thickness", s.pixelsThickness},
            {"pixels_specular", s.pixelsSpecular},
            {"pixels_invalid", s.pixelsInvalid},
            {"device_milliseconds", s.deviceMilliseconds},
            {"pixels_wide_shadow", s.pixelsWideShadow},
            {"bands", s.bands},
            {"variants", s.variants},
            {"tiles_partial", s.tilesPartial},
            {"pixels_shadow_texels", s.pixelsShadowTexels},
            {"pixels_irradiance", s.pixelsIrradiance},
            {"pixels_by_scattering", byMethod(s.pixelsByScattering)},
            {"tiles_by_scattering", byMethod(s.tilesByScattering)},
            {"pixels_scattered", s.pixelsScattered},
            {"pixels_kept", s.pixelsKept},
            {"scatter_taps", s.scatterTaps},
            {"pixels_by_choice", byMethod(s.pixelsByChoice)},
            {"pixels_eye", s.pixelsEye},
            {"pixels_iris", s.pixelsIris},
            {"pixels_caustic", s.pixelsCaustic},
            {"tiles_eye", s.tilesEye},
            {"stands_in", s.standsIn != 0},
            {"taken_target_error", s.takenTargetError},
            {"expected_milliseconds", s.expectedMilliseconds},
            {"expected_error", s.expectedError},
            {"tuned", s.tuned != 0},
            {"pixels_history", s.pixelsHistory},
            {"taken_half_rate", s.takenHalfRate != 0},
            {"texels_reached", s.texelsReached}};
}

void reportSize(Run& run, const ShadeArguments& a, const io::Image& gbuffer, uint64_t invalid) {
    run.report["output"] = a.output;
    if (!a.picture.empty()) run.report["picture"] = a.picture;
    run.report["width"] = gbuffer.width;
    run.report["height"] = gbuffer.height;
    run.report["pixels"] = gbuffer.pixelCount();
    run.report["pixels_invalid"] = invalid;
}

// A scene that scatters irradiance alone.
void scatter(Run& run, const ShadeArguments& a, const io::SceneFile& scene, const std::string& picture,
             bool hasParts) {
    if (hasParts || a.stats || a.scratchMib || a.timeBudget > 0)
        throw UsageError("--outputs, --show, --stats, --scratch-mib, --time-budget: " + a.scene +
                         " has a [scatter] table, whose result is one image");
    const std::set<std::string> names = io::namesOf(io::gbufferGroups(scene));
    const io::Image gbuffer = io::readChannels(a.gbuffer, {names.begin(), names.end()});
    const io::ScatteredFrame frame = io::scatterFrame(run.device(), gbuffer, scene);
    warnOfInvalid(run, frame.stats.pixelsInvalid, frame.stats.pixelsCovered, "unchanged");
    if (picture != a.output) io::writeRadiance(a.output, gbuffer.width, gbuffer.height, frame.light);
    if (!picture.empty())
        io::writeImage8(picture, gbuffer.width, gbuffer.height, 3, io::toSrgb8(frame.light, a.tone));
    reportSize(run, a, gbuffer, frame.stats.pixelsInvalid);
}

void runShade(ShadeArguments a) {
    checkOutput(a.output, {"exr", "png", "jpg", "jpeg", "bmp", "tga"});
    if (!a.picture.empty()) checkOutput(a.picture, {"png", "jpg", "jpeg", "bmp", "tga"});
    const std::string picture = io::isPicture(a.output) ? a.output : a.picture;
    if (picture.empty() && a.show != std::vector<std::string>{"final"})
        throw UsageError(
            "--show: parts are shown in a picture; name one with --picture, or write -o to a .png");
    if (picture.empty() && (a.tone.exposure != io::ToneMap().exposure || a.tone.curve != io::ToneMap().curve))
        throw UsageError(
            "--exposure and --tonemap: of pictures; name one with --picture, or write -o to a .png");
    if (picture == a.output && !a.picture.empty())
        throw UsageError("--picture: -o is a picture already; write -o to an .exr, or leave --picture out");
    if (a.scene.empty()) {
        if (io::extensionOf(a.gbuffer) != "toml")
            throw UsageError("--scene is needed beside a G-buffer: a scene file (TOML)");
        a.scene = std::exchange(a.gbuffer, "");
    }
    Run run(a.run);
    io::SceneFile scene = io::readScene(a.scene);
    if (a.gbuffer.empty()) a.gbuffer = scene.gbuffer;
    if (a.gbuffer.empty())
        throw UsageError("gbuffer: " + a.scene + " names none; write GBUFFER.exr --scene " + a.scene);
    scene.options.buildInBackground = 0;  // the picture is of the methods that it names
    io::checkReadable(a.gbuffer);
    const auto files = outputFiles(a, scene);
    std::vector<PelImageSlot> outputs;
    std::vector<std::string> inputs{a.gbuffer, a.scene};
    for (const std::string* file : io::filesOf(scene)) inputs.push_back(*file);
    keepInputs(a.output, inputs);
    if (!a.picture.empty()) keepInputs(a.picture, inputs);
    const auto place = [](const std::string& file) { return std::filesystem::weakly_canonical(file); };
    std::set<std::filesystem::path> distinct{place(a.output), place(a.picture)};
    for (const auto& [slot, file] : files) {
        if (outputs.empty() || outputs.back() != slot) outputs.push_back(slot);
        io::requireExtension(file, {"exr"});
        if (!distinct.insert(place(file)).second)
            throw io::FileError(file, "would be written twice; give each output a name of its own");
        io::checkWritable(file);
        keepInputs(file, inputs);
    }
    if (!picture.empty())
        for (const std::string& part : a.show)
            if (const PelImageSlot slot = slotOfPart(part);
                slot != PEL_SLOT_RADIANCE && std::ranges::find(outputs, slot) == outputs.end())
                outputs.push_back(slot);
    io::LutStore luts(run.device());
    PelShaderOptions options = pelShaderOptionsDefaults();
    options.countPixels = a.stats;
    options.scratchBudget = a.scratchMib << 20;
    options.timeBudget = a.timeBudget;
    // If the library refuses something here, it came from the two files.
    withInput(a.gbuffer + " with " + a.scene, [&] {
        if (scene.scatter) return scatter(run, a, scene, picture, !files.empty() || !outputs.empty());
        Inputs inputs = frameOf(a.gbuffer, run.device(), scene, luts, options, outputs);
        const io::Image& gbuffer = inputs.gbuffer;
        io::SceneFrame& frame = *inputs.frame;
        frame.shade();
        const PelShaderStats stats = frame.stats();
        warnOfNothing(run, scene, outputs, stats.features);
        std::istringstream warnings(frame.warnings());
        for (std::string line; std::getline(warnings, line);) run.warn(line);
        for (const std::string& sentence :
             io::unlikely(gbuffer, scene, inputs.images ? &*inputs.images : nullptr))
            run.warn(sentence);
        warnOfInvalid(run, stats.pixelsInvalid, stats.pixelsShaded, "black");
        if (picture != a.output) io::writeRadiance(a.output, gbuffer.width, gbuffer.height, frame.radiance());
        if (!picture.empty())
            writeShadePicture(picture, gbuffer, frame, scene.options.millimetresPerUnit, a.show, a.tone);
        for (const auto& [slot, file] : files)
            (slot == PEL_SLOT_OUT_THICKNESS ? io::writeThickness : io::writeRadiance)(
                file, gbuffer.width, gbuffer.height, frame.output(slot));
        reportSize(run, a, gbuffer, stats.pixelsInvalid);
        for (const auto& [slot, file] : files) run.report["outputs"].push_back(file);
        for (const io::SceneMaterial& m : scene.materials) {
            const PelMaterial resolved = frame.material(m.id);
            run.report["materials"].push_back({{"id", m.id},
                                               {"diffusion_radius", resolved.diffusionRadius},
                                               {"normal_blend", resolved.normalBlend},
                                               {"shadow_filter_width", resolved.shadowFilterWidth}});
        }
        if (a.stats) {
            run.report["stats"] = toJson(stats);
            for (const PelPassStats& pass : frame.passes())
                run.report["stats"]["passes"].push_back({{"name", pass.name},
                                                         {"ms", pass.milliseconds},
                                                         {"launches", pass.launches},
                                                         {"bytes", pass.bytes},
                                                         {"tiles", pass.tiles}});
        }
    });
    run.finish();
}

}  // namespace

void addShade(CLI::App& app) {
    auto [command, a] = subcommand<ShadeArguments>(app, "shade", "Shade a G-buffer", runShade);
    option(command, "gbuffer", a.gbuffer, "multi-layer EXR; or a scene file that names one", required);
    option(command, "--scene", a.scene, "scene file (TOML): lights, materials, which channel is what");
    option(command, "-o,--output", a.output,
           "file to write: .exr for radiance R, G, B; .png, .jpg, .bmp or .tga for a picture to look at",
           required);
    option(command, "--picture", a.picture, "picture to write beside an .exr");
    addToneOptions(command, a.tone);
    option(command, "--show", a.show, "what the picture shows, side by side (default: final)", separated,
           isOneOf(showableParts()));
    option(command, "--outputs", a.parts,
           "parts of the picture to write beside it, as OUT_diffuse.exr and so on", separated,
           isOneOf({"diffuse", "deep_scatter", "specular", "thickness", "all"}));
    option(command, "--stats", a.stats, "count tiles and pixels per feature, and time each pass");
    option(
        command, "--scratch-mib", a.scratchMib,
        "most MiB for blurred normals and filtered shadows; larger frames are shaded in bands. 0: no limit",
        inRange(0, 1 << 30), shown);
    option(command, "--time-budget", a.timeBudget,
           "milliseconds of the device that \"auto\" may take beyond plain lighting (default: the scene's)",
           isPositive());
    addRunOptions(command, a.run);
}

}  // namespace pellucid::cli
