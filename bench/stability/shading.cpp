// The shading kernel, one program for all: each pixel of a frame has normals, place, curvature, shadow,
// roughness and material of its own. The outputs show the terms one by one.
#include "stability.h"

namespace stability {
namespace {

using namespace shade_test;

// `axis` turned by an angle; `around`, 0 to 1 for a full turn, is the azimuth of the turn.
Vec3 turned(Vec3 axis, double angle, double around) {
    const Vec3 side = normalized(cross(axis, std::abs(axis.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})),
               other = cross(axis, side);
    const double turn = 2 * std::numbers::pi * around;
    return normalized(std::cos(angle) * axis +
                      std::sin(angle) * (std::cos(turn) * side + std::sin(turn) * other));
}

constexpr size_t materials = 120;  // of either specular model
// Of |L + V|: beyond 151 degrees between the two the half vector is made of rounding.
constexpr double leastHalf = 0.5;
constexpr double degree = std::numbers::pi / 180;
enum Dimension {
    placeX,
    placeY,
    placeZ,
    turn,
    around,
    geometric,
    geometricAround,
    blurred,
    blurredAround,
    curvature,
    wide,
    occlusion,
    roughness,
    specular,
    albedo,
    material,
    spare,  // keeps the random numbers of the records
    dimensions
};

enum class Lit { directional, point, spot, all, constant, harmonics, cube };
// The direction from which the shading normal is tilted.
enum class Focus { light, half };
struct Kind {
    Lit lit;
    Focus focus;
    bool ggx;
    PelImageSlot output;
};

double turnOf(const Kind& kind, const Point& p) {
    return kind.focus == Focus::half ? logBetween(p[turn], 1e-4, 1.6) : p[turn] * 180 * degree;
}
double roughnessOf(const Point& p) {
    return logBetween(p[roughness], 0.03, 1);
}

// Three lights of three kinds with maps, ambient light of every sort, materials for all pixels.
const Frame& base() {
    static const Frame frame = [] {
        Frame f = randomFrame(7, 16, 1, 3);
        f.lights[1].params.range = 350;  // of places 200 to 470 mm away
        PelLight& spot = f.lights[2].params;
        spot.spotCosInner = 0.98f, spot.spotCosOuter = 0.9f;  // 11 and 26 degrees
        const Vec3 inwards = normalized(-1 * vectorOf(spot.position));
        for (int c = 0; c < 3; ++c) {
            spot.spotDirection[c] = float(inwards[c]);
            spot.color[c] *= 4, f.lights[1].params.color[c] *= 4;  // of order 1 there
        }
        f.materials.clear();
        Dice dice(3);
        for (uint32_t id = 1; id <= 2 * materials; ++id) {
            PelMaterial m = fixture::faceworksMaterial();
            m.specular = m.roughness = m.roughness2 = 1;  // images give them per pixel
            m.specularModel = id % 2 ? PEL_SPECULAR_KSK : PEL_SPECULAR_GGX;
            m.diffusionRadius = float(logBetween(dice.uniform(), 0.5, 20));
            m.deepScatterRadius = float(logBetween(dice.uniform(), 1, 40));
            m.shadowFilterWidth = float(logBetween(dice.uniform(), 1, 30));
            m.f0 = float(logBetween(dice.uniform(), 0.01, 1));
            m.thicknessTaps = 8u << dice.bits() % 3;
            for (float& c : m.deepScatterColor) c = 1;
            for (float& b : m.normalBlend) b = float(dice.uniform());
            f.materials[id] = m;
        }
        f.cube.size = 9;
        for (int i = 0; i < 6 * 9 * 9; ++i)
            f.cube.texels.push_back({dice.uniform(), dice.uniform(), dice.uniform()});
        diskTaps(8), diskTaps(16), diskTaps(32);  // cached before threads read them
        return f;
    }();
    return frame;
}

// Keeps the requested lights and makes the others black, so that the program stays the same.
Frame litBy(Lit lit) {
    Frame f = base();
    const bool ambient = lit >= Lit::constant;
    for (int i = 0; i < 3; ++i)
        if (ambient || (lit != Lit::all && int(lit) != i))
            std::fill_n(f.lights[size_t(i)].params.color, 3, 0.0f);
    if (lit == Lit::point) std::swap(f.lights[0], f.lights[1]);  // thickness is that of the first
    if (lit == Lit::spot) std::swap(f.lights[0], f.lights[2]);
    if (lit != Lit::all && lit != Lit::constant) std::fill_n(f.ambient.constant, 3, 0.0f);
    if (lit != Lit::all && lit != Lit::harmonics)
        for (auto& basis : f.ambient.sh) std::fill_n(basis, 3, 0.0f);
    if (lit != Lit::all && lit != Lit::cube) f.cube.texels.assign(f.cube.texels.size(), {0, 0, 0});
    return f;
}

struct Shading {
    Shading(const Kind& kind, const std::vector<Point>& points)
        : kind_(kind), frame_(litBy(kind.lit)), count_(points.size()) {
        frame_.width = 64;
        frame_.height = uint32_t((count_ + 63) / 64);
        for (int slot = 1; slot < PEL_SLOT_OUT_DIFFUSE; ++slot) {
            Image& image = frame_.slots[slot];
            if (image.components) image.values.assign(frame_.pixels() * image.components, 0.5f);
        }
        frame_.slots[PEL_SLOT_MATERIAL].values.assign(frame_.pixels(), 0);
        for (Light& l : frame_.lights) l.wide.values.assign(frame_.pixels(), 1);
        for (size_t i = 0; i < count_; ++i) set(i, points[i]);
    }
    void move(Jitter& j) {
        for (int slot = 2; slot < PEL_SLOT_OUT_DIFFUSE; ++slot) j(frame_.slots[slot].values);
        for (Light& l : frame_.lights) {
            j(l.wide.values);
            for (float* v : {l.params.toLight, l.params.position})
                for (int c = 0; c < 3; ++c) v[c] = j(v[c]);
            for (float& m : l.params.worldToShadow) m = m == 0 ? m : j(m);
        }
    }
    std::vector<float> measured() const {
        Shader shader(device());
        setFrame(device(), shader, frame_, tables());
        Buffer shown;
        for (const auto slot : {PEL_SLOT_RADIANCE, PEL_SLOT_OUT_DIFFUSE, PEL_SLOT_OUT_DEEP_SCATTER,
                                PEL_SLOT_OUT_SPECULAR, PEL_SLOT_OUT_THICKNESS}) {
            const bool one = slot == PEL_SLOT_OUT_THICKNESS;
            const Buffer image(device(), frame_.pixels() * (one ? 4 : 12));
            shader.set(slot, imageDesc(image, one ? PEL_FORMAT_R32F : PEL_FORMAT_RGB32F, frame_.width,
                                       frame_.height));
            if (slot == kind_.output) shown = image;
        }
        shader.commit().execute();
        std::vector<float> values = shown.readAll<float>();
        values.resize(count_ * (kind_.output == PEL_SLOT_OUT_THICKNESS ? 1 : 3));
        return values;
    }
    std::vector<double> truth() const {
        std::vector<std::vector<double>> each(count_);
        inParallel(count_, [&](size_t i) { each[i] = truthAt(i); });
        std::vector<double> all;
        for (const auto& values : each) all.insert(all.end(), values.begin(), values.end());
        return all;
    }

