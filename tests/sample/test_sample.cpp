// The sample renderer against analytic surfaces: G-buffer, shadow maps of all forms, sky, and irradiance on a
// mesh that is split where the light is not linear.
#include "io/io_files.h"
#include "sample/lit_mesh.h"
#include "sample/occlusion.h"
#include "sample/shadow_map.h"
#include "sample/sky.h"
#include "sample/waves.h"

using namespace pellucid::sample;

namespace {

constexpr double radius = 50;
constexpr int rings = 256;
// How far the middle of a facet lies inside of the sphere: half an edge subtends pi / (2 rings) both ways.
const double facetSag = radius * (1 - std::pow(std::cos(std::numbers::pi / (2 * rings)), 2));

Mesh sphere() {
    return makeSphere(radius, rings, 2 * rings);
}

Mesh square(double half, double z = 0) {
    return makeRectangle(-half, half, -half, half, z);
}

GBufferOptions plain() {
    GBufferOptions options;
    options.detail.enabled = false;
    return options;
}

// Looks down from there; y is up in the picture.
Camera above(double height, double x = 0, double y = 0) {
    return {.eye = {x, y, height}, .target = {x, y, 0}, .up = {0, 1, 0}, .nearPlane = 1};
}

GBuffer drawn(const Mesh& mesh, const Camera& camera, int side, const GBufferOptions& options = plain()) {
    return renderGBuffer(Scene(mesh.view()), camera, side, side, options);
}

// The mean over all pixels.
double slope2Of(const Image& normals) {
    double sum = 0;
    for (size_t i = 0; i < normals.planeSize(); ++i) sum += std::pow(normals.plane(2)[i], -2) - 1;
    return sum / double(normals.planeSize());
}

// Checks the map's matrix, depth decoding and texels against the sphere of `radius` at the origin.
void checkMapOfSphere(const ShadowMap& map, Vec3 lightPosition, bool parallel) {
    const Matrix4 back = map.worldToUvz.inverse();
    EXPECT_NEAR(map.right.z, 0, 1e-12) << "rows lie across the z axis";
    int hit = 0;
    for (int y = 0; y < map.size; y += 7)
        for (int x = 0; x < map.size; x += 7) {
            const double z = map.depth[size_t(y) * map.size + x];
            if (z == 1) continue;
            ++hit;
            // The texel's centre and depth, taken back to the world, lie on the sphere's lit side.
            const Vec3 p = back.project({(x + 0.5) / map.size, (y + 0.5) / map.size, z});
            EXPECT_NEAR(length(p), radius, facetSag + tolerance::samplePosition);
            const Vec3 toLight = parallel ? -map.forward : lightPosition - p;
            EXPECT_GT(dot(p, toLight), -tolerance::samplePosition * radius);
            const double along = dot(p - (parallel ? Vec3{} : lightPosition), map.forward);
            EXPECT_NEAR(map.distance(z), along, tolerance::samplePosition);
        }
    EXPECT_GT(hit, 200);
}

Lighting fromAbove() {
    SurfaceLight light;
    light.color = {1, 0.5, 0.25};
    return {{light}, {}};
}

Vec3 cornerOf(const LitMesh& lit, size_t corner) {
    return {lit.positions[3 * corner], lit.positions[3 * corner + 1], lit.positions[3 * corner + 2]};
}

struct Sums {
    double area = 0, flux = 0, longest = 0;
};
Sums sumsOf(const LitMesh& lit) {
    Sums sums;
    for (size_t t = 0; t < lit.triangles.size(); t += 3) {
        const Vec3 a = cornerOf(lit, t), b = cornerOf(lit, t + 1), c = cornerOf(lit, t + 2);
        const double area = length(cross(b - a, c - a)) / 2;
        sums.area += area;
        for (int k = 0; k < 3; ++k) sums.flux += area * lit.irradiance[3 * (t + size_t(k))] / 3;
        sums.longest = std::max({sums.longest, length(b - a), length(c - b), length(a - c)});
    }
    return sums;
}

}  // namespace

