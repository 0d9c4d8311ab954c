// The gain of curved bodies (docs/mathematics.md, section 12): the mean curvature that is measured on the
// screen, and pictures against random walks.
#include "device_lanes.h"
#include "diffusion/reference_scenes.h"
#include "npy.h"

using namespace reference_scenes;
using reference::Vec3;

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

// Its pixels round the middle, dark and of material 1, and its normals.
struct Seen {
    Seen(const std::function<double(double, double)>& height, uint32_t side, double size)
        : picture(side, side) {
        for (size_t i = 0; i < picture.pixels(); ++i) {
            const double x = (double(i % side) + 0.5 - 0.5 * side) * size,
                         y = (0.5 * side - double(i / side) - 0.5) * size, h = 1e-4;
            const Vec3 n = normalized(Vec3{(height(x - h, y) - height(x + h, y)) / (2 * h),
                                           (height(x, y - h) - height(x, y + h)) / (2 * h), 1});
            for (int k = 0; k < 3; ++k) normals.push_back(float(n[k]));
            picture.set(i, {x, y, height(x, y)}, {});
        }
    }
    scatter_scene::Frame frame(PelScattering method, float strength) const {
        scatter_scene::Frame f(picture, method);
        f.images[PEL_SLOT_NORMAL_SHADING] = normals;
        f.profile = profile();
        f.material.specular = 0;
        f.material.curvatureGain = strength;
        return f;
    }
    scatter_scene::Picture picture;
    std::vector<float> normals;
};

struct Look {
    PelScattering method;
    float strength = 1;
    uint64_t budget = 0;
    int cut = 0;  // a third of the picture is left out: 1: on the left, 2: on the right
    double unit = 1;
    pellucid::Device on = device();
};

// Under even light, which scattering leaves as it is.
std::vector<float> gainsOf(const Surface& surface, uint32_t side, double size, const Look& look) {
    scatter_scene::Frame f = Seen(surface.height, side, size).frame(look.method, look.strength);
    for (float& p : f.picture.positions) p /= float(look.unit);
    for (size_t i = 0; look.cut && i < f.picture.pixels(); ++i)
        f.picture.ids[i] = (look.cut == 1 ? i % side : side - 1 - i % side) >= side / 3;
    f.images[PEL_SLOT_CURVATURE].assign(f.picture.pixels(), 0);
    f.options.scratchBudget = look.budget;
    f.options.millimetresPerUnit = float(look.unit);
    f.giveIrradiance = false;
    scatter_scene::ShownImages shown(look.on, 1, 1);
    const bool byTables = look.method == PEL_SCATTERING_PREINTEGRATED;
    if (byTables) {  // half of it is direct
        f.lamps.resize(1);
        f.lamps[0].light.toLight[0] = f.lamps[0].light.toLight[1] = 0, f.lamps[0].light.toLight[2] = 1;
        std::fill_n(f.lamps[0].light.color, 3, 0.5f);
    }
    PelAmbient ambient = pelAmbientDefaults();
    std::fill_n(ambient.constant, 3, byTables ? 0.5f : 1.0f);
    shown.shader.set(ambient);
    return f.shade(shown).light;
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

bool hasData() {
    return std::getenv("PELLUCID_RULER_DIR") && std::getenv("PELLUCID_GBUFFER_DIR");
}

}  // namespace

