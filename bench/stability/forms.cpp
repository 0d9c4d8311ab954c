// Wide shadow and thickness from shadow maps of every form: each pixel is a place on open ground, with a
// normal of its own.
#include "faceworks_material.h"
#include "shading/shadow_form_truth.h"

#include "vectors.h"

namespace stability {
namespace {

using namespace shade_test;

constexpr uint32_t materials = 24;
enum Dimension { placeX, placeY, placeZ, lean, around, material, scene, dimensions };
enum class Form { parallel, perspective, cube, radialCube, cascades, moments, exponentials };
const Vec3 lamp{24, 10, 70};  // of the cubes

// Filter widths of 1 to 30 mm, disks of 0.005 to 0.05 of the map.
const PelMaterial& materialOf(uint32_t id) {
    static const std::vector<PelMaterial> all = [] {
        std::vector<PelMaterial> some(materials + 1, fixture::faceworksMaterial());
        Dice dice(5);
        for (PelMaterial& m : some) {
            for (int c = 0; c < 3; ++c) m.deepScatterColor[c] = m.albedo[c] = 1;
            m.shadowFilterWidth = float(logBetween(dice.uniform(), 1, 30));
            m.thicknessFilterRadius = float(logBetween(dice.uniform(), 0.005, 0.05));
            m.thicknessTaps = 8u << dice.bits() % 3;
        }
        diskTaps(8), diskTaps(16), diskTaps(32);  // read once, before threads ask
        return some;
    }();
    return all[id];
}

// A map of one form, as the device and as the oracle take it.
struct Scene {
    FormLight light;
    FormTruth truth;
    std::shared_ptr<const void> from;  // what the truth refers to
};
template <class Light>
Scene sceneOf(FormLight light, std::shared_ptr<Light> from) {
    return {std::move(light), truthOf(*from), from};
}

void setLight(PelLight& l, size_t number) {
    constexpr float biases[] = {0.5f, 0.1f, 2, 0.5f}, softness[] = {0.25f, 0.25f, 0.1f, 1};
    l.shadowBias = biases[number], l.shadowSoftness = softness[number];
    constexpr uint32_t texels[] = {256, 48, 16, 8};
    l.shadowFilterTexels = texels[number];
}

Scene planeScene(bool perspective, size_t number) {
    auto from = std::make_shared<MapLight>(mapLight(uint32_t(number), perspective, number % 2,
                                                    {0.6, 0.3, 0.3 + 0.5 * double(number)}, {16, 8, 5}, 50,
                                                    60 + 40 * uint32_t(number)));
    setLight(from->light.params, number);
    const uint32_t size = from->light.mapSize;
    return sceneOf({from->light.params, {{PEL_LIGHT_SHADOW_MAP, size, size, 1, from->light.map.values}}}, from);
}

Scene cubeScene(bool radial, size_t number) {
    const Vec3 aims[] = {{0, 0, 1}, {1, 0, 1}, {-1, 1, 1}, {0.3, 0.5, 1}};
    const auto bumps = [](Vec3 d, int texel) {
        const double ground = d.z < -1e-3 ? (lamp.z + 8) / -d.z : 500;
        const int cell = texel / 7 * 31;
        return std::min(ground, 500.0) - (cell % 3 ? 9 + cell % 23 : 0) / reference::length(d);
    };
    auto from = std::make_shared<CubeLight>(
        cubeLight(32u << number, radial, turnTo({0, 0, -1}, aims[number]), lamp, bumps));
    setLight(from->light.params, number);
    return sceneOf(from->light, from);
}

Scene cascadeScene(size_t number) {
    auto from =
        std::make_shared<CascadeLight>(cascadeLight({14, 24, 36, 52}, number % 2, 60 + 30 * uint32_t(number)));
    setLight(from->light.params, number);
    return sceneOf(from->light, from);
}

Scene contentScene(PelShadowContent content, size_t number) {
    auto from = std::make_shared<ContentLight>(
        contentLight(content, number & 1, number & 2, 60 + 20 * uint32_t(number)));
    setLight(from->light.params, number);
    return sceneOf(from->light, from);
}

Scene makeScene(Form form, size_t number) {
    switch (form) {
        case Form::parallel:
        case Form::perspective:
            return planeScene(form == Form::perspective, number);
        case Form::cube:
        case Form::radialCube:
            return cubeScene(form == Form::radialCube, number);
        case Form::cascades:
            return cascadeScene(number);
        case Form::moments:
            return contentScene(PEL_SHADOW_CONTENT_MOMENTS, number);
        default:
            return contentScene(PEL_SHADOW_CONTENT_EXPONENTIAL, number);
    }
}
const Scene& madeScene(Form form, size_t number) {
    static std::map<std::pair<Form, size_t>, Scene> made;
    const auto [at, fresh] = made.try_emplace({form, number});
    if (fresh) at->second = makeScene(form, number);
    return at->second;
}

class Mapped : public Pixels {
  public:
    Mapped(Form form, bool thickness, double limit, size_t number, const std::vector<Point>& points)
        : scene_(madeScene(form, number)), thickness_(thickness), limit_(limit) {
        frame_ = formFrame(1, 64, uint32_t((points.size() + 63) / 64));
        frame_.materials.clear();
        for (uint32_t id = 1; id <= materials; ++id) frame_.materials[id] = materialOf(id);
        std::fill(frame_.slots[PEL_SLOT_MATERIAL].values.begin(),
                  frame_.slots[PEL_SLOT_MATERIAL].values.end(), 0.0f);
        const Vec3 up = scene_.light.params.type == PEL_LIGHT_DIRECTIONAL ? vector(scene_.light.params.toLight)
                                                                          : Vec3{0, 0, 1};
        for (size_t i = 0; i < points.size(); ++i) {
            const Point& p = points[i];
            const Vec3 at{between(p[placeX], -2, 50), between(p[placeY], -2, 22), between(p[placeZ], -5, 35)},
                n = turned(up, p[lean] * 2, p[around]);
            for (int c = 0; c < 3; ++c) {
                frame_.slots[PEL_SLOT_POSITION].values[3 * i + size_t(c)] = float(at[c]);
                frame_.slots[PEL_SLOT_NORMAL_GEOMETRIC].values[3 * i + size_t(c)] = float(n[c]);
            }
            frame_.slots[PEL_SLOT_MATERIAL].values[i] = float(1 + uint32_t(p[material] * (materials - 1e-6)));
        }
        count_ = points.size();
    }
    // The last column of a light's matrix is of the order of the distance to it, 150 mm: its rounding moves
    // all places.
    void move(Jitter& j) override {
        j(frame_.slots[PEL_SLOT_POSITION].values), j(frame_.slots[PEL_SLOT_NORMAL_GEOMETRIC].values);
        for (int c = 0; c < 3; ++c) column_[c] = double(j(150)) - 150;
    }
    std::vector<float> measured() override {
        const Seen seen = shadeForms(frame_, {scene_.light});
        std::vector<float> values = thickness_ ? seen.thickness : seen.wide;
        values.resize(count_);
        return values;
    }
    std::vector<double> truth(size_t i) override {
        const PelMaterial& m = materialOf(uint32_t(frame_.slots[PEL_SLOT_MATERIAL].at(i)));
        const Vec3 p = frame_.slots[PEL_SLOT_POSITION].vec(i) + column_,
                   n = reference::normalized(frame_.slots[PEL_SLOT_NORMAL_GEOMETRIC].vec(i));
        const auto of = [&](Vec3 at) {
            return thickness_ ? scene_.truth.thickness(m, at, n, diskTaps(m.thicknessTaps))
                              : scene_.truth.wide(m, at, n);
        };
        const double value = of(p);
        // Which face or cascade is taken, and every how manieth texel is read, are decisions.
        for (int c = 0; c < 3; ++c)
            for (const double side : {-1e-5, 1e-5}) {
                Vec3 beside = p;
                beside[c] += side;
                if (std::abs(of(beside) - value) > limit_ / 2) return {NAN};
            }
        return {value};
    }