TEST(SampleGBuffer, OfASphereIsWhatTheCameraSees) {
    const Camera camera{.eye = {210, -180, 90}, .target = {3, -2, 1}};
    for (const auto& size : {std::pair(160, 120), {161, 97}, {96, 128}}) {
        const int width = size.first, height = size.second;
        const GBuffer g = renderGBuffer(Scene(sphere().view()), camera, width, height, plain());
        const double aspect = double(width) / height;
        const Matrix4 toClip = camera.viewProjection(aspect), inverse = camera.inverseViewProjection(aspect);
        int covered = 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                SCOPED_TRACE(std::to_string(x) + ", " + std::to_string(y));
                const auto at = [&](double z) {
                    return inverse.project({2 * (x + 0.5) / width - 1, 1 - 2 * (y + 0.5) / height, z});
                };
                const Vec3 p = vectorAt(g.position, x, y), n = vectorAt(g.geometricNormal, x, y);
                const double depth = g.viewDepth.at(0, x, y), z = toClip.project(p).z;
                // Where the pixel's ray passes the origin: the length of the perpendicular.
                const double miss = length(cross(camera.eye, normalize(at(1) - camera.eye)));
                const bool seen = g.coverage.at(0, x, y) == 1;
                EXPECT_EQ(g.material[size_t(y) * size_t(width) + size_t(x)], seen ? 1u : 0u);
                covered += seen;
                if (!seen) {
                    EXPECT_GE(miss, radius - facetSag);
                    EXPECT_EQ(depth, backgroundDepth);
                    EXPECT_EQ(length(p) + length(vectorAt(g.shadingNormal, x, y)), 0);
                    continue;
                }
                EXPECT_LE(miss, radius);
                EXPECT_LE(length(p), radius + tolerance::samplePosition);
                EXPECT_GE(length(p), radius - facetSag - tolerance::samplePosition);
                EXPECT_LT(length(n - normalize(p)), tolerance::sampleFacetNormal);
                EXPECT_NEAR(length(n), 1, tolerance::sampleUnit);
                EXPECT_FLOAT_EQ(g.curvature.at(0, x, y), float(1 / radius));
                EXPECT_LT(dot(n, p - camera.eye), 0) << "the near side is seen";
                EXPECT_NEAR((toClip.project(p).x + 1) / 2 * width, x + 0.5, tolerance::samplePixel);
                EXPECT_NEAR((1 - toClip.project(p).y) / 2 * height, y + 0.5, tolerance::samplePixel);
                EXPECT_NEAR(depth, dot(p - camera.eye, camera.forward()), tolerance::samplePosition);
                EXPECT_TRUE(z > 0 && z < 1) << z;
                EXPECT_LT(length(at(z) - p), tolerance::sampleFromDepth);
            }
        EXPECT_GT(covered, 1000);
    }
}

TEST(SampleGBuffer, UvAndMaterialsFollowTheSurface) {
    Mesh mesh = makeRectangle(-10, 10, -10, 10, 0);
    mesh.append(makeRectangle(10, 30, -10, 10, 0));
    mesh.materials = {3, 3, 7, 7};
    const GBuffer g = drawn(mesh, above(100, 9, 1), 64);
    int seen[2] = {0, 0};
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            if (g.coverage.at(0, x, y) == 0) continue;
            const Vec3 p = vectorAt(g.position, x, y);
            const bool second = p.x > 10;
            ++seen[second];
            EXPECT_EQ(g.material[size_t(y) * 64 + x], second ? 7u : 3u);
            EXPECT_NEAR(g.uv.at(0, x, y), (p.x - (second ? 10 : -10)) / 20, tolerance::sampleUnit);
            EXPECT_NEAR(g.uv.at(1, x, y), (10 - p.y) / 20, tolerance::sampleUnit);
            EXPECT_EQ(vectorAt(g.geometricNormal, x, y).z, 1);
        }
    EXPECT_GT(seen[0], 100);
    EXPECT_GT(seen[1], 100);
}

TEST(SampleGBuffer, WithoutNormalsTheFaceNormalIsTaken) {
    Mesh mesh = sphere();
    mesh.normals.clear();
    mesh.uvs.clear();
    const GBuffer g = drawn(mesh, {.eye = {200, 0, 0}}, 40);
    EXPECT_TRUE(g.uv.data.empty());
    const Vec3 n = vectorAt(g.geometricNormal, 20, 20), p = vectorAt(g.position, 20, 20);
    EXPECT_GT(dot(n, normalize(p)), std::cos(std::numbers::pi / rings));
    EXPECT_NE(length(n - normalize(p)), 0);
}

TEST(SampleGBuffer, ClosedMeshesHaveNoCracks) {
    const Camera inside{.eye = {0, 0, 0}, .target = {40, 5, 0}, .verticalFov = 120};
    EXPECT_EQ(std::ranges::count(drawn(sphere(), inside, 360).coverage.data, 0.0f), 0);
}

TEST(SampleGBuffer, ThicknessIsThatOfTheBodyBelow) {
    GBufferOptions options = plain();
    const auto seen = [&](const Mesh& mesh) { return drawn(mesh, above(300), 41, options); };
    EXPECT_TRUE(seen(sphere()).thickness.data.empty());
    options.thickness = true;
    Mesh mesh = sphere();
    mesh.curvature.clear();
    const GBuffer ball = seen(mesh);
    const float radius = float(vectorAt(ball.position, 20, 20).z);
    EXPECT_NEAR(ball.thickness.at(0, 20, 20), 2 * radius, 0.5);
    EXPECT_EQ(ball.thickness.at(0, 0, 0), 0);  // background
    for (const float share : {0.25f, 1.0f}) {  // of a ball's curvature; a ball is no sheet
        mesh.curvature.assign(mesh.positions.size() / 3, share / radius);
        EXPECT_NEAR(seen(mesh).thickness.at(0, 20, 20),
                    share < 1 ? radius * 8 / 3 : std::sqrt(12.0f) * radius, 0.01 * radius);
    }
    // A single sheet encloses nothing.
    EXPECT_EQ(seen(square(50)).thickness.at(0, 20, 20), 0);
    // The upper face is z = 0, x from 0 on; the lower one falls by the angle.
    for (const double angle : {0.2, 0.6, 1.2}) {
        const float lower = float(-100 * std::tan(angle));
        const Mesh wedge{
            .positions = {0, -50, 0, 100, -50, 0, 0, 50, 0, 100, 50, 0, 100, -50, lower, 100, 50, lower},
            .triangles = {0, 1, 2, 2, 1, 3, 0, 2, 4, 2, 5, 4}};
        const GBuffer g = seen(wedge);
        const double x = vectorAt(g.position, 30, 20).x, below = x * std::tan(angle),
                     extent = std::hypot(100, 100, lower);
        ASSERT_GT(x, 1);
        EXPECT_NEAR(g.thickness.at(0, 30, 20), angle < 1 ? below / (2 * std::cos(angle) - 1) : extent,
                    1e-4 * extent);
    }
}

