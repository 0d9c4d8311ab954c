// Penumbrae of lights with a size, from maps that are seen from their centre: of a straight edge over a
// plane, against the part of the light that is above the edge.
#include "shade_scene.h"
#include "test.h"

using namespace shade_test;

namespace {

constexpr uint32_t columns = 256, rows = 16;
constexpr float lightHeight = 300, extent = 120, rowY = rows / 2;  // of the light; of the row of pixels

float columnX(size_t column) {
    return (float(column) + 0.5f) / columns * extent - extent / 2;
}

// A white plane under a light whose centre is over x = 0, and an edge at that x over it: x below 0 is dark.
// slope: of the plane, along x and y.
struct Edge {
    PelLightType type = PEL_LIGHT_SPHERE;
    float radius = 20, height = 60;
    bool cube = false;
    PelScattering scattering = PEL_SCATTERING_NONE;
    float slope[2] = {0, 0};
    float side = 0;    // of a square in place of the edge, if not 0; its middle is over the row of pixels
    float turned = 1;  // cosine, of a rectangle that is longer by as much
    float planeAt(float x, float y) const { return slope[0] * x + slope[1] * y; }
};

Light lightOver(const Edge& edge, uint32_t size = 512) {
    Light light;
    PelLight& l = light.params = pelLightDefaults();
    l.type = edge.type;
    l.position[2] = lightHeight;
    std::fill_n(l.color, 3, lightHeight * lightHeight);
    if (edge.type == PEL_LIGHT_RECTANGLE)
        l.halfWidth[0] = edge.radius, l.halfHeight[1] = -edge.radius,  // downwards
            l.halfHeight[2] = edge.radius * std::sqrt(1 - edge.turned * edge.turned) / edge.turned;
    else
        l.radius = edge.radius;
    const float near = 50, far = 1000, a = 1 / far - 1 / near, b = 1 / near;
    l.shadowDepthA = a, l.shadowDepthB = b;
    const auto depthOf = [&](float alongX, float alongY) {
        // Of the plane, or of what is over x below 0.
        const float over = lightHeight - edge.height,
                    distance = lightHeight / std::max(1 + edge.planeAt(alongX, alongY), lightHeight / far);
        const bool beside = edge.side > 0 && (alongX < -edge.side / over ||
                                              std::abs(alongY - rowY / lightHeight) > edge.side / 2 / over);
        return (1 / (alongX < 0 && !beside ? std::min(distance, over) : distance) - b) / a;
    };
    const auto middle = [&](uint32_t texel) { return 2 * (float(texel) + 0.5f) / float(size) - 1; };
    if (edge.cube) {
        l.shadowProjection = PEL_SHADOW_CUBE;
        const float matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -lightHeight, 0, 0, 0, 1};
        std::copy_n(matrix, 16, l.worldToShadow);
        MapImage map{PEL_LIGHT_SHADOW_MAP, size, 6 * size, 1, std::vector<float>(size_t(6) * size * size, 1)};
        for (uint32_t y = 0; y < size; ++y)
            for (uint32_t x = 0; x < size; ++x)  // the face that looks along -z has u along -x
                map.values[(size_t(5) * size + y) * size + x] = depthOf(-middle(x), -middle(y));
        light.maps.push_back(map);
    } else {
        l.shadowProjection = PEL_SHADOW_PERSPECTIVE;
        const float matrix[16] = {
            0.5f, 0, -0.5f, 0.5f * lightHeight,        0, 0.5f, -0.5f, 0.5f * lightHeight,
            0,    0, b / a, (1 - b * lightHeight) / a, 0, 0,    -1,    lightHeight};
        std::copy_n(matrix, 16, l.worldToShadow);
        light.mapSize = size;
        light.map.components = 1;
        for (uint32_t y = 0; y < size; ++y)
            for (uint32_t x = 0; x < size; ++x) light.map.values.push_back(depthOf(middle(x), middle(y)));
    }
    return light;
}

