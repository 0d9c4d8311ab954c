// pellucid shade: a host's G-buffer and a scene file in, radiance out.
#include "frame.h"
#include "io/atomic_file.h"
#include "io/file_error.h"

namespace pellucid::cli {
namespace {

struct Arguments {
    Run::Options run;
    std::string gbuffer, scene, output;
    bool stats = false;
};

void run(const Arguments& a) {
    try {
        io::requireExtension(a.output, {"exr"});
        io::checkWritable(a.output);
    } catch (const io::FileError& e) {
        throw UsageError(e.what());
    }
    Run run(a.run);
    const io::SceneFile scene = io::readScene(a.scene);
    const io::Image gbuffer = io::readImage(a.gbuffer);
    LutStore luts(run.device());
    PelShaderOptions options = pelShaderOptionsDefaults();
    options.countPixels = a.stats;
    try {
        Frame frame(run.device(), gbuffer, scene, luts, {}, options);
        frame.shade();
        writeRadiance(a.output, gbuffer.width, gbuffer.height, frame.radiance());
        run.report["output"] = a.output;
        run.report["width"] = gbuffer.width;
        run.report["height"] = gbuffer.height;
        run.report["pixels"] = gbuffer.pixelCount();
        const PelShaderStats stats = frame.stats();
        if (a.stats) run.report["stats"] = toJson(stats);
        if (stats.pixelsInvalid > 0)
            run.warn(std::to_string(stats.pixelsInvalid) + " pixels have NaN or Inf inputs; they are 0");
    } catch (const Error& e) {
        // What the library refuses here came from the two files.
        if (e.code() == PEL_ERROR_INVALID_ARGUMENT)
            throw InputError(a.gbuffer + " with " + a.scene + ": " + e.what());
        throw;
    }
    run.finish();
}

}  // namespace

void addShade(CLI::App& app) {
    CLI::App* command = app.add_subcommand("shade", "Shade a G-buffer");
    auto a = std::make_shared<Arguments>();
    command->add_option("gbuffer", a->gbuffer, "multi-layer EXR")->required();
    command->add_option("--scene", a->scene, "scene file (TOML): lights, materials, which channel is what")
        ->required();
    command->add_option("-o,--output", a->output, "EXR to write: radiance R, G, B")->required();
    command->add_flag("--stats", a->stats, "count tiles and pixels per feature");
    addRunOptions(*command, a->run);
    command->callback([a] { run(*a); });
}

}  // namespace pellucid::cli
