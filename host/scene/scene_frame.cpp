#include "scene/scene_frame.h"

#include <cstring>

#include "io/choice_keys.h"
#include "io/lut/lut_file.h"
#include "io/lut/profile_file.h"

namespace pellucid::io {
namespace {

// Equal requests give equal bits, so that the description is the key. Its structures have no padding.
bool sameTable(const SceneLut& a, const SceneLut& b) {
    return a.file == b.file && a.expected == b.expected && a.profile == b.profile &&
           std::memcmp(&a.info, &b.info, sizeof a.info) == 0;
}

Lut make(const Device& device, const SceneLut& request) {
    if (!request.file.empty()) {
        const Lut lut = readLut(device, request.file);
        checkLutInfo(request.file, lut.info(), request.info, request.expected);
        return lut;
    }
    const Profile profile = request.profile.empty() ? Profile() : findProfile(request.profile).profile;
    PelLutInfo info = request.info;
    info.curvature.profile = info.shadow.profile = profile.get();
    return info.kind == PEL_LUT_CURVATURE ? Lut(device, info.curvature) : Lut(device, info.shadow);
}

// True if curvature is measured from the picture, unless the G-buffer has a channel called "screen".
bool isScreenCurvature(const Image& gbuffer, const SceneFile& scene) {
    const std::vector<std::string>& channel = scene.channels[PEL_SLOT_CURVATURE];
    if (channel != std::vector<std::string>{"screen"}) return false;
    return std::none_of(gbuffer.channels.begin(), gbuffer.channels.end(),
                        [](const auto& c) { return c.name == "screen"; });
}

// A shadow map with the pixels of these channels; without a name, of all.
Image readMap(const std::string& file, const std::string& channel, const std::string& second) {
    return channel.empty() ? readImage(file) : readChannels(file, {channel, second});
}

void clear(const Buffer& buffer) {
    std::memset(buffer.map(), 0, buffer.bytes());
    buffer.unmap();
}

// R, G and B, or the first three channels; `need`: the requirement, for messages.
std::vector<std::string> colorChannels(const std::string& file, const Image& image, const char* need) {
    if (image.channels.size() < 3)
        throw FileError(file, concat("has ", image.channels.size(), " channels; ", need));
    std::vector<std::string> names{"R", "G", "B"};
    if (!(image.has("R") && image.has("G") && image.has("B")))
        for (size_t c = 0; c < 3; ++c) names[c] = image.channels[c].name;
    return names;
}

}  // namespace

std::map<std::string, ShadowMapFile> shadowMapsOf(const SceneFile& scene) {
    std::map<std::string, ShadowMapFile> files;
    for (const SceneLight& light : scene.lights) {
        if (light.shadowMapFile.empty()) continue;
        const auto add = [&](const std::string& file, const std::string& channel, const std::string& second) {
            ShadowMapFile& map = files[file.empty() ? light.shadowMapFile : file];
            map.cube |= light.light.shadowProjection >= PEL_SHADOW_CUBE;
            map.groups.insert(second.empty() ? ChannelGroup{channel} : ChannelGroup{channel, second});
        };
        add(light.shadowMapFile, light.shadowMapChannel, light.secondChannel);
        for (const SceneCascade& c : light.furtherCascades()) add(c.file, c.channel, c.secondChannel);
    }
    return files;
}

ShadowMaps readShadowMaps(const SceneFile& scene) {
    ShadowMaps maps;
    for (const auto& [file, map] : shadowMapsOf(scene)) {
        const std::set<std::string> names = namesOf(map.groups);
        maps[file] = names.contains("") ? readImage(file) : readChannels(file, {names.begin(), names.end()});
    }
    return maps;
}

ShadowMaps readShadowMaps(const SceneFile& scene, DeviceImages& images) {
    ShadowMaps maps;
    for (const auto& [file, map] : shadowMapsOf(scene)) maps[file] = images.read(file, map.groups);
    return maps;
}

Lut LutStore::faceworks(const std::string& source, const Profile& profile, PelLutKind kind) {
    PelCurvatureLutDesc curvature = pelCurvatureLutDescFaceWorks();
    PelShadowLutDesc shadow = pelShadowLutDescFaceWorks();
    curvature.profile = shadow.profile = profile.get();
    for (const auto& [key, lut] : faceworks_)
        if (key == std::pair(source, kind)) return lut;
    faceworks_.emplace_back(std::pair(source, kind),
                            kind == PEL_LUT_CURVATURE ? Lut(device_, curvature) : Lut(device_, shadow));
    return faceworks_.back().second;
}

Lut LutStore::get(const SceneFile& scene, const std::string& name, PelLutKind kind) {
    if (name.empty()) return {};
    const SceneLut* request = scene.lut(name, kind);
    if (!request) throw FileError(scene.source, "no look-up table of this kind is named \"" + name + "\"");
    for (const auto& [known, lut] : luts_)
        if (sameTable(known, *request)) return lut;
    luts_.emplace_back(*request, make(device_, *request));
    return luts_.back().second;
}

SceneFrame::SceneFrame(const Device& device, const Image& gbuffer, const SceneFile& scene, LutStore& luts,
                       const ShadowMaps& shadowMaps, const PelShaderOptions& options,
                       const std::vector<PelImageSlot>& outputs, bool buildOnly)
    : device_(device), wanted_(outputs), shadowMaps_(&shadowMaps), shader_(device) {
    if (scene.scatter)
        throw FileError(scene.source,
                        "has a [scatter] table, and nothing to shade: `pellucid shade` alone reads it");
    setPictures(gbuffer, scene);
    set(scene, luts, options);
    shadowMaps_ = nullptr;
    if (!buildOnly) {
        shader_.commit();
        return;
    }
    PelShaderOptions whole = withOptionsOf(scene, options);
    const PelShaderOptions wanted = whole;
    whole.regionX = whole.regionY = whole.regionWidth = whole.regionHeight = 0;  // `gbuffer` is a blank one
    shader_.set(whole);
    if (!options.buildInBackground) warmUpPrograms(device_, 0, {shader_});
    shader_.set(wanted);
    gbuffer_ = nullptr;
}

void SceneFrame::show(const Image& gbuffer, const SceneFile& scene, const ShadowMaps& shadowMaps,
                      const DeviceImages* images) {
    shadowMaps_ = &shadowMaps;
    deviceImages_ = images;
    pictures_.clear();
    maps_.clear();
    setPictures(gbuffer, scene);
    setLights(scene);
    shader_.commit();
    shadowMaps_ = nullptr;
    deviceImages_ = nullptr;
}

void SceneFrame::setPictures(const Image& gbuffer, const SceneFile& scene) {
    gbuffer_ = &gbuffer;
    const auto width = uint32_t(gbuffer.width), height = uint32_t(gbuffer.height);
    before_.clear();
    if (const ChannelGroup& held = scene.channels[PEL_SLOT_RADIANCE]; !held.empty()) {
        const PixelValues values(gbuffer, held, deviceImages_);
        before_.assign(values.at(), values.at() + 3 * gbuffer.pixelCount());
    }
    radiance_ =
        Buffer(device_, gbuffer.pixelCount() * 3 * sizeof(float), before_.empty() ? nullptr : before_.data());
    shader_.set(PEL_SLOT_RADIANCE, imageDesc(radiance_, PEL_FORMAT_RGB32F, width, height));
    for (PelImageSlot slot : wanted_) {
        const bool length = slot == PEL_SLOT_OUT_THICKNESS;
        const Buffer buffer(device_, gbuffer.pixelCount() * (length ? 1 : 3) * sizeof(float));
        shader_.set(slot, imageDesc(buffer, length ? PEL_FORMAT_R32F : PEL_FORMAT_RGB32F, width, height));
        outputs_[slot] = buffer;
    }
    for (size_t slot = PEL_SLOT_RADIANCE + 1; slot < scene.channels.size(); ++slot)
        if (slot == PEL_SLOT_CURVATURE && isScreenCurvature(gbuffer, scene))
            shader_.set(PEL_SLOT_CURVATURE, measureCurvature(scene));
        else if (!scene.channels[slot].empty())
            shader_.set(PelImageSlot(slot), upload(gbuffer, scene.channels[slot], pictures_));
}

uint64_t SceneFrame::inputBytes() const {
    uint64_t bytes = 0;
    for (const std::vector<Buffer>* buffers : {&pictures_, &files_})
        for (const Buffer& b : *buffers) bytes += b.bytes();
    return bytes;
}

PelShaderOptions withOptionsOf(const SceneFile& scene, PelShaderOptions options) {
    const PelShaderOptions& own = scene.options;
    options.accumulate |= own.accumulate;
    options.blurNormals |= own.blurNormals;
    options.rotateTaps |= own.rotateTaps;
    options.everyPixel |= own.everyPixel;
    options.halfRate |= own.halfRate;
    options.buildInBackground |= own.buildInBackground;
    options.targetError = own.targetError;
    if (options.timeBudget == 0) options.timeBudget = own.timeBudget;
    if (own.frameIndex) options.frameIndex = own.frameIndex;
    if (own.historyWeight > 0) options.historyWeight = own.historyWeight;
    options.historyCut += own.historyCut;
    options.millimetresPerUnit = own.millimetresPerUnit;
    return options;
}

void SceneFrame::update(const SceneFile& scene, LutStore& luts, const PelShaderOptions& options) {
    // The moment is the same, so the motion in the G-buffer does not refer to the previous execution.
    PelShaderOptions anew = options;
    anew.historyCut += ++updates_;
    set(scene, luts, anew);
    shader_.commit();
}

void SceneFrame::set(const SceneFile& scene, LutStore& luts, const PelShaderOptions& options) {
    shader_.set(withOptionsOf(scene, options));
    std::set<uint32_t> materials, eyes;
    for (const SceneMaterial& m : scene.materials) materials.insert(m.id);
    for (const SceneEye& e : scene.eyes) eyes.insert(e.material);
    bool removed = false;
    for (const uint32_t id : materials_)
        if (!materials.contains(id)) {
            check(pelShaderSetMaterial(shader_.get(), id, nullptr, nullptr, nullptr));
            irises_.erase(id);
            removed = true;
        }
    for (auto iris = irises_.begin(); iris != irises_.end();)
        if (eyes.contains(iris->first)) {
            ++iris;
        } else {
            shader_.clearEye(iris->first);
            iris = irises_.erase(iris);
        }
    materials_ = materials;
    // Pixels whose material is removed are not written again.
    if (removed || options.accumulate) {
        if (before_.empty())
            clear(radiance_);
        else
            radiance_.write(before_.data(), radiance_.bytes());
        for (const auto& [slot, buffer] : outputs_) clear(buffer);
    }
    for (const SceneMaterial& m : scene.materials) setMaterial(scene, m, luts);
    for (const SceneMaterial& m : scene.materials) {
        shader_.setNormalMap(m.id, !m.normalMap.empty()        ? normalMap(m.normalMap)
                                   : m.normalMapLevels.empty() ? std::vector<PelImageDesc>()
                                                               : normalMapLevels(m.normalMapLevels));
        if (m.scatteredTexture.empty())
            shader_.clearScatteredTexture(m.id);
        else
            shader_.setScatteredTexture(m.id,
                                        colorImage(m.scatteredTexture, "a scattered texture needs three"));
    }
    setLights(scene);
    shader_.set(scene.ambient);
    for (const SceneEye& e : scene.eyes) setEye(scene, e);
    const auto setCube = [&](const std::string& file, auto set) {
        const PelImageDesc cube = file.empty() ? pelImageDescDefaults() : cubeImage(file);
        check(set(shader_.get(), file.empty() ? nullptr : &cube));
    };
    setCube(scene.ambientCube, pelShaderSetAmbientCube);
    setCube(scene.reflectionCube, pelShaderSetReflectionCube);
    if (scene.environment != environment_.first ||
        !std::ranges::equal(scene.environmentAxes, environment_.second)) {
        environment_ = {scene.environment, std::to_array(scene.environmentAxes)};
        if (scene.environment.empty())
            shader_.clearEnvironment();
        else
            shader_.setEnvironment(colorImage(scene.environment, "an environment needs three"),
                                   scene.environmentAxes);
    }
    shader_.set(scene.camera);
}

void SceneFrame::setLights(const SceneFile& scene) {
    std::vector<PelLight> lights;
    for (const SceneLight& l : scene.lights) lights.push_back(l.light);
    shader_.set(lights);
    for (uint32_t i = 0; i < scene.lights.size(); ++i) {
        const SceneLight& l = scene.lights[i];
        if (!l.wideShadow.empty()) {
            PelImageDesc& wide = maps_[{"", l.wideShadow}];
            if (!wide.buffer) wide = upload(*gbuffer_, {l.wideShadow}, pictures_);
            shader_.set(i, PEL_LIGHT_WIDE_SHADOW, wide);
        }
        if (l.shadowMapFile.empty()) continue;
        shader_.set(i, PEL_LIGHT_SHADOW_MAP, mapOf(l.shadowMapFile, l.shadowMapChannel, l.secondChannel));
        auto slot = int(PEL_LIGHT_CASCADE_1);
        for (const SceneCascade& c : l.furtherCascades())
            shader_.set(i, PelLightSlot(slot++),
                        mapOf(c.file.empty() ? l.shadowMapFile : c.file, c.channel, c.secondChannel));
    }
}

const Image* SceneFrame::givenImage(const std::string& file) const {
    if (!shadowMaps_) return nullptr;
    const auto given = shadowMaps_->find(file);
    return given == shadowMaps_->end() ? nullptr : &given->second;
}

PelImageDesc SceneFrame::mapOf(const std::string& file, const std::string& channel,
                               const std::string& second) {
    const std::vector<std::string> key{file, channel, second};
    if (const auto kept = maps_.find(key); kept != maps_.end()) return kept->second;
    const Image* const known = givenImage(file);
    const Image read = known ? Image() : readMap(file, channel, second);
    const Image& map = known ? *known : read;
    std::vector<std::string> channels{channel.empty() && map.channels.size() == 1 ? map.channels[0].name
                                                                                  : channel};
    if (!second.empty()) channels.push_back(second);
    return maps_[key] = upload(map, channels, pictures_);
}

// The radius of a table from a file, in mm: `pellucid lut` writes mm, while the library takes the radius of a
// table in the scene's unit. 0 for other tables, and if the scene itself names the radius.
static float fileRadius(const SceneFile& scene, const std::string& name, const Lut& lut) {
    if (!lut) return 0;
    const PelLutInfo info = lut.info();
    const SceneLut& table = *scene.lut(name, info.kind);
    if (table.file.empty() || std::ranges::count(table.expected, "diffusion_radius")) return 0;
    return info.kind == PEL_LUT_SHADOW ? info.shadow.diffusionRadius : info.curvature.diffusionRadius;
}

void SceneFrame::setMaterial(const SceneFile& scene, const SceneMaterial& m, LutStore& luts) {
    PelMaterial material = m.material;
    Lut curvature = luts.get(scene, m.curvatureLut, PEL_LUT_CURVATURE),
        shadow = luts.get(scene, m.shadowLut, PEL_LUT_SHADOW);
    Profile profile;
    try {
        profile = profileOf(m.profile);
    } catch (const FileError& e) {
        throw FileError(scene.source, concat("the profile of material ", m.id, " is refused: ", e.what()),
                        m.line);
    }
    if (m.preset == ScenePreset::faceworks) {
        if (!profile) profile = Profile::skin();
        if (!curvature) curvature = luts.faceworks(m.profile, profile, PEL_LUT_CURVATURE);
        if (!shadow) shadow = luts.faceworks(m.profile, profile, PEL_LUT_SHADOW);
        if (material.scattering == PEL_SCATTERING_AUTO) material.scattering = PEL_SCATTERING_PREINTEGRATED;
        if (material.diffusionRadius == 0)
            material.diffusionRadius = profile.info().radius / scene.options.millimetresPerUnit;
    } else if (profile) {
        material.profile = profile.get();
    } else if (material.diffusionRadius == 0) {
        const float mm =
            curvature ? fileRadius(scene, m.curvatureLut, curvature) : fileRadius(scene, m.shadowLut, shadow);
        material.diffusionRadius = mm / scene.options.millimetresPerUnit;
    }
    shader_.setMaterial(m.id, material, curvature, shadow);
}

void SceneFrame::setEye(const SceneFile& scene, const SceneEye& e) {
    PelEye eye = e.eye;
    Profile profile;
    try {
        profile = profileOf(e.irisProfile);
        eye.irisProfile = profile.get();
        Lut& caustics = caustics_[e.caustics];
        if (!caustics && !e.caustics.empty()) caustics = readLut(device_, e.caustics);
        shader_.setEye(e.material, eye, caustics);
    } catch (const Error& error) {
        throw FileError(scene.source, error.what(), e.line);
    }
    // A texture that is set is read again.
    const auto iris = irises_.try_emplace(e.material).first;
    if (iris->second == e.irisTexture) return;
    if (e.irisTexture.empty())
        shader_.clearIrisTexture(e.material);
    else
        shader_.setIrisTexture(e.material, colorImage(e.irisTexture, "the texture of an iris needs three"));
    iris->second = e.irisTexture;
}

PelImageDesc SceneFrame::cubeImage(const std::string& file) {
    if (const auto kept = images_.find({file}); kept != images_.end()) return kept->second;
    const Image image = readImage(file);
    if (image.height != 6 * image.width && image.width != 6 * image.height)
        throw FileError(
            file,
            concat(
                "is ", image.width, " x ", image.height,
                "; a cube map is six square faces, one below the other (n x 6n) or side by side (6n x n)"));
    return images_[{file}] =
               upload(image, colorChannels(file, image, "a cube map needs three: red, green, blue"), files_);
}

const std::vector<PelImageDesc>& SceneFrame::normalMap(const std::string& file) {
    std::vector<PelImageDesc>& levels = normalMaps_[{file}];
    if (!levels.empty()) return levels;
    const Image image = readImage(file);
    std::vector<float> normals =
        image.interleaved(colorChannels(file, image, "a normal map needs three: x, y, z, from 0 to 1"));
    for (float& v : normals) v = 2 * v - 1;
    const MipChain chain = mipChain(image.width, image.height, std::move(normals));
    files_.emplace_back(device_, chain.texels);
    for (const MipLevel& level : chain.levels)
        levels.push_back(imageDesc(files_.back(), PEL_FORMAT_RGB32F, uint32_t(level.width),
                                   uint32_t(level.height), level.byteOffset));
    return levels;
}

const std::vector<PelImageDesc>& SceneFrame::normalMapLevels(const std::vector<std::string>& files) {
    std::vector<std::string> key = files;
    key.emplace_back();  // differs from the key of a map whose levels are made
    std::vector<PelImageDesc>& levels = normalMaps_[key];
    if (!levels.empty()) return levels;
    std::vector<Image> images;
    std::vector<float> texels;
    for (const std::string& file : files) {
        const Image& image = images.emplace_back(readImage(file));
        const auto names = colorChannels(file, image, "a level of a normal map needs three: x, y, z");
        const std::vector<float> values = image.interleaved(names);
        texels.insert(texels.end(), values.begin(), values.end());
    }
    files_.emplace_back(device_, texels);
    uint64_t offset = 0;
    for (const Image& image : images) {
        levels.push_back(imageDesc(files_.back(), PEL_FORMAT_RGB32F, uint32_t(image.width),
                                   uint32_t(image.height), offset));
        offset += image.pixelCount() * 3 * sizeof(float);
    }
    return levels;
}

Profile SceneFrame::profileOf(const std::string& nameOrPath) {
    if (nameOrPath.empty()) return {};
    const auto known = profiles_.find(nameOrPath);
    return known != profiles_.end()
               ? known->second
               : profiles_.emplace(nameOrPath, findProfile(nameOrPath).profile).first->second;
}

PelImageDesc SceneFrame::colorImage(const std::string& file, const char* need) {
    if (const auto kept = images_.find({file}); kept != images_.end()) return kept->second;
    const Image* const given = givenImage(file);
    const Image read = given ? Image() : readImage(file);
    const Image& image = given ? *given : read;
    return images_[{file}] = upload(image, colorChannels(file, image, need), files_);
}

PelImageDesc SceneFrame::measureCurvature(const SceneFile& scene) {
    const auto image = [&](PelImageSlot slot) {
        return scene.channels[slot].empty() ? pelImageDescDefaults()
                                            : upload(*gbuffer_, scene.channels[slot], pictures_);
    };
    // Geometric normals if there are any, because those of a normal map do not follow the surface.
    const PelImageDesc normals =
        image(scene.channels[PEL_SLOT_NORMAL_GEOMETRIC].empty() ? PEL_SLOT_NORMAL_SHADING
                                                                : PEL_SLOT_NORMAL_GEOMETRIC);
    const PelImageDesc positions = image(PEL_SLOT_POSITION), ids = image(PEL_SLOT_MATERIAL);
    const PelImageDesc depth = positions.buffer ? pelImageDescDefaults() : image(PEL_SLOT_DEPTH);
    if (!positions.buffer && !depth.buffer)
        throw FileError(
            scene.source,
            "[channels] curvature = \"screen\" is measured from positions or depth; name their channels");
    PelScreenCurvatureParams params = pelScreenCurvatureParamsDefaults();
    std::copy_n(scene.camera.inverseViewProjection, 16, params.inverseViewProjection);
    pictures_.emplace_back(device_, gbuffer_->pixelCount() * sizeof(float));
    const PelImageDesc curvature =
        imageDesc(pictures_.back(), PEL_FORMAT_R32F, uint32_t(gbuffer_->width), uint32_t(gbuffer_->height));
    screenCurvature(device_, params, normals, positions.buffer ? &positions : nullptr,
                    depth.buffer ? &depth : nullptr, ids.buffer ? &ids : nullptr, curvature);
    return curvature;
}

PelImageDesc SceneFrame::upload(const Image& image, const std::vector<std::string>& channels,
                                std::vector<Buffer>& to) {
    if (deviceImages_)
        if (const OwnedImage* known = deviceImages_->find(image, channels)) return **known;
    for (const std::string& name : channels) image.channel(name);  // throws before memory is allocated
    const Buffer& buffer = to.emplace_back(device_, channels.size() * image.pixelCount() * sizeof(float));
    image.interleave(channels, MappedBuffer(buffer).at());
    return imageDesc(buffer, groupFormats[channels.size() - 1], uint32_t(image.width),
                     uint32_t(image.height));
}

static void writeChannels(const std::string& path, int width, int height, const ChannelGroup& names,
                          const std::vector<float>& values) {
    Image image;
    image.width = width;
    image.height = height;
    image.addInterleaved(names, values);
    writeExr(path, image);
}

// A black image with these channels, of the smallest size that the kernels treat like a frame.
static Image blank(const std::set<std::string>& channels, int height = 2) {
    Image image;
    image.width = 16;
    image.height = height;
    for (const std::string& name : channels)
        if (!name.empty()) image.addInterleaved(std::vector{name}, std::vector<float>(image.pixelCount()));
    return image;
}

static Image blankGBuffer(const SceneFile& scene) {
    std::set<std::string> channels;
    for (size_t slot = 0; slot < scene.channels.size(); ++slot)
        if (slot != PEL_SLOT_CURVATURE || scene.channels[slot] != std::vector<std::string>{"screen"})
            channels.insert(scene.channels[slot].begin(), scene.channels[slot].end());
    for (const SceneLight& light : scene.lights) channels.insert(light.wideShadow);
    return blank(channels);
}

static ShadowMaps blankMaps(const SceneFile& scene) {
    ShadowMaps maps;
    for (const auto& [file, map] : shadowMapsOf(scene)) {
        std::set<std::string> names = namesOf(map.groups);
        if (names.erase("") && names.empty()) names.insert("Z");
        Image& image = maps[file] = blank(names, map.cube ? 6 * 16 : 2);
        image.source = file;
    }
    return maps;
}

void writeRadiance(const std::string& path, int width, int height, const std::vector<float>& radiance) {
    writeChannels(path, width, height, {"R", "G", "B"}, radiance);
}

void writeThickness(const std::string& path, int width, int height, const std::vector<float>& lengths) {
    writeChannels(path, width, height, {"Thickness.V"}, lengths);
}

SceneFrame prepareFrame(const Device& device, const SceneFile& scene, LutStore& luts,
                        const PelShaderOptions& options, const std::vector<PelImageSlot>& outputs) {
    return {device, blankGBuffer(scene), scene, luts, blankMaps(scene), options, outputs, true};
}

void buildPrograms(const Device& device, const SceneFile& scene, LutStore& luts, const ShadowMaps& images) {
    ShadowMaps maps = blankMaps(scene);
    maps.insert(images.begin(), images.end());
    SceneFrame(device, blankGBuffer(scene), scene, luts, maps, pelShaderOptionsDefaults(), {}, true);
}

}  // namespace pellucid::io