TEST(SampleDetail, ShadingDiffersFromGeometricAsAsked) {
    // A close view, so that a pixel is much smaller than a pore.
    GBufferOptions options;
    options.detail.foldSlope = 0;
    const auto seen = [&](int side) { return drawn(square(50), above(200), side, options); };
    const GBuffer g = seen(400);
    EXPECT_NEAR(std::sqrt(slope2Of(g.shadingNormal)), options.detail.poreSlope,
                tolerance::sampleRandomField * options.detail.poreSlope);
    // Pores are much finer than the diffusion radius.
    EXPECT_LT(slope2Of(g.blurredNormal), 0.01 * slope2Of(g.shadingNormal));

    options.detail.foldSlope = 0.1;
    const double wide = slope2Of(seen(100).blurredNormal);
    options.diffusionRadius = 1;
    EXPECT_GT(wide, 0);
    EXPECT_GT(slope2Of(seen(100).blurredNormal), 1.5 * wide);

    options = plain();
    const GBuffer off = seen(20);
    EXPECT_EQ(off.shadingNormal.data, off.geometricNormal.data);
    EXPECT_EQ(off.blurredNormal.data, off.geometricNormal.data);
}

// Slopes that the pixel blurs away are added to the roughness: their sum does not depend on the distance.
TEST(SampleDetail, ReliefFinerThanAPixelBecomesRoughness) {
    GBufferOptions options;
    options.detail.foldSlope = 0;
    const double slope2 = std::pow(options.detail.poreSlope, 2),
                 width2 = std::pow(options.detail.roughness, 2);
    double before = 0;
    for (const double distance : {150.0, 450.0, 900.0, 3000.0}) {
        const GBuffer g = drawn(square(2000), above(distance), 200, options);
        double added = 0;
        for (const float roughness : g.roughness.data) added += (std::pow(roughness, 2) - 1) * width2 / 40000;
        EXPECT_NEAR(slope2Of(g.shadingNormal) + added, slope2, tolerance::sampleRandomField * slope2)
            << distance;
        EXPECT_GT(added, before);
        before = added;
    }
    EXPECT_NEAR(before, slope2, 0.02 * slope2) << "all of it, from afar";
}

TEST(SampleDetail, ZonesOfSkinHaveTheirOwnColourGlossAndRelief) {
    GBufferOptions options;
    options.detail.foldSlope = options.detail.blotchAmount = 0;
    options.zones = {{{0, 0, 0}, {20, 20, 20}, {0.5, 0.25, 0.125}, 0.2, 1.5, 0.75, 0}};
    const GBuffer g = drawn(square(50), above(200), 101, options);
    const std::array<float, 3> mean = Look().albedo;
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(g.albedo.at(c, 50, 50), std::ldexp(mean[size_t(c)], -1 - c), 1e-6);
        EXPECT_NEAR(g.albedo.at(c, 2, 2), mean[size_t(c)], 1e-6);
    }
    EXPECT_EQ(g.specular.at(0, 50, 50), 1.5f);
    EXPECT_EQ(g.specular.at(0, 2, 2), 1);
    EXPECT_EQ(g.roughness.at(0, 50, 50), 0.75f);
    EXPECT_GE(g.roughness.at(0, 2, 2), 1);
    EXPECT_EQ(g.shadingNormal.at(2, 50, 50), 1) << "no pores in the zone";
    EXPECT_LT(g.shadingNormal.at(2, 2, 2), 1);
    // Half way through the edge: from 16 to 20 mm.
    const SkinZone& zone = options.zones[0];
    EXPECT_NEAR(zone.weight({0, 18, 0}), 0.5, 1e-12);
    EXPECT_NEAR(zone.colorAt({0, 18, 0})[0], 0.75, 1e-12);
}

// Lines that run up and down turn normals to the sides alone.
TEST(SampleDetail, FurrowsAreInTheirZone) {
    GBufferOptions options;
    options.detail.poreSlope = options.detail.foldSlope = 0;
    options.zones = {{.radii = {20, 20, 20}, .furrows = 0.1}};
    Camera near = above(200);
    near.verticalFov = 5;
    const GBuffer g = drawn(square(50), near, 101, options);
    double across = 0, along = 0;
    for (int i = 0; i < 101 * 101; ++i)
        across += std::pow(g.shadingNormal.plane(0)[i], 2), along += std::abs(g.shadingNormal.plane(1)[i]);
    EXPECT_NEAR(std::sqrt(across) / 101, 0.1 / std::sqrt(2), 0.03);
    EXPECT_EQ(along, 0);
}