TEST(CurvatureGain, IsThatOfTheSurface) {
    const auto expectGain = [](const Surface& surface, double size, double unit) {
        for (PelScattering method : {PEL_SCATTERING_SCREEN, PEL_SCATTERING_SEPARABLE}) {
            const uint32_t side = size < 0.1 ? 64 : 20;
            const std::vector<float> light = gainsOf(surface, side, size, {.method = method, .unit = unit});
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
        return gainsOf(slope(turn), side, 0.1, {.method = PEL_SCATTERING_SCREEN, .cut = turn < 0 ? 2 : 1});
    };
    const std::vector<float> left = gains(1), right = gains(-1);
    for (size_t row = 0; row < side; ++row)
        for (size_t column = 0; column < side; ++column)
            EXPECT_NEAR(left[3 * (row * side + column)], right[3 * (row * side + side - 1 - column)], 1e-4)
                << column << ", " << row;
}

TEST(CurvatureGain, FollowsItsStrengthAndIsNothingOnPlanes) {
    for (PelScattering method : methods) {
        const std::vector<float> none = gainsOf(surfaces[1], 24, 0.3, {method, 0}),
                                 half = gainsOf(surfaces[1], 24, 0.3, {method, 0.5f}),
                                 plane = gainsOf(surfaces[0], 24, 0.3, {method, 1}),
                                 without = gainsOf(surfaces[0], 24, 0.3, {method, 0});
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
    const auto gains = [](float strength, uint64_t budget) {
        return gainsOf(surfaces[1], 48, 0.3, {PEL_SCATTERING_PREINTEGRATED, strength, budget, 1});
    };
    const std::vector<float> whole = gains(1, 0), none = gains(0, 0);
    EXPECT_EQ(whole, gains(1, 48 * 12 * 4));
    for (size_t x = 16; x < 48; ++x) {
        const size_t i = 3 * (24 * 48 + x);
        EXPECT_NEAR(whole[i] / none[i], gainAt(0.05, 0), 2 * tolerance::gain) << x;
    }
}

// The size of the window depends on the surface at its own pixel, not on the other pixels of a vector, and
// differences that reach beyond the frame are left out one by one.
TEST(CurvatureGain, DoesNotDependOnTheWidthOfVectors) {
    const Surface waves{"waves", [](double x, double y) { return 3 * std::cos(x) + 0.1 * y * y; }, 0};
    constexpr uint32_t side = 96;
    const auto gainsBy = [&](int count) {
        return gainsOf(waves, side, 0.1, {.method = PEL_SCATTERING_SEPARABLE, .on = lanes::deviceOf(count)});
    };
    const std::vector<float> one = gainsBy(1);
    for (int count : {8, 16}) {
        const Variable fence("PELLUCID_FENCE", "end");
        const std::vector<float> many = gainsBy(count);
        for (size_t i = 0; i < many.size(); ++i)
            ASSERT_NEAR(many[i], one[i], tolerance::widthsAgree) << count << " lanes, value " << i;
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
        Seen groove([=](double x, double) { return slope * std::abs(x); }, side, size);
        for (size_t i = 0; i < groove.picture.pixels(); ++i)
            if (groove.picture.place(i).x < 0) std::fill_n(&groove.picture.irradiance[3 * i], 3, 1.0f);
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
        reference::ScatterPicture picture = groove.picture.exact();
        picture.camera = Vec3{0, 0, 60};
        const auto even = reference::scatterOnScreen(picture, *exact);
        picture.directed = 0.92;
        const auto directed = reference::scatterOnScreen(picture, *exact);
        for (const auto& [gain, method] : {std::pair{0, PEL_SCATTERING_SCREEN},
                                           {1, PEL_SCATTERING_SCREEN},
                                           {0, PEL_SCATTERING_LIGHT},
                                           {1, PEL_SCATTERING_LIGHT}}) {
            scatter_scene::Frame f = groove.frame(method, float(gain));
            if (method == PEL_SCATTERING_LIGHT) f.lamps = {lamp};
            scatter_scene::ShownImages shown(device(), 1, 1);
            shown.shader.set(scatter_scene::standingAt({0, 0, 60}));
            const std::vector<float> light = f.shade(shown).light;
            const auto& expected = gain ? directed : even;
            // Beyond the window of the curvature, and that of pixels round a texel.
            for (uint32_t column = side / 2 + (method == PEL_SCATTERING_LIGHT ? 10 : 7);
                 column < side / 2 + 14; ++column) {
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
    Seen half([=](double x, double y) { return std::sqrt(std::max(radius * radius - x * x - y * y, 0.0)); },
              side, size);
    for (size_t i = 0; i < half.picture.pixels(); ++i) {
        const Vec3 p = half.picture.place(i);
        const double e = std::max(0.8 * p.x + 0.6 * p.z, 0.0) / radius;
        half.picture.set(i, p, {e, e, e}, p.z > 0);
    }
    const float far_ = 4000, extent = float(side * size / 2);
    const auto parallel = [&](float depth, float distance) {
        PelCamera camera = pelCameraDefaults();
        const float matrix[16] = {extent, 0, 0, 0, 0, extent, 0, 0, 0, 0, depth, -depth / 2, 0, 0, 0, 1};
        if (depth != 0) std::copy_n(matrix, 16, camera.inverseViewProjection);
        camera.position[2] = distance;
        return camera;
    };
    for (PelScattering method : {PEL_SCATTERING_SCREEN, PEL_SCATTERING_AUTO}) {
        std::string warnings;
        const auto lightFrom = [&](const PelCamera& camera) {
            scatter_scene::ShownImages shown(device(), 1, 1);
            shown.shader.set(camera);
            const std::vector<float> light = half.frame(method, 1).shade(shown).light;
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
    ReferenceScene r = ball(std::getenv("PELLUCID_GBUFFER_DIR"));
    r.gain = 1;
    for (size_t k = 0; k < 6; ++k) {
        r.profileScale = float(10 / radii[k] / meanFreePath[0]);  // of a ball of 10 mm, in red
        for (PelScattering method : methods) {
            const Shown shown = shade(device(), r, method, true);
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
            EXPECT_LT(rms, plain) << "radius " << radii[k] << ", method " << int(method);
            if (method == PEL_SCATTERING_AUTO) {
                EXPECT_LT(rms, tolerance::walkBalls[k]) << "radius " << radii[k];
            }
        }
    }
}

TEST(CurvatureGain, HeadsAgainstRandomWalks) {
    if (!hasData()) GTEST_SKIP() << "PELLUCID_RULER_DIR or PELLUCID_GBUFFER_DIR is not set: no reference";
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
            const auto without = errorOfWalk(r, shade(device(), r, method, false).light, truth);
            r.gain = 1;
            const auto own = errorOfWalk(r, shade(device(), r, method, false).light, truth);
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