  private:
    std::vector<double> truthAt(size_t i) const {
        const PelLight& lamp = frame_.lights[0].params;
        const PelMaterial& m = frame_.materials.at(uint32_t(frame_.slots[PEL_SLOT_MATERIAL].at(i)));
        if (kind_.output == PEL_SLOT_OUT_THICKNESS)
            return {truthLight(frame_, m, frame_.lights[0], i).thickness};
        for (const Light& l : frame_.lights)  // nothing beyond the range
            if (l.params.range > 0 &&
                std::abs(length(vectorOf(lamp.position) - place(i)) / lamp.range - 1) < 1e-5)
                return {NAN, NAN, NAN};
        if (kind_.focus == Focus::half &&
            length(toLight(i) + normalized(vectorOf(frame_.camera.position) - place(i))) < leastHalf)
            return {NAN, NAN, NAN};
        const reference::Shaded s = shade_test::truth(frame_, tables(), i);
        const Rgb rgb = kind_.output == PEL_SLOT_OUT_DIFFUSE        ? s.scattered + s.ambient
                        : kind_.output == PEL_SLOT_OUT_DEEP_SCATTER ? s.deepScatter
                        : kind_.output == PEL_SLOT_OUT_SPECULAR     ? s.specular
                                                                    : s.sum();
        return {rgb.x, rgb.y, rgb.z};
    }
    Vec3 place(size_t i) const { return frame_.slots[PEL_SLOT_POSITION].vec(i); }
    Vec3 toLight(size_t i) const {
        const PelLight& l = frame_.lights[0].params;
        return l.type == PEL_LIGHT_DIRECTIONAL ? vectorOf(l.toLight)
                                               : normalized(vectorOf(l.position) - place(i));
    }
    void put(PelImageSlot slot, size_t i, Vec3 v) {
        for (int c = 0; c < 3; ++c) frame_.slots[slot].values[3 * i + size_t(c)] = float(v[c]);
    }
    void set(size_t i, const Point& p) {
        put(PEL_SLOT_POSITION, i,
            {between(p[placeX], -100, 100), between(p[placeY], -100, 100), between(p[placeZ], -100, 100)});
        const Vec3 toViewer = normalized(vectorOf(frame_.camera.position) - place(i)),
                   axis = kind_.focus == Focus::half ? normalized(toLight(i) + toViewer) : toLight(i);
        const Vec3 n = turned(axis, turnOf(kind_, p), p[around]);
        put(PEL_SLOT_NORMAL_SHADING, i, n);
        put(PEL_SLOT_NORMAL_GEOMETRIC, i, turned(n, 25 * degree * p[geometric], p[geometricAround]));
        put(PEL_SLOT_NORMAL_BLURRED, i, turned(n, 25 * degree * p[blurred], p[blurredAround]));
        const auto one = [&](PelImageSlot slot, double v) { frame_.slots[slot].values[i] = float(v); };
        one(PEL_SLOT_CURVATURE, between(p[curvature], -0.1, 1.2));
        one(PEL_SLOT_AMBIENT_OCCLUSION, p[occlusion]);
        one(PEL_SLOT_ROUGHNESS, roughnessOf(p));
        one(PEL_SLOT_SPECULAR, p[specular]);
        one(PEL_SLOT_MATERIAL, 1 + double(kind_.ggx) + 2 * std::floor(p[material] * (materials - 1e-6)));
        put(PEL_SLOT_ALBEDO, i, {p[albedo], p[albedo], p[albedo]});
        for (Light& light : frame_.lights)
            light.wide.values[i] = float(std::clamp(between(p[wide], -0.2, 1.2), 0.0, 1.0));
    }