TEST(SampleDetail, AlbedoVariesAboutItsMean) {
    const GBuffer g = drawn(sphere(), {.eye = {0, -300, 0}}, 200, {});
    for (int c = 0; c < 3; ++c) {
        std::vector<double> seen;
        for (size_t i = 0; i < g.albedo.planeSize(); ++i)
            if (g.coverage.data[i] != 0) seen.push_back(g.albedo.plane(c)[i]);
        EXPECT_NEAR(std::reduce(seen.begin(), seen.end()) / double(seen.size()), Look().albedo[size_t(c)],
                    tolerance::sampleAlbedoMean);
        const auto [low, high] = std::ranges::minmax(seen);
        EXPECT_TRUE(0 < low && low < high && high <= 1) << low << ' ' << high;
    }
    // Blood takes 0.1, 0.9, 0.8 of the channels' logarithms and pigment 0.3, 0.6, 0.9: they span a plane.
    double off = 0, pigment = 0, blood = 0;
    for (size_t i = 0; i < g.albedo.planeSize(); ++i) {
        if (g.coverage.data[i] == 0) continue;
        double log[3];
        for (int c = 0; c < 3; ++c)
            log[c] = std::log(g.albedo.plane(c)[i] / double(Look().albedo[size_t(c)]));
        off = std::max(off, std::abs(0.33 * log[0] + 0.15 * log[1] - 0.21 * log[2]));
        pigment = std::max(pigment, std::abs(8 * log[1] - 9 * log[2])),
        blood = std::max(blood, std::abs(2 * log[1] - 6 * log[0]));
    }
    EXPECT_LT(off, 1e-6);
    EXPECT_GT(std::min(pigment, blood), 0.1);
}

TEST(SampleDetail, WhitesOfEyesArePinkAtTheCorners) {
    const EyeLook eye{.radius = 12};
    const Vec3 corner = eye.radius * normalize(Vec3{0.9, 0, 0.4}),
               above{0, 0.8 * eye.radius, 0.6 * eye.radius};
    EXPECT_LT(eye.at(corner)[1], 0.8 * eye.sclera[1]);
    EXPECT_GT(eye.at(corner)[0], 0.9 * eye.sclera[0]);
    EXPECT_EQ(eye.at(above), eye.sclera);
    // Grey along the iris, over a width that varies.
    const auto beside = [&](double fromAxis, double x, double y) {
        return eye.at(eye.radius * Vec3{x * fromAxis, y * fromAxis, std::sqrt(1 - fromAxis * fromAxis)})[0];
    };
    EXPECT_LT(beside(0.505, 0, 1), 0.85 * eye.sclera[0]);
    EXPECT_EQ(beside(0.62, 0, 1), eye.sclera[0]);
    EXPECT_GT(std::abs(beside(0.53, 0, 1) - beside(0.53, 0, -1)), 0.02);
}

TEST(SampleDetail, PixelsOfAnEyeHaveItsColours) {
    Mesh ball = makeSphere(12, 40, 80);
    ball.materials.assign(ball.triangles.size() / 3, 1);
    GBufferOptions options;
    options.looks.resize(1);
    options.looks[0].kind = Look::Kind::Eye;
    options.eyes.resize(1);
    options.eyes[0].gaze = {0, 0, -1};  // away from the camera
    options.eyes[0].sclera = {0.8f, 0.5f, 0.3f};
    const GBuffer g = drawn(ball, {.eye = {0, 0, 100}}, 21, options);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(g.albedo.at(c, 10, 10), options.eyes[0].sclera[size_t(c)], 1e-6);
}

// The blurred field against a quadrature of the sharp one over the footprint.
TEST(SampleWaves, BlurIsAGaussianInTheTangentPlane) {
    const WaveField field(6, 24, 5);
    const Vec3 normal = normalize({0.3, -0.8, 0.5});
    const Vec3 along = perpendicular(normal, {1, 0, 0}), across = cross(normal, along);
    const Footprint sharp{normal}, blurred{normal, 1.1, along, 1.7};
    for (const Vec3 p : {Vec3{1, 2, 3}, Vec3{-20, 7, 0.5}, Vec3{100, -40, 31}}) {
        double value = 0, total = 0;
        Vec3 slope;
        for (int i = -60; i <= 60; ++i)
            for (int j = -60; j <= 60; ++j) {
                const double a = i / 10.0, b = j / 10.0, weight = std::exp(-0.5 * (a * a + b * b));
                const Vec3 q =
                    p + along * (a * blurred.sigma * blurred.stretch) + across * (b * blurred.sigma);
                Vec3 s;
                field.slope(q, &sharp, 1, &s);
                value += weight * field.value(q, sharp);
                slope = slope + s * weight;
                total += weight;
            }
        Vec3 result;
        field.slope(p, &blurred, 1, &result);
        EXPECT_NEAR(field.value(p, blurred), value / total, tolerance::sampleWaves);
        EXPECT_LT(length(result - slope * (1 / total)), tolerance::sampleWaves);
        EXPECT_NEAR(dot(result, normal), 0, tolerance::sampleWaves);
    }
}

TEST(SampleGBuffer, EmptyAndTinySizes) {
    const Scene scene(sphere().view()), nothing((MeshView()));
    const Camera camera{.eye = {0, -300, 0}};
    EXPECT_TRUE(renderGBuffer(scene, camera, 0, 0).position.data.empty());
    EXPECT_TRUE(renderGBuffer(scene, camera, 5, 0).material.empty());
    EXPECT_THROW(renderGBuffer(scene, camera, -1, 4), std::invalid_argument);
    const GBuffer one = renderGBuffer(scene, camera, 1, 1);
    EXPECT_NEAR(one.viewDepth.at(0, 0, 0), 300 - radius, facetSag + tolerance::samplePosition);
    EXPECT_EQ(renderGBuffer(scene, camera, 1, 33).coverage.at(0, 0, 16), 1);
    const GBuffer none = renderGBuffer(nothing, camera, 20, 3);
    EXPECT_EQ(std::ranges::count(none.coverage.data, 0.0f), 60);
}

