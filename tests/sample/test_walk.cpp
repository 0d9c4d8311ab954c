// Random walks through the volume of a mesh, against the naive walk of the oracle in double precision, and
// against walks of another program (PELLUCID_RULER_DIR).
#include <omp.h>
#include "test.h"

#include "io/image/image_file.h"
#include "io/mesh/mesh_parts.h"
#include "io/shortest.h"
#include "npy.h"
#include "reference/random_walk.h"
#include "reference/skin_walk.h"
#include "sample/random_walk.h"

using namespace pellucid::sample;

namespace {

constexpr std::array<double, 3> white{1, 1, 1};
// Of facets against a ball, and of tabulated walks with noise of their own: 0.5 to 1.5e-3 measured.
constexpr double ballError = 2.5e-3;
// Of a head, whose shadows have edges that the two programs place a little differently.
constexpr double headError = 4e-3, headBias = 5e-4;
// 0.0024 of the fit of the medium, and three standard errors of 38,000 walks.
constexpr double reflectanceError = 6e-3;

Lighting zenith() {
    return {{SurfaceLight{}}, {}};
}
Lighting fromEverywhere() {
    return {{}, [](Vec3) { return white; }};
}

Medium medium(double meanFreePath, double albedo = 0.99055) {
    return {{meanFreePath, meanFreePath, meanFreePath}, {albedo, albedo, albedo}};
}

// Points of the triangles' middles, on every `stride`-th triangle.
std::vector<SurfacePoint> middles(const Scene& scene, size_t stride) {
    std::vector<SurfacePoint> points;
    for (size_t t = 0; t < scene.mesh().triangles.size() / 3; t += stride)
        points.push_back({uint32_t(t), {1 / 3., 1 / 3., 1 / 3.}});
    return points;
}

// A ball of radius 1 as a body, and points on it.
struct Ball {
    explicit Ball(int rings, size_t stride)
        : scene(makeSphere(1, rings, 2 * rings).view()), points(middles(scene, stride)) {}
    const Scene scene;
    const WalkBody body{scene, 0};
    const std::vector<SurfacePoint> points;
};

// Squared differences to `expected` without noise (the mean product of both halves'), and its standard error.
struct Error {
    double mean = 0, uncertainty = 0;
};
template <class Expected>
Error errorOf(const WalkedLight& light, const Expected& expected) {
    double sum = 0, square = 0;
    const size_t count = light.first.size();
    for (size_t i = 0; i < count; ++i) {
        const double product = (light.first[i] - expected(i)) * (light.second[i] - expected(i));
        sum += product, square += product * product;
    }
    return {sum / double(count), std::sqrt(square) / double(count)};
}

}  // namespace

// Small and large against the mean free path.
TEST(WalkLight, BallEqualsTheOraclesWalk) {
    constexpr int bins = 20;
    const Ball ball(96, sized(160, 1600));
    for (double radius : {4.0, 15.0}) {  // mean free paths
        const WalkedLight light =
            walkLight(ball.body, zenith(), ball.points, medium(1 / radius), {uint32_t(sized(64, 8))});
        const reference::WalkResult expected =
            reference::walkBall({1, 0.99055}, radius, bins, sized(300000, 3000), 5);
        const Error e = errorOf(light, [&](size_t i) {
            // Linear between the middles of the bins.
            const Vec3 p = surfaceAt(ball.scene.mesh(), ball.points[i / 3]).position;
            const double at = (p.z / length(p) + 1) / 2 * bins - 0.5;
            const int bin = std::clamp(int(std::floor(at)), 0, bins - 2);
            return expected.radiance[bin] +
                   (at - bin) * (expected.radiance[bin + 1] - expected.radiance[bin]);
        });
        if (testsAreSmall()) continue;
        EXPECT_LT(e.mean, ballError * ballError + 3 * e.uncertainty) << radius;
        EXPECT_LT(light.noise, 0.02);
        EXPECT_GT(light.noise, 0.002);
    }
}

// Over both halves, of one channel.
double meanOf(const WalkedLight& light, size_t channel) {
    double sum = 0;
    for (size_t i = channel; i < light.first.size(); i += 3) sum += light.first[i] + light.second[i];
    return sum / double(2 * light.first.size() / 3);
}