Frame edgeFrame(const Edge& edge) {
    Frame f;
    f.width = columns, f.height = rows;
    f.slots[PEL_SLOT_POSITION].components = f.slots[PEL_SLOT_NORMAL_SHADING].components = 3;
    for (size_t i = 0; i < f.pixels(); ++i) {
        const float x = columnX(i % columns), y = float(i / columns);
        f.slots[PEL_SLOT_POSITION].push({x, y, edge.planeAt(x, y)});
        f.slots[PEL_SLOT_NORMAL_SHADING].push(normalized(Vec3{-edge.slope[0], -edge.slope[1], 1}));
    }
    PelMaterial& m = f.materials[1] = pelMaterialDefaults();
    m.scattering = edge.scattering;
    m.specular = 0;
    std::fill_n(m.albedo, 3, 1.0f);
    f.curvatureLut = f.shadowLut = false;
    f.lights.push_back(lightOver(edge));
    for (const bool cube : {false, true}) {  // black ones: all frames take the same programs
        f.lights.push_back(lightOver({.cube = cube}, 8));
        std::fill_n(f.lights.back().params.color, 3, 0.0f);
    }
    return f;
}

// The part of the light that a point sees: of a disk or square beyond -x (H - h) / h.
double visible(const Edge& edge, double x) {
    const double below = edge.height - edge.planeAt(float(x), rowY),
                 t = std::clamp(x * (lightHeight - edge.height) / (below * edge.radius), -1.0, 1.0);
    if (edge.type == PEL_LIGHT_RECTANGLE) return (1 + t) / 2;
    return 0.5 + (t * std::sqrt(1 - t * t) + std::asin(t)) / reference::pi;
}

std::vector<float> withoutMap(Frame f) {
    f.lights[0].map = {}, f.lights[0].maps.clear();
    return shade(f);
}

std::vector<float> shadowIn(const Frame& f) {
    const auto shadowed = shade(f), lit = withoutMap(f);
    std::vector<float> share;
    for (size_t x = 0; x < columns; ++x) {
        const size_t at = 3 * (size_t(rows / 2) * columns + x);
        share.push_back(shadowed[at] / lit[at]);
    }
    return share;
}

std::vector<float> shadowOf(const Edge& edge) {
    return shadowIn(edgeFrame(edge));
}

// Pixels between 5 % and 95 % of light, as a length.
double penumbra(const std::vector<float>& share) {
    return double(std::ranges::count_if(share, [](float s) { return s > 0.05f && s < 0.95f; })) * extent /
           columns;
}

// RMS, and of single columns.
template <class Truth>
void expectRms(const std::vector<float>& share, const Truth& truth, double rms) {
    double square = 0;
    for (size_t x = 0; x < columns; ++x) {
        square += std::pow(share[x] - truth(x), 2) / columns;
        EXPECT_NEAR(share[x], truth(x), 5 * rms) << x;
    }
    EXPECT_LE(std::sqrt(square), rms);
}

void expectPartAbove(const Edge& edge) {
    expectRms(
        shadowOf(edge), [&](size_t x) { return visible(edge, columnX(x)); }, tolerance::softShadow);
}

// Of the same occluder, seen in a cube and in a plain map.
TEST(SoftShadow, OfACubeIsThatOfAMap) {
    for (const auto& [radius, height] : {std::pair{20.0f, 60.0f}, {40.0f, 60.0f}, {20.0f, 120.0f}}) {
        const auto map = shadowOf({PEL_LIGHT_SPHERE, radius, height});
        expectRms(
            shadowOf({PEL_LIGHT_SPHERE, radius, height, true}), [&](size_t x) { return map[x]; },
            tolerance::softShadowInCube);
    }
}