TEST(SampleMesh, BrokenMeshesAreRefusedWithAReason) {
    const auto refused = [](const char* words, auto change) {
        Mesh mesh = makeRectangle(0, 1, 0, 1, 0);
        change(mesh);
        EXPECT_TRUE(contains(messageOf<std::invalid_argument>([&] { Scene scene(mesh.view()); }), words));
    };
    refused("triangle 1 has vertex 17, but there are only 4", [](auto& m) { m.triangles[4] = 17; });
    refused("vertex 0, whose position is not finite", [](auto& m) { m.positions[0] = NAN; });
    refused("triangles holds 5 values", [](auto& m) { m.triangles.pop_back(); });
    refused("normals holds 11 values", [](auto& m) { m.normals.pop_back(); });
}

TEST(SampleCamera, FramingFitsTheBox) {
    Bounds box;
    box.add({-40, -55, -120});
    box.add({60, 70, 120});
    for (double azimuth : {0.0, 30.0, 90.0, 180.0, 250.0})
        for (double aspect : {16.0 / 9, 1.0, 0.4}) {
            const Framing framing{.azimuth = azimuth, .elevation = 10};
            const Camera camera = frameHead(box, {}, framing, aspect);
            const Matrix4 toClip = camera.viewProjection(aspect);
            double reach = 0;
            for (int i = 0; i < 8; ++i) {
                const Vec3 c = toClip.project(box.corner(i));
                reach = std::max({reach, std::abs(c.x), std::abs(c.y)});
                EXPECT_GT(c.z, 0);
                EXPECT_LT(c.z, 1);
            }
            EXPECT_NEAR(reach, framing.fill, tolerance::sampleMatrix);
            const Matrix4 identity = toClip * camera.inverseViewProjection(aspect);
            for (int i = 0; i < 16; ++i)
                EXPECT_NEAR(identity.m[i], i % 5 == 0 ? 1 : 0, tolerance::sampleMatrix);
        }
    EXPECT_THROW(Matrix4{{}}.inverse(), std::domain_error);
}

TEST(SampleCamera, DirectionsRoundTheHead) {
    // The same head with y up is turned about x: what was at -y is at +z.
    const HeadPose pose;
    const std::tuple<HeadPose, double, double, Vec3> cases[] = {
        {pose, 0, 0, {0, -1, 0}},
        {pose, 90, 0, {1, 0, 0}},
        {pose, 200, 90, {0, 0, 1}},
        {poseWithUp('y'), 0, 0, {0, 0, 1}},
        {poseWithUp('y'), 90, 0, {1, 0, 0}},
        {poseWithUp('y'), 200, 90, {0, 1, 0}},
        {poseWithUp('z'), 30, 10, headDirection(pose, 30, 10)}};
    for (const auto& [head, azimuth, elevation, direction] : cases)
        EXPECT_NEAR(length(headDirection(head, azimuth, elevation) - direction), 0, tolerance::sampleMatrix);
    // Seen from the front, the left ear is on the right of the picture.
    const Camera camera{.eye = {0, -500, 0}};
    EXPECT_GT(camera.viewProjection(1).project(headDirection(pose, 90, 0)).x, 0);
    EXPECT_GT(camera.viewProjection(1).project({0, 0, 1}).y, 0);
}

// Under the middle of a square ceiling of half side a at height a: four times a corner's (2/pi) (1/sqrt 2)
// atan(1/sqrt 2) / 2 [Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-3].
TEST(Sample, AmbientOcclusionUnderASquareIsItsFormFactor) {
    constexpr double half = 40;
    const Mesh floor = square(2000);
    Mesh both = floor;
    both.append(square(half, half));
    const auto occlusionOf = [&](const Mesh& mesh) {
        return ambientOcclusion(Scene(mesh.view()), drawn(mesh, above(half / 2), 16));
    };
    const double covered = 4 / std::numbers::pi * std::atan(std::sqrt(0.5)) * std::sqrt(0.5);
    EXPECT_NEAR(occlusionOf(both).at(0, 8, 8), 1 - covered, 0.01);
    for (const float open : occlusionOf(floor).data) EXPECT_EQ(open, 1);
    const Scene scene(floor.view());
    EXPECT_THROW(ambientOcclusion(scene, GBuffer(), 0), std::invalid_argument);
}

// A square 5 mm before a wall: an image of a view is enlarged within each of them, and between pixels of one.
TEST(Sample, ImagesAreEnlargedWithinSurfaces) {
    Mesh both = square(100);
    both.append(makeRectangle(-9, 7, -8, 11, 5));
    const GBuffer from = drawn(both, above(60), 16), to = drawn(both, above(60), 37);
    Image image(16, 16, 2);
    std::copy_n(from.position.plane(2), image.planeSize(), image.plane(0));
    std::copy_n(from.position.plane(0), image.planeSize(), image.plane(1));
    const Image out = enlarged(image, from, to);
    const double pixel = from.position.at(0, 1, 8) - from.position.at(0, 0, 8);
    for (int y = 0; y < 37; ++y)
        for (int x = 0; x < 37; ++x) {
            EXPECT_NEAR(out.at(0, x, y), to.position.at(2, x, y), 1e-4) << x << " " << y;
            EXPECT_NEAR(out.at(1, x, y), to.position.at(0, x, y), pixel) << x << " " << y;
        }
    EXPECT_NEAR(out.at(1, 4, 18), to.position.at(0, 4, 18), 0.02 * pixel) << "far from edges";
}