// A box so large that its top is that of a half-space; the top's first triangle is 0 0 to 1 1.
Mesh largeBox(float s = 100, float deep = 60) {
    Mesh box;
    for (int i = 0; i < 8; ++i)
        box.positions.insert(box.positions.end(), {i & 1 ? s : -s, i & 2 ? s : -s, i & 4 ? 0 : -deep});
    box.triangles = {4, 5, 7, 4, 7, 6, 0, 3, 1, 0, 2, 3, 0, 1, 5, 0, 5, 4,
                     1, 3, 7, 1, 7, 5, 3, 2, 6, 3, 6, 7, 2, 0, 4, 2, 4, 6};
    return box;
}

// The means of the channels at the middle of that box, lit from everywhere.
std::array<double, 3> reflectedByLargeBox(const LayeredMedium& medium, uint32_t samples) {
    const Scene scene(largeBox().view());
    const std::vector<SurfacePoint> middle(sized(32, 2), {0, {0.5, 0, 0.5}});
    const WalkedLight light = walkLight(WalkBody(scene, 0), fromEverywhere(), middle, medium, {samples});
    EXPECT_EQ(light.lost, 0u);
    return {meanOf(light, 0), meanOf(light, 1), meanOf(light, 2)};
}

TEST(WalkLight, LayersReflectWhatTheOraclesWalkDoes) {
    for (const double thickness : {0.06, 1.0}) {
        // The upper layer absorbs more, less, and the medium is white at a second wavelength of a channel.
        LayeredMedium medium;
        medium.thickness = thickness;
        medium.refractiveIndex = 1.4;
        medium.waves = {{4, 2, 0.1, {1, 0, -0.25}}, {2, 0.02, 3, {0, 1, 0}}, {3, 0.2, 0.05, {0, 0, 1.25}}};
        std::vector<reference::SkinWalk> walks;
        for (const Wave& w : medium.waves)
            walks.push_back(reference::walkSkin(
                {{thickness, w.outerAbsorption, w.scattering}, {0, w.absorption, w.scattering}}, 1.4,
                sized(40000, 2000), 3));
        const auto light = reflectedByLargeBox(medium, sized(400u, 50u));
        for (size_t c = 0; c < 3; ++c) {
            double expected = 0, uncertainty = 0;
            for (size_t i = 0; i < walks.size(); ++i) {
                expected += medium.waves[i].weight[c] * walks[i].reflectance;
                uncertainty += std::abs(medium.waves[i].weight[c]) * walks[i].error;
            }
            EXPECT_NEAR(light[c], expected, testsAreSmall() ? 0.1 : 6 * uncertainty)
                << "channel " << c << ", thickness " << thickness;
        }
    }
}

// Beside the edge of a shadow, which shows how far light travels in layers.
TEST(WalkLight, LayersCarryLightAsFarAsInTheOraclesWalk) {
    Mesh both = largeBox(10, 10);
    both.positions.insert(both.positions.end(), {-10, -10, 5, 0, -10, 5, 0, 10, 5, -10, 10, 5});
    both.triangles.insert(both.triangles.end(), {8, 9, 10, 8, 10, 11});
    both.materials = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 2, 2};
    const Scene scene(both.view());
    const WalkBody body(scene, 1);
    const double thickness = 0.1;
    LayeredMedium layers;
    layers.thickness = thickness, layers.refractiveIndex = 1.4;
    layers.waves = {{4, 2, 0.1, {1, 1, 1}}};
    for (const double away : {0.1, 0.5}) {
        const reference::SkinWalk expected =
            reference::walkSkin({{thickness, 2, 4}, {0, 0.1, 4}}, 1.4, sized(100000, 4000), 9, away);
        const std::vector<SurfacePoint> inShadow(sized(32, 2),
                                                 {0, {0.5 + away / 20, 0.25 - away / 20, 0.25}});
        const WalkedLight light = walkLight(body, zenith(), inShadow, layers, {uint32_t(sized(300, 50))});
        EXPECT_NEAR(meanOf(light, 0), expected.beyond, testsAreSmall() ? 0.05 : 6 * expected.error) << away;
    }
}

