// Spheres and rectangles as lights, against many small lights in double precision; their limits; and invalid
// sizes.
#include "scattering_frame.h"
#include "shader_ready.h"
#include "test.h"

using namespace shade_test;

namespace {

constexpr PelLightType sizes[] = {PEL_LIGHT_SPHERE, PEL_LIGHT_RECTANGLE};

const char* nameOf(PelLightType type) {
    return type == PEL_LIGHT_SPHERE ? "sphere" : "rectangle";
}

// Turns lights into spheres or rectangles that look to the origin. `size`: of a half side, or the radius,
// over the distance to the origin, at most.
void makeArea(Frame& f, PelLightType type, uint32_t seed, float size) {
    Random random(seed);
    for (Light& light : f.lights) {
        PelLight& l = light.params;
        l.type = type;
        l.range = 0;
        const Vec3 to = vectorOf(l.position);
        const double distance = length(to);
        for (float& c : l.color) c = 20000 * random.uniform(0.2f, 1);
        l.radius = float(distance) * size * random.uniform(0.3f, 1);
        // Along -position, and a little aside.
        const Vec3 axis = normalized(-1 / distance * to + 0.5 * random.unit());
        const Vec3 u = normalized(cross(axis, std::abs(axis.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})),
                   v = cross(axis, u);
        const double width = distance * size * random.uniform(0.3f, 1),
                     height = distance * size * random.uniform(0.3f, 1);
        copyTo(l.halfWidth, width * u), copyTo(l.halfHeight, height * v);
    }
}

// By the programs for lights with a size, also where there is none.
std::vector<float> shadeByArea(Frame f) {
    f.lights.emplace_back().params = pellucid::sphereLight({0, 0, 100}, 1, {0, 0, 0});
    return shade(f);
}

// Without shadows, ambient light and deep scatter.
Frame areaFrame(uint32_t seed, PelLightType type, float size, uint32_t lights = 1) {
    Frame f = randomFrame(seed, 48, 16, lights);
    f.ambient = pelAmbientDefaults();
    f.slots[PEL_SLOT_CURVATURE] = {};
    f.shadowLut = false;
    for (Light& light : f.lights) light.wide = light.map = {};
    for (auto& [id, m] : f.materials) {
        m.specular = 0;
        std::fill_n(m.deepScatterColor, 3, 0.0f);
    }
    makeArea(f, type, seed, size);
    return f;
}

// Whether pixels below a light at this distance are lit.
bool litAt(PelLightType type, float distance, float range) {
    Frame f = areaFrame(1, type, 0.1f);
    for (size_t i = 0; i < f.pixels(); ++i) {
        f.slots[PEL_SLOT_POSITION].set(i, {});
        for (const int slot : {PEL_SLOT_NORMAL_SHADING, PEL_SLOT_NORMAL_GEOMETRIC})
            f.slots[slot].set(i, {0, 0, 1});
    }
    PelLight& l = f.lights[0].params;
    copyTo(l.position, {0, 0, distance});
    copyTo(l.halfWidth, {0.1, 0, 0}), copyTo(l.halfHeight, {0, -0.1, 0});
    l.range = range;
    return std::ranges::any_of(shadeByArea(f), [](float v) { return v > 0; });
}

// Relative to the brightest pixel, to the RMS of all, and to their sum.
struct Errors {
    double worst = 0, rms = 0, sum = 0;
};

Errors errorsOf(const Frame& f) {
    const std::vector<float> result = shade(f);
    Errors e;
    double brightest = 0, square = 0, total = 0;
    for (size_t i = 0; i < f.pixels(); ++i) {
        const Rgb truth = shade_test::truth(f, tables(), i).sum();
        for (int c = 0; c < 3; ++c) {
            const double difference = result[3 * i + c] - truth[c];
            e.worst = std::max(e.worst, std::abs(difference));
            e.rms += difference * difference, e.sum += difference;
            brightest = std::max(brightest, truth[c]);
            square += truth[c] * truth[c], total += truth[c];
        }
    }
    e.worst /= brightest, e.rms = std::sqrt(e.rms / square), e.sum /= total;
    return e;
}

double largestDifference(const std::vector<float>& a, const std::vector<float>& b, double scale = 1) {
    double largest = 0;
    for (size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(scale * b[i] - double(a[i])));
    return largest;
}

// Normals by which most pixels show the light: halfway between it and the camera, and up to `aside` off.
void showHighlights(Frame& f, float aside) {
    Random random(7);
    for (size_t i = 0; i < f.pixels(); ++i) {
        const Vec3 p = f.slots[PEL_SLOT_POSITION].vec(i);
        const Vec3 tilt = random.unit();
        const Vec3 half = normalized(vectorOf(f.lights[0].params.position) - p) +
                          normalized(vectorOf(f.camera.position) - p);
        f.slots[PEL_SLOT_NORMAL_SHADING].set(
            i, normalized(normalized(half) + double(random.uniform(0, aside)) * tilt));
    }
}

struct Size {
    PelLightType type;
    float size;  // of makeArea
    double rms;
};
void PrintTo(const Size& s, std::ostream* out) {
    *out << nameOf(s.type) << ' ' << s.size;
}

class AreaSizes : public testing::TestWithParam<Size> {};

TEST_P(AreaSizes, DiffuseLightAgainstManySmallLights) {
    const Errors e = errorsOf(areaFrame(3, GetParam().type, GetParam().size, 2));
    EXPECT_LE(e.rms, tolerance::areaDiffuse);
    EXPECT_LE(e.worst, 4 * tolerance::areaDiffuse);
}

// Of normals by which the horizon goes through the light.
TEST(AreaLights, OfASmallSphereAtTheHorizon) {
    constexpr float size = 0.002f;
    Frame f = areaFrame(3, PEL_LIGHT_SPHERE, size);
    for (size_t i = 0; i < f.pixels(); ++i) {
        const Vec3 to = normalized(vectorOf(f.lights[0].params.position) - f.slots[PEL_SLOT_POSITION].vec(i)),
                   aside = normalized(cross(to, Vec3{0.36, 0.48, 0.8}));
        f.slots[PEL_SLOT_NORMAL_SHADING].set(i, normalized(aside + size * (double(i % 41) / 20 - 1) * to));
    }
    EXPECT_LE(errorsOf(f).rms, 4 * tolerance::areaDiffuse) << "normals are floats";
}

// A strip near a ball: at most places the horizon cuts it. The truth: 400 short rectangles, each far away.
TEST(AreaLights, StripsAtTheHorizon) {
    Frame f = areaFrame(3, PEL_LIGHT_RECTANGLE, 0.1f);
    PelLight& l = f.lights[0].params;
    for (size_t i = 0; i < f.pixels(); ++i)
        f.slots[PEL_SLOT_POSITION].set(i, f.slots[PEL_SLOT_NORMAL_SHADING].vec(i));
    copyTo(l.position, {0, 1.5, 0});
    std::fill_n(l.color, 3, 1.0f);
    const float length = 2, half = 0.03f;
    copyTo(l.halfHeight, {0, 0, half}), copyTo(l.halfWidth, {length, 0, 0});
    const auto strip = shade(f);
    constexpr int parts = 400;
    copyTo(l.halfWidth, {length / parts, 0, 0});
    for (float& c : l.color) c /= parts;
    const Light part = f.lights[0];
    f.lights.assign(parts, part);
    for (int k = 0; k < parts; ++k)
        f.lights[size_t(k)].params.position[0] = length * (float(2 * k + 1) / parts - 1);
    const auto sum = sumOfLights(f);
    EXPECT_LE(largestDifference(strip, sum), 3e-4 * std::ranges::max(sum));
}

TEST_P(AreaSizes, TablesAgainstManySmallLights) {
    Frame f = areaFrame(4, GetParam().type, GetParam().size);
    f.slots[PEL_SLOT_CURVATURE] = randomFrame(4, 48, 16, 1).slots[PEL_SLOT_CURVATURE];
    const Errors e = errorsOf(f);
    EXPECT_LE(e.rms, tolerance::areaTables * GetParam().size);
    EXPECT_LE(std::abs(e.sum), 0.25 * tolerance::areaTables * GetParam().size);
}

TEST_P(AreaSizes, SpecularLightAgainstManySmallLights) {
    for (const PelSpecularModel model : {PEL_SPECULAR_KSK, PEL_SPECULAR_GGX}) {
        Frame f = areaFrame(5, GetParam().type, GetParam().size);
        f.slots[PEL_SLOT_ALBEDO].values.assign(f.pixels() * 3, 0.0f);
        for (auto& [id, m] : f.materials) m.specular = 1, m.specularModel = model;
        showHighlights(f, GetParam().size + 0.3f);
        const Errors e = errorsOf(f);
        EXPECT_LE(e.rms, GetParam().rms);
        EXPECT_LE(std::abs(e.sum), 0.7 * GetParam().rms);
    }
}

INSTANTIATE_TEST_SUITE_P(All, AreaSizes,
                         testing::Values(Size{PEL_LIGHT_SPHERE, 0.05f, tolerance::areaHighlightSmall},
                                         Size{PEL_LIGHT_SPHERE, 0.3f, tolerance::areaHighlight},
                                         Size{PEL_LIGHT_SPHERE, 0.6f, tolerance::areaHighlightLarge},
                                         Size{PEL_LIGHT_RECTANGLE, 0.05f, tolerance::areaHighlightSmall},
                                         Size{PEL_LIGHT_RECTANGLE, 0.3f, tolerance::areaHighlight},
                                         Size{PEL_LIGHT_RECTANGLE, 0.6f, tolerance::areaHighlightLarge},
                                         Size{PEL_LIGHT_SPHERE, 4, tolerance::areaHighlightWall},
                                         Size{PEL_LIGHT_RECTANGLE, 4, tolerance::areaHighlightWall}));

TEST(AreaLights, OfNoSizeArePoints) {
    Frame f = randomFrame(6, 64, 24, 2);
    for (Light& light : f.lights) light.params.type = PEL_LIGHT_SPHERE, light.params.radius = 0;
    const auto spheres = shadeByArea(f);
    for (Light& light : f.lights) light.params.type = PEL_LIGHT_POINT;
    EXPECT_LE(largestDifference(spheres, shadeByArea(f)), tolerance::shadeTerm);
}

// From 200,000 lengths away rectangles are points whose light falls by the cosine to their axis.
TEST(AreaLights, RectanglesFarAwayArePoints) {
    Frame f = areaFrame(6, PEL_LIGHT_RECTANGLE, 0.05f);
    PelLight& l = f.lights[0].params;
    double along = 0;
    const Vec3 axis = normalized(cross(vectorOf(l.halfWidth), vectorOf(l.halfHeight)));
    for (int c = 0; c < 3; ++c) {
        along -= l.position[c] * axis[c] / 300;
        l.position[c] *= 2e5f / 300, l.color[c] = 4e10f;
    }
    ASSERT_GT(along, 0.3);
    const auto rectangle = shadeByArea(f);
    l.type = PEL_LIGHT_POINT;
    EXPECT_LE(largestDifference(rectangle, shadeByArea(f), along),
              3e-4);  // the frame's extent over the distance
}

TEST(AreaLights, InsideASphereAndBehindARectangle) {
    Frame f = areaFrame(6, PEL_LIGHT_SPHERE, 0.1f);
    f.slots[PEL_SLOT_MATERIAL] = f.slots[PEL_SLOT_ALBEDO] = {};
    std::fill_n(f.materials[1].albedo, 3, 1.0f);
    PelLight& l = f.lights[0].params;
    l.radius = 1000;
    std::fill_n(l.color, 3, 1e6f);
    for (const bool centre : {false, true}) {  // the last position is the light's
        if (centre) std::copy_n(l.position, 3, f.slots[PEL_SLOT_POSITION].values.end() - 3);
        const auto inside = shade(f);
        for (size_t i = 0; i < inside.size(); ++i) {
            ASSERT_TRUE(std::isfinite(inside[i]));
            ASSERT_GE(inside[i], 0);
        }
        if (f.materials[1].specular == 0) {
            EXPECT_LE(std::ranges::max(inside), 1.0f) << "the radiance is 1, and albedo too";
        }
        f.materials[1].specular = 1, f.materials[1].roughness = 0;
    }
    // The camera sees normals that face the light; turned round, a rectangle lights none of them.
    makeArea(f, PEL_LIGHT_RECTANGLE, 1, 0.5f);
    const auto before = shade(f);
    EXPECT_GT(std::ranges::max(before), 0.01f);
    for (float& v : l.halfWidth) v = -v;
    for (const float v : shade(f)) ASSERT_EQ(v, 0);
    // In turn before and behind it, with normals against its axis.
    const Vec3 axis = normalized(cross(vectorOf(l.halfWidth), vectorOf(l.halfHeight)));
    for (size_t i = 0; i < f.pixels(); ++i) {
        f.slots[PEL_SLOT_POSITION].set(i, vectorOf(l.position) + (i % 2 ? 20.0 : -20.0) * axis);
        f.slots[PEL_SLOT_NORMAL_SHADING].set(i, -1 * axis);
    }
    const auto sides = shade(f);
    for (size_t i = 0; i < f.pixels(); ++i) EXPECT_EQ(sides[3 * i] > 0, i % 2 == 1) << i;
    // Points in the rectangle and in its plane.
    for (size_t i = 0; i < f.pixels(); ++i)
        f.slots[PEL_SLOT_POSITION].set(i, vectorOf(l.position) + double(i) / 100 * vectorOf(l.halfWidth) +
                                              double(i % 7) / 3 * vectorOf(l.halfHeight));
    for (const float v : shade(f)) ASSERT_TRUE(std::isfinite(v) && v >= 0);
}

TEST(AreaLights, LightOf64Adds) {
    Frame f = areaFrame(8, PEL_LIGHT_SPHERE, 0.3f, 64);
    for (auto& [id, m] : f.materials) m.specular = 0.5f;
    Frame rectangles = f;
    makeArea(rectangles, PEL_LIGHT_RECTANGLE, 9, 0.3f);
    for (size_t i = 0; i < 64; i += 3) f.lights[i] = rectangles.lights[i];
    for (size_t i = 1; i < 64; i += 9) f.lights[i].params.type = PEL_LIGHT_POINT;
    const auto all = shade(f);
    EXPECT_LE(largestDifference(all, sumOfLights(f)), 1e-5 * std::ranges::max(all));
}

// Irradiance per pixel is what the shading kernel has without it.
TEST(AreaLights, IrradiancePerPixel) {
    for (const PelLightType type : sizes) {
        Frame f = areaFrame(6, type, 0.5f, 2);
        const auto direct = shade(f);
        for (auto& [id, m] : f.materials) m.scattering = PEL_SCATTERING_NONE;
        EXPECT_LE(largestDifference(direct, shade(f)), tolerance::shadeTerm) << nameOf(type);
    }
}

// Methods by tables, from irradiance, and from shadow maps: a small light equals a point, and a large one
// lights beyond the terminator.
TEST(AreaLights, OfMethodsOfScattering) {
    for (const PelScattering method :
         {PEL_SCATTERING_PREINTEGRATED, PEL_SCATTERING_SEPARABLE, PEL_SCATTERING_LIGHT}) {
        Frame f = scatteringFrame(method, 96, 64);
        const pellucid::Profile profile = pellucid::Profile::skin();
        for (auto& [id, m] : f.materials) m.profile = profile.get();
        f.ambient = pelAmbientDefaults();
        PelLight& l = f.lights[0].params;
        l.type = PEL_LIGHT_POINT;
        copyTo(l.position, 200 * vectorOf(l.toLight));
        std::fill_n(l.color, 3, 200.0f * 200);
        const auto point = shadeByArea(f);
        l.type = PEL_LIGHT_SPHERE, l.radius = 0.01f;
        EXPECT_LE(largestDifference(shadeByArea(f), point), 1e-3) << method;
        l.type = PEL_LIGHT_RECTANGLE;
        copyTo(l.halfHeight, {0.008, 0, -0.006});
        copyTo(l.halfWidth, cross(vectorOf(l.toLight), vectorOf(l.halfHeight)));
        // It looks to the middle of the picture, where the cosine is 1.
        EXPECT_LE(largestDifference(shadeByArea(f), point), 0.05) << method;
        l.type = PEL_LIGHT_SPHERE, l.radius = 100;
        EXPECT_GE(largestDifference(shadeByArea(f), point), 0.01) << method;
    }
}

TEST(AreaLights, ReachTheirRange) {
    for (const PelLightType type : {PEL_LIGHT_POINT, PEL_LIGHT_SPHERE, PEL_LIGHT_RECTANGLE}) {
        EXPECT_TRUE(litAt(type, 4, 4)) << int(type);
        EXPECT_FALSE(litAt(type, 4, 3.999f)) << int(type);
    }
}

TEST(AreaLights, SizesThatAreNone) {
    const auto refused = [](const char* word, auto change) {
        PelLight l = pelLightDefaults();
        l.type = PEL_LIGHT_RECTANGLE;
        change(l);
        expectRefused({"PelLight 0", word}, [&] { Shader(device()).set(std::vector{l}); });
    };
    const auto sphere = [](float radius) {
        return [radius](PelLight& l) { l.type = PEL_LIGHT_SPHERE, l.radius = radius; };
    };
    for (const float radius : {-1.0f, NAN, INFINITY}) refused("radius", sphere(radius));
    refused("halfWidth", [](PelLight& l) { l.halfWidth[1] = NAN; });
    refused("halfHeight", [](PelLight& l) { l.halfHeight[1] = INFINITY; });
    refused("lengths", [](PelLight& l) { l.halfWidth[0] = 0; });
    refused("lengths", [](PelLight& l) { l.halfHeight[1] = 1e30f; });
    refused("9.999999e-07", [](PelLight& l) { l.halfHeight[1] = 9.999999e-7f; });
    refused("right angles", [](PelLight& l) { l.halfHeight[0] = 0.01f; });
    refused("position", [](PelLight& l) { l.position[2] = NAN; });
}

}  // namespace