// Beside a wall that a lamp along the floor lights [Howell, B-4: half of a rectangle across the element].
// With an even sky and no loss, all paths end in it but for those of more reflections than are followed.
TEST(Sample, BouncedLightBesideAWallIsItsFormFactor) {
    constexpr double high = 60, wide = 80, albedo = 0.1;
    Mesh mesh = makeRectangle(0, high, -wide, wide, 0);
    for (size_t i = 0; i < mesh.positions.size(); i += 3) {
        float* p = &mesh.positions[i];
        p[2] = float(high) - p[0], p[0] = 0;
        mesh.normals[i] = 1, mesh.normals[i + 2] = 0;
    }
    mesh.append(makeRectangle(0, 2000, -2000, 2000, 0));
    const Scene scene(mesh.view());
    const GBuffer g = drawn(mesh, above(40, 30), 16);
    Bounces b;
    b.lamps.resize(1), b.lamps[0].toLight = {1, 0, 0}, b.lamps[0].color = {1, 2, 4};
    b.sky.scale = 0, b.albedo = {albedo, albedo, albedo}, b.rays = 64;
    const Image lit = bouncedLight(scene, g, b);
    for (int x = 0; x < 16; x += 5) {
        const double d = g.position.at(0, x, 8), far = std::hypot(d, high),
                     seen = (std::atan(wide / d) - d / far * std::atan(wide / far)) / std::numbers::pi;
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(lit.at(c, x, 8), albedo * seen * (1 << c), 0.01 * (1 << c) * albedo) << x;
    }
    b.lamps.clear(), b.albedo = {1, 1, 0.5};
    b.sky = {.zenith = {1, 1, 1}, .horizon = {1, 1, 1}, .floor = {1, 1, 1}, .lampRadiance = {0, 0, 0}};
    const Image even = bouncedLight(scene, g, b), open = ambientOcclusion(scene, g);
    for (int x = 0; x < 16; x += 5) {
        EXPECT_NEAR(even.at(0, x, 8) + open.at(0, x, 8), 0.97, 0.035) << x;
        EXPECT_LT(even.at(2, x, 8), 0.6 * even.at(0, x, 8));
    }
    const Scene hair(Curves{{10, -50, 10, 8, 10, 50, 10, 8}, {0}});
    b.hair = &hair;
    EXPECT_LT(bouncedLight(scene, g, b).at(0, 8, 8), 0.95 * even.at(0, 8, 8));
    b.rays = 0;
    EXPECT_THROW(bouncedLight(scene, g, b), std::invalid_argument);
}

// A roof over x < 0, or a hair along y, above a floor: their edges hide the parts of the disk beyond lines.
TEST(Sample, SoftShadowIsTheHiddenPartOfADisk) {
    constexpr double height = 30, hairHeight = 20, hairRadius = 0.8, radius = 0.06;
    const Mesh floor = square(2000);
    Mesh mesh = floor;
    mesh.append(makeRectangle(-2000, 0, -2000, 2000, height));
    const Scene scene(mesh.view()), open(floor.view());
    const auto hairAt = [&](float z) { return Curves{{0, -50, z, hairRadius, 0, 50, z, hairRadius}, {0}}; };
    const Scene hair(hairAt(hairHeight)), far(hairAt(height));
    const GBuffer g = drawn(mesh, above(height / 2), 40);
    const Image lit = softShadow(scene, g, {0, 0, 1}, radius, 8),
                beside = softShadow(open, g, {0, 0, 1}, radius, 8, &hair);
    const auto part = [](double u) {
        u = std::clamp(u, -1.0, 1.0);
        return 0.5 + (u * std::sqrt(1 - u * u) + std::asin(u)) / std::numbers::pi;
    };
    for (int x = 0; x < 40; ++x) {
        const double at = g.position.at(0, x, 20);
        EXPECT_NEAR(lit.at(0, x, 20), part(at / (height * radius)), 0.06) << x;  // 128 samples, four pixels
        const double hidden =
            part((at + hairRadius) / (hairHeight * radius)) - part((at - hairRadius) / (hairHeight * radius));
        EXPECT_NEAR(beside.at(0, x, 20), 1 - hidden, 0.06) << x;
    }
    EXPECT_LT(ambientOcclusion(open, g, 8, &hair).at(0, 20, 20), 0.985);
    for (const float all : softShadow(scene, g, {0, 0, -1}, radius, 8).data)
        EXPECT_EQ(all, 1) << "nothing of it is above the horizon";
    EXPECT_EQ(std::ranges::min(softShadow(open, g, {0, 0, 1}, radius, 8, &far).data), 1)
        << "a hair that is too far away";
    EXPECT_THROW(softShadow(scene, g, {0, 0, 1}, radius, 0), std::invalid_argument);
}

