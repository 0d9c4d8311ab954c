// The gain of curved bodies (docs/mathematics.md, section 12): the mean curvature that is measured on the
// screen, and pictures against random walks.
#include "device_lanes.h"
#include "diffusion/reference_scenes.h"
#include "npy.h"

using namespace reference_scenes;

namespace {

constexpr PelScattering methods[] = {PEL_SCATTERING_PREINTEGRATED, PEL_SCATTERING_SEPARABLE,
                                     PEL_SCATTERING_SCREEN, PEL_SCATTERING_LIGHT, PEL_SCATTERING_AUTO};

// A surface z(x, y) seen in parallel, `size` to a pixel, with its normal, and its mean curvature in the
// middle.
struct Surface {
    const char* name;
    std::function<double(double, double)> height;
    double curvature;
};
const Surface surfaces[] = {
    {"plane", [](double x, double y) { return 0.3 * x - 0.2 * y; }, 0},
    {"ball", [](double x, double y) { return std::sqrt(400 - x * x - y * y); }, 0.05},
    {"hollow", [](double x, double y) { return -std::sqrt(400 - x * x - y * y); }, -0.05},
    {"cylinder", [](double x, double) { return std::sqrt(400 - x * x); }, 0.025},
    {"saddle", [](double x, double y) { return 0.02 * (x * x - y * y); }, 0},
    {"paraboloid", [](double x, double y) { return -0.02 * x * x - 0.01 * y * y; }, 0.03},
};
// Light scatters across ripples of a quarter of a millimetre, however strongly they curve.
const Surface rippled{
    "rippled ball",
    [](double x, double y) { return std::sqrt(400 - x * x - y * y) + 2e-4 * std::cos(25 * x); }, 0.05};

// Under even light, which scattering leaves as it is.
Shown gainsOf(const Surface& surface, uint32_t side, double size, PelScattering method, float strength,
              uint64_t budget = 0, bool cut = false, double unit = 1, const Device& device = Device(""),
              bool mirrored = false) {
    scatter_scene::Picture p(side, side);
    std::vector<float> normals;
    for (uint32_t row = 0; row < side; ++row)
        for (uint32_t column = 0; column < side; ++column) {
            const double x = (column + 0.5 - 0.5 * side) * size, y = (0.5 * side - row - 0.5) * size,
                         h = 1e-4;
            const reference::Vec3 n = normalized(
                reference::Vec3{(surface.height(x - h, y) - surface.height(x + h, y)) / (2 * h),
                                (surface.height(x, y - h) - surface.height(x, y + h)) / (2 * h), 1});
            for (int k = 0; k < 3; ++k) normals.push_back(float(n[k]));
            p.set(p.at(column, row), reference::Vec3{x, y, surface.height(x, y)} / unit, {},
                  cut && (mirrored ? side - 1 - column : column) < side / 3 ? 0 : 1);
        }
    scatter_scene::Frame f(p, method);
    f.images[PEL_SLOT_NORMAL_SHADING] = normals;
    f.images[PEL_SLOT_CURVATURE].assign(p.pixels(), 0);
    f.options.scratchBudget = budget;
    f.options.millimetresPerUnit = float(unit);
    f.giveIrradiance = false;
    f.profile = profile();
    f.material.specular = 0;
    f.material.curvatureGain = strength;
    scatter_scene::ShownImages shown(device, 1, 1);
    if (method == PEL_SCATTERING_PREINTEGRATED) {  // its gain is one of direct light
        f.lamps.resize(1);
        f.lamps[0].light.toLight[0] = f.lamps[0].light.toLight[1] = 0, f.lamps[0].light.toLight[2] = 1;
    } else {
        PelAmbient ambient = pelAmbientDefaults();
        std::fill_n(ambient.constant, 3, 1.0f);
        shown.shader.set(ambient);
    }
    return f.shade(shown);
}

double gainAt(double curvature, int channel, double strength = 1) {
    return reference::curvatureGain(strength * meanFreePath[channel] * curvature, 1.087);
}

// Radiance of random walks at some pixels: of each channel two estimates.
npy::Array<float> walk(const char* name) {
    return npy::read<float>(std::filesystem::path(std::getenv("PELLUCID_RULER_DIR")) / name);
}

// RMSE in 1e-4 without the noise of the walk.
std::array<double, 3> errorOfWalk(const ReferenceScene& r, const std::vector<float>& light,
                                  const npy::Array<float>& walk) {
    std::array<double, 3> sum{};
    for (size_t k = 0; k < walk.shape[0]; ++k) {
        const float* row = walk.row(k);
        const size_t pixel = size_t(row[0]) * r.side + size_t(row[1]);
        for (int c = 0; c < 3; ++c) {
            const double v = albedo * light[3 * pixel + c];
            sum[c] += (v - row[4 + 2 * c]) * (v - row[5 + 2 * c]) / double(walk.shape[0]);
        }
    }
    for (double& s : sum) s = 1e4 * std::sqrt(std::max(s, 0.0));
    return sum;
}

void print(const char* scene, int method, const std::array<double, 3>& own,
           const std::array<double, 3>& lambert) {
    std::printf("%-12s method %d  1e-4: %5.1f %5.1f %5.1f   Lambert %5.0f %5.0f %5.0f\n", scene, method,
                own[0], own[1], own[2], lambert[0], lambert[1], lambert[2]);
}

bool hasData() {
    return std::getenv("PELLUCID_RULER_DIR") && std::getenv("PELLUCID_GBUFFER_DIR");
}

}  // namespace

