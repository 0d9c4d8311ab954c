#include "shading/capture.h"

#include "cl/module.h"
#include "core/error_log.h"
#include "core/handle_table.h"
#include "core/launch_policy.h"
#include "shading/image_slots.h"
#include "shading/launch_ranges.h"
#include "shading/shading_constants.h"

namespace pel {
namespace {

#define COMPONENTS(name, number, role, content, components, key, words, bits) components,
constexpr uint32_t slotComponents[] = {PEL_EACH_IMAGE(COMPONENTS)};
#undef COMPONENTS

// PEL_READ_AS of image_values.cl.
enum class ReadAs { NUMBERS, DIRECTIONS, NORMAL_MAP, IDS };

CapturedImage valuesOf(Device& device, const ImageView& view, uint32_t components,
                       ReadAs as = ReadAs::NUMBERS) {
    CapturedImage image;
    if (!view) return image;
    const uint32_t given = view.info().components;
    if (as != ReadAs::DIRECTIONS) components = std::min(components, given);
    const auto& program = device.programs().get("shading/image_values.cl",
                                                {{"PEL_FORMAT", formatCode(view, device.info().mathWidth)},
                                                 {"PEL_COMPONENTS", components},
                                                 {"PEL_FOURTH", int(components == 4 && given == 4)},
                                                 {"PEL_READ_AS", int(as)}});
    image.values.resize(size_t(view.width) * view.height * components);
    const size_t bytes = image.values.size() * sizeof(float);
    const PelShadeImage place = describeImage(view);
    const cl::Memory described = device.allocate(sizeof place, &place), values = device.allocate(bytes);
    cl::Launch launch(program, "image_values", described, view, values);
    device.launch(launch, vectorRange(device, view.width, view.height));
    device.read(values.get(), 0, bytes, image.values.data(), true);
    image.width = view.width, image.height = view.height, image.components = components;
    return image;
}

class Capture {
  public:
    Capture(Device& device, const ShaderState& state, const ScatterInput* scatter);
    CapturedFrame frame;

  private:
    // A handle that lives as long as this object.
    PelLut handleOf(const Ref<Lut>& lut) {
        return lut ? handles_.emplace_back(std::make_unique<LentHandle<PelLut, Lut>>(lut))->get() : nullptr;
    }
    int numberOf(const Ref<Profile>& profile) {
        if (!profile) return -1;
        const auto known = std::ranges::find_if(
            profiles_, [&](const Ref<Profile>& other) { return other.get() == profile.get(); });
        const int number = int(known - profiles_.begin());
        if (known == profiles_.end()) {
            profiles_.push_back(profile);
            frame.profiles.push_back(profile->recipe());
        }
        return number;
    }

