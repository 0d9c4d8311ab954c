#include "frame.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "io/choice_keys.h"
#include "io/file_error.h"
#include "io/image/mip_chain.h"
#include "io/lut/lut_file.h"
#include "io/lut/profile_file.h"

namespace pellucid::cli {

namespace {

// Equal requests give equal bits, so that the description is the key. Its structures have no padding.
bool sameTable(const io::SceneLut& a, const io::SceneLut& b) {
    return a.file == b.file && a.expected == b.expected && a.profile == b.profile &&
           std::memcmp(&a.info, &b.info, sizeof a.info) == 0;
}

Lut make(const Device& device, const io::SceneLut& request) {
    if (!request.file.empty()) {
        const Lut lut = io::readLut(device, request.file);
        io::checkLutInfo(request.file, lut.info(), request.info, request.expected);
        return lut;
    }
    const Profile profile = request.profile.empty() ? Profile() : io::findProfile(request.profile).profile;
    PelLutInfo info = request.info;
    info.curvature.profile = info.shadow.profile = profile.get();
    return info.kind == PEL_LUT_CURVATURE ? Lut(device, info.curvature) : Lut(device, info.shadow);
}

std::string shown(float value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", double(value));
    return text;
}

// The values of a slot at each pixel that may have a material.
template <class Use>
void eachPixel(const io::Image& gbuffer, const io::SceneFile& scene, PelImageSlot slot, Use&& use) {
    const std::vector<float> values = gbuffer.interleaved(scene.channels[slot]);
    const size_t components = scene.channels[slot].size();
    std::vector<float> ids;
    if (!scene.channels[PEL_SLOT_MATERIAL].empty())
        ids = gbuffer.interleaved(scene.channels[PEL_SLOT_MATERIAL]);
    for (size_t i = 0; i < gbuffer.pixelCount(); ++i)
        if (ids.empty() || ids[i] > 0) use(&values[i * components]);
}

// The scene asks for curvature from the picture itself; a channel of that name would be meant instead.
bool isScreenCurvature(const io::Image& gbuffer, const io::SceneFile& scene) {
    const std::vector<std::string>& channel = scene.channels[PEL_SLOT_CURVATURE];
    if (channel != std::vector<std::string>{"screen"}) return false;
    return std::none_of(gbuffer.channels.begin(), gbuffer.channels.end(),
                        [](const auto& c) { return c.name == "screen"; });
}

// A shadow map with the pixels of these channels; without a name, of all.
io::Image readMap(const std::string& file, const std::string& channel, const std::string& second) {
    return channel.empty() ? io::readImage(file) : io::readChannels(file, {channel, second});
}

// R, G and B, or the first three channels; `need` says what the image should have.
std::vector<std::string> colorChannels(const std::string& file, const io::Image& image, const char* need) {
    if (image.channels.size() < 3)
        throw io::FileError(file, "has " + std::to_string(image.channels.size()) + " channels; " + need);
    std::vector<std::string> names{"R", "G", "B"};
    if (!(image.has("R") && image.has("G") && image.has("B")))
        for (size_t c = 0; c < 3; ++c) names[c] = image.channels[c].name;
    return names;
}

}  // namespace

Lut LutStore::faceworks(const Profile& profile, PelLutKind kind) {
    PelLutInfo info = pelLutInfoDefaults();  // whose descriptions are those of FaceWorks
    info.kind = kind;
    info.curvature.profile = info.shadow.profile = profile.get();
    const std::string name = profile.info().name;
    for (const auto& [key, lut] : faceworks_)
        if (key == std::pair(name, kind)) return lut;
    faceworks_.emplace_back(std::pair(name, kind), kind == PEL_LUT_CURVATURE ? Lut(device_, info.curvature)
                                                                             : Lut(device_, info.shadow));
    return faceworks_.back().second;
}

Lut LutStore::get(const io::SceneFile& scene, const std::string& name, PelLutKind kind) {
    if (name.empty()) return {};
    const io::SceneLut* request = scene.lut(name, kind);
    if (!request)
        throw io::FileError(scene.source, "no look-up table of this kind is named \"" + name + "\"");
    for (const auto& [known, lut] : luts_)
        if (sameTable(known, *request)) return lut;
    luts_.emplace_back(*request, make(device_, *request));
    return luts_.back().second;
}

Frame::Frame(const Device& device, const io::Image& gbuffer, const io::SceneFile& scene, LutStore& luts,
             const ShadowMaps& shadowMaps, const PelShaderOptions& options,
             const std::vector<PelImageSlot>& outputs)
    : shader_(device), radiance_(device, gbuffer.pixelCount() * 3 * sizeof(float)) {
    PelShaderOptions all = options;
    all.blurNormals |= scene.blurNormals;
    all.rotateTaps |= scene.rotateTaps;
    all.targetError = scene.targetError;
    if (scene.frameIndex) all.frameIndex = scene.frameIndex;
    all.millimetresPerUnit = scene.unitMm;
    shader_.set(all);
    shader_.set(PEL_SLOT_RADIANCE,
                imageDesc(radiance_, PEL_FORMAT_RGB32F, uint32_t(gbuffer.width), uint32_t(gbuffer.height)));
    for (PelImageSlot slot : outputs) {
        const bool length = slot == PEL_SLOT_OUT_THICKNESS;
        const Buffer buffer(device, gbuffer.pixelCount() * (length ? 1 : 3) * sizeof(float));
        shader_.set(slot, imageDesc(buffer, length ? PEL_FORMAT_R32F : PEL_FORMAT_RGB32F,
                                    uint32_t(gbuffer.width), uint32_t(gbuffer.height)));
        outputs_[slot] = buffer;
    }
    for (size_t slot = 0; slot < scene.channels.size(); ++slot)
        if (slot == PEL_SLOT_CURVATURE && isScreenCurvature(gbuffer, scene))
            shader_.set(PEL_SLOT_CURVATURE, measureCurvature(device, gbuffer, scene));
        else if (!scene.channels[slot].empty())
            shader_.set(PelImageSlot(slot), upload(device, gbuffer, scene.channels[slot]));
    for (const io::SceneMaterial& m : scene.materials) setMaterial(scene, m, luts);
    for (const io::SceneMaterial& m : scene.materials)
        if (!m.normalMap.empty()) setNormalMap(device, m.id, m.normalMap);
    for (const io::SceneMaterial& m : scene.materials)
        if (!m.scatteredTexture.empty()) setScatteredTexture(device, m.id, m.scatteredTexture);
    std::vector<PelLight> lights;
    for (const io::SceneLight& l : scene.lights) lights.push_back(l.light);
    shader_.set(lights);
    for (uint32_t i = 0; i < scene.lights.size(); ++i) {
        const io::SceneLight& l = scene.lights[i];
        if (!l.wideShadow.empty())
            shader_.set(i, PEL_LIGHT_WIDE_SHADOW, upload(device, gbuffer, {l.wideShadow}));
        if (l.shadowMapFile.empty()) continue;
        const auto setMap = [&](PelLightSlot slot, const std::string& file, const std::string& channel,
                                const std::string& second) {
            const auto known = shadowMaps.find(file);
            const io::Image read = known == shadowMaps.end() ? readMap(file, channel, second) : io::Image();
            const io::Image& map = known == shadowMaps.end() ? read : known->second;
            std::vector<std::string> channels{channel.empty() && map.channels.size() == 1 ? map.channels[0].name
                                                                                          : channel};
            if (!second.empty()) channels.push_back(second);
            shader_.set(i, slot, upload(device, map, channels));
        };
        setMap(PEL_LIGHT_SHADOW_MAP, l.shadowMapFile, l.shadowMapChannel, l.secondChannel);
        for (uint32_t k = 0; k + 1 < l.light.shadowCascades; ++k) {
            const io::SceneCascade& c = l.cascades[k];
            setMap(PelLightSlot(PEL_LIGHT_CASCADE_1 + k), c.file.empty() ? l.shadowMapFile : c.file,
                   c.channel, c.secondChannel);
        }
    }
    shader_.set(scene.ambient);
    for (const io::SceneEye& e : scene.eyes) setEye(device, scene, e);
    if (!scene.ambientCube.empty()) shader_.setAmbientCube(uploadCube(device, scene.ambientCube));
    if (!scene.reflectionCube.empty()) shader_.setReflectionCube(uploadCube(device, scene.reflectionCube));
    shader_.set(scene.camera);
    shader_.commit();
}

void Frame::setMaterial(const io::SceneFile& scene, const io::SceneMaterial& m, LutStore& luts) {
    PelMaterial material = m.material;
    Lut curvature = luts.get(scene, m.curvatureLut, PEL_LUT_CURVATURE),
        shadow = luts.get(scene, m.shadowLut, PEL_LUT_SHADOW);
    Profile profile;
    try {
        if (!m.profile.empty()) profile = io::findProfile(m.profile).profile;
    } catch (const io::FileError& e) {
        throw io::FileError(scene.source,
                            "the profile of material " + std::to_string(m.id) + " is refused: " + e.what(),
                            m.line);
    }
    if (m.preset == io::ScenePreset::faceworks) {
        if (!profile) profile = Profile::skin();
        if (!curvature) curvature = luts.faceworks(profile, PEL_LUT_CURVATURE);
        if (!shadow) shadow = luts.faceworks(profile, PEL_LUT_SHADOW);
        if (material.scattering == PEL_SCATTERING_AUTO) material.scattering = PEL_SCATTERING_PREINTEGRATED;
        if (material.diffusionRadius == 0) material.diffusionRadius = profile.info().radius / scene.unitMm;
    } else {
        material.profile = profile.get();
    }
    shader_.setMaterial(m.id, material, curvature, shadow);
}

void Frame::setEye(const Device& device, const io::SceneFile& scene, const io::SceneEye& e) {
    PelEye eye = e.eye;
    Profile profile;
    try {
        if (!e.irisProfile.empty()) profile = io::findProfile(e.irisProfile).profile;
        eye.irisProfile = profile.get();
        shader_.setEye(e.material, eye, e.caustics.empty() ? Lut() : io::readLut(device, e.caustics));
    } catch (const Error& error) {
        throw io::FileError(scene.source, error.what(), e.line);
    }
    if (e.irisTexture.empty()) return;
    const io::Image image = io::readImage(e.irisTexture);
    shader_.setIrisTexture(
        e.material,
        upload(device, image, colorChannels(e.irisTexture, image, "the texture of an iris needs three")));
}

PelImageDesc Frame::uploadCube(const Device& device, const std::string& file) {
    const io::Image image = io::readImage(file);
    if (image.height != 6 * image.width && image.width != 6 * image.height)
        throw io::FileError(
            file,
            "is " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                "; a cube map is six square faces, one below the other (n x 6n) or side by side (6n x n)");
    return upload(device, image, colorChannels(file, image, "a cube map needs three: red, green, blue"));
}

void Frame::setNormalMap(const Device& device, uint32_t id, const std::string& file) {
    const io::Image image = io::readImage(file);
    std::vector<float> normals =
        image.interleaved(colorChannels(file, image, "a normal map needs three: x, y, z, from 0 to 1"));
    for (float& v : normals) v = 2 * v - 1;
    const io::MipChain chain = io::mipChain(image.width, image.height, std::move(normals));
    inputs_.emplace_back(device, chain.texels);
    inputBytes_ += inputs_.back().bytes();
    std::vector<PelImageDesc> levels;
    for (const io::MipLevel& level : chain.levels)
        levels.push_back(imageDesc(inputs_.back(), PEL_FORMAT_RGB32F, uint32_t(level.width),
                                   uint32_t(level.height), level.byteOffset));
    shader_.setNormalMap(id, levels);
}

void Frame::setScatteredTexture(const Device& device, uint32_t id, const std::string& file) {
    const io::Image image = io::readImage(file);
    shader_.setScatteredTexture(
        id, upload(device, image, colorChannels(file, image, "a scattered texture needs three")));
}

PelImageDesc Frame::measureCurvature(const Device& device, const io::Image& gbuffer, const io::SceneFile& scene) {
    const auto image = [&](PelImageSlot slot) {
        return scene.channels[slot].empty() ? pelImageDescDefaults()
                                            : upload(device, gbuffer, scene.channels[slot]);
    };
    // The surface's own normals where there are: those of a normal map turn without the surface doing so.
    const PelImageDesc normals =
        image(scene.channels[PEL_SLOT_NORMAL_GEOMETRIC].empty() ? PEL_SLOT_NORMAL_SHADING
                                                                : PEL_SLOT_NORMAL_GEOMETRIC);
    const PelImageDesc positions = image(PEL_SLOT_POSITION), ids = image(PEL_SLOT_MATERIAL);
    const PelImageDesc depth = positions.buffer ? pelImageDescDefaults() : image(PEL_SLOT_DEPTH);
    if (!positions.buffer && !depth.buffer)
        throw io::FileError(scene.source,
                            "[channels] curvature = \"screen\" is measured from positions or depth; "
                            "name their channels");
    PelScreenCurvatureParams params = pelScreenCurvatureParamsDefaults();
    std::copy_n(scene.camera.inverseViewProjection, 16, params.inverseViewProjection);
    inputs_.emplace_back(device, gbuffer.pixelCount() * sizeof(float));
    const PelImageDesc curvature =
        imageDesc(inputs_.back(), PEL_FORMAT_R32F, uint32_t(gbuffer.width), uint32_t(gbuffer.height));
    screenCurvature(device, params, normals, positions.buffer ? &positions : nullptr,
                    depth.buffer ? &depth : nullptr, ids.buffer ? &ids : nullptr, curvature);
    return curvature;
}

PelImageDesc Frame::upload(const Device& device, const io::Image& image,
                           const std::vector<std::string>& channels) {
    static constexpr PelFormat formats[] = {PEL_FORMAT_R32F, PEL_FORMAT_RG32F, PEL_FORMAT_RGB32F,
                                            PEL_FORMAT_RGBA32F};
    for (const std::string& name : channels) image.channel(name);  // an error before memory is taken
    const Buffer& buffer = inputs_.emplace_back(device, channels.size() * image.pixelCount() * sizeof(float));
    image.interleave(channels, static_cast<float*>(buffer.map()));
    buffer.unmap();
    inputBytes_ += buffer.bytes();
    return imageDesc(inputs_.back(), formats[channels.size() - 1], uint32_t(image.width), uint32_t(image.height));
}

std::vector<std::string> unlikely(const io::Image& gbuffer, const io::SceneFile& scene) {
    std::vector<std::string> found;
    if (!scene.channels[PEL_SLOT_DEPTH].empty() && scene.channels[PEL_SLOT_POSITION].empty()) {
        float furthest = 0;
        eachPixel(gbuffer, scene, PEL_SLOT_DEPTH, [&](const float* v) {
            if (std::isfinite(v[0])) furthest = std::max(furthest, v[0]);
        });
        if (furthest > 1.001f)
            found.push_back("the depth channel reaches " + shown(furthest) +
                            ", and device depth ends at 1: it looks like a distance along the "
                            "view; name a position channel, or write the depth that the projection gives");
    }
    if (scene.channels[PEL_SLOT_POSITION].empty()) return found;
    float low[3], high[3];
    bool any = false;
    eachPixel(gbuffer, scene, PEL_SLOT_POSITION, [&](const float* p) {
        if (!(std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]))) return;
        for (int c = 0; c < 3; ++c) {
            low[c] = any ? std::min(low[c], p[c]) : p[c];
            high[c] = any ? std::max(high[c], p[c]) : p[c];
        }
        any = true;
    });
    if (!any) return found;
    const float size = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]}) * scene.unitMm;
    for (const io::SceneMaterial& m : scene.materials) {
        if (m.profile.empty()) continue;
        const float reach = io::findProfile(m.profile).profile.info().reach;
        // Seen whole, nothing of skin is smaller than a fingertip, nor larger than a few people.
        if (size > 2.3f * reach && size < 500 * reach) continue;
        found.push_back("what is seen is " + shown(size) + " mm long with unit_mm = " + shown(scene.unitMm) +
                        ", and light reaches " + shown(reach) + " mm far in the profile of material " +
                        std::to_string(m.id) +
                        ": unit_mm says how many millimetres a unit of the positions is");
    }
    return found;
}

void writeRadiance(const std::string& path, int width, int height, const std::vector<float>& radiance) {
    io::Image image;
    image.width = width;
    image.height = height;
    image.addInterleaved(std::vector<std::string>{"R", "G", "B"}, radiance);
    io::writeExr(path, image);
}

void writeThickness(const std::string& path, int width, int height, const std::vector<float>& lengths) {
    io::Image image;
    image.width = width;
    image.height = height;
    image.addInterleaved(std::vector<std::string>{"Thickness.V"}, lengths);
    io::writeExr(path, image);
}

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
            {"pixels_eye", s.pixelsEye},
            {"pixels_iris", s.pixelsIris},
            {"pixels_caustic", s.pixelsCaustic},
            {"tiles_eye", s.tilesEye},
            {"pixels_wide_shadow", s.pixelsWideShadow},
            {"pixels_shadow_texels", s.pixelsShadowTexels},
            {"bands", s.bands},
            {"pixels_invalid", s.pixelsInvalid},
            {"shade_ms", s.deviceMilliseconds}};
}

}  // namespace pellucid::cli
