// Wide shadows where the map ends inside of the scene, and with softness from hard to wider than the filter.
#include <gtest/gtest.h>

#include "pass_scene.h"
#include "tolerances.h"

using namespace shade_test;

namespace {

double shadowTruth(const Frame& f, const MapLight& from, size_t i) {
    const PelMaterial& m = f.materials.at(uint32_t(f.slots[PEL_SLOT_MATERIAL].at(i)));
    const PelLight& l = f.lights[0].params;
    return reference::wideShadow(
        from.map, from.view, f.slots[PEL_SLOT_POSITION].vec(i), f.slots[PEL_SLOT_NORMAL_GEOMETRIC].vec(i),
        {m.shadowFilterWidth, l.shadowBias, l.shadowSoftness, l.shadowConeSlope, int(l.shadowFilterTexels)});
}

Frame sceneUnder(const MapLight& from, uint32_t seed) {
    Frame f = reliefFrame(seed, 130, 60, 0.4f);
    f.materials[2].shadowFilterWidth = 3;
    f.lights = {from.light};
    f.options.countPixels = 1;
    showWideShadow(f);
    return f;
}

// What the bounds of the map's blocks decide is what its texels give, to the bit, and both are right.
struct Seen {
    double worst = 0;
    size_t lit = 0, dark = 0, between = 0;
    uint64_t filtered = 0, read = 0;
};
Seen compare(Frame f, const MapLight& from, const std::string& where) {
    PelShaderStats stats = pelShaderStatsDefaults();
    const std::vector<float> shown = shade(device(), f, tables(), &stats);
    Seen seen;
    for (size_t i = 0; i < f.pixels(); ++i) {
        if (f.slots[PEL_SLOT_MATERIAL].values[i] == 0) continue;
        const double truth = shadowTruth(f, from, i);
        seen.worst = std::max(seen.worst, std::abs(truth - shown[3 * i]));
        ++(truth < 0.01 ? seen.dark : truth > 0.99 ? seen.lit : seen.between);
    }
    seen.filtered = stats.pixelsWideShadow;
    seen.read = stats.pixelsShadowTexels;
    f.options.disableSkipping = 1;
    EXPECT_EQ(shown, shade(device(), f, tables())) << where << ": without bounds";
    // Of a hard shadow float depths are a larger part.
    EXPECT_LE(seen.worst, f.lights[0].params.shadowSoftness < 0.1f ? tolerance::wideShadowAnywhere
                                                                   : tolerance::wideShadow)
        << where;
    return seen;
}

constexpr float softnesses[] = {0.01f, 0.25f, 1.0f, 1.7f, 5.0f, 40.0f};

void setDepth(MapLight& from, size_t texel, double distance) {
    const double z = from.view.decoding.perspective
                         ? (1 / distance - from.view.decoding.b) / from.view.decoding.a
                         : distance / from.view.decoding.range;
    from.light.map.values[texel] = float(z);
    from.map.depth[texel] = double(float(z));
}

TEST(WideShadowEdges, SoftnessFromHardToWiderThanTheFilter) {
    for (const float softness : softnesses)
        for (const bool perspective : {false, true})
            for (const bool reversed : {false, true}) {
                MapLight from = mapLight(7, perspective, reversed, {0.5, 0.2, 0.9}, {26, 12, 5}, 70, 200);
                from.light.params.shadowSoftness = softness;
                Frame f = sceneUnder(from, 1);
                for (auto& [id, material] : f.materials) material.shadowFilterWidth *= 0.4f;
                const std::string where = "softness " + std::to_string(softness) +
                                          (perspective ? ", perspective" : "") +
                                          (reversed ? ", reversed" : "");
                const Seen seen = compare(f, from, where);
                EXPECT_LT(seen.read, seen.filtered) << where << ": bounds decide some";
                EXPECT_GT(seen.between, 100u) << where;
            }
}

// Under a closed roof that comes down into the ground everything is in shadow, but for where it is nearer
// than the softness, or below.
TEST(WideShadowEdges, UnderARoofThatComesDown) {
    for (const float softness : softnesses)
        for (const bool perspective : {false, true})
            for (const bool reversed : {false, true}) {
                MapLight from = mapLight(7, perspective, reversed, {0.1, 0.2, 0.9}, {26, 12, 0}, 90, 200);
                from.light.params.shadowSoftness = softness;
                for (size_t i = 0; i < from.light.map.values.size(); ++i)
                    setDepth(from, i, 168 - 0.2 * double(i % 200) + 0.01 * double(i / 200));
                Frame f = sceneUnder(from, 1);
                for (auto& [id, material] : f.materials) material.shadowFilterWidth *= 0.4f;
                const std::string where = "softness " + std::to_string(softness) +
                                          (perspective ? ", perspective" : "") +
                                          (reversed ? ", reversed" : "");
                const Seen seen = compare(f, from, where);
                EXPECT_LT(seen.read, seen.filtered) << where << ": bounds decide some";
                EXPECT_GT(seen.between, 20u) << where;
                if (softness < 2) {
                    EXPECT_GT(seen.dark, 50u) << where;
                }
            }
}

// The map of a plane alone, lit at a slant: the bounds know its slope, so that hardly a filter reads texels.
TEST(WideShadowEdges, ASlantedPlaneIsDecidedByItsSlope) {
    MapLight from = mapLight(7, false, false, {0.8, 0.3, 0.5}, {26, 12, 0}, 120, 200);
    for (size_t i = 0; i < from.light.map.values.size(); ++i) {
        const auto& v = from.view;
        const double right = (double(i % 200) + 0.5) / 200 - 0.5, down = (double(i / 200) + 0.5) / 200 - 0.5;
        const reference::Vec3 p = v.origin + right * v.extent * v.right + down * v.extent * v.down;
        setDepth(from, i, -p.z / v.forward.z);
    }
    from.light.params.shadowBias = 1;  // the plane itself is not its own shadow's border
    Frame f = sceneUnder(from, 1);
    for (size_t i = 0; i < f.pixels(); ++i) {
        f.slots[PEL_SLOT_POSITION].values[3 * i + 2] = 0;
        for (int c = 0; c < 3; ++c) f.slots[PEL_SLOT_NORMAL_GEOMETRIC].values[3 * i + size_t(c)] = c == 2;
    }
    for (auto& [id, material] : f.materials) material.shadowFilterWidth *= 0.4f;
    const Seen seen = compare(f, from, "slanted plane");
    EXPECT_GT(seen.filtered, 1000u);
    EXPECT_LT(double(seen.read), 0.05 * double(seen.filtered));
}

// A plane under a roof that is the whole map: beyond each of its four borders light comes in, although the
// outermost texels are near the light. With bias and slope, and with filters of which the map is a small
// part.
TEST(WideShadowEdges, OutsideOfTheMapEverythingIsLit) {
    for (const bool perspective : {false, true})
        for (const bool reversed : {false, true})
            for (const uint32_t size : {1u, 2u, 7u, 8u, 9u, 16u, 17u, 40u, 129u}) {
                MapLight from = mapLight(3, perspective, reversed, {0.2, 0.1, 0.9}, {26, 12, 0}, 16, size);
                for (size_t i = 0; i < from.light.map.values.size(); ++i) setDepth(from, i, 100);
                from.light.params.shadowFilterTexels = 256;
                const Frame f = sceneUnder(from, 2);
                const std::string where = std::to_string(size) + " texels" +
                                          (perspective ? ", perspective" : "") +
                                          (reversed ? ", reversed" : "");
                const Seen seen = compare(f, from, where);
                EXPECT_GT(seen.between, 200u) << where;
                if (size > 2) {
                    EXPECT_GT(seen.lit, 500u) << where;
                }
                if (size > 16) {
                    EXPECT_GT(seen.dark, 50u) << where;
                }
            }
}

// A straight edge between two blocks of the map: filters that overlap blocks of both sides read texels, and
// no others do.
TEST(WideShadowEdges, TexelsAreReadAcrossTheEdgeAlone) {
    for (const bool nearIsLeft : {true, false}) {
        MapLight from = mapLight(3, false, false, {0, 0, 1}, {24, 10, 0}, 128, 128);
        for (size_t i = 0; i < from.light.map.values.size(); ++i)
            setDepth(from, i, (i % 128 < 64) == nearIsLeft ? 50 : 250);
        Frame f = sceneUnder(from, 2);
        uint64_t skin = 0, across = 0, doubtful = 0;
        for (size_t i = 0; i < f.pixels(); ++i) {
            const float up[3] = {0, 0, 1};
            std::copy_n(up, 3, &f.slots[PEL_SLOT_NORMAL_GEOMETRIC].values[3 * i]);
            f.slots[PEL_SLOT_POSITION].values[3 * i + 2] = 0;
            const uint32_t id = uint32_t(f.slots[PEL_SLOT_MATERIAL].values[i]);
            if (id == 0) continue;
            ++skin;
            const Vec3 offset = f.slots[PEL_SLOT_POSITION].vec(i) - from.view.origin;
            const double x = reference::dot(from.view.right, offset) / from.view.extent * 128 + 63.5;
            // texels, at least two
            const double radius = std::max(0.5 * f.materials[id].shadowFilterWidth, 2.0);
            across += x - radius <= 63 && x + radius >= 64;
            doubtful += std::abs(x - radius - 63) < 1e-3 || std::abs(x + radius - 64) < 1e-3;
        }
        PelShaderStats stats = pelShaderStatsDefaults();
        shade(device(), f, tables(), &stats);
        EXPECT_EQ(stats.pixelsWideShadow, skin);
        EXPECT_NEAR(double(stats.pixelsShadowTexels), double(across), double(doubtful));
        EXPECT_GT(across, 500u);
        EXPECT_LT(across, skin / 2);
        EXPECT_LT(doubtful, across / 20);
    }
}

// Left, right, above and below the map by themselves: half of the filter lies outside.
TEST(WideShadowEdges, EachBorderByItself) {
    MapLight from = mapLight(3, false, false, {0, 0, 1}, {26, 12, 0}, 16, 64);
    for (size_t i = 0; i < from.light.map.values.size(); ++i) setDepth(from, i, 100);
    from.light.params.shadowFilterTexels = 256;
    Frame f = sceneUnder(from, 2);
    const double k = from.view.extent / 2;
    const Vec3 middle = from.view.origin + 150.0 * from.view.forward;
    const Vec3 borders[] = {middle - k * from.view.right, middle + k * from.view.right,
                            middle - k * from.view.down, middle + k * from.view.down};
    for (size_t i = 0; i < f.pixels(); ++i) {
        f.slots[PEL_SLOT_MATERIAL].values[i] = 1;
        const float up[3] = {0, 0, 1};
        std::copy_n(up, 3, &f.slots[PEL_SLOT_NORMAL_GEOMETRIC].values[3 * i]);
        for (int c = 0; c < 3; ++c) f.slots[PEL_SLOT_POSITION].values[3 * i + c] = float(borders[i % 4][c]);
    }
    const std::vector<float> shown = shade(device(), f, tables());
    for (size_t i = 0; i < f.pixels(); ++i) EXPECT_NEAR(shown[3 * i], 0.5, 0.05) << "border " << i % 4;
}

// The bounds of a map are of what its texels say, in whatever format.
TEST(WideShadowEdges, AMapOfIntegersIsTheMapOfItsFloats) {
    MapLight from = mapLight(7, false, false, {0.5, 0.2, 0.9}, {26, 12, 5}, 70, 200);
    std::vector<uint16_t> integers;
    for (size_t i = 0; i < from.light.map.values.size(); ++i) {
        integers.push_back(uint16_t(std::lround(65535 * std::clamp(from.light.map.values[i], 0.0f, 1.0f))));
        setDepth(from, i, from.view.decoding.range * integers.back() / 65535.0);
    }
    const Frame f = sceneUnder(from, 1);
    const std::vector<float> expected = shade(device(), f, tables());
    const std::vector<float> shown = shade(device(), f, tables(), nullptr, [&](pellucid::Shader& shader) {
        const pellucid::Buffer map(device(), integers);
        shader.set(0, PEL_LIGHT_SHADOW_MAP, pellucid::imageDesc(map, PEL_FORMAT_R16_UNORM, 200, 200));
    });
    EXPECT_GT(*std::max_element(shown.begin(), shown.end()), 0.1f);
    for (size_t i = 0; i < shown.size(); ++i) ASSERT_NEAR(shown[i], expected[i], tolerance::wideShadow) << i;
}

}  // namespace