  private:
    const Scene& scene_;
    bool thickness_;
    double limit_;
    Frame frame_;
    Vec3 column_;
    size_t count_ = 0;
};

Operation form(const char* name, Form kind, bool thickness, const tolerance::Tolerance& limit, size_t points) {
    return operation(
        {std::string(thickness ? "thickness, " : "wide shadow, ") + name,
         thickness ? "8 to 32 taps within 0.005 to 0.05 of the map; 32 to 180 texels a side; depth either "
                     "way; places and normals at random"
                   : "filters of 1 to 30 mm, bias 0.1 to 2 mm, softness 0.1 to 1; 32 to 180 texels a side, "
                     "at most 8 to 256 read; depth either way; places and normals at random",
         thickness ? Unit::length : Unit::absolute, limit, dimensions, points},
        4,
        [=](size_t number, const std::vector<Point>& points) {
            return std::make_unique<Mapped>(kind, thickness, limit.value, number, points);
        },
        [](size_t number, const Point& p) {
            const PelMaterial& m = materialOf(1 + uint32_t(p[material] * (materials - 1e-6)));
            return text("map %.0f, filter %.3g mm, disk %.3g of the map, normal %.3g degrees from the light",
                        double(number + 1), m.shadowFilterWidth, m.thicknessFilterRadius,
                        p[lean] * 2 * 57.29578);
        });
}

}  // namespace

std::vector<Operation> formOperations() {
    std::vector<Operation> all;
    const std::tuple<const char*, Form, tolerance::Tolerance, tolerance::Tolerance> forms[] = {
        {"parallel map", Form::parallel, tolerance::wideShadowAnywhere, tolerance::mapThickness},
        {"perspective map", Form::perspective, tolerance::wideShadowAnywhere, tolerance::mapThickness},
        {"cube", Form::cube, tolerance::wideShadowAnywhere, tolerance::cubeThickness},
        {"radial cube", Form::radialCube, tolerance::wideShadowAnywhere, tolerance::cubeThickness},
        {"cascades", Form::cascades, tolerance::wideShadowAnywhere, tolerance::mapThickness},
        {"moments", Form::moments, tolerance::contentShadow, tolerance::contentThickness},
        {"exponentials", Form::exponentials, tolerance::contentShadow, tolerance::contentThickness}};
    for (const auto& [name, kind, wide, thickness] : forms) {
        all.push_back(form(name, kind, false, wide, 10000));
        all.push_back(form(name, kind, true, thickness, 30000));
    }
    return all;
}

}  // namespace stability
