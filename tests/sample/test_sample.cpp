// The sample renderer's G-buffer against surfaces whose every pixel is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <stdexcept>

#include "sample/gbuffer.h"
#include "sample/occlusion.h"
#include "sample/waves.h"
#include "tolerances.h"

namespace sample = pellucid::sample;
using sample::Vec3;

namespace {

constexpr double sphereRadius = 50;
constexpr int rings = 256;
// How far the middle of a facet lies inside of the sphere: half an edge subtends pi / (2 rings) both ways.
const double facetSag = sphereRadius * (1 - std::pow(std::cos(std::numbers::pi / (2 * rings)), 2));

sample::Mesh sphere() {
    return sample::makeSphere(sphereRadius, rings, 2 * rings);
}

Vec3 vectorAt(const sample::Image& image, int x, int y) {
    return {image.at(0, x, y), image.at(1, x, y), image.at(2, x, y)};
}

sample::GBufferOptions plain() {
    sample::GBufferOptions options;
    options.detail.enabled = false;
    return options;
}

bool sameBits(const sample::GBuffer& a, const sample::GBuffer& b) {
    using sample::GBuffer;
    for (auto image : {&GBuffer::position, &GBuffer::geometricNormal, &GBuffer::shadingNormal,
                       &GBuffer::blurredNormal, &GBuffer::curvature, &GBuffer::albedo, &GBuffer::uv,
                       &GBuffer::viewDepth, &GBuffer::deviceDepth, &GBuffer::coverage})
        if ((a.*image).data != (b.*image).data) return false;
    return a.material == b.material;
}

}  // namespace

