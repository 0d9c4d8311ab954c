// Normal maps and their levels; positions from depth.
#include "vectors.h"

namespace stability {
namespace {

using namespace shade_test;

constexpr uint32_t finest = 64;
constexpr double uvScale = 120;  // mm

// Levels of random normals.
struct Levels {
    std::vector<reference::NormalLevel> levels;
    std::vector<float> texels;
};
const Levels& normalMap() {
    static const Levels made = [] {
        Levels m;
        Dice dice(11);
        for (uint32_t size = finest; size > 0; size /= 2) {
            reference::NormalLevel level{int(size), int(size), {}};
            for (uint32_t i = 0; i < size * size; ++i) {
                const Vec3 v = turned({0, 0, 1}, 1.2 * dice.uniform(), dice.uniform());
                for (int c = 0; c < 3; ++c) m.texels.push_back(float(v[c]));
                const float* t = &m.texels[m.texels.size() - 3];
                level.texels.push_back({t[0], t[1], t[2]});
            }
            m.levels.push_back(level);
        }
        return m;
    }();
    return made;
}

class NormalMap : public Pixels {
  public:
    enum Dimension { u, v, footprint, gradientAround, lean, around, side, material, dimensions };

    explicit NormalMap(const std::vector<Point>& points) : count_(points.size()) {
        frame_ = reliefFrame(1, 64, uint32_t((count_ + 63) / 64), 0.5f);
        auto& s = frame_.slots;
        std::fill(s[PEL_SLOT_MATERIAL].values.begin(), s[PEL_SLOT_MATERIAL].values.end(), 0.0f);
        s[PEL_SLOT_UV].components = 2;
        s[PEL_SLOT_UV_GRADIENT].components = s[PEL_SLOT_TANGENT].components = 4;
        for (int slot : {PEL_SLOT_UV, PEL_SLOT_UV_GRADIENT, PEL_SLOT_TANGENT})
            s[slot].values.resize(frame_.pixels() * s[slot].components);
        for (uint32_t id = 1; id <= 8; ++id) {
            frame_.materials[id] = frame_.materials[1];
            frame_.materials[id].diffusionRadius = float(logBetween(id / 8.0, 0.2, 30));
            frame_.materials[id].uvScale = float(uvScale);
        }
        for (size_t i = 0; i < count_; ++i) {
            const Point& p = points[i];
            const Vec3 n = turned({0, 0, 1}, p[lean] * 3.14, p[around]),
                       t = turned(n, 1.5707963267948966, p[side]);
            for (int c = 0; c < 3; ++c) {
                s[PEL_SLOT_NORMAL_GEOMETRIC].values[3 * i + size_t(c)] = float(n[c]);
                s[PEL_SLOT_TANGENT].values[4 * i + size_t(c)] = float(t[c]);
            }
            s[PEL_SLOT_TANGENT].values[4 * i + 3] = p[side] < 0.5 ? 1 : -1;
            s[PEL_SLOT_UV].values[2 * i] = float(between(p[u], -1.5, 2.5)),
                                      s[PEL_SLOT_UV].values[2 * i + 1] = float(between(p[v], -1.5, 2.5));
            const double along = logBetween(p[footprint], 2e-4, 0.25), turn = 6.2831853 * p[gradientAround];
            const double g[4] = {along * std::cos(turn), along * std::sin(turn),
                                 -0.7 * along * std::sin(turn), 0.7 * along * std::cos(turn)};
            for (size_t c = 0; c < 4; ++c) s[PEL_SLOT_UV_GRADIENT].values[4 * i + c] = float(g[c]);
            s[PEL_SLOT_MATERIAL].values[i] = float(1 + uint32_t(p[material] * 7.999));
        }
        showBlurredNormal(frame_);
    }
    void move(Jitter& j) override {
        for (int slot : {PEL_SLOT_NORMAL_GEOMETRIC, PEL_SLOT_TANGENT, PEL_SLOT_UV, PEL_SLOT_UV_GRADIENT})
            j(frame_.slots[slot].values);
    }
    std::vector<float> measured() override {
        Shader shader(device());
        setFrame(device(), shader, frame_, tables());
        const Buffer map(device(), normalMap().texels), target(device(), frame_.pixels() * 12);
        std::vector<PelImageDesc> levels;
        uint64_t at = 0;
        for (const auto& l : normalMap().levels) {
            levels.push_back(imageDesc(map, PEL_FORMAT_RGB32F, uint32_t(l.width), uint32_t(l.height), at));
            at += l.texels.size() * 12;
        }
        for (uint32_t id = 1; id <= 8; ++id) shader.setNormalMap(id, levels);
        shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, frame_.width, frame_.height));
        shader.commit().execute();
        const std::vector<float> shown = target.readAll<float>();
        std::vector<float> n;
        for (size_t i = 0; i < count_; ++i)
            for (int c = 0; c < 3; ++c) n.push_back(float(shownNormal(shown, i)[c]));
        return n;
    }
    std::vector<double> truth(size_t i) override {
        const auto& s = frame_.slots;
        const PelMaterial& m = frame_.materials.at(uint32_t(s[PEL_SLOT_MATERIAL].at(i)));
        const auto g = [&](uint32_t c) { return s[PEL_SLOT_UV_GRADIENT].at(i, c); };
        const double level = std::max(reference::blurredNormalMip(finest, m.diffusionRadius, m.uvScale),
                                      reference::footprintLevel({g(0), g(1), g(2), g(3)}, finest, finest));
        const Vec3 texel =
            reference::trilinear(normalMap().levels, s[PEL_SLOT_UV].at(i, 0), s[PEL_SLOT_UV].at(i, 1), level);
        const Image& t = s[PEL_SLOT_TANGENT];
        const Vec3 n = reference::fromTangentSpace(texel, {t.at(i, 0), t.at(i, 1), t.at(i, 2)},
                                                   s[PEL_SLOT_NORMAL_GEOMETRIC].vec(i), t.at(i, 3) < 0 ? -1 : 1);
        return {n.x, n.y, n.z};
    }