TEST(WalkLight, EqualLayersAreOneMedium) {
    const Ball ball(24, 60);
    LayeredMedium layers = medium(0.1);
    layers.thickness = 0.2;
    const auto walked = [&](const LayeredMedium& m) {
        return walkLight(ball.body, zenith(), ball.points, m, {8}).first;
    };
    EXPECT_EQ(walked(layers), walked(medium(0.1)));
    for (Wave& w : layers.waves) w.outerAbsorption *= 2;
    EXPECT_NE(walked(layers), walked(medium(0.1)));
    // A white furnace: all light that enters the surface returns.
    layers.refractiveIndex = fresnelIndex;
    for (Wave& w : layers.waves) w.outerAbsorption = w.absorption = 0;
    EXPECT_NEAR(meanOf(walkLight(ball.body, fromEverywhere(), ball.points, layers, {64}), 0), 0.92319, 5e-3)
        << "diffuse Fresnel transmission";
}

TEST(WalkLight, LargePlaneReflectsWhatTheMediumWasMadeFor) {
    const std::array<double, 3> reflectance{0.8, 0.5, 0.25};
    for (const auto boundary : {Boundary::IndexMatched, Boundary::Fresnel}) {
        const Medium m = burleyMedium({0.9, 0.9, 0.9}, reflectance, boundary);
        const auto light = reflectedByLargeBox(m, sized(600u, 50u));
        for (size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(light[c], reflectance[c], testsAreSmall() ? 0.1 : reflectanceError)
                << "channel " << c << ", index " << m.refractiveIndex;
    }
}

TEST(WalkLight, MediumOfBurleysProfile) {
    // docs/mathematics.md, section 14: l = 1.087 d and an albedo of 0.99055 at a reflectance of 0.8.
    const Medium m = burleyMedium({1, 2, 0.1}, {0.8, 0.8, 0.8}, Boundary::IndexMatched);
    EXPECT_NEAR(m.meanFreePath[0], 1.087, 0.004);
    EXPECT_NEAR(m.meanFreePath[1], 2 * m.meanFreePath[0], 1e-12);
    EXPECT_NEAR(m.albedo[2], 0.99055, 1e-4);
    double before = 0;
    for (double A : {0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0}) {
        const Medium one = burleyMedium({1, 1, 1}, {A, A, A}, Boundary::IndexMatched);
        EXPECT_GT(one.albedo[0], before);
        EXPECT_LT(one.albedo[0], 1);
        EXPECT_TRUE(one.meanFreePath[0] > 0.5 && one.meanFreePath[0] < 5);
        before = one.albedo[0];
    }
}

TEST(WalkLight, SameResultWithAnyNumberOfThreads) {
    const Ball ball(24, 60);
    const auto walked = [&](int threads, uint64_t seed) {
        omp_set_num_threads(threads);
        return walkLight(ball.body, zenith(), ball.points, medium(0.1), {8, 0, seed}).first;
    };
    const int before = omp_get_max_threads();
    EXPECT_EQ(walked(1, 3), walked(5, 3));
    EXPECT_NE(walked(1, 3), walked(1, 4));
    omp_set_num_threads(before);
}

TEST(WalkLight, SamplesForANoise) {
    const Ball ball(24, 10);
    for (double noise : {0.02, 0.01}) {
        const auto light = walkLight(ball.body, zenith(), ball.points, medium(0.1), {1, noise});
        EXPECT_NEAR(light.noise / noise, 1, 0.25) << light.samples;
    }
    EXPECT_EQ(walkLight(ball.body, zenith(), {}, medium(0.1), {1, 1e-9}).first.size(), 0u);
}

TEST(WalkLight, CancelsWhileItWalks) {
    const Ball ball(24, 1);
    const WalkOptions options{maxWalkSamples, 0, 1, [](double) { throw std::domain_error("cancelled"); }};
    const auto start = std::chrono::steady_clock::now();
    EXPECT_THROW(walkLight(ball.body, zenith(), ball.points, medium(0.1), options), std::domain_error);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10)) << "of many hours";
}

// A ball inside of a ball. The outer one lets walks of the inner one's medium pass, and shades it.
TEST(WalkLight, BodiesOfTheirOwn) {
    Mesh two = makeSphere(1, 24, 48);
    two.materials.assign(two.triangles.size() / 3, 1);
    Mesh outer = makeSphere(2, 24, 48);
    outer.materials.assign(outer.triangles.size() / 3, 2);
    const size_t inner = two.materials.size();
    two.append(outer);
    const Scene scene(two.view());
    const WalkBody body(scene, 1);
    const Ball alone(24, 100);
    std::vector<SurfacePoint> points = alone.points;
    EXPECT_EQ(walkLight(body, fromEverywhere(), points, medium(0.2), {8}).first,
              walkLight(alone.body, fromEverywhere(), points, medium(0.2), {8}).first);
    for (float v : walkLight(body, zenith(), points, medium(0.2), {8}).first)
        EXPECT_EQ(v, 0) << "in the shadow";
    points.push_back({uint32_t(inner), {1, 0, 0}});
    EXPECT_THROW(walkLight(body, zenith(), points, medium(0.2), {8}), std::invalid_argument);
    EXPECT_THROW(WalkBody(scene, 3), std::invalid_argument);
}