TEST(CurvatureGain, IsThatOfTheSurface) {
    const auto expectGain = [](const Surface& surface, double size, double unit) {
        for (PelScattering method : {PEL_SCATTERING_SCREEN, PEL_SCATTERING_SEPARABLE}) {
            const uint32_t side = size < 0.1 ? 64 : 20;
            const std::vector<float> light = gainsOf(surface, side, size, method, 1, 0, false, unit).light;
            const size_t middle = side / 2 * side + side / 2;
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(light[3 * middle + size_t(c)], gainAt(surface.curvature, c), tolerance::gain)
                    << surface.name << ", pixels of " << size << ", unit " << unit << ", channel " << c;
        }
    };
    for (const Surface& surface : surfaces)
        for (auto [size, unit] : {std::pair{0.05, 1.0}, {0.2, 1.0}, {0.2, 1000.0}, {1.0, 1.0}})
            expectGain(surface, size, unit);
    expectGain(rippled, 0.05, 1);
}

// A steep slope, whose pixels are shorter on one side than on the other, and its mirror image.
TEST(CurvatureGain, HasNoPreferredSide) {
    const auto slope = [](double turn) {
        return Surface{"slope",
                       [=](double x, double y) { return -0.02 * x * x - 2 * std::exp(turn * x) - y; }, 0};
    };
    const uint32_t side = 48;
    const auto gains = [&](double turn) {
        return gainsOf(slope(turn), side, 0.1, PEL_SCATTERING_SCREEN, 1, 0, true, 1, Device(""), turn < 0)
            .light;
    };
    const std::vector<float> left = gains(1), right = gains(-1);
    for (size_t row = 0; row < side; ++row)
        for (size_t column = 0; column < side; ++column)
            EXPECT_NEAR(left[3 * (row * side + column)], right[3 * (row * side + side - 1 - column)], 1e-4)
                << column << ", " << row;
}