TEST(SoftShadow, OfAnEdgeIsThePartOfTheLightAboveIt) {
    for (const bool cube : {false, true}) {
        for (const PelLightType type : {PEL_LIGHT_SPHERE, PEL_LIGHT_RECTANGLE})
            for (const auto& [radius, height] : {std::pair{20.0f, 60.0f}, {40.0f, 60.0f}, {20.0f, 120.0f}})
                expectPartAbove({type, radius, height, cube});
        for (const auto& [x, y] : {std::pair{0.4f, 0.0f}, {-0.4f, 0.0f}, {0.0f, 0.8f}, {0.0f, -0.8f}})
            expectPartAbove({PEL_LIGHT_SPHERE, 20, 60, cube, PEL_SCATTERING_NONE, {x, y}});
        // Part of the sampled disk is beyond the plane's horizon, where the map is empty.
        expectPartAbove({PEL_LIGHT_SPHERE, 40, 60, cube, PEL_SCATTERING_NONE, {0, 2}});
        // A rectangle of 1:2 that is seen as a square.
        expectPartAbove({PEL_LIGHT_RECTANGLE, 20, 60, cube, PEL_SCATTERING_NONE, {0, 0}, 0, 0.5f});
    }
}

// Small beside the disk that is sampled.
TEST(SoftShadow, OfASquareUnderALargeLight) {
    for (const bool cube : {false, true}) {
        const Edge square{PEL_LIGHT_RECTANGLE, 100, 60, cube, PEL_SCATTERING_NONE, {0, 0}, 20};
        const double across = square.side * lightHeight / (2 * square.radius * square.height),
                     shift = square.side * lightHeight / (lightHeight - square.height);
        expectRms(
            shadowOf(square),
            [&](size_t x) {
                const double at = columnX(x);
                return 1 - across * (visible(square, at + shift) - visible(square, at));
            },
            4 * tolerance::softShadow);
    }
}

// The penumbra of the material's filter and that of the light add up as squares.
TEST(SoftShadow, OfMaterialsWithTables) {
    Edge edge{PEL_LIGHT_SPHERE, 40, 60, false, PEL_SCATTERING_PREINTEGRATED};
    const double both = penumbra(shadowOf(edge));
    edge.scattering = PEL_SCATTERING_NONE;
    const double light = penumbra(shadowOf(edge));
    edge.scattering = PEL_SCATTERING_PREINTEGRATED, edge.radius = 0;
    const double material = penumbra(shadowOf(edge));
    EXPECT_NEAR(both, std::hypot(light, material), 0.1 * both);
}

TEST(SoftShadow, WithoutASizeOrAFilterIsSharp) {
    const auto sharp = shadowOf({PEL_LIGHT_POINT, 0, 60});
    EXPECT_LT(penumbra(sharp), 3);
    const auto sphere = shadowOf({PEL_LIGHT_SPHERE, 0, 60});
    for (size_t x = 0; x < columns; ++x) EXPECT_NEAR(sphere[x], sharp[x], tolerance::shadeTerm);
    // Penumbrae of less than two texels, across or along.
    Frame flat = edgeFrame({PEL_LIGHT_SPHERE, 6, 60});
    flat.lights[0].params.worldToShadow[5] /= 4;
    for (const auto& narrow : {shadowOf({PEL_LIGHT_SPHERE, 3, 60}), shadowIn(flat)})
        for (size_t x = 0; x < columns; ++x) EXPECT_NEAR(narrow[x], sharp[x], 1e-3);
    Frame f = edgeFrame({PEL_LIGHT_SPHERE, 40, 60});
    f.lights[0].params.shadowFilterTexels = 0;
    const auto unfiltered = shade(f);
    size_t between = 0;
    for (size_t x = 0; x < columns; ++x) between += unfiltered[3 * x] > 0.1f && unfiltered[3 * x] < 0.9f;
    EXPECT_LE(between * extent / columns, 3);
}