TEST(WalkLight, StartsInsideOfSharpCorners) {
    Mesh needle;
    needle.positions = {0, 0, 0, 0, 1, 0, 0, 0, 1, 5, 0.3f, 0.3f};
    needle.triangles = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    const Scene scene(needle.view());
    std::vector<SurfacePoint> corners;
    for (uint32_t t = 0; t < 4; ++t)
        for (int k = 0; k < 3; ++k) corners.push_back({t, {double(k == 0), double(k == 1), double(k == 2)}});
    const WalkedLight light = walkLight(WalkBody(scene, 0), fromEverywhere(), corners, medium(0.1), {64});
    EXPECT_EQ(light.lost, 0u);
    for (float v : light.first) EXPECT_GT(v, 0.5);
}

TEST(WalkLight, RefusesWhatHasNoResult) {
    const Ball ball(8, 1000);
    const auto refused = [&](const LayeredMedium& m, const WalkOptions& options = {}) {
        EXPECT_THROW(walkLight(ball.body, zenith(), ball.points, m, options), std::invalid_argument);
    };
    for (double path : {0.0, -1.0, double(INFINITY), std::nan("")}) refused(medium(path));
    for (double albedo : {-0.1, 1.1, std::nan("")}) refused(medium(1, albedo));
    refused(medium(1), {0});
    refused(medium(1), {maxWalkSamples + 1});
    refused(medium(1), {1, std::nan("")});
    refused({});
    for (const double thickness : {-1.0, std::nan("")}) {
        LayeredMedium layers = medium(1);
        layers.thickness = thickness;
        refused(layers);
    }
    Medium glass = medium(1);
    glass.refractiveIndex = 0.5;
    refused(glass);
    // A white medium behind a boundary, and an open mesh: walks end.
    glass.refractiveIndex = 3;
    glass.albedo = white;
    glass.meanFreePath = {1e-3, 1e3, 1};
    for (float v : walkLight(ball.body, fromEverywhere(), ball.points, glass, {2}).first)
        EXPECT_TRUE(v >= 0 && v <= 1.001f);
    const Scene sheet(makeRectangle(-1, 1, -1, 1, 0).view());
    const WalkedLight open = walkLight(WalkBody(sheet, 0), zenith(), ball.points, medium(0.1), {64});
    EXPECT_GT(open.lost, 0u);
    for (float v : open.first) EXPECT_TRUE(std::isfinite(v));
}

namespace {

// The head of the G-buffers: the triangles of the reference data are halves of quads, which were subdivided
// twice. Its y axis is up; that of the G-buffers is z.
pellucid::io::PartedMesh subdividedHead(const std::filesystem::path& folder) {
    const auto positions = npy::read<float>(folder / "mesh_head_pos_f32.npy").data;
    const auto triangles = npy::read<int32_t>(folder / "mesh_head_idx_i32.npy").data;
    std::map<std::array<float, 3>, size_t> welded;
    std::string text;
    std::vector<size_t> numbers;
    for (size_t i = 0; i < positions.size(); i += 3) {
        const std::array<float, 3> p{positions[i], -positions[i + 2], positions[i + 1]};
        const auto [at, isNew] = welded.try_emplace(p, welded.size() + 1);
        numbers.push_back(at->second);
        if (isNew)
            text += pellucid::io::printed("v %.8g %.8g %.8g\n", double(p[0]), double(p[1]), double(p[2]));
    }
    const auto vertex = [&](size_t corner) { return numbers[size_t(triangles[corner])]; };
    for (size_t t = 0; t < triangles.size(); t += 6) {
        // The corner of each half that the other one does not have, and the corners after it.
        const std::set<size_t> second{vertex(t + 3), vertex(t + 4), vertex(t + 5)};
        size_t k = 0;
        while (second.contains(vertex(t + k))) ++k;
        const size_t a = vertex(t + k), b = vertex(t + (k + 1) % 3), d = vertex(t + (k + 2) % 3);
        size_t c = 0;
        for (const size_t v : second)
            if (v != b && v != d) c = v;
        for (const size_t v : {a, b, c, d}) text += (v == a ? "f " : " ") + std::to_string(v);
        text += "\n";
    }
    return pellucid::io::decodeParts("head.obj", text, 2);
}

}  // namespace