TEST(SampleShadowMap, OfASphere) {
    const Scene scene(sphere().view());
    const Vec3 toLight = normalize({0.4, -0.5, 0.77});
    const ShadowMap parallel = renderShadowMap(scene, DirectionalLight{toLight}, 512);
    EXPECT_NEAR(length(parallel.forward + toLight), 0, tolerance::sampleMatrix);
    checkMapOfSphere(parallel, {}, true);
    const Vec3 position{150, -100, 120};
    const ShadowMap map = renderShadowMap(scene, SpotLight{position, normalize(-position), 25}, 512);
    checkMapOfSphere(map, position, false);
    // The cone's edge meets the middle of the map's sides.
    const double tangent = std::tan(25 * std::numbers::pi / 180);
    EXPECT_NEAR(map.worldToUvz.project(position + map.forward + map.right * tangent).x, 1,
                tolerance::sampleMatrix);
    EXPECT_NEAR(map.worldToUvz.project(position + map.forward - map.down * tangent).y, 0,
                tolerance::sampleMatrix);
}

TEST(SampleShadowMap, EmptyAndTiny) {
    const Scene nothing((MeshView()));
    const Scene scene(makeSphere(radius, 8, 16).view());
    EXPECT_EQ(renderShadowMap(nothing, DirectionalLight{}, 4).depth, std::vector<float>(16, 1.0f));
    const Vec3 seen = renderShadowMap(nothing, DirectionalLight{}, 4, 0).worldToUvz.project({1, 2, 3});
    EXPECT_TRUE(std::isfinite(seen.x + seen.y + seen.z));
    EXPECT_EQ(renderShadowMap(nothing, SpotLight{}, 4).depth, std::vector<float>(16, 1.0f));
    EXPECT_TRUE(renderShadowMap(scene, DirectionalLight{}, 0).depth.empty());
    EXPECT_LT(renderShadowMap(scene, DirectionalLight{}, 1).depth[0], 0.1f);
    EXPECT_THROW(renderShadowMap(scene, DirectionalLight{}, -1), std::invalid_argument);
}

// Where directions are in OpenEXR's equirectangular images, and what a rectangle sends to a point: 4 asin(a b
// / sqrt((1 + a^2)(1 + b^2))) for half sides a and b at a distance of 1.
TEST(Sky, AnEquirectangularImageHasEachDirectionAtItsPlace) {
    constexpr int height = 256;
    constexpr double a = 0.3, b = 0.6, pi = std::numbers::pi;
    for (const char axis : {'y', 'z'}) {
        const HeadPose pose = poseWithUp(axis);
        Sky sky;
        sky.up = pose.up;
        sky.lamp = headDirection(pose, 80, 25);
        const std::vector<float> open = equirectangular(sky, pose.front, height);
        ASSERT_EQ(open.size(), 6u * height * height);
        for (const double azimuth : {-170.0, -35.0, 0.0, 90.0})
            for (const double elevation : {-60.0, 5.0, 80.0}) {
                // The left ear, azimuth 90, is left of the middle.
                const auto x = size_t(height * (1 - azimuth / 180)),
                           y = size_t(height * (0.5 - elevation / 180));
                const Rgb right = sky.radiance(headDirection(pose, azimuth, elevation));
                for (size_t c = 0; c < 3; ++c)
                    EXPECT_NEAR(open[3 * (2 * height * y + x) + c], right[c], 0.04) << azimuth << elevation;
            }
        sky.panels.push_back({headDirection(pose, -35, 30), a, b, {2, 4, 8}});
        const std::vector<float> lit = equirectangular(sky, pose.front, height);
        double sum[3] = {};
        for (size_t i = 0; i < lit.size(); ++i)
            sum[i % 3] += (lit[i] - open[i]) *
                          std::cos(pi * (0.5 - (double(i / 3 / (2 * height)) + 0.5) / height)) * pi / height *
                          pi / height;
        const double solidAngle = 4 * std::asin(a * b / std::sqrt((1 + a * a) * (1 + b * b)));
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], (2 << c) * solidAngle, 0.02 * (2 << c));
    }
}

// More triangles than are split at a time.
TEST(LitMesh, ALargeSphereTakesTheFluxOfItsDisk) {
    const Scene scene(makeSphere(radius, 100, 200).view());
    std::vector<double> told;
    const LitMesh lit =
        lightMesh(scene, fromAbove(), {INFINITY, 0, 1}, [&](double part) { told.push_back(part); });
    const double pi = std::numbers::pi;
    const Sums sums = sumsOf(lit);
    EXPECT_EQ(lit.triangles.size(), scene.mesh().triangles.size()) << "nothing to split";
    EXPECT_NEAR(sums.area / (4 * pi * radius * radius), 1, tolerance::litSphere);
    EXPECT_NEAR(sums.flux / (pi * radius * radius), 1, tolerance::litSphere);
    ASSERT_GE(told.size(), 2u);
    EXPECT_EQ(told[0], 0);
    for (size_t i = 1; i < told.size(); ++i) EXPECT_GT(told[i], told[i - 1]);
    EXPECT_LT(told.back(), 1);
    for (size_t corner = 0; corner < lit.triangles.size(); ++corner) {
        EXPECT_EQ(lit.triangles[corner], corner);
        const double expected = std::max(0.0, cornerOf(lit, corner).z / radius);
        const float* E = &lit.irradiance[3 * corner];
        ASSERT_NEAR(E[0], expected, tolerance::sampleFacetNormal) << corner;
        ASSERT_NEAR(E[1], expected / 2, tolerance::sampleFacetNormal);
        ASSERT_NEAR(E[2], expected / 4, tolerance::sampleFacetNormal);
    }
}

