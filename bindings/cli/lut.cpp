// pellucid lut curvature|shadow: integrates a look-up table and writes it.
#include "io/lut_file.h"

#include "command.h"

namespace pellucid::cli {
namespace {

const std::map<std::string, PelLutEncoding> encodings{
    {"float", PEL_LUT_FLOAT}, {"half", PEL_LUT_HALF}, {"faceworks8", PEL_LUT_FACEWORKS8}};

struct Arguments {
    Run::Options run;
    std::string output, size = "512x512", encoding, form = "arc", profile = "skin";
    PelCurvatureLutDesc curvature = pelCurvatureLutDescDefaults();
    PelShadowLutDesc shadow = pelShadowLutDescDefaults();
};

template <class Desc>
void integrate(Arguments& arguments, Desc& desc) {
    parseSize(arguments.size, desc.width, desc.height);
    std::optional<PelLutEncoding> encoding;
    if (!arguments.encoding.empty()) encoding = encodings.at(arguments.encoding);
    try {
        encoding = io::checkLutPath(arguments.output, encoding);
    } catch (const std::exception& e) {  // before any work: the output is the user's choice
        throw UsageError(e.what());
    }
    Run run(arguments.run);
    const Lut lut(run.device(), desc);
    io::writeLut(arguments.output, lut, encoding);
    run.report["output"] = arguments.output;
    run.report["width"] = desc.width;
    run.report["height"] = desc.height;
    run.report["texels"] = uint64_t(desc.width) * desc.height;
    run.finish();
}

void addCommon(CLI::App& command, Arguments& a, float& diffusionRadius) {
    command.add_option("-o,--output", a.output, "file to write: .exr, .png, .bmp or .npy")->required();
    command.add_option("--size", a.size, "texels, WxH")->capture_default_str();
    command.add_option("--diffusion-radius", diffusionRadius, "sigma of the widest Gaussian, mm")
        ->capture_default_str();
    command.add_option("--encoding", a.encoding, "float, half or faceworks8 (default: by the file's kind)")
        ->check(CLI::IsMember({"float", "half", "faceworks8"}));
    addRunOptions(command, a.run);
}

}  // namespace

void addLut(CLI::App& app) {
    CLI::App* lut = app.add_subcommand("lut", "Integrate a look-up table");
    lut->require_subcommand(1);
    auto a = std::make_shared<Arguments>();

    CLI::App* curvature =
        lut->add_subcommand("curvature", "Light scattered round a curved surface, over N.L and curvature");
    addCommon(*curvature, *a, a->curvature.diffusionRadius);
    curvature->add_option("--radius-min", a->curvature.radiusMin, "smallest radius of curvature, mm")
        ->capture_default_str();
    curvature->add_option("--radius-max", a->curvature.radiusMax, "largest radius of curvature, mm")
        ->capture_default_str();
    curvature->add_option("--form", a->form, "geometry that light is integrated over")
        ->check(CLI::IsMember({"arc"}))
        ->capture_default_str();
    curvature->add_option("--profile", a->profile, "diffusion profile")
        ->check(CLI::IsMember({"skin"}))
        ->capture_default_str();
    curvature->callback([a] { integrate(*a, a->curvature); });

    CLI::App* shadow =
        lut->add_subcommand("shadow", "Light scattered across a shadow edge, over shadow value and 1/width");
    addCommon(*shadow, *a, a->shadow.diffusionRadius);
    shadow->add_option("--width-min", a->shadow.widthMin, "narrowest penumbra, mm")->capture_default_str();
    shadow->add_option("--width-max", a->shadow.widthMax, "widest penumbra, mm")->capture_default_str();
    shadow->add_option("--sharpening", a->shadow.sharpening, "how much narrower the shadow gets, from 1")
        ->capture_default_str();
    shadow->callback([a] { integrate(*a, a->shadow); });
}

}  // namespace pellucid::cli