TEST(WalkLight, HeadEqualsAnotherProgramsWalk) {
    const char *walks = std::getenv("PELLUCID_RULER_DIR"), *gbuffers = std::getenv("PELLUCID_GBUFFER_DIR"),
               *oracle = std::getenv("PELLUCID_ORACLE_DIR");
    if (!walks || !gbuffers || !oracle)
        GTEST_SKIP() << "PELLUCID_RULER_DIR, PELLUCID_GBUFFER_DIR and PELLUCID_ORACLE_DIR are needed";
    const pellucid::io::PartedMesh head = subdividedHead(oracle);
    ASSERT_EQ(head.mesh.triangleCount(), 2u * 141472);
    const Scene scene(MeshView{head.mesh.positions, head.mesh.normals, {}, {}, head.mesh.triangles, {}});
    const WalkBody body(scene, 0);
    const pellucid::io::Image gbuffer = pellucid::io::readImage(gbuffers + std::string("/head_gbuf.exr"));
    const std::vector<float> positions = gbuffer.interleaved(
        std::vector<std::string>{"ViewLayer.Position.X", "ViewLayer.Position.Y", "ViewLayer.Position.Z"});
    const struct {
        const char* file;
        double scale;
        Vec3 toLight;
    } cases[] = {{"head_side_walk_f32.npy", 1, {0.7990018725, -0.4494385421, 0.3995009363}},
                 {"head_side_x4_walk_f32.npy", 4, {0.7990018725, -0.4494385421, 0.3995009363}},
                 {"head_back_x4_walk_f32.npy", 4, {0.55, 0.75, 0.36}}};
    for (const auto& c : cases) {
        const auto theirs = npy::read<float>(std::filesystem::path(walks) / c.file);
        ASSERT_EQ(theirs.shape, (std::vector<size_t>{6000, 10}));
        std::vector<float> from;
        std::vector<const float*> rows;
        const size_t stride = testsAreSmall() ? 60 : 6;
        for (size_t i = 0; i < 6000; i += stride) {
            const float* row = &theirs.data[10 * i];
            const float* p = &positions[3 * (size_t(row[0]) * 512 + size_t(row[1]))];
            from.insert(from.end(), p, p + 3);
            rows.push_back(row);
        }
        std::vector<double> off;
        const std::vector<SurfacePoint> points = nearestPoints(scene, from, off);
        EXPECT_LT(*std::max_element(off.begin(), off.end()), 0.01) << "cm";
        Lighting lighting = zenith();
        lighting.lights[0].toLight = normalize(c.toLight);
        // Lengths of the profile in cm.
        const double d = 0.1 * c.scale;
        const Medium m =
            burleyMedium({0.29205 * d, 0.10902 * d, 0.05411 * d}, {0.8, 0.8, 0.8}, Boundary::IndexMatched);
        const WalkedLight light = walkLight(body, lighting, points, m, {uint32_t(sized(64, 4))});
        for (size_t channel = 0; channel < 3; ++channel) {
            // Both programs have two halves: the product of their differences has no noise in the mean.
            double sum = 0, square = 0, bias = 0, spread = 0;
            for (size_t i = 0; i < rows.size(); ++i) {
                const double e = light.first[3 * i + channel] - rows[i][4 + 2 * channel],
                             f = light.second[3 * i + channel] - rows[i][5 + 2 * channel];
                sum += e * f, square += e * f * e * f, bias += (e + f) / 2, spread += (e + f) * (e + f) / 4;
            }
            const double n = double(rows.size()), uncertainty = std::sqrt(square) / n;
            EXPECT_LT(sum / n, headError * headError + 3 * uncertainty) << c.file << ", channel " << channel;
            EXPECT_NEAR(bias / n, 0, headBias + 3 * std::sqrt(spread) / n)
                << c.file << ", channel " << channel;
        }
    }
}
