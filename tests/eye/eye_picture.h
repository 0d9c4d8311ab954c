// A picture of one eye: the G-buffer of its exact surface, shaded by the library and by the tracer.
#pragma once
#include "eye/reference_eye.h"
#include "shading/shade_scene.h"

namespace eye_test {

using reference::Rgb;
using reference::Vec3;

struct EyeScene {
    PelEye eye = pelEyeDefaults();
    PelMaterial sclera = pelMaterialDefaults();
    std::vector<PelLight> lights;
    PelAmbient ambient = pelAmbientDefaults();
    double unit = 10;  // mm
    Vec3 camera{5.2, 1.1, 9.3};
    int size = 80, textureSize = 0;
    std::vector<float> texture;                    // RGB
    std::vector<float> wetness, shadow, indirect;  // per pixel; empty: none
    bool skipping = true;

    EyeScene() {
        sclera.albedo[0] = 0.8f, sclera.albedo[1] = 0.75f, sclera.albedo[2] = 0.7f;
        sclera.scattering = PEL_SCATTERING_NONE;
        const float center[3] = {1.5f, -0.4f, 2}, gaze[3] = {0.3f, 0.1f, 0.9f};
        for (int i = 0; i < 3; ++i) eye.center[i] = center[i], eye.gaze[i] = gaze[i];
    }
    void addLight(Vec3 toLight, Rgb color) {
        PelLight& light = lights.emplace_back(pelLightDefaults());
        shade_test::copyTo(light.toLight, normalized(toLight));
        shade_test::copyTo(light.color, color);
    }
    // Bands round and rays outwards, of three colours.
    void makeTexture(int n) {
        textureSize = n;
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const double x = (i + 0.5) / n * 2 - 1, y = (j + 0.5) / n * 2 - 1, r = std::hypot(x, y),
                             a = std::atan2(y, x);
                for (int c = 0; c < 3; ++c) {
                    const double pattern = std::sin(12 * r + c) * std::cos((5 + c) * a);
                    texture.push_back(float(0.5 + 0.3 * pattern + 0.1 * x));
                }
            }
    }
};

struct EyePixel {
    reference::EyeHit hit;
    Vec3 position, normal;  // world
    Vec3 eyeToCamera;       // in the eye's space
    bool shown = false;
};

class EyePicture {
  public:
    const pellucid::Device device = ::device();

    explicit EyePicture(const EyeScene& scene)
        : s_(scene), truth_(referenceOf(scene.eye)), texture_{scene.textureSize, scene.textureSize, {}} {
        const std::vector<float>& t = scene.texture;
        for (size_t i = 0; i < t.size(); i += 3) texture_.texels.push_back({t[i], t[i + 1], t[i + 2]});
        z_ = normalized(vec(s_.eye.gaze));
        y_ = vec(s_.eye.up);
        y_ = normalized(y_ - dot(y_, z_) * z_);
        x_ = cross(y_, z_);
        const Vec3 forward = normalized(vec(s_.eye.center) - s_.camera);
        const Vec3 right = normalized(cross(forward, Vec3{0, 1, 0})), down = cross(forward, right);
        const double half = 1.15 * s_.eye.scleraRadius / s_.unit / length(vec(s_.eye.center) - s_.camera);
        for (int j = 0; j < s_.size; ++j)
            for (int i = 0; i < s_.size; ++i) {
                const Vec3 d = normalized(forward + half * (2 * (i + 0.5) / s_.size - 1) * right +
                                          half * (2 * (j + 0.5) / s_.size - 1) * down);
                pixels.push_back(pixel(d));
            }
    }

    // `caustics`: without them the library's own.
    std::vector<float> shade(PelShaderStats* stats = nullptr, const pellucid::Lut& caustics = {}) const {
        shade_test::Frame f;
        f.width = f.height = uint32_t(s_.size);
        auto& position = f.slots[PEL_SLOT_POSITION] = {3, {}};
        auto& normal = f.slots[PEL_SLOT_NORMAL_SHADING] = {3, {}};
        auto& id = f.slots[PEL_SLOT_MATERIAL] = {1, {}};
        for (const EyePixel& p : pixels)
            position.push(p.position), normal.push(p.normal), id.values.push_back(p.shown);
        // All inputs are there, so that all pictures are made by the same programs.
        const auto input = [&](const std::vector<float>& values, uint32_t components, float otherwise) {
            return shade_test::Image{
                components, values.empty() ? std::vector<float>(components * f.pixels(), otherwise) : values};
        };
        f.slots[PEL_SLOT_INDIRECT] = input(s_.indirect, 3, 0);
        f.slots[PEL_SLOT_WETNESS] = input(s_.wetness, 1, 0);
        f.materials[1] = s_.sclera;
        f.curvatureLut = f.shadowLut = false;
        for (const PelLight& light : s_.lights) f.lights.push_back({light, input({}, 1, 1)});
        if (!s_.shadow.empty()) f.lights[0].wide.values = s_.shadow;
        f.ambient = s_.ambient;
        shade_test::copyTo(f.camera.position, s_.camera);
        f.options.millimetresPerUnit = float(s_.unit);
        f.options.disableSkipping = !s_.skipping;
        return shade_test::shade(device, f, {}, stats, [&](pellucid::Shader& shader) {
            shader.setEye(1, s_.eye, caustics);
            const auto side = uint32_t(s_.textureSize);
            if (side)
                shader.setIrisTexture(
                    1, imageDesc(pellucid::Buffer(device, s_.texture), PEL_FORMAT_RGB32F, side, side));
        });
    }