// Along the terminator a coarse sphere is split until light is linear, and no further than `finest`.
TEST(LitMesh, SplitsWhereLightIsNotLinear) {
    const Scene scene(makeSphere(radius, 16, 32).view());
    const auto lit = [&](double deviation, double finest, double coarsest = INFINITY) {
        return lightMesh(scene, fromAbove(), {coarsest, finest, deviation});
    };
    size_t before = scene.mesh().triangles.size();
    for (double deviation : {0.004, 0.002, 0.001}) {
        const LitMesh mesh = lit(deviation, 0.01);
        EXPECT_GT(mesh.triangles.size(), before) << deviation;
        before = mesh.triangles.size();
        EXPECT_NEAR(sumsOf(mesh).area, sumsOf(lit(1, 0)).area, tolerance::litSphere * radius * radius);
    }
    // Triangles that meet in a point agree on its light.
    const LitMesh mesh = lit(0.002, 0.01);
    std::map<std::array<long, 3>, float> lightAt;
    for (size_t corner = 0; corner < mesh.triangles.size(); ++corner) {
        const Vec3 p = cornerOf(mesh, corner);
        const auto [known, isNew] =
            lightAt.try_emplace({std::lround(1e4 * p.x), std::lround(1e4 * p.y), std::lround(1e4 * p.z)},
                                mesh.irradiance[3 * corner]);
        ASSERT_NEAR(known->second, mesh.irradiance[3 * corner], tolerance::unitRoundTrip);
    }
    EXPECT_EQ(lit(0, 1000).triangles.size(), scene.mesh().triangles.size()) << "all edges are short enough";
    const double coarsest = 2;
    const Sums split = sumsOf(lit(1, 0, coarsest));
    EXPECT_LE(split.longest, coarsest);
    EXPECT_GT(split.longest, coarsest / 4) << "not much further than asked for";
}

TEST(LitMesh, LightsAndLimits) {
    Mesh two = makeSphere(radius, 8, 16);
    two.materials.assign(two.triangles.size() / 3, 1);
    // Shifted slightly: Embree may miss a triangle if a ray hits its corner exactly.
    Mesh other = makeSphere(radius, 8, 16, {0.3, 0.7, -300});
    other.materials.assign(other.triangles.size() / 3, 2);
    two.append(other);
    const Scene scene(two.view());
    LitMeshOptions options{INFINITY, INFINITY, 1};
    options.material = 2;
    const LitMesh behind = lightMesh(scene, fromAbove(), options);
    EXPECT_EQ(behind.triangles.size(), other.triangles.size()) << "of its own material only";
    for (size_t corner = 0; corner < behind.triangles.size(); ++corner)
        if (std::hypot(behind.positions[3 * corner], behind.positions[3 * corner + 1]) < 0.9 * radius) {
            ASSERT_EQ(behind.irradiance[3 * corner], 0) << "in the first one's shadow";
        }
    options.mostTriangles = 3;
    EXPECT_THROW(lightMesh(scene, fromAbove(), options), std::length_error);
    // Refused by the area alone, before any light; and where shadows need too many; `progress` may end it.
    int calls = 0;
    const auto count = [&](double) { ++calls; };
    EXPECT_THROW(lightMesh(scene, fromAbove(), {.coarsest = 1e-3 * radius}, count), std::length_error);
    EXPECT_EQ(calls, 0);
    EXPECT_THROW(lightMesh(scene, fromAbove(), {.deviation = 1e-9, .mostTriangles = 5000}, count),
                 std::length_error);
    EXPECT_GT(calls, 2);
    EXPECT_THROW(
        lightMesh(scene, fromAbove(), {.deviation = 1e-9}, [](double) { throw std::domain_error(""); }),
        std::domain_error);

    // A point light at distance 100 from the first sphere's pole, without and with a range; a spot's cone.
    SurfaceLight light;
    light.type = SurfaceLight::Type::Point;
    light.position = {0, 0, radius + 100};
    light.color = {1e4, 1e4, 1e4};
    uint32_t pole = 0, triangle = 0;
    for (uint32_t t = 0; t < scene.mesh().triangles.size() / 3; ++t)
        for (uint32_t k = 0; k < 3; ++k)
            if (scene.mesh().positions[3 * scene.mesh().triangles[3 * t + k] + 2] > radius - 1e-3)
                triangle = t, pole = k;
    std::array<double, 3> weights{};
    weights[pole] = 1;
    const SurfacePoint point{triangle, weights};
    const auto atPole = [&](const SurfaceLight& l) { return irradianceAt(scene, {{l}, {}}, {&point, 1})[0]; };
    EXPECT_NEAR(atPole(light), 1, tolerance::sampleFacetNormal);
    light.range = 99;
    EXPECT_EQ(atPole(light), 0);
    light.range = 101;
    EXPECT_NEAR(atPole(light), 1, tolerance::sampleFacetNormal);
    light.type = SurfaceLight::Type::SpotLight;
    const double inner = light.spotCosInner, outer = light.spotCosOuter;
    for (double cosine : {inner, 0.75 * inner + 0.25 * outer, (inner + outer) / 2, outer}) {
        light.spotDirection = {std::sqrt(1 - cosine * cosine), 0, -cosine};
        const double t = (cosine - outer) / (inner - outer);
        EXPECT_NEAR(atPole(light), t * t * (3 - 2 * t), tolerance::sampleFacetNormal) << cosine;
    }
}