    Kind kind_;
    Frame frame_;
    size_t count_;
};

std::string whereOf(const Kind& kind, const Point& p) {
    const PelMaterial& m = base().materials.at(1 + uint32_t(p[material] * (materials - 1e-6)) * 2);
    std::string s = text("normal %.3g degrees from the ", turnOf(kind, p) / degree) +
                    (kind.focus == Focus::half ? "half vector" : "light");
    if (kind.output == PEL_SLOT_OUT_SPECULAR || kind.output == PEL_SLOT_RADIANCE)
        s += text(", roughness %.3g", roughnessOf(p));
    if (kind.output == PEL_SLOT_OUT_DEEP_SCATTER)
        s += text(", deep scatter radius %.3g mm", m.deepScatterRadius);
    if (kind.output == PEL_SLOT_OUT_DIFFUSE && kind.lit < Lit::constant)
        s += text(", curvature %.3g /mm, diffusion radius %.3g mm, shadow %.3g",
                  between(p[curvature], -0.1, 1.2), m.diffusionRadius,
                  std::clamp(between(p[wide], -0.2, 1.2), 0.0, 1.0));
    return s;
}

}  // namespace

std::vector<Operation> shadingOperations() {
    constexpr const char* diffuse =
        "curvature -0.1 to 1.2 /mm, diffusion radius 0.5 to 20 mm, shadow filters of 1 to 30 mm, any shadow, "
        "normals at all "
        "angles and up to 25 degrees apart";
    constexpr const char* through =
        "maps of noise, 24 to 35 mm deep; 8 to 32 taps; deep scatter radius 1 to 40 mm; normals at all "
        "angles";
    constexpr const char* shine =
        "roughness 0.03 to 1, normals 0.006 to 90 degrees from the half vector, light and viewer up to 151 "
        "degrees apart, f0 0.01 to 1";
    constexpr const char* white = "normals at all angles, blended from two up to 25 degrees apart";
    using enum Lit;
    constexpr auto light = Focus::light, half = Focus::half;
    constexpr auto diffusely = PEL_SLOT_OUT_DIFFUSE, deeply = PEL_SLOT_OUT_DEEP_SCATTER,
                   thickness = PEL_SLOT_OUT_THICKNESS, shining = PEL_SLOT_OUT_SPECULAR;
    const auto &term = tolerance::shadeTerm, &depth = tolerance::shadeThickness, &sum = tolerance::shadeSum;
    const struct {
        const char *name, *range;
        Kind kind;
        double limit;
        size_t points;
    } rows[] = {
        {"scattered light, directional", diffuse, {directional, light, false, diffusely}, term, 100000},
        {"scattered light, point light", diffuse, {point, light, false, diffusely}, term, 100000},
        {"scattered light, spot light", diffuse, {spot, light, false, diffusely}, term, 100000},
        {"deep scatter, parallel map", through, {directional, light, false, deeply}, term, 100000},
        {"deep scatter, perspective map", through, {point, light, false, deeply}, term, 100000},
        {"thickness of noise, parallel map", through, {directional, light, false, thickness}, depth, 100000},
        {"thickness of noise, perspective map", through, {point, light, false, thickness}, depth, 100000},
        {"specular, Beckmann", shine, {directional, half, false, shining}, sum, 200000},
        {"specular, GGX", shine, {directional, half, true, shining}, sum, 200000},
        {"ambient, constant", white, {constant, light, false, diffusely}, term, 50000},
        {"ambient, harmonics", white, {harmonics, light, false, diffusely}, term, 50000},
        {"ambient, cube map", white, {cube, light, false, diffusely}, term, 50000},
        {"radiance, all terms", shine, {Lit::all, half, false, PEL_SLOT_RADIANCE}, sum, 200000}};
    std::vector<Operation> operations;
    for (const auto& row : rows) {
        const Unit unit = row.kind.output == thickness ? Unit::length : Unit::absolute;
        const auto make = [kind = row.kind](const std::vector<Point>& points) {
            const auto pixels = std::make_shared<Shading>(kind, points);
            return Case{[=](Jitter& j) { pixels->move(j); }, [=] { return pixels->measured(); },
                        [=] { return pixels->truth(); }, whereOf(kind, points[0])};
        };
        Operation& o = operations.emplace_back(
            Operation{{row.name, row.range, unit, row.limit, dimensions, row.points}, make, 512, {}});
        if (row.kind.output == shining) o.axis = Axis{roughness, 0.03, 1, "roughness"};
    }
    return operations;
}

}  // namespace stability
