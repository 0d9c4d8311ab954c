#include "sample/gbuffer.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

#include "sample/waves.h"

namespace pellucid::sample {
namespace {

// The view's rays.
struct View {
    View(const Camera& camera, int width, int height)
        : eye(camera.eye),
          forward(camera.forward()),
          up(perpendicular(forward, camera.up)),
          right(cross(forward, up)) {
        pixel = 2 * std::tan(camera.verticalFov * std::numbers::pi / 360) / height;
        x0 = 0.5 - 0.5 * width;
        y0 = 0.5 - 0.5 * height;
    }
    Ray ray(int x, int y) const {
        return {eye, normalize(forward + right * ((x0 + x) * pixel) - up * ((y0 + y) * pixel))};
    }

    Vec3 eye, forward, up, right;
    double pixel;  // size at distance 1
    double x0, y0;
};

struct Detail {
    explicit Detail(const SkinDetail& s)
        : settings(s),
          pores(s.poreWavelength, 100, s.seed),
          folds(s.foldWavelength, 32, s.seed + 1),
          blood(s.blotchWavelength, 32, s.seed + 2),
          pigment(0.6 * s.blotchWavelength, 32, s.seed + 3),
          furrows(s.furrowWavelength, 32, s.seed + 4) {}

    SkinDetail settings;
    WaveField pores, folds, blood, pigment, furrows;

    // The slope of lines that run up and down and spread from `middle`: a field that is stretched along them,
    // bent, and deeper in some places than in others.
    Vec3 furrowSlope(Vec3 p, Vec3 middle, const Footprint& pixel) const {
        constexpr double stretch = 5, spread = 0.05;  // spread per mm
        const double y = p.y - middle.y, x = (p.x - middle.x) / (1 + spread * std::abs(y));
        const double bent = 0.4 * std::sin(0.7 * y + 0.35 * x) + 0.3 * std::sin(0.5 * y - 0.8 * x);
        const double depth = 1 + 0.8 * std::sin(0.9 * x + 0.5 * y + 1) * std::sin(0.55 * x - 0.8 * y);
        Vec3 slope;
        furrows.slope({x + bent, p.y / stretch, p.z / stretch}, &pixel, 1, &slope);
        const Vec3 across{depth * slope.x, 0, 0};
        return across - pixel.normal * dot(across, pixel.normal);
    }
};

class Renderer {
  public:
    Renderer(const Scene& scene, const Camera& camera, const GBufferOptions& options, GBuffer& out)
        : scene_(scene),
          mesh_(scene.mesh()),
          view_(camera, out.width, out.height),
          options_(options),
          out_(out) {
        if (options.detail.enabled) detail_.emplace(options.detail);
    }

    void render() {
        traceRays(
            scene_, out_.width, out_.height, [&](int x, int y) { return view_.ray(x, y); },
            [&](int x, int y, const Ray& ray, const Hit& hit) { pixel(x, y, ray, hit); });
    }

  private:
    double interpolate(const std::vector<float>& values, const Hit& hit, int stride, int component) const {
        double sum = 0;
        for (int i = 0; i < 3; ++i) {
            const size_t vertex = mesh_.triangles[3 * size_t(hit.triangle) + i];
            sum += hit.weights[i] * values[vertex * size_t(stride) + size_t(component)];
        }
        return sum;
    }
    Vec3 interpolate3(const std::vector<float>& values, const Hit& hit) const {
        return {interpolate(values, hit, 3, 0), interpolate(values, hit, 3, 1),
                interpolate(values, hit, 3, 2)};
    }
    Vec3 faceNormal(const Hit& hit) const {
        const auto [a, b, c] = mesh_.corners(hit.triangle);
        return normalize(cross(b - a, c - a));
    }
    // Thickness of the sheet that loses as much light as the body, measured along the inward normal of the
    // triangle. A body with a curvature (1/mm) of 2 over its thickness is a ball, which the gain of curved
    // bodies describes already; where faces meet at 60 degrees or more, light comes in through both.
    double thicknessBelow(Vec3 position, Vec3 face, double curvature) const {
        Vec3 otherFace;
        const double distance = scene_.depthBelow(position, face, otherFace), facing = -dot(otherFace, face);
        if (!(distance < INFINITY) || facing <= 0) return 0;
        const double ofSheet = std::max(2 * facing - 1, 0.0) * std::max(1 - distance * curvature / 2, 0.0);
        return std::min(distance / std::max(ofSheet, 1e-6),
                        length(scene_.bounds().high - scene_.bounds().low));
    }
    static void store(Image& image, int x, int y, Vec3 v) {
        image.at(0, x, y) = float(v.x);
        image.at(1, x, y) = float(v.y);
        image.at(2, x, y) = float(v.z);
    }

    void pixel(int x, int y, const Ray& ray, const Hit& hit) {
        const Vec3 position = ray.origin + ray.direction * hit.distance;
        const Vec3 face = faceNormal(hit);
        const Vec3 geometric =
            mesh_.normals.empty() ? face : normalize(interpolate3(mesh_.normals, hit), face);
        const double depth = hit.distance * dot(ray.direction, view_.forward);
        store(out_.position, x, y, position);
        store(out_.geometricNormal, x, y, geometric);
        if (!mesh_.curvature.empty())
            out_.curvature.at(0, x, y) = float(interpolate(mesh_.curvature, hit, 1, 0));
        if (options_.thickness)
            out_.thickness.at(0, x, y) = float(thicknessBelow(position, face, out_.curvature.at(0, x, y)));
        for (int c = 0; c < out_.uv.channels; ++c)
            out_.uv.at(c, x, y) = float(interpolate(mesh_.uvs, hit, 2, c));
        out_.viewDepth.at(0, x, y) = float(depth);
        out_.coverage.at(0, x, y) = 1;
        out_.material[size_t(y) * size_t(out_.width) + size_t(x)] =
            mesh_.materials.empty() ? 1 : mesh_.materials[hit.triangle];
        surface(x, y, position, geometric, ray.direction, depth);
    }

