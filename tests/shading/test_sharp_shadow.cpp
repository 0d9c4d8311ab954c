// Sharp shadows from shadow maps: neither acne nor gaps, whatever the angle, the shape and the unit of
// lengths.
#include "pass_scene.h"
#include "test.h"
#include "variable.h"

using namespace shade_test;

namespace {

// Distance along a ray of the light to the first surface.
using Cast = std::function<double(Vec3 origin, Vec3 direction)>;

struct SharpScene {
    std::vector<Vec3> points, normals;
    MapLight light;
    double texel;  // of the map, at the target
};

constexpr uint32_t mapSize = 256;
constexpr double mapExtent = 85;  // 0.33 a texel

SharpScene sceneOf(Vec3 toLight, bool perspective, bool reversed, const Cast& cast) {
    SharpScene s;
    s.light = mapLight(1, perspective, reversed, toLight, {0, 0, 0}, mapExtent, mapSize);
    s.texel = mapExtent / mapSize;
    const auto& v = s.light.view;
    for (uint32_t i = 0; i < mapSize * mapSize; ++i) {
        const double across = v.extent * ((i % mapSize + 0.5) / mapSize - 0.5),
                     down = v.extent * ((i / mapSize + 0.5) / mapSize - 0.5);
        const Vec3 side = across * v.right + down * v.down;
        const double t = perspective ? cast(v.origin, v.forward + side) : cast(v.origin + side, v.forward);
        s.light.light.map.values[i] =
            float(perspective ? (1 / t - v.decoding.b) / v.decoding.a : t / v.decoding.range);
    }
    return s;
}

// Shadow times N.L of each point, all lengths counted in another unit. `rounded`: the map in another format.
// `width`: of the filter; 0: sharp shadows.
std::vector<float> lit(const SharpScene& s, double unit = 1, uint32_t cascades = 0,
                       const std::function<void(Shader&)>& rounded = {}, float width = 0) {
    Frame f;
    f.width = uint32_t(s.points.size()), f.height = 1;
    f.curvatureLut = f.shadowLut = false;
    for (int slot : {PEL_SLOT_POSITION, PEL_SLOT_NORMAL_SHADING}) f.slots[slot].components = 3;
    for (const Vec3& p : s.points) f.slots[PEL_SLOT_POSITION].push(unit * p);
    for (const Vec3& n : s.normals) f.slots[PEL_SLOT_NORMAL_SHADING].push(n);
    f.materials[1] = pelMaterialDefaults();
    f.materials[1].scattering = width > 0 ? PEL_SCATTERING_PREINTEGRATED : PEL_SCATTERING_NONE;
    for (float& a : f.materials[1].albedo) a = 1;
    Light light = s.light.light;
    PelLight& l = light.params;
    for (int r = 0; r < 4; ++r) copyTo(l.worldToShadow + 4 * r, 1 / unit * vectorOf(l.worldToShadow + 4 * r));
    l.shadowDepthRange = float(l.shadowDepthRange * unit);
    l.shadowDepthA = float(l.shadowDepthA / unit);
    l.shadowDepthB = float(l.shadowDepthB / unit);
    f.materials[1].shadowFilterWidth = width;
    l.shadowFilterTexels = width > 0 ? 48 : 0;
    l.shadowBias = 0;
    l.shadowCascades = cascades;
    f.lights = {light};
    std::vector<float> radiance = shade(f, nullptr, rounded), result;
    for (size_t i = 0; i < radiance.size(); i += 3) result.push_back(radiance[i]);
    return result;
}

double cosine(const SharpScene& s, size_t i) {
    return dot(s.normals[i], -1.0 * s.light.view.forward);
}

Vec3 lightAt(double cosine, double turn) {
    const double sine = std::sqrt(1 - cosine * cosine);
    return {sine * std::cos(turn), sine * std::sin(turn), cosine};
}

const Cast ground = [](Vec3 o, Vec3 d) { return -o[2] / d[2]; };

void scatterOverGround(SharpScene& s, uint32_t count) {
    Random random(3);
    for (uint32_t i = 0; i < count; ++i) {
        s.points.push_back({random.uniform(-8, 8), random.uniform(-8, 8), 0});
        s.normals.push_back({0, 0, 1});
    }
}

TEST(SharpShadow, APlaneThrowsNoneOnItselfAtAnyAngleInAnyUnit) {
    for (double c : {1.0, 0.7, 0.3, 0.1, 0.06})
        for (double turn : {0.3, 2.0})
            for (int form = 0; form < 4; ++form) {
                SharpScene s = sceneOf(lightAt(c, turn), form & 1, form & 2, ground);
                scatterOverGround(s, 512);
                for (double unit : {1.0, 0.1, 0.001, 1000.0}) {
                    const std::vector<float> e = lit(s, unit);
                    double least = 1, most = 0;
                    for (size_t i = 0; i < e.size(); ++i) {
                        least = std::min(least, e[i] / cosine(s, i));
                        most = std::max(most, e[i] / cosine(s, i));
                    }
                    EXPECT_GT(least, 1 - 1e-4)
                        << "cosine " << c << " turn " << turn << " form " << form << " unit " << unit;
                    EXPECT_LT(most, 1 + 1e-4);
                }
            }
}

// The pass agrees with its definition, on a map of discs and noise that has shadows, edges and texels at the
// tolerance.
TEST(SharpShadow, IsItsDefinition) {
    for (bool perspective : {false, true})
        for (bool reversed : {false, true}) {
            SharpScene s;
            s.light = mapLight(4, perspective, reversed, lightAt(0.7, 1), {0, 0, 0}, mapExtent, 64);
            s.texel = mapExtent / 64;
            Random random(11);
            for (int i = 0; i < 3000; ++i) {
                const Vec3 n = random.unit();
                s.points.push_back(
                    {random.uniform(-40, 40), random.uniform(-40, 40), random.uniform(-25, 25)});
                s.normals.push_back(normalized(Vec3{0, 0, 1} + 0.5 * n));
            }
            const std::vector<float> e = lit(s);
            size_t partly = 0, turned = 0;
            for (size_t i = 0; i < e.size(); ++i) {
                const double truth =
                    reference::sharpShadow(s.light.map, s.light.view, s.points[i], s.normals[i]);
                partly += truth > 0.01 && truth < 0.99;
                // Rounding may turn a decision: whether a texel is dark, whether steps are those of a round
                // body.
                turned += std::abs(e[i] - truth * std::max(cosine(s, i), 0.0)) > tolerance::sharpShadow;
            }
            EXPECT_GT(partly, e.size() / 40);
            EXPECT_LE(turned, e.size() / 500);
        }
}

// The steps of coarse formats are longer than half a texel.
TEST(SharpShadow, FormatsOfMapsThrowNoneByTheirRounding) {
    constexpr double share = 0.02;  // of the range, used by the ground
    for (const PelFormat format : {PEL_FORMAT_R16_UNORM, PEL_FORMAT_R16F, PEL_FORMAT_R8_UNORM})
        for (double c : {1.0, 0.3}) {
            SharpScene s = sceneOf(lightAt(c, 2), false, false, ground);
            scatterOverGround(s, 512);
            PelLight& l = s.light.light.params;
            const double part = format == PEL_FORMAT_R8_UNORM ? 1 : share;
            for (int k = 8; k < 12; ++k) l.worldToShadow[k] *= float(part);
            l.worldToShadow[11] += float(0.5 * (1 - part));
            l.shadowDepthRange /= float(part);
            std::vector<uint8_t> bytes;
            for (const float z : s.light.light.map.values) {
                const double stored = 0.5 + part * (double(z) - 0.5);
                const auto bits = uint16_t(format == PEL_FORMAT_R16F        ? toHalf(float(stored))
                                           : format == PEL_FORMAT_R16_UNORM ? std::lround(65535 * stored)
                                                                            : std::lround(255 * stored));
                bytes.push_back(uint8_t(bits & 255));
                if (format != PEL_FORMAT_R8_UNORM) bytes.push_back(uint8_t(bits >> 8));
            }
            const auto given = [&](Shader& shader) {
                const Buffer map(device(), bytes);
                shader.set(0, PEL_LIGHT_SHADOW_MAP, imageDesc(map, format, mapSize, mapSize));
            };
            for (float width : {0.0f, 4.0f}) {
                const std::vector<float> e = lit(s, 1, 0, given, width);
                for (size_t i = 0; i < e.size(); ++i)
                    ASSERT_NEAR(e[i], cosine(s, i), 1e-4)
                        << "format " << format << " cosine " << c << " width " << width << ", " << i;
            }
        }
}

// A map alone or as its own only cascade is the same. Points outside of the map are lit, and texels of NaN
// throw no shadow.
TEST(SharpShadow, NoShadowFromWhatIsNotThere) {
    SharpScene s = sceneOf(lightAt(0.7, 1), false, false, ground);
    scatterOverGround(s, 256);
    EXPECT_EQ(lit(s), lit(s, 1, 1));
    for (double away : {100.0, 1e4, 1e9}) s.points.push_back({away, away, 0}), s.normals.push_back({0, 0, 1});
    for (float& z : s.light.light.map.values) z = NAN;
    const std::vector<float> e = lit(s);
    for (size_t i = 0; i < e.size(); ++i) EXPECT_NEAR(e[i], cosine(s, i), 1e-6) << i;
    const Variable fence("PELLUCID_FENCE", "end");
    s.points.assign(32, {1e4, 1e4, 0}), s.normals.assign(32, {0, 0, 1});
    s.light.light.mapSize = 2, s.light.light.map.values.assign(4, 0.5f);
    for (const float each : lit(s)) EXPECT_NEAR(each, cosine(s, 0), 1e-6);
}

}  // namespace