// Occluders near the light count as a quarter of the way from it: taps would be too far apart.
TEST(SoftShadow, OfAnEdgeNearTheLightIsLimited) {
    for (const bool cube : {false, true})
        EXPECT_NEAR(penumbra(shadowOf({PEL_LIGHT_SPHERE, 5, 270, cube})),
                    penumbra(shadowOf({PEL_LIGHT_SPHERE, 5, 225, cube})), 5);
}

// A map whose rim is near the light, and the same one with lit texels around it.
TEST(SoftShadow, NothingIsBeyondAMap) {
    constexpr uint32_t inner = 128;
    const auto shadow = [](uint32_t size) {
        Frame f = edgeFrame({});
        Light& light = f.lights[0];
        for (const int across : {0, 5}) light.params.worldToShadow[across] *= 6.0f * inner / float(size);
        light.mapSize = size;
        light.map.values.clear();
        const PelLight& l = light.params;
        for (uint32_t y = 0; y < size; ++y)
            for (uint32_t x = 0; x < size; ++x) {
                const uint32_t column = x - (size - inner) / 2, row = y - (size - inner) / 2;
                const bool inside = column < inner && row < inner,
                           rim = column % (inner - 1) == 0 || row % (inner - 1) == 0;
                const float distance = !inside              ? lightHeight
                                       : rim                ? 100
                                       : column < inner / 2 ? 240
                                                            : lightHeight;
                light.map.values.push_back((1 / distance - l.shadowDepthB) / l.shadowDepthA);
            }
        return shade(f);
    };
    const auto alone = shadow(inner), padded = shadow(2 * inner);
    for (size_t i = 0; i < alone.size(); ++i) ASSERT_NEAR(alone[i], padded[i], tolerance::shadeTerm) << i;
}

// If the horizon hides the light's centre, the map does not show the occluders of the rest.
TEST(SoftShadow, OfAPointThatSeesTheRimAlone) {
    // A rectangle's light comes from beside its centre, here from above the horizon.
    for (const auto& [type, normal] : {std::pair{PEL_LIGHT_SPHERE, Vec3{0.995, 0, -0.0998}},
                                       {PEL_LIGHT_RECTANGLE, Vec3{-0.9889, 0, 0.1483}}})
        for (const bool cube : {false, true}) {
            Frame f = edgeFrame({type, type == PEL_LIGHT_SPHERE ? 100.0f : 200.0f, 60, cube});
            f.slots[PEL_SLOT_NORMAL_GEOMETRIC] = f.slots[PEL_SLOT_NORMAL_SHADING];
            for (int slot : {PEL_SLOT_NORMAL_SHADING, PEL_SLOT_NORMAL_GEOMETRIC})
                for (size_t i = 0; i < f.pixels(); ++i) f.slots[slot].set(i, normal);
            const auto lit = shade(f), all = withoutMap(f);
            for (size_t x = 0; x < columns; ++x)
                if (const float at = columnX(x); at < 0 && normal.z * lightHeight < normal.x * at) {
                    EXPECT_EQ(lit[3 * x], all[3 * x]) << at;
                    EXPECT_GT(all[3 * x], 0.01f);
                }
        }
}

// Where the surface is turned from all of the light, and its shading normal is not, as the map has it.
TEST(SoftShadow, OfNormalsThatAreTurnedToTheLight) {
    for (const bool cube : {false, true}) {
        Frame f = edgeFrame({PEL_LIGHT_SPHERE, 5, 60, cube});
        f.slots[PEL_SLOT_NORMAL_GEOMETRIC] = f.slots[PEL_SLOT_NORMAL_SHADING];
        for (size_t i = 0; i < f.pixels(); ++i) f.slots[PEL_SLOT_NORMAL_GEOMETRIC].set(i, {0.6, 0, -0.8});
        const auto share = shadowIn(f);
        for (size_t x = 0; x < columns; ++x)
            if (columnX(x) < -10) {
                EXPECT_LT(share[x], 0.01f) << columnX(x);
            }
    }
}

}  // namespace
