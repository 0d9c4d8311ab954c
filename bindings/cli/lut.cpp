// pellucid lut curvature|shadow|specular|eye: integrates a look-up table and writes it.
#include "io/choice_keys.h"
#include "io/lut/lut_file.h"
#include "io/lut/lut_preset.h"
#include "io/lut/profile_file.h"

#include "command.h"
#include "io/atomic_file.h"
#include "io/image/image_file.h"
#include "io/image/tone_map.h"

namespace pellucid::cli {
namespace {

struct LutArguments {
    Run::Options run;
    std::string output, size, encoding, irisProfile, form, axis, profile = "skin", preset = "material";
    bool openEnds = false;
    PelCurvatureLutDesc curvature = pelCurvatureLutDescDefaults();
    PelShadowLutDesc shadow = pelShadowLutDescDefaults();
    PelSpecularLutDesc specular = pelSpecularLutDescDefaults();
    PelEyeLutDesc eye = pelEyeLutDescDefaults();
};

// A picture of the table to look at: its values as linear light, from 0 to 1.
void writeTablePicture(const std::string& path, const Lut& lut, uint32_t width, uint32_t height) {
    io::writeImage8(path, int(width), int(height), 3,
                    io::toSrgb8(lut.read<float>(PEL_LUT_FLOAT), {.curve = io::ToneCurve::none}));
}

// WxHxD of an eye's table, WxH of the others.
void parseLutSize(const std::string& text, PelEyeLutDesc& desc) {
    parseSize(text, {&desc.width, &desc.height, &desc.depth});
}
template <class Desc>
void parseLutSize(const std::string& text, Desc& desc) {
    parseSize(text, {&desc.width, &desc.height});
}

uint32_t rowsOf(const PelEyeLutDesc& desc) {
    return desc.height * desc.depth;
}
template <class Desc>
uint32_t rowsOf(const Desc& desc) {
    return desc.height;
}

// Describes the table, including the values that follow from its profile.
void describe(const PelLutInfo& info, nlohmann::ordered_json& report) {
    if (info.kind == PEL_LUT_CURVATURE) {
        report["form"] = io::curvatureForms[info.curvature.form];
        report["axis"] = io::lutAxes[info.curvature.axis];
        report["diffusion_radius"] = info.curvature.diffusionRadius;
        report["radius_min"] = info.curvature.radiusMin;
        report["radius_max"] = info.curvature.radiusMax;
    } else if (info.kind == PEL_LUT_SHADOW) {
        report["axis"] = io::lutAxes[info.shadow.axis];
        report["closed_ends"] = info.shadow.closedEnds != 0;
        report["diffusion_radius"] = info.shadow.diffusionRadius;
        report["width_min"] = info.shadow.widthMin;
        report["width_max"] = info.shadow.widthMax;
    } else if (info.kind == PEL_LUT_EYE) {
        report["depth"] = info.eye.depth;
    }
}

template <class Desc>
void integrate(LutArguments& arguments, Desc& desc) {
    if (!arguments.size.empty()) parseLutSize(arguments.size, desc);
    const bool picture = arguments.encoding.empty() && io::isPicture(arguments.output);
    std::optional<PelLutEncoding> encoding;
    if (!arguments.encoding.empty()) encoding = chosen<PelLutEncoding>(io::lutEncodings, arguments.encoding);
    try {
        if (picture)
            io::checkWritable(arguments.output);
        else
            encoding = io::checkLutPath(arguments.output, encoding);
    } catch (const std::exception& e) {  // before any work: the user chose the output
        throw UsageError(e.what());
    }
    Run run(arguments.run);
    const Lut lut(run.device(), desc);
    run.progress(0.9, "table");  // ends here after Ctrl-C
    run.report["output"] = arguments.output;
    if (picture)
        writeTablePicture(arguments.output, lut, desc.width, rowsOf(desc));
    else
        io::writeLut(arguments.output, lut, encoding);
    run.report["encoding"] =
        picture ? "picture: sRGB, to look at; engines need --encoding" : io::lutEncodings[*encoding];
    run.report["width"] = desc.width;
    run.report["height"] = rowsOf(desc);
    run.report["texels"] = uint64_t(desc.width) * rowsOf(desc);
    describe(lut.info(), run.report);
    if (encoding == PEL_LUT_FACEWORKS8 && lut.info().kind == PEL_LUT_CURVATURE)
        run.report["clipped_texels"] = lut.clippedTexels();
    run.finish();
}

// Integrates the table that a preset describes, with the profile and the lengths of the command line.
template <class Desc>
void integratePreset(LutArguments& a, const Desc& given, Desc preset, const CLI::App& command,
                     const std::vector<std::pair<const char*, float Desc::*>>& lengths) {
    for (const auto& [option, field] : lengths)
        if (command.count(option) > 0) preset.*field = given.*field;
    if (!a.axis.empty()) preset.axis = chosen<PelLutAxis>(io::lutAxes, a.axis);
    const Profile profile = io::findProfile(a.profile).profile;
    preset.profile = profile.get();
    integrate(a, preset);
}

void addCommon(CLI::App& command, LutArguments& a, const std::string& size) {
    option(command, "-o,--output", a.output, "file to write: .exr, .png, .bmp, .tga, .npy, .dds or .ktx2",
           required);
    option(command, "--size", a.size, size, Word{"SIZE"});
    option(command, "--encoding", a.encoding,
           "float, half, or faceworks8 (.png, .bmp, .tga for engines; default: "
           "float for .exr and .npy, half for .dds and .ktx2; a .png without it is a picture to look at)",
           isOneOf(io::lutEncodings));
    addRunOptions(command, a.run);
}

// The options of a table of a profile. `material`, `faceworks`: the presets.
template <class Desc>
void addOfProfile(CLI::App& command, LutArguments& a, Desc& desc, const Desc& material,
                  const Desc& faceworks) {
    addCommon(command, a,
              io::concat("texels, WxH (default: ", material.width, "x", material.height, "; ",
                         faceworks.width, "x", faceworks.height, " with --preset faceworks)"));
    option(command, "--preset", a.preset,
           "material: as a material makes it of its profile; faceworks: as FaceWorks does",
           isOneOf(io::lutPresets), shown);
    option(command, "--axis", a.axis,
           "spread of texels: linear, or root, by which small tables look up better (default: root; linear "
           "with --preset faceworks)",
           isOneOf(io::lutAxes));
    option(command, "--profile", a.profile, "a material (pellucid profile list) or a .toml file",
           Word{profileWord}, shown);
    option(command, "--diffusion-radius", desc.diffusionRadius,
           "sigma of the widest Gaussian, mm (default: the profile's own)", isPositive());
}

io::LutPreset presetOf(const LutArguments& a) {
    return chosen<io::LutPreset>(io::lutPresets, a.preset);
}

}  // namespace

void addLut(CLI::App& app) {
    CLI::App* lut = app.add_subcommand("lut", "Integrate a look-up table");
    lut->require_subcommand(1);
    auto a = std::make_shared<LutArguments>();

    CLI::App* curvature =
        lut->add_subcommand("curvature", "Light scattered round a curved surface, over N.L and curvature");
    addOfProfile(*curvature, *a, a->curvature, pelCurvatureLutDescDefaults(), pelCurvatureLutDescFaceWorks());
    option(*curvature, "--radius-min", a->curvature.radiusMin,
           "smallest radius of curvature, mm (default: a quarter of the diffusion radius; 1 with --preset "
           "faceworks)");
    option(*curvature, "--radius-max", a->curvature.radiusMax,
           "largest radius of curvature, mm (default: 1000 diffusion radii; 100 with --preset faceworks)");
    option(*curvature, "--form", a->form,
           "geometry that light is integrated over (default: sphere; arc with --preset faceworks)",
           isOneOf(io::curvatureForms));
    curvature->callback([a, curvature] {
        PelCurvatureLutDesc preset = io::presetCurvature(presetOf(*a));
        if (!a->form.empty()) preset.form = chosen<PelCurvatureForm>(io::curvatureForms, a->form);
        integratePreset(*a, a->curvature, preset, *curvature,
                        {{"--radius-min", &PelCurvatureLutDesc::radiusMin},
                         {"--radius-max", &PelCurvatureLutDesc::radiusMax},
                         {"--diffusion-radius", &PelCurvatureLutDesc::diffusionRadius}});
    });

    CLI::App* shadow =
        lut->add_subcommand("shadow", "Light scattered across a shadow edge, over shadow value and 1/width");
    addOfProfile(*shadow, *a, a->shadow, pelShadowLutDescDefaults(), pelShadowLutDescFaceWorks());
    option(*shadow, "--width-min", a->shadow.widthMin,
           "narrowest penumbra, mm (default: the filter that follows from the profile; 8 with --preset "
           "faceworks)");
    option(*shadow, "--width-max", a->shadow.widthMax,
           "widest penumbra, mm (default: 1000 times the narrowest; 100 with --preset faceworks)");
    option(*shadow, "--sharpening", a->shadow.sharpening, "how much narrower the shadow gets, from 1", shown);
    option(*shadow, "--open-ends", a->openEnds,
           "rows are not rescaled to run from 0 to 1 (--preset faceworks does not either)");
    shadow->callback([a, shadow] {
        PelShadowLutDesc preset = io::presetShadow(presetOf(*a));
        if (a->openEnds) preset.closedEnds = 0;
        integratePreset(*a, a->shadow, preset, *shadow,
                        {{"--width-min", &PelShadowLutDesc::widthMin},
                         {"--width-max", &PelShadowLutDesc::widthMax},
                         {"--sharpening", &PelShadowLutDesc::sharpening},
                         {"--diffusion-radius", &PelShadowLutDesc::diffusionRadius}});
    });

    CLI::App* specular = lut->add_subcommand("specular", "Beckmann's distribution over n.h and roughness");
    addCommon(*specular, *a, "texels, WxH (default: 512x512)");
    specular->callback([a] { integrate(*a, a->specular); });

    CLI::App* eye = lut->add_subcommand(
        "eye", "Light on the iris behind a cornea, over place and the light's angle: slice below slice");
    addCommon(*eye, *a, "texels, WxHxD (default: 64x64x32)");
    option(*eye, "--profile", a->irisProfile, "of the iris, in which light scatters (default: none)",
           Word{profileWord});
    const std::pair<const char*, float*> lengths[] = {
        {"--sclera-radius", &a->eye.scleraRadius}, {"--cornea-radius", &a->eye.corneaRadius},
        {"--limbus-radius", &a->eye.limbusRadius}, {"--chamber-depth", &a->eye.chamberDepth},
        {"--iris-radius", &a->eye.irisRadius},     {"--iris-concavity", &a->eye.irisConcavity},
    };
    for (const auto& [name, value] : lengths) option(*eye, name, *value, "mm", shown);
    option(*eye, "--cornea-conic", a->eye.corneaConic, "conic constant", shown);
    option(*eye, "--cornea-index", a->eye.corneaIndex, "refractive index", shown);
    option(*eye, "--aqueous-index", a->eye.aqueousIndex, "refractive index", shown);
    eye->callback([a] {
        Profile profile;
        if (!a->irisProfile.empty()) profile = io::findProfile(a->irisProfile).profile;
        a->eye.profile = profile.get();
        integrate(*a, a->eye);
    });
}

}  // namespace pellucid::cli