  private:
    Frame frame_;
    size_t count_;
};

// Near planes at 0.1 to 100 mm, ordinary and reversed depth; what is seen lies 110 to 900 mm away. A point
// light shows the place: how bright it is says how far off.
class FromDepth : public Pixels {
  public:
    enum Dimension { distance, scene, dimensions };

    FromDepth(size_t number, const std::vector<Point>& points) : count_(points.size()) {
        const double nearest = std::pow(10, double(number / 2) - 1), farthest = 1000,
                     n = number % 2 ? farthest : nearest, f = number % 2 ? nearest : farthest;
        a_ = f / (f - n), b_ = -n * a_;
        frame_ = reliefFrame(1, 64, uint32_t((count_ + 63) / 64), 0.5f);
        frame_.materials = {{1, frame_.materials[1]}};
        frame_.ambient = pelAmbientDefaults();
        // The camera at (0, 0, 500) looks down -z; x_clip = 4 x / w, depth = a + b / w.
        const float inverse[16] = {0.25f,
                                   0,
                                   0,
                                   0,
                                   0,
                                   0.25f,
                                   0,
                                   0,
                                   0,
                                   0,
                                   float(500 / b_),
                                   float(-500 * a_ / b_ - 1),
                                   0,
                                   0,
                                   float(1 / b_),
                                   float(-a_ / b_)};
        std::copy_n(inverse, 16, frame_.camera.inverseViewProjection);
        Light light;
        light.params.type = PEL_LIGHT_POINT;
        const float position[3] = {300, 200, 500};
        std::copy_n(position, 3, light.params.position);
        std::fill_n(light.params.color, 3, 1.0f);
        frame_.lights = {light};
        auto& s = frame_.slots;
        s[PEL_SLOT_POSITION] = s[PEL_SLOT_NORMAL_GEOMETRIC] = {};
        s[PEL_SLOT_DEPTH] = {1, std::vector<float>(frame_.pixels(), float(a_ + b_ / 200))};
        s[PEL_SLOT_MATERIAL].values.assign(frame_.pixels(), 0);
        for (size_t i = 0; i < count_; ++i) {
            s[PEL_SLOT_DEPTH].values[i] =
                float(a_ + b_ / logBetween(points[i][distance], std::max(110.0, 1.1 * nearest), 900));
            s[PEL_SLOT_MATERIAL].values[i] = 1;
            const Vec3 toLight = reference::normalized(vector(position) - place(i));
            for (int c = 0; c < 3; ++c)
                s[PEL_SLOT_NORMAL_SHADING].values[3 * i + size_t(c)] = float(toLight[c]);
        }
    }
    void move(Jitter& j) override {
        j(frame_.slots[PEL_SLOT_DEPTH].values);
        for (float& m : frame_.camera.inverseViewProjection) m = m == 0 ? m : j(m);
    }
    std::vector<float> measured() override {
        std::vector<float> away;
        const std::vector<float> shown = shade(device(), frame_, tables());
        for (size_t i = 0; i < count_; ++i) away.push_back(float(1 / std::sqrt(double(shown[3 * i]))));
        return away;
    }
    std::vector<double> truth(size_t i) override {
        return {reference::length(vector(frame_.lights[0].params.position) - place(i))};
    }

  private:
    // By the matrix of floats.
    Vec3 place(size_t i) const {
        const float* m = frame_.camera.inverseViewProjection;
        const double clip[4] = {(double(i % frame_.width) + 0.5) * 2 / frame_.width - 1,
                                1 - (double(i / frame_.width) + 0.5) * 2 / frame_.height,
                                frame_.slots[PEL_SLOT_DEPTH].at(i), 1};
        double h[4] = {};
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c) h[r] += double(m[4 * r + c]) * clip[c];
        return {h[0] / h[3], h[1] / h[3], h[2] / h[3]};
    }

    Frame frame_;
    size_t count_;
    double a_, b_;
};

}  // namespace

std::vector<Operation> normalOperations() {
    Operation depth = operation(
        {"position from depth", "near planes 0.1 to 100 mm and reversed, far 1,000 mm; 110 to 900 mm away",
         Unit::length, tolerance::placeFromDepth, FromDepth::dimensions, 40000},
        8,
        [](size_t number, const std::vector<Point>& points) {
            return std::make_unique<FromDepth>(number, points);
        },
        [](size_t number, const Point& p) {
            const double nearest = std::pow(10, double(number / 2) - 1);
            return text("near plane %.3g mm, %.3g mm away", nearest,
                        logBetween(p[FromDepth::distance], std::max(110.0, 1.1 * nearest), 900)) +
                   (number % 2 ? ", reversed" : "");
        });
    return {
        operation(
            {"normal maps and their levels",
             "64 x 64 texels and 7 levels of random normals; UV -1.5 to 2.5; footprints 0.01 to 16 texels, "
             "diffusion radius 0.3 to 30 mm",
             Unit::absolute, tolerance::mappedNormal, NormalMap::dimensions + 1, 50000},
            1, [](size_t, const std::vector<Point>& points) { return std::make_unique<NormalMap>(points); },
            [](size_t, const Point& p) {
                return text("u %.3g, v %.3g, footprint %.3g texels", between(p[NormalMap::u], -1.5, 2.5),
                            between(p[NormalMap::v], -1.5, 2.5),
                            finest * logBetween(p[NormalMap::footprint], 2e-4, 0.25));
            }),
        depth};
}

}  // namespace stability