TEST(SampleGBuffer, OfASphereIsWhatTheCameraSees) {
    const sample::Camera camera{.eye = {210, -180, 90}, .target = {3, -2, 1}};
    for (auto [width, height] : {std::pair(160, 120), {161, 97}, {96, 128}}) {
        const sample::GBuffer g =
            sample::renderGBuffer(sample::Scene(sphere().view()), camera, width, height, plain());
        const double aspect = double(width) / height;
        const sample::Matrix4 toClip = camera.viewProjection(aspect),
                              inverse = camera.inverseViewProjection(aspect);
        int covered = 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                SCOPED_TRACE(std::to_string(x) + ", " + std::to_string(y));
                const auto at = [&](double z) {
                    return inverse.project({2 * (x + 0.5) / width - 1, 1 - 2 * (y + 0.5) / height, z});
                };
                const Vec3 p = vectorAt(g.position, x, y), n = vectorAt(g.geometricNormal, x, y);
                const double depth = g.viewDepth.at(0, x, y), z = g.deviceDepth.at(0, x, y);
                // Where the pixel's ray passes the origin: the length of the perpendicular.
                const double miss = length(cross(camera.eye, normalize(at(1) - camera.eye)));
                const bool seen = g.coverage.at(0, x, y) == 1;
                EXPECT_EQ(g.material[size_t(y) * size_t(width) + size_t(x)], seen ? 1u : 0u);
                covered += seen;
                if (!seen) {
                    EXPECT_GE(miss, sphereRadius - facetSag);
                    EXPECT_EQ(depth, sample::backgroundDepth);
                    EXPECT_EQ(z, 1);
                    EXPECT_EQ(length(p) + length(vectorAt(g.shadingNormal, x, y)), 0);
                    continue;
                }
                EXPECT_LE(miss, sphereRadius);
                EXPECT_LE(length(p), sphereRadius + tolerance::samplePosition);
                EXPECT_GE(length(p), sphereRadius - facetSag - tolerance::samplePosition);
                EXPECT_LT(length(n - normalize(p)), tolerance::sampleFacetNormal);
                EXPECT_NEAR(length(n), 1, tolerance::sampleUnit);
                EXPECT_FLOAT_EQ(g.curvature.at(0, x, y), float(1 / sphereRadius));
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
    sample::Mesh mesh = sample::makeRectangle(-10, 10, -10, 10, 0);
    mesh.append(sample::makeRectangle(10, 30, -10, 10, 0));
    mesh.materials = {3, 3, 7, 7};
    const sample::Camera camera{.eye = {9, 1, 100}, .target = {9, 1, 0}, .up = {0, 1, 0}, .nearPlane = 10};
    const sample::GBuffer g = sample::renderGBuffer(sample::Scene(mesh.view()), camera, 64, 48, plain());
    int seen[2] = {0, 0};
    for (int y = 0; y < 48; ++y)
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
    sample::Mesh mesh = sphere();
    mesh.normals.clear();
    mesh.uvs.clear();
    const sample::GBuffer g =
        sample::renderGBuffer(sample::Scene(mesh.view()), {.eye = {200, 0, 0}}, 40, 40, plain());
    EXPECT_TRUE(g.uv.data.empty());
    const Vec3 n = vectorAt(g.geometricNormal, 20, 20), p = vectorAt(g.position, 20, 20);
    EXPECT_GT(dot(n, normalize(p)), std::cos(std::numbers::pi / rings));
    EXPECT_NE(length(n - normalize(p)), 0);
}

TEST(SampleGBuffer, ClosedMeshesHaveNoCracks) {
    for (const sample::Mesh& mesh : {sphere(), sample::makeTorus(40, 15, 37, 91)}) {
        const bool torus = mesh.positions.size() != sphere().positions.size();
        const sample::Camera inside{
            .eye = {torus ? 40.0 : 0.0, 0, 0}, .target = {40, 5, 0}, .verticalFov = 120};
        const sample::GBuffer g =
            sample::renderGBuffer(sample::Scene(mesh.view()), inside, 512, 256, plain());
        EXPECT_EQ(std::count(g.coverage.data.begin(), g.coverage.data.end(), 0.0f), 0);
    }
}

TEST(SampleDetail, ShadingDiffersFromGeometricAsAsked) {
    // A close view, so that a pixel is much smaller than a pore.
    const sample::Mesh mesh = sample::makeRectangle(-50, 50, -50, 50, 0);
    const sample::Camera camera{.eye = {0, 0, 200}, .up = {0, 1, 0}, .nearPlane = 10};
    sample::GBufferOptions options;
    options.detail.foldSlope = 0;
    const auto meanSquareSlope = [&](const sample::Image& normals) {
        double sum = 0;
        for (size_t i = 0; i < normals.planeSize(); ++i) {
            const double z = normals.plane(2)[i];
            sum += (1 - z * z) / (z * z);
        }
        return sum / double(normals.planeSize());
    };
    const sample::Scene scene(mesh.view());
    const sample::GBuffer g = sample::renderGBuffer(scene, camera, 400, 400, options);
    EXPECT_NEAR(std::sqrt(meanSquareSlope(g.shadingNormal)), options.detail.poreSlope,
                tolerance::sampleRandomField * options.detail.poreSlope);
    // Pores are much finer than the diffusion radius.
    EXPECT_LT(meanSquareSlope(g.blurredNormal), 0.01 * meanSquareSlope(g.shadingNormal));

    options.detail.foldSlope = 0.1;
    const double wide =
        meanSquareSlope(sample::renderGBuffer(scene, camera, 100, 100, options).blurredNormal);
    options.diffusionRadius = 1;
    const double narrow =
        meanSquareSlope(sample::renderGBuffer(scene, camera, 100, 100, options).blurredNormal);
    EXPECT_GT(wide, 0);
    EXPECT_GT(narrow, 1.5 * wide);

    const sample::GBuffer off = sample::renderGBuffer(scene, camera, 20, 20, plain());
    EXPECT_EQ(off.shadingNormal.data, off.geometricNormal.data);
    EXPECT_EQ(off.blurredNormal.data, off.geometricNormal.data);
}

TEST(SampleDetail, AlbedoVariesAboutItsMean) {
    const sample::Scene scene(sphere().view());
    sample::GBufferOptions options;
    const sample::GBuffer g = sample::renderGBuffer(scene, {.eye = {0, -300, 0}}, 200, 200, options);
    for (int c = 0; c < 3; ++c) {
        double sum = 0, count = 0, low = 1, high = 0;
        for (size_t i = 0; i < g.albedo.planeSize(); ++i) {
            if (g.coverage.data[i] == 0) continue;
            const double a = g.albedo.plane(c)[i];
            sum += a;
            ++count;
            low = std::min(low, a);
            high = std::max(high, a);
        }
        EXPECT_NEAR(sum / count, sample::Look().albedo[size_t(c)], tolerance::sampleAlbedoMean);
        EXPECT_LT(low, high);
        EXPECT_GT(low, 0);
        EXPECT_LE(high, 1);
    }
}

// Of an adult's eye: pupil, iris with its limbus, sclera, by the distance from the axis on the ball.
TEST(SampleDetail, PaintedEyesHaveTheSizesOfAnAdults) {
    const sample::EyeLook eye;
    const auto red = [&](double mm) {
        const double angle = mm / eye.radius;
        return eye.at(eye.radius * Vec3{std::sin(angle), 0, std::cos(angle)})[0];
    };
    for (double mm : {0.0, 1.8}) EXPECT_NEAR(red(mm), 0.01, 1e-9) << mm;
    for (double mm : {2.3, 3.0, 4.4}) EXPECT_NEAR(red(mm), 0.17, 0.25 * 0.17) << mm;
    EXPECT_LT(red(5.7), 0.5 * red(4.4)) << "the limbus";
    for (double mm : {6.8, 9.0, 30.0}) EXPECT_NEAR(red(mm), 0.72, 1e-9) << mm;
}

TEST(SampleWaves, MeanSquaresAreOneOverManySurfaces) {
    const sample::WaveField field(6, 100, 5);
    double value = 0, slope = 0;
    const int count = 20000;
    for (int i = 0; i < count; ++i) {
        // Points and normals on two spirals that share no period.
        const double z = 2 * (i + 0.5) / count - 1, r = std::sqrt(1 - z * z), t = 2.399963 * i;
        const sample::Footprint sharp{{r * std::cos(t), r * std::sin(t), z}};
        const Vec3 p{37.1 * std::cos(1.7 * i), 0.613 * i, 29.3 * std::sin(0.9 * i)};
        Vec3 s;
        field.slope(p, &sharp, 1, &s);
        value += std::pow(field.value(p, sharp), 2) / count;
        slope += dot(s, s) / count;
    }
    EXPECT_NEAR(value, 1, tolerance::sampleMeanSquare);
    EXPECT_NEAR(slope, 1, tolerance::sampleMeanSquare);
}

// The blurred field against a quadrature of the sharp one over the footprint.
TEST(SampleWaves, BlurIsAGaussianInTheTangentPlane) {
    const sample::WaveField field(6, 24, 5);
    const Vec3 normal = sample::normalize({0.3, -0.8, 0.5});
    const Vec3 along = sample::perpendicular(normal, {1, 0, 0}), across = cross(normal, along);
    const sample::Footprint sharp{normal}, blurred{normal, 1.1, along, 1.7};
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
    const sample::Scene scene(sphere().view()), nothing((sample::MeshView()));
    const sample::Camera camera{.eye = {0, -300, 0}};
    EXPECT_TRUE(sample::renderGBuffer(scene, camera, 0, 0).position.data.empty());
    EXPECT_TRUE(sample::renderGBuffer(scene, camera, 5, 0).material.empty());
    EXPECT_THROW(sample::renderGBuffer(scene, camera, -1, 4), std::invalid_argument);
    const sample::GBuffer one = sample::renderGBuffer(scene, camera, 1, 1);
    EXPECT_NEAR(one.viewDepth.at(0, 0, 0), 300 - sphereRadius, facetSag + tolerance::samplePosition);
    EXPECT_EQ(sample::renderGBuffer(scene, camera, 1, 33).coverage.at(0, 0, 16), 1);
    const sample::GBuffer none = sample::renderGBuffer(nothing, camera, 20, 3);
    EXPECT_EQ(std::count(none.coverage.data.begin(), none.coverage.data.end(), 0.0f), 60);
}

TEST(SampleGBuffer, TwoRunsAreTheSameToTheBit) {
    const sample::Mesh mesh = sample::makeTorus(40, 15, 37, 91);
    const sample::Camera camera{.eye = {60, -200, 80}};
    const auto run = [&] { return sample::renderGBuffer(sample::Scene(mesh.view()), camera, 120, 90); };
    const sample::GBuffer first = run();
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(sameBits(first, run()));
    EXPECT_GT(std::count(first.coverage.data.begin(), first.coverage.data.end(), 1.0f), 500);
}

TEST(SampleMesh, BrokenMeshesAreRefusedWithAReason) {
    const auto refused = [](const char* words, auto change) {
        sample::Mesh mesh = sample::makeRectangle(0, 1, 0, 1, 0);
        change(mesh);
        try {
            sample::Scene scene(mesh.view());
            ADD_FAILURE() << "no error: " << words;
        } catch (const std::invalid_argument& error) {
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        }
    };
    refused("triangle 1 has vertex 17, but there are only 4", [](auto& m) { m.triangles[4] = 17; });
    refused("vertex 0, whose position is not finite", [](auto& m) { m.positions[0] = NAN; });
    refused("triangles holds 5 values", [](auto& m) { m.triangles.pop_back(); });
    refused("normals holds 11 values", [](auto& m) { m.normals.pop_back(); });
}

TEST(SampleCamera, FramingFitsTheBox) {
    sample::Bounds box;
    box.add({-40, -55, -120});
    box.add({60, 70, 120});
    for (double azimuth : {0.0, 30.0, 90.0, 180.0, 250.0})
        for (double aspect : {16.0 / 9, 1.0, 0.4}) {
            const sample::Framing framing{.azimuth = azimuth, .elevation = 10};
            const sample::Camera camera = sample::frameHead(box, {}, framing, aspect);
            const sample::Matrix4 toClip = camera.viewProjection(aspect);
            double reach = 0;
            for (int i = 0; i < 8; ++i) {
                const Vec3 c = toClip.project(box.corner(i));
                reach = std::max({reach, std::abs(c.x), std::abs(c.y)});
                EXPECT_GT(c.z, 0);
                EXPECT_LT(c.z, 1);
            }
            EXPECT_NEAR(reach, framing.fill, tolerance::sampleMatrix);
            const sample::Matrix4 identity = toClip * camera.inverseViewProjection(aspect);
            for (int i = 0; i < 16; ++i)
                EXPECT_NEAR(identity.m[i], i % 5 == 0 ? 1 : 0, tolerance::sampleMatrix);
        }
    EXPECT_THROW(sample::Matrix4{{}}.inverse(), std::domain_error);
}

TEST(SampleCamera, DirectionsRoundTheHead) {
    // The same head with y up is turned about x: what was at -y is at +z.
    const sample::HeadPose pose;
    const std::tuple<sample::HeadPose, double, double, Vec3> cases[] = {
        {pose, 0, 0, {0, -1, 0}},
        {pose, 90, 0, {1, 0, 0}},
        {pose, 200, 90, {0, 0, 1}},
        {sample::poseWithUp('y'), 0, 0, {0, 0, 1}},
        {sample::poseWithUp('y'), 90, 0, {1, 0, 0}},
        {sample::poseWithUp('y'), 200, 90, {0, 1, 0}},
        {sample::poseWithUp('z'), 30, 10, sample::headDirection(pose, 30, 10)}};
    for (const auto& [head, azimuth, elevation, direction] : cases)
        EXPECT_NEAR(length(sample::headDirection(head, azimuth, elevation) - direction), 0,
                    tolerance::sampleMatrix);
    // Seen from the front, the left ear is on the right of the picture.
    const sample::Camera camera{.eye = {0, -500, 0}};
    EXPECT_GT(camera.viewProjection(1).project(sample::headDirection(pose, 90, 0)).x, 0);
    EXPECT_GT(camera.viewProjection(1).project({0, 0, 1}).y, 0);
    EXPECT_GT(dot(sample::keyLightDirection(pose, sample::KeyLight::Front), pose.front), 0.5);
    EXPECT_LT(dot(sample::keyLightDirection(pose, sample::KeyLight::Back), pose.front), -0.5);
}

// Under the middle of a square ceiling of half side a at height a: four times the form factor of a corner,
// (2/pi) (1/sqrt 2) atan(1/sqrt 2) / 2 [Howell, A Catalog of Radiation Heat Transfer Configuration Factors,
// B-3].
TEST(Sample, AmbientOcclusionUnderASquareIsItsFormFactor) {
    constexpr double half = 40;
    const sample::Mesh floor = sample::makeRectangle(-2000, 2000, -2000, 2000, 0);
    sample::Mesh both = floor;
    both.append(sample::makeRectangle(-half, half, -half, half, half));
    const sample::Camera camera{
        .eye = {0, 0, half / 2}, .target = {0, 0, 0}, .up = {0, 1, 0}, .nearPlane = 1};
    const auto occlusionOf = [&](const sample::Mesh& mesh) {
        const sample::Scene scene(mesh.view());
        return sample::ambientOcclusion(scene, sample::renderGBuffer(scene, camera, 16, 16, plain()));
    };
    const double covered = 4 / std::numbers::pi * std::atan(std::sqrt(0.5)) * std::sqrt(0.5);
    EXPECT_NEAR(occlusionOf(both).at(0, 8, 8), 1 - covered, 0.01);
    for (const float open : occlusionOf(floor).data) EXPECT_EQ(open, 1);
    const sample::Scene scene(floor.view());
    EXPECT_THROW(sample::ambientOcclusion(scene, sample::GBuffer(), 0), std::invalid_argument);
}