    // The tracer's picture. Caustics by `photons` for each light.
    std::vector<double> trace(uint64_t photons = 1'000'000) const {
        std::vector<reference::Caustic> caustics;
        for (const PelLight& light : s_.lights)
            caustics.push_back(tracePhotons(
                truth_, std::acos(std::clamp(toEye(vec(light.toLight)).z, -1.0, 1.0)), 128, 64, photons, 5));
        std::map<int, double> ambient;  // by 1/24 of the iris' radius
        std::vector<double> picture;
        for (size_t k = 0; k < pixels.size(); ++k) {
            const EyePixel& p = pixels[k];
            Rgb sum;
            if (p.shown) sum = radiance(p, k, caustics, ambient);
            for (int c = 0; c < 3; ++c) picture.push_back(sum[c]);
        }
        return picture;
    }

    std::vector<EyePixel> pixels;

  private:
    static Vec3 vec(const float (&v)[3]) { return {v[0], v[1], v[2]}; }
    Vec3 toEye(Vec3 v) const { return {dot(v, x_), dot(v, y_), dot(v, z_)}; }
    Vec3 fromEye(Vec3 v) const { return v.x * x_ + v.y * y_ + v.z * z_; }

    EyePixel pixel(Vec3 d) const {
        EyePixel p;
        const Vec3 local = toEye(d), origin = s_.unit * toEye(s_.camera - vec(s_.eye.center));
        p.hit = traceEye(truth_, origin, local);
        const Vec3 nearest = origin - dot(origin, local) * local;
        p.shown = p.hit.cornea || length(nearest) < truth_.sclera;
        if (!p.shown) return p;
        p.position = vec(s_.eye.center) + fromEye(p.hit.point) / s_.unit;
        p.normal = fromEye(p.hit.normal);
        p.eyeToCamera = toEye(normalized(s_.camera - p.position));
        return p;
    }

    Rgb radiance(const EyePixel& p, size_t k, const std::vector<reference::Caustic>& caustics,
                 std::map<int, double>& known) const {
        const reference::EyeHit& h = p.hit;
        Rgb onIris, onSclera, gloss;
        const Vec3 corneal = truth_.corneaNormal(h.point.x, h.point.y);
        const Vec3 n = h.share > 0 ? normalized(mix(h.normal, corneal, h.share)) : h.normal;
        const double wet = s_.wetness.empty() ? 0 : s_.wetness[k];
        const double roughness = std::lerp(truth_.tearRoughness, truth_.wetLineRoughness, wet);
        for (size_t i = 0; i < s_.lights.size(); ++i) {
            const double w = i == 0 && !s_.shadow.empty() ? s_.shadow[k] : 1;
            const Vec3 l = toEye(vec(s_.lights[i].toLight));
            const Rgb color = w * vec(s_.lights[i].color);
            onSclera = onSclera + reference::max0(dot(h.normal, l)) * color;
            gloss = gloss + reference::tearGloss(n, l, p.eyeToCamera, roughness, truth_.nTear) * color;
            if (h.share > 0) {
                const double side = std::hypot(l.x, l.y), ex = side > 1e-9 ? l.x / side : 1,
                             ey = side > 1e-9 ? l.y / side : 0;
                const double x = h.px * ex + h.py * ey, y = h.py * ex - h.px * ey;
                onIris = onIris + caustics[i].at(x, y, truth_.iris) * color;
            }
        }
        const Rgb everywhere = vec(s_.ambient.constant);
        onSclera = onSclera + everywhere;
        if (h.share > 0 && everywhere.x > 0) {
            const double at = h.radius / truth_.iris * 24;
            const int i = std::min(int(at), 23);
            for (const int j : {i, i + 1})
                if (!known.contains(j)) known[j] = ambientOnIris(truth_, truth_.iris * j / 24, 72);
            onIris = onIris + (known[i] + (at - i) * (known[i + 1] - known[i])) * everywhere;
        }
        Rgb sum = (1 - h.share) * (vec(s_.sclera.albedo) * onSclera) + gloss;
        if (h.share > 0) {
            const reference::Vec2 uv = irisTexture(truth_, h);
            const Rgb albedo = s_.textureSize ? bilinear(texture_, uv.x, uv.y) : Rgb{1, 1, 1};
            const double through =
                irisVisible(truth_, h) * h.transmittance / (truth_.nAqueous * truth_.nAqueous);
            sum = sum + h.share * through * (albedo * onIris);
        }
        return sum;
    }

    const EyeScene& s_;
    reference::Eye truth_;
    reference::Table texture_;
    Vec3 x_, y_, z_;
};

struct PictureError {
    double rms = 0, worst = 0;
};

inline PictureError differenceOf(const EyePicture& picture, const std::vector<float>& is,
                                 const std::vector<double>& should) {
    PictureError error;
    double sum = 0;
    size_t count = 0;
    for (size_t k = 0; k < picture.pixels.size(); ++k) {
        if (!picture.pixels[k].shown) continue;
        for (size_t c = 0; c < 3; ++c) {
            const double d = std::abs(is[3 * k + c] - should[3 * k + c]);
            sum += d * d, ++count;
            error.worst = std::max(error.worst, d);
        }
    }
    error.rms = std::sqrt(sum / double(count));
    return error;
}

}  // namespace eye_test