    Vec3 eyeColor(Vec3 p) const {
        const auto nearest = std::ranges::min_element(
            options_.eyes, {}, [&](const EyeLook& eye) { return length(p - eye.centre); });
        const LinearColor c = nearest == options_.eyes.end() ? EyeLook().sclera : nearest->at(p);
        return {c[0], c[1], c[2]};
    }

    void surface(int x, int y, Vec3 position, Vec3 geometric, Vec3 direction, double depth) {
        const uint32_t id = out_.material[size_t(y) * size_t(out_.width) + size_t(x)];
        const Look look = id - 1 < options_.looks.size() ? options_.looks[id - 1] : Look();
        Vec3 shading = geometric, blurred = geometric;
        Vec3 albedo{look.albedo[0], look.albedo[1], look.albedo[2]};
        double specular = 1, roughness = 1, relief = 1, furrows = 0;
        Vec3 furrowed;
        if (look.kind == Look::Kind::Eye) albedo = eyeColor(position);
        if (look.kind == Look::Kind::Skin) {
            for (const SkinZone& zone : options_.zones) {
                const double weight = zone.weight(position);
                if (weight <= 0) continue;
                const LinearColor factor = zone.colorAt(position);
                albedo = {albedo.x * factor[0], albedo.y * factor[1], albedo.z * factor[2]};
                specular *= 1 + weight * (zone.specular - 1);
                roughness *= 1 + weight * (zone.roughness - 1);
                relief *= 1 + weight * (zone.relief - 1);
                furrows += weight * zone.furrows;
                if (zone.furrows > 0) furrowed = zone.centre;
            }
        }
        if (detail_ && look.kind == Look::Kind::Skin) {
            // Half a pixel of standard deviation, longer where the surface is seen at a slant.
            const double facing = dot(direction, geometric);
            const Footprint pixel{geometric, 0.5 * view_.pixel * depth,
                                  normalize(direction - geometric * facing, Vec3{}),
                                  1 / std::max(std::abs(facing), 0.05)};
            const Footprint blur{geometric, std::hypot(pixel.sigma, 0.5 * options_.diffusionRadius)};
            const Footprint both[2] = {pixel, blur};
            Vec3 pores[2], folds[2];
            const double lost = detail_->pores.slope(position, both, 2, pores);
            detail_->folds.slope(position, both, 2, folds);
            const SkinDetail& s = detail_->settings;
            const double poreSlope = relief * s.poreSlope, width = roughness * s.roughness;
            Vec3 slope = pores[0] * poreSlope + folds[0] * s.foldSlope;
            if (furrows > 0) slope = slope + detail_->furrowSlope(position, furrowed, pixel) * furrows;
            shading = normalize(geometric - slope);
            blurred = normalize(geometric - pores[1] * poreSlope - folds[1] * s.foldSlope);
            // The squared roughness is the mean square slope of a surface's facets.
            roughness *= std::sqrt(1 + poreSlope * poreSlope * lost / (width * width));
            // Blood takes green and blue, pigment takes blue most and red least.
            const double blood = s.blotchAmount * detail_->blood.value(position, pixel);
            const double pigment = s.blotchAmount * detail_->pigment.value(position, pixel);
            albedo.x *= std::exp(-0.1 * blood - 0.3 * pigment);
            albedo.y *= std::exp(-0.9 * blood - 0.6 * pigment);
            albedo.z *= std::exp(-0.8 * blood - 0.9 * pigment);
            albedo = {std::min(albedo.x, 1.0), std::min(albedo.y, 1.0), std::min(albedo.z, 1.0)};
        }
        store(out_.shadingNormal, x, y, shading);
        store(out_.blurredNormal, x, y, blurred);
        store(out_.albedo, x, y, albedo);
        out_.specular.at(0, x, y) = float(specular);
        out_.roughness.at(0, x, y) = float(roughness);
    }

    const Scene& scene_;
    const Mesh& mesh_;
    View view_;
    GBufferOptions options_;
    std::optional<Detail> detail_;
    GBuffer& out_;
};

}  // namespace

GBuffer renderGBuffer(const Scene& scene, const Camera& camera, int width, int height,
                      const GBufferOptions& options) {
    if (width < 0 || height < 0)
        throw std::invalid_argument("G-buffer: a size of " + std::to_string(width) + " x " +
                                    std::to_string(height) + "; both must be 0 or more");
    GBuffer out;
    out.width = width;
    out.height = height;
    for (Image* image :
         {&out.position, &out.geometricNormal, &out.shadingNormal, &out.blurredNormal, &out.albedo})
        *image = Image(width, height, 3);
    for (Image* image : {&out.curvature, &out.coverage, &out.specular, &out.roughness})
        *image = Image(width, height, 1);
    if (!scene.mesh().uvs.empty()) out.uv = Image(width, height, 2);
    if (options.thickness) out.thickness = Image(width, height, 1);
    out.viewDepth = Image(width, height, 1, backgroundDepth);
    out.material.assign(size_t(width) * size_t(height), 0);
    if (out.material.empty()) return out;

    Renderer(scene, camera, options, out).render();
    return out;
}

}  // namespace pellucid::sample