    std::vector<std::unique_ptr<LentHandle<PelLut, Lut>>> handles_;
    std::vector<Ref<Profile>> profiles_;
};

Capture::Capture(Device& device, const ShaderState& state, const ScatterInput* scatter) {
    if (scatter) frame.scatter = scatter->params;
    frame.options = state.options;
    for (int slot = 0; slot < PEL_SLOT_COUNT; ++slot) {
        const ImageView& view = state.images[slot];
        const Content content = imageSlot(slot).content;
        if (slotComponents[slot])
            frame.images[slot] = valuesOf(device, view, slotComponents[slot],
                                          content == Content::NORMAL ? ReadAs::DIRECTIONS
                                          : content == Content::ID   ? ReadAs::IDS
                                                                     : ReadAs::NUMBERS);
        frame.outputs[slot] = isOutput(slot) && view;
    }
    for (const auto& [id, from] : state.materials) {
        CapturedMaterial& to = frame.materials.emplace_back();
        to.id = id;
        to.material = from.given;
        to.material.profile = nullptr;
        // A table's file does not say whose unit its radius is in.
        if (!from.profile && (from.givenCurvatureLut || from.givenShadowLut))
            to.material.diffusionRadius = from.params.diffusionRadius;
        if (scatter) to.scale = scatter->scales.at(id);
        to.profile = numberOf(from.profile);
        to.curvature = handleOf(from.givenCurvatureLut);
        to.shadow = handleOf(from.givenShadowLut);
        for (const ImageView& level : from.normalMap)
            to.normalMap.push_back(valuesOf(device, level, 3, ReadAs::NORMAL_MAP));
        to.scatteredTexture = valuesOf(device, from.scatteredTexture, 3);
        if (!from.eye) continue;
        CapturedEye& eye = to.eye.emplace();
        eye.eye = from.eye->given;
        eye.eye.irisProfile = nullptr;
        eye.irisProfile = numberOf(from.eye->irisProfile);
        if (!from.eye->ownCaustics) eye.caustics = handleOf(from.eye->caustics);
        eye.iris = valuesOf(device, from.eye->iris, 3);
    }
    for (const ShaderLight& from : state.lights) {
        CapturedLight& to = frame.lights.emplace_back();
        to.light = from.params;
        const bool moments = from.params.shadowContent == PEL_SHADOW_CONTENT_MOMENTS;
        for (int slot = 0; slot < PEL_LIGHT_SLOT_COUNT; ++slot)
            to.images[slot] =
                valuesOf(device, from.images[slot], moments && slot != PEL_LIGHT_WIDE_SHADOW ? 2 : 1);
    }
    frame.ambient = state.ambient;
    frame.camera = state.camera;
    frame.ambientCube = valuesOf(device, state.ambientCube, 3);
    frame.reflectionCube = valuesOf(device, state.reflectionCube, 3);
    frame.environment = valuesOf(device, state.environment, 3);
    frame.environmentAxes = state.environmentAxes;
}

// Settings that a scene file cannot represent, one sentence a line.
std::string lost(const ShaderState& state) {
    std::string lines;
    const auto say = [&](auto&&... parts) {
        lines += text(lines.empty() ? "" : "\n", "the capture leaves out ", parts...);
    };
    const PelShaderOptions& o = state.options;
    if (o.scratchBudget)
        say("PelShaderOptions.scratchBudget: --scratch-mib ", o.scratchBudget >> 20,
            " of the command sets it");
    for (const float c : o.invalidColor)
        if (c != 0) {
            say("PelShaderOptions.invalidColor: the scene's invalid pixels are black");
            break;
        }
    int64_t lightImages = 0;
    for (const ShaderLight& light : state.lights)
        lightImages += std::ranges::count_if(light.images, [](const ImageView& v) { return bool(v); });
    if (lightImages > PEL_LIGHT_BUFFERS)
        say("which of the lights' ", lightImages,
            " images share buffers: `pellucid shade` has a buffer for each, ", PEL_LIGHT_BUFFERS, " at most");
    const auto exact = [](const float(&v)[3]) { return std::abs(length(threeAt(v)) - 1) < 1e-6; };
    for (size_t i = 0; i < state.lights.size(); ++i) {
        const PelLight& l = state.lights[i].params;
        const bool directional = l.type == PEL_LIGHT_DIRECTIONAL;
        if (!(directional ? exact(l.toLight) : l.type != PEL_LIGHT_SPOT || exact(l.spotDirection)))
            say("the length of PelLight ", i, ".", directional ? "toLight" : "spotDirection",
                ": a scene's reader scales it to 1");
    }
    return lines;
}

void tell(const std::string& lines) {
    if (!warn(lines)) std::fprintf(stderr, "pellucid: %s\n", lines.c_str());
}

// A new folder: an existing one, or a link, is never written to.
std::string newFolder(const std::string& parent, const std::string& name) {
    namespace fs = std::filesystem;
    fs::create_directories(parent);
    for (int number = 1;; ++number) {
        const fs::path folder = fs::path(parent) / text(name, "-", number);
        std::error_code why;
        if (fs::create_directory(folder, why)) return folder.string();
        if (!fs::exists(fs::symlink_status(folder)))  // not a name that is taken
            fail(PEL_ERROR_UNKNOWN, folder.string(), " cannot be made: ", why.message());
    }
}

}  // namespace

const char* captureFolder(bool& asked) {
    if (std::exchange(asked, true)) return nullptr;
    const char* folder = std::getenv("PELLUCID_CAPTURE");
    return folder && *folder ? folder : nullptr;
}

void captureFrame(Device& device, const ShaderState& state, const std::string& folder,
                  const ScatterInput* scatter) {
    std::string name = nameInCall();  // the module's calls have names of their own
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    if (name.empty()) name = scatter ? "scatter" : "shader";
    tell(lost(state));
    try {
        const auto write =
            reinterpret_cast<WriteCapture>(cl::moduleFunction(PELLUCID_CAPTURE, "pellucidCapture"));
        const std::string to = newFolder(folder, name);
        const Capture capture(device, state, scatter);
        if (const std::string wrong = write(capture.frame, to); !wrong.empty())
            tell(text("PELLUCID_CAPTURE: ", wrong));
    } catch (const std::exception& e) {
        tell(text("PELLUCID_CAPTURE: ", e.what()));
    }
}

}  // namespace pel
