// The module for PELLUCID_CAPTURE (host/shading/capture.cpp): a frame's input as a scene folder.
#include "io/atomic_file.h"
#include "io/lut/lut_file.h"
#include "io/lut/profile_file.h"
#include "io/scene/scene_keys.h"

namespace pellucid::io {
namespace {

using Names = std::vector<std::string>;

// "albedo.X", "albedo.Y", "albedo.Z".
Names channelNames(std::string_view key, uint32_t components) {
    Names names;
    for (uint32_t c = 0; c < components; ++c) names.push_back(std::string(key) + "." + "XYZW"[c]);
    return names;
}

class Writer {
  public:
    Writer(const pel::CapturedFrame& frame, const std::string& folder)
        : frame_(frame), folder_(folder + "/") {}

    void write() {
        scene_.scatter = frame_.scatter;
        scene_.options = frame_.options;
        scene_.ambient = frame_.ambient;
        scene_.camera = frame_.camera;
        scene_.ambientCube = colors("ambient_cube", frame_.ambientCube);
        scene_.reflectionCube = colors("reflection_cube", frame_.reflectionCube);
        scene_.environment = colors("environment", frame_.environment);
        if (frame_.environment)
            std::copy(frame_.environmentAxes.begin(), frame_.environmentAxes.end(), scene_.environmentAxes);
        for (size_t i = 0; i < frame_.profiles.size(); ++i)
            writeWholeFile(folder_ + profile(int(i)), profileText(frame_.profiles[i]));
        for (const SlotKey& k : slotKeys) scene_.channels[k.slot] = add(k.key, frame_.images[k.slot]);
        for (const OutputKey& k : outputKeys)
            if (frame_.outputs[k.slot]) scene_.outputs[k.slot] = concat(k.key, ".exr");
        for (const pel::CapturedLight& light : frame_.lights) addLight(light);
        for (const pel::CapturedMaterial& material : frame_.materials) addMaterial(material);
        scene_.gbuffer = "gbuffer.exr";
        writeExr(folder_ + scene_.gbuffer, gbuffer_);
        writeScene(folder_ + "scene.toml", scene_);  // last: if it exists, all files do
    }

  private:
    static std::string profile(int number) { return number < 0 ? "" : concat("profile_", number, ".toml"); }
    static void addTo(Image& image, const Names& names, const pel::CapturedImage& from) {
        image.width = int(from.width), image.height = int(from.height);
        image.addInterleaved(names, from.values);
    }
    // Writes these channels to a file; "": there is no image.
    std::string file(const std::string& name, const Names& names, const pel::CapturedImage& from) const {
        if (!from) return {};
        Image image;
        addTo(image, names, from);
        writeExr(folder_ + name + ".exr", image);
        return name + ".exr";
    }
    std::string colors(const std::string& name, const pel::CapturedImage& from) const {
        return file(name, {"R", "G", "B"}, from);
    }
    std::string table(const std::string& name, PelLut lut) const {
        if (!lut) return {};
        pelLutRetain(lut);
        writeLut(folder_ + name + ".exr", Lut(lut));
        return name + ".exr";
    }
    // Channels of the G-buffer.
    Names add(std::string_view key, const pel::CapturedImage& from) {
        if (!from) return {};
        Names names = channelNames(key, from.components);
        addTo(gbuffer_, names, from);
        return names;
    }

    void addLight(const pel::CapturedLight& from) {
        SceneLight light;
        light.light = from.light;
        const std::string name = concat("light_", scene_.lights.size());
        if (const Names wide = add(name, from.images[PEL_LIGHT_WIDE_SHADOW]); !wide.empty())
            light.wideShadow = wide[0];
        const auto map = [&](int slot, std::string& toFile, std::string& channel, std::string& second) {
            const pel::CapturedImage& image = from.images[slot];
            const Names names = channelNames("map", image.components);
            toFile = file(concat(name, "_map_", slot), names, image);
            if (image) channel = names[0];
            if (names.size() > 1) second = names[1];
        };
        map(PEL_LIGHT_SHADOW_MAP, light.shadowMapFile, light.shadowMapChannel, light.secondChannel);
        for (int i = 0; i < 3; ++i)
            map(PEL_LIGHT_CASCADE_1 + i, light.cascades[i].file, light.cascades[i].channel,
                light.cascades[i].secondChannel);
        scene_.lights.push_back(std::move(light));
    }

    std::string addTable(const std::string& name, PelLut lut, PelLutKind kind) {
        if (!lut) return {};
        SceneLut& to = scene_.luts.emplace_back();
        to.name = name;
        to.info.kind = kind;
        to.file = table(name, lut);
        return name;
    }

    void addMaterial(const pel::CapturedMaterial& from) {
        SceneMaterial& to = scene_.materials.emplace_back();
        to.id = from.id;
        to.material = from.material;
        to.scale = from.scale;
        to.profile = profile(from.profile);
        to.curvatureLut = addTable(concat("curvature_", from.id), from.curvature, PEL_LUT_CURVATURE);
        to.shadowLut = addTable(concat("shadow_", from.id), from.shadow, PEL_LUT_SHADOW);
        for (size_t level = 0; level < from.normalMap.size(); ++level)
            to.normalMapLevels.push_back(
                colors(concat("normal_map_", from.id, "_", level), from.normalMap[level]));
        to.scatteredTexture = colors(concat("scattered_", from.id), from.scatteredTexture);
        if (!from.eye) return;
        SceneEye& eye = scene_.eyes.emplace_back();
        eye.material = from.id;
        eye.eye = from.eye->eye;
        eye.irisProfile = profile(from.eye->irisProfile);
        eye.caustics = table(concat("caustics_", from.id), from.eye->caustics);
        eye.irisTexture = colors(concat("iris_", from.id), from.eye->iris);
    }

    const pel::CapturedFrame& frame_;
    std::string folder_;
    SceneFile scene_;
    Image gbuffer_;
};

}  // namespace
}  // namespace pellucid::io

#ifdef _WIN32
#define EXPORTED __declspec(dllexport)
#else
#define EXPORTED __attribute__((visibility("default")))
#endif
extern "C" EXPORTED std::string pellucidCapture(const pel::CapturedFrame& frame, const std::string& folder) {
    try {
        pellucid::io::Writer(frame, folder).write();
        return {};
    } catch (const std::exception& e) {
        return e.what();
    }
}