TEST(CurvatureGain, FollowsItsStrengthAndIsNothingOnPlanes) {
    for (PelScattering method : methods) {
        const std::vector<float> none = gainsOf(surfaces[1], 24, 0.3, method, 0).light,
                                 half = gainsOf(surfaces[1], 24, 0.3, method, 0.5f).light,
                                 plane = gainsOf(surfaces[0], 24, 0.3, method, 1).light,
                                 without = gainsOf(surfaces[0], 24, 0.3, method, 0).light;
        const size_t middle = 12 * 24 + 12;
        for (size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(half[3 * middle + c] / none[3 * middle + c], gainAt(0.05, int(c), 0.5),
                        tolerance::gain)
                << int(method);
        for (size_t i = 0; i < plane.size(); ++i) ASSERT_NEAR(plane[i], without[i], 1e-5) << int(method);
    }
}

// Beside an edge of the material, and in bands of rows.
TEST(CurvatureGain, NeedsNeitherAllNeighboursNorTheWholeFrame) {
    const Shown whole = gainsOf(surfaces[1], 48, 0.3, PEL_SCATTERING_PREINTEGRATED, 1, 0, true),
                bands = gainsOf(surfaces[1], 48, 0.3, PEL_SCATTERING_PREINTEGRATED, 1, 48 * 12 * 4, true);
    EXPECT_EQ(whole.light, bands.light);
    const Shown none = gainsOf(surfaces[1], 48, 0.3, PEL_SCATTERING_PREINTEGRATED, 0, 0, true);
    for (size_t x = 16; x < 48; ++x) {
        const size_t i = 3 * (24 * 48 + x);
        EXPECT_NEAR(whole.light[i] / none.light[i], gainAt(0.05, 0), 2 * tolerance::gain) << x;
    }
}

// The size of the window depends on the surface at its own pixel, not on the other pixels of a vector, and
// differences that reach beyond the frame are left out one by one.
TEST(CurvatureGain, DoesNotDependOnTheWidthOfVectors) {
    const Surface waves{"waves", [](double x, double y) { return 3 * std::cos(x) + 0.1 * y * y; }, 0};
    constexpr uint32_t side = 96;
    const std::vector<float> one =
        gainsOf(waves, side, 0.1, PEL_SCATTERING_SEPARABLE, 1, 0, false, 1, lanes::deviceOf(1)).light;
    for (int count : {8, 16}) {
        const std::vector<float> many =
            gainsOf(waves, side, 0.1, PEL_SCATTERING_SEPARABLE, 1, 0, false, 1, lanes::deviceOf(count)).light;
        for (size_t y = 0; y < side; ++y)
            for (size_t x = 0; x < side; ++x)
                for (size_t i = 3 * (side * y + x); i < 3 * (side * y + x) + 3; ++i)
                    ASSERT_NEAR(many[i], one[i], tolerance::widthsAgree)
                        << count << " lanes, " << x << ", " << y;
    }
}

// A groove of two planes, of which the left one is lit, seen from above: where the medium is known, less
// light crosses the air in it. Over a ridge more light travels through the body. A shadow map of only the
// left plane gives the same: surface deep below a receiver that faces the light is not the far side of a
// slab.
TEST(CurvatureGain, LightTakesItsWayThroughTheBody) {
    const uint32_t side = 64;
    const double size = 0.15;
    const auto exact = reference::burleyProfile({meanFreePath[0], meanFreePath[1], meanFreePath[2]},
                                                {albedo, albedo, albedo});
    for (double slope : {1.0, -1.0}) {
        scatter_scene::Picture p(side, side);
        std::vector<float> normals;
        for (uint32_t row = 0; row < side; ++row)
            for (uint32_t column = 0; column < side; ++column) {
                const double x = (column + 0.5 - 0.5 * side) * size, y = (0.5 * side - row - 0.5) * size,
                             lean = (x < 0 ? 1 : -1) * slope / std::sqrt(2.0), e = x < 0 ? 1 : 0;
                p.set(p.at(column, row), {x, y, slope * std::abs(x)}, {e, e, e});
                for (double v : {lean, 0.0, std::sqrt(0.5)}) normals.push_back(float(v));
            }
        constexpr uint32_t texels = 128;
        scatter_scene::Lamp lamp{pelLightDefaults(), {{}}, texels, texels};
        const float per = 1 / float(side * size), depth = 40,
                    matrix[16] = {per, 0, 0, 0.5f, 0, -per, 0, 0.5f, 0, 0, -1 / depth, 0.5f, 0, 0, 0, 1};
        std::copy_n(matrix, 16, lamp.light.worldToShadow);
        lamp.light.shadowDepthRange = depth;
        lamp.light.toLight[0] = lamp.light.toLight[1] = 0, lamp.light.toLight[2] = 1;
        std::fill_n(lamp.light.color, 3, float(std::sqrt(2.0)));
        for (uint32_t i = 0; i < texels * texels; ++i) {
            const float x = ((float(i % texels) + 0.5f) / texels - 0.5f) / per;
            lamp.maps[0].push_back(x < 0 ? 0.5f + float(slope) * x / depth : 1);
        }
        reference::ScatterPicture picture = p.exact();
        picture.camera = reference::Vec3{0, 0, 60};
        for (const auto& [gain, method] : {std::pair{0, PEL_SCATTERING_SCREEN},
                                           {1, PEL_SCATTERING_SCREEN},
                                           {0, PEL_SCATTERING_LIGHT},
                                           {1, PEL_SCATTERING_LIGHT}}) {
            scatter_scene::Frame f(p, method);
            if (method == PEL_SCATTERING_LIGHT) f.lamps = {lamp};
            f.images[PEL_SLOT_NORMAL_SHADING] = normals;
            f.profile = profile();
            f.material.specular = 0;
            f.material.curvatureGain = float(gain);
            scatter_scene::ShownImages shown(Device(""), 1, 1);
            shown.shader.set(scatter_scene::standingAt({0, 0, 60}));
            const std::vector<float> light = f.shade(shown).light;
            picture.directed = 0;
            const auto even = reference::scatterOnScreen(picture, *exact);
            picture.directed = 0.92 * gain;
            const auto expected = reference::scatterOnScreen(picture, *exact);
            // Beyond the window of the curvature, and that of pixels round a texel.
            for (uint32_t column = method == PEL_SCATTERING_LIGHT ? 42 : 39; column < 46; ++column) {
                const size_t i = side / 2 * side + column;
                EXPECT_NEAR(light[3 * i], expected[i].x, tolerance::scatterBlocksRms + 0.1 * expected[i].x)
                    << column << ", slope " << slope << ", gain " << gain << ", method " << int(method);
                if (!gain) continue;
                EXPECT_GT(slope * (even[i].x - light[3 * i]), 0.1 * slope * (even[i].x - expected[i].x))
                    << column << ", slope " << slope;
            }
        }
    }
}

// A parallel view, with ordinary and reversed depth, and a camera without a matrix are like a view from afar:
// the camera's position tells which side of the surface is outside.
TEST(CurvatureGain, ParallelViewsAreLikeThoseFromAfar) {
    const uint32_t side = 64;
    const double size = 0.4, radius = 12;
    scatter_scene::Picture p(side, side);
    std::vector<float> normals;
    for (uint32_t row = 0; row < side; ++row)
        for (uint32_t column = 0; column < side; ++column) {
            const double x = (column + 0.5 - 0.5 * side) * size, y = (0.5 * side - row - 0.5) * size,
                         z2 = radius * radius - x * x - y * y, z = std::sqrt(std::max(z2, 0.0)),
                         e = std::max(0.8 * x + 0.6 * z, 0.0) / radius;
            p.set(p.at(column, row), {x, y, z}, {e, e, e}, z2 > 0);
            for (double v : {x, y, z}) normals.push_back(float(v / radius));
        }
    const float far_ = 4000, half = float(side * size / 2);
    const auto parallel = [&](float depth, float distance) {
        PelCamera camera = pelCameraDefaults();
        const float matrix[16] = {half, 0, 0, 0, 0, half, 0, 0, 0, 0, depth, -depth / 2, 0, 0, 0, 1};
        if (depth != 0) std::copy_n(matrix, 16, camera.inverseViewProjection);
        camera.position[2] = distance;
        return camera;
    };
    for (PelScattering method : {PEL_SCATTERING_SCREEN, PEL_SCATTERING_AUTO}) {
        std::string warnings;
        const auto lightFrom = [&](const PelCamera& camera) {
            scatter_scene::Frame f(p, method);
            f.images[PEL_SLOT_NORMAL_SHADING] = normals;
            f.profile = profile();
            f.material.specular = 0;
            f.material.curvatureGain = 1;
            scatter_scene::ShownImages shown(Device(""), 1, 1);
            shown.shader.set(camera);
            const std::vector<float> light = f.shade(shown).light;
            warnings = shown.shader.warnings();
            return light;
        };
        const std::vector<float> expected = lightFrom(scatter_scene::standingAt({0, 0, far_}));
        const auto differenceFrom = [&](const PelCamera& camera) {
            const std::vector<float> light = lightFrom(camera);
            double most = 0;
            for (size_t i = 0; i < light.size(); ++i)
                most = std::max(most, double(std::abs(light[i] - expected[i])));
            return most;
        };
        for (float depth : {-40.0f, 40.0f, 0.0f})
            for (float distance : {far_, 1e8f}) {
                EXPECT_LT(differenceFrom(parallel(depth, distance)), tolerance::parallelView)
                    << "method " << int(method) << ", depth " << depth << ", from " << distance;
                EXPECT_EQ(warnings.find("PelCamera.position"), std::string::npos) << warnings;
            }
        EXPECT_GT(differenceFrom(parallel(-40, 0)), 5 * tolerance::parallelView) << "nothing to tell apart";
        EXPECT_NE(warnings.find("PelCamera.position"), std::string::npos) << warnings;
    }
}

// No method is further from the random walk than Lambert, whatever the ball's radius.
TEST(CurvatureGain, BallsAgainstRandomWalks) {
    if (!hasData()) GTEST_SKIP() << "PELLUCID_RULER_DIR or PELLUCID_GBUFFER_DIR is not set: no reference";
    const npy::Array<double> walks =
        npy::read<double>(std::filesystem::path(std::getenv("PELLUCID_RULER_DIR")) / "ball_walks_f64.npy");
    constexpr double radii[] = {3.47, 8.68, 11.57, 17.35, 28.92, 57.84};  // mean free paths
    const Device device("");
    ReferenceScene r = ball(std::getenv("PELLUCID_GBUFFER_DIR"));
    r.gain = 1;
    for (size_t k = 0; k < 6; ++k) {
        r.profileScale = float(10 / radii[k] / meanFreePath[0]);  // of a ball of 10 mm, in red
        for (PelScattering method : methods) {
            const Shown shown = shade(device, r, method, true);
            double own = 0, lambert = 0;
            size_t count = 0;
            for (size_t i = 0; i < r.ids.size(); ++i) {
                if (!r.ids[i]) continue;
                double cosine = 0;
                for (int c = 0; c < 3; ++c) cosine += double(r.positions[3 * i + c]) * r.light.toLight[c];
                const double at = std::clamp((cosine + 1) * 50, 0.0, 99.999);
                const auto node = [&](size_t n) { return walks.data[(101 * k + n) * 3 + 1]; };
                const double truth =
                    node(size_t(at)) + (at - std::floor(at)) * (node(size_t(at) + 1) - node(size_t(at)));
                own += std::pow(albedo * shown.light[3 * i] - truth, 2);
                lambert += std::pow(albedo * r.irradiance[3 * i] - truth, 2);
                ++count;
            }
            const double rms = 1e4 * std::sqrt(own / double(count)),
                         plain = 1e4 * std::sqrt(lambert / double(count));
            std::printf("ball of %5.2f paths, method %d: %5.1f, Lambert %4.0f\n", radii[k], int(method), rms,
                        plain);
            EXPECT_LT(rms, plain) << "radius " << radii[k] << ", method " << int(method);
            if (method == PEL_SCATTERING_AUTO) {
                EXPECT_LT(rms, tolerance::walkBalls[k]) << "radius " << radii[k];
            }
        }
    }
}

TEST(CurvatureGain, HeadsAgainstRandomWalks) {
    if (!hasData()) GTEST_SKIP() << "PELLUCID_RULER_DIR or PELLUCID_GBUFFER_DIR is not set: no reference";
    const Device device("");
    const char *references = std::getenv("PELLUCID_RULER_DIR"),
               *gbuffers = std::getenv("PELLUCID_GBUFFER_DIR");
    ReferenceScene r = headTimesFour(references, gbuffers);
    for (float scale : {1.0f, 4.0f}) {
        const npy::Array<float> truth =
            walk(scale == 1 ? "head_side_walk_f32.npy" : "head_side_x4_walk_f32.npy");
        r.profileScale = scale;
        const std::array<double, 3> lambert = errorOfWalk(r, r.irradiance, truth);
        for (PelScattering method : methods) {
            if (method == PEL_SCATTERING_PREINTEGRATED) continue;  // needs curvature and a filtered shadow
            r.gain = 0;
            const auto without = errorOfWalk(r, shade(device, r, method, false).light, truth);
            r.gain = 1;
            const auto own = errorOfWalk(r, shade(device, r, method, false).light, truth);
            print(scale == 1 ? "head" : "head x 4", int(method), own, lambert);
            for (int c = 0; c < 3; ++c) {
                EXPECT_LT(own[c], lambert[c]) << "scale " << scale << ", method " << int(method);
                EXPECT_LT(own[c], 1.03 * without[c] + 1) << "scale " << scale << ", method " << int(method);
            }
            if (method != PEL_SCATTERING_AUTO) continue;
            for (int c = 0; c < 3; ++c)
                EXPECT_LT(own[c], (scale == 1 ? tolerance::walkHead : tolerance::walkHeadTimesFour)[c]);
        }
    }
}
