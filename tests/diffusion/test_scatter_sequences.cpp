// Objects keep memory, tables and levels from one picture to the next. Each picture of a sequence must
// equal, to the bit, what a new object makes of it. And the smallest pictures: single pixels, lines, two
// tiles.
#include <gtest/gtest.h>

#include <algorithm>

#include "device_lanes.h"
#include "diffusion/lit_ball.h"
#include "tolerances.h"

using namespace lit_ball;

namespace {

constexpr PelScattering screen = PEL_SCATTERING_SCREEN, separable = PEL_SCATTERING_SEPARABLE;

Profile gaussian(float sigma) {
    return Profile::gaussians({{sigma * sigma, {1, 0.6f, 0.3f}}, {0.04f * sigma * sigma, {0, 0.4f, 0.7f}}});
}

// Stripes over a plane, in squares of several ids.
Picture stripes(uint32_t width, uint32_t height, double period, uint32_t ids) {
    Picture p = plane(width, height, 0.2, [&](double x, double y) {
        const double light = std::fmod(x + 0.3 * y, period) < 0.5 * period ? 1 : 0.1;
        return Vec3{light, 0.8 * light, 0.5 * light};
    });
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) p.ids[p.at(x, y)] = uint8_t((x / 11 + y / 7) % ids + (ids < 3));
    return p;
}

struct Step {
    const char* name;
    Picture picture;
    Profile profile;
    float scale;
    bool weights = false;
};

std::vector<Step> steps() {
    Picture everywhere = stripes(60, 44, 3, 2);
    everywhere.params.everywhere = 1;
    Picture small = plane(48, 32, 0.2, [](double x, double) { return x < 4.8 ? Vec3{1, 1, 1} : Vec3{}; });
    return {{"stripes by a wide profile", stripes(160, 96, 9, 1), gaussian(3), 1},
            {"an edge by a narrow one",
             plane(160, 96, 0.2,
                   [](double x, double) {
                       return x < 15.9 ? Vec3{1, 0.5, 0.25} : Vec3{0.3, 0.3, 0.3};
                   }),
             gaussian(0.1f), 1},
            {"other ids", stripes(160, 96, 5, 4), gaussian(1), 1},
            {"a smaller picture", small, gaussian(1), 1},
            // As many bytes in every level, but other widths.
            {"another shape of the same size", stripes(33, 32, 2, 1), gaussian(1), 1},
            {"the shape before", small, gaussian(1), 1},
            {"another scale", small, gaussian(1), 0.3f},
            {"weights", small, gaussian(1), 0.3f, true},
            {"every tile", everywhere, gaussian(0.4f), 2},
            {"another profile", stripes(60, 44, 3, 2), Profile::skin(), 1},
            {"a ball", ball(50, 10, 0.42, normalized(Vec3{1, 0.3, 0.2})), Profile::skin(), 1}};
}

std::vector<float> scatter(Scatter& object, const Step& step, const PelScatterControls& controls) {
    const Picture& p = step.picture;
    for (uint32_t id : {1u, 2u, 3u}) {
        object.setMaterial(id, id < 3 ? step.profile : Profile(), step.scale);
        if (id < 3) object.setControls(id, controls);
    }
    std::vector<float> weights(p.pixels());
    for (size_t i = 0; i < weights.size(); ++i) weights[i] = float(i % 5) / 4;
    const Buffer e(device(), p.irradiance), x(device(), p.positions), i(device(), p.ids),
        w(device(), weights), out(device(), std::vector<float>(p.irradiance.size(), -7.0f));
    const auto image = [&](const Buffer& b, PelFormat format) {
        return pellucid::imageDesc(b, format, p.width, p.height);
    };
    const PelImageDesc positions = image(x, PEL_FORMAT_RGB32F), ids = image(i, PEL_FORMAT_R8_UINT);
    object.clear(PEL_SLOT_SCATTER_WEIGHT);
    if (step.weights) object.set(PEL_SLOT_SCATTER_WEIGHT, image(w, PEL_FORMAT_R32F));
    object.execute(p.params, image(e, PEL_FORMAT_RGB32F), &positions, nullptr, &ids,
                   image(out, PEL_FORMAT_RGB32F));
    return out.readAll<float>();
}

// How many values differ, and by how much.
void expectSame(const std::vector<float>& now, const std::vector<float>& expected, const std::string& where) {
    ASSERT_EQ(now.size(), expected.size()) << where;
    size_t count = 0, first = 0;
    float largest = 0;
    for (size_t i = 0; i < now.size(); ++i) {
        if (!std::memcmp(&now[i], &expected[i], sizeof(float))) continue;
        if (!count++) first = i;
        largest = std::max(largest, std::abs(now[i] - expected[i]));
    }
    EXPECT_EQ(count, 0u) << where << ": first at value " << first << ", by up to " << largest;
}

}  // namespace

TEST(ScatterSequences, EachPictureEqualsThatOfANewObject) {
    for (const auto& [method, taps] : {std::pair{screen, 0u}, {screen, 16u}, {separable, 9u}}) {
        PelScatterControls controls = pelScatterControlsDefaults();
        controls.scattering = method;
        controls.scatterTaps = taps;
        Scatter kept(device());
        for (const Step& step : steps()) {
            Scatter fresh(device());
            const std::vector<float> expected = scatter(fresh, step, controls);
            expectSame(scatter(kept, step, controls), expected,
                       "method " + std::to_string(int(method)) + ", " + std::to_string(taps) +
                           " taps: " + step.name);
            EXPECT_NE(expected, step.picture.irradiance) << step.name;
        }
    }
}

// The shader, with methods, lights, maps and materials that follow one another.
TEST(ScatterSequences, EachFrameEqualsThatOfANewShader) {
    constexpr PelScattering methods[] = {PEL_SCATTERING_AUTO, PEL_SCATTERING_LIGHT, screen,
                                         separable,           PEL_SCATTERING_LIGHT, PEL_SCATTERING_AUTO};
    const Vec3 side = normalized(Vec3{0.8, 0.2, 0.1}), behind = normalized(Vec3{-0.5, 0.1, -0.8});
    const LitBall one = makeBall(Form::parallel, side, 128), two = makeBall(Form::parallel, behind, 128);
    LitBall wide = two;  // 48 x 32 texels and 33 x 32 take the same memory
    wide.width = 48, wide.height = 32, wide.maps[0].resize(48 * 32);
    LitBall narrow = one;
    narrow.width = 33, narrow.height = 32, narrow.maps[0].resize(33 * 32);
    const std::vector<std::vector<LitBall>> lights{
        {one}, {two}, {one, two}, {wide}, {narrow}, {makeBall(Form::cascades, side, 64)}, {two}};
    ShownImages kept(device(), 40, 40);
    size_t frame = 0;
    for (PelScattering method : methods)
        for (const std::vector<LitBall>& lit : lights) {
            const Profile profile = frame % 3 ? Profile::skin() : gaussian(0.5f);
            const Request request{method, frame % 2 ? 0.0f : 0.6f};
            Picture p = pictureOf(lit, 40);
            if (frame % 4 == 3)
                for (size_t i = 0; i < p.pixels(); ++i) p.ids[i] = i % 40 < 20 ? p.ids[i] : 0;
            ShownImages fresh(device(), 40, 40);
            std::vector<float> now = show(kept, p, lit, profile, request).light;
            for (size_t i = 0; i < p.pixels(); ++i)  // a shader leaves what has no material as it is
                if (!p.ids[i]) std::fill_n(&now[3 * i], 3, 0.0f);
            expectSame(now, show(fresh, p, lit, profile, request).light,
                       "frame " + std::to_string(frame) + ", method " + std::to_string(int(method)));
            ++frame;
        }
}

// What a device computes does not depend on how many lanes it computes at a time.
TEST(ScatterSequences, WidthsAgree) {
    const Vec3 toLight = normalized(Vec3{0.9, 0.2, -0.1});
    for (Form form : {Form::parallel, Form::perspective})
        for (PelScattering method : {PEL_SCATTERING_LIGHT, PEL_SCATTERING_AUTO}) {
            const LitBall lit = makeBall(form, toLight, sized(512u, 64u));
            const Picture p = pictureOf(lit, sized(96u, 24u));
            std::vector<float> before;
            for (int lanes : {1, 8, 16}) {
                ShownImages shown(lanes::deviceOf(lanes), p.width, p.height);
                const std::vector<float> now = show(shown, p, {lit}, Profile::skin(), {method, 0.3f}).light;
                // By auto, pixels of one vector are left out together.
                const double most =
                    method == PEL_SCATTERING_LIGHT
                        ? double(tolerance::widthsAgree)
                        : tolerance::scatterLeftOut * double(pelShaderOptionsDefaults().targetError);
                for (size_t i = 0; i < before.size(); ++i)
                    ASSERT_NEAR(now[i], before[i], most)
                        << lanes << " lanes, method " << int(method) << ", value " << i;
                before = now;
            }
        }
}

TEST(SmallPictures, LinesScatterAlongThemselves) {
    const auto light = [](double x, double y) { return x + y < 6 ? Vec3{1, 1, 1} : Vec3{}; };
    for (const auto& [method, taps] : {std::pair{screen, 0u}, {screen, 64u}, {separable, 25u}}) {
        PelScatterControls controls = pelScatterControlsDefaults();
        controls.scattering = method;
        controls.scatterTaps = taps;
        std::vector<float> lines[2];
        for (int k = 0; k < 2; ++k) {
            Scatter object(device());
            Picture p = k ? plane(1, 64, 0.2, light) : plane(64, 1, 0.2, light);
            p.params.everywhere = 1;
            lines[k] = scatter(object, {"", p, gaussian(1), 1}, controls);
            const size_t edge = 3 * 29;
            EXPECT_GT(lines[k][edge + 3], 0.02f) << int(method) << " " << k;
            EXPECT_LT(lines[k][edge - 3], 0.98f) << int(method) << " " << k;
        }
        if (taps == 64) continue;  // a disk is turned from pixel to pixel
        for (size_t i = 0; i < lines[0].size(); ++i)
            EXPECT_NEAR(lines[0][i], lines[1][i], 1e-5) << int(method) << ", " << i;
    }
}

TEST(SmallPictures, ASinglePixelKeepsItsLight) {
    for (const auto& [method, taps] : {std::pair{screen, 0u}, {screen, 16u}, {separable, 9u}}) {
        PelScatterControls controls = pelScatterControlsDefaults();
        controls.scattering = method;
        controls.scatterTaps = taps;
        Picture p(20, 20);
        p.set(p.at(7, 9), {1, 2, 3}, {0.5, 0.25, 0.125});
        Scatter object(device());
        EXPECT_EQ(scatter(object, {"", p, gaussian(1), 1}, controls), p.irradiance) << int(method);
    }
}

// Tiles are chosen alike from all sides: pixels lie close together in one tile of two and far apart in the
// other, and the picture is mirrored and transposed. Contrasts pass the bound, so that tiles begin to
// scatter on the way.
TEST(SmallPictures, TwoTilesAreChosenAlikeFromEverySide) {
    uint64_t tapped[3] = {};
    const int contrasts = 60;
    for (int k = 0; k < contrasts; ++k)
        for (int way = 0; way < 3; ++way) {
            Picture p = way < 2 ? Picture(32, 16) : Picture(16, 32);
            for (uint32_t i = 0; i < 32; ++i)
                for (uint32_t j = 0; j < 16; ++j) {
                    const double size = i < 16 ? 2 : 0.25, x = i < 16 ? 2.0 * i : 30 + 0.25 * (i - 15);
                    const double e = 0.5 + 1e-4 * std::pow(1.1, k) * (i % 8 < 4 ? 1 : -1);
                    const uint32_t column = way == 0 ? i : way == 1 ? 31 - i : j, row = way < 2 ? j : i;
                    p.set(p.at(column, row), {x, size * j, 0}, {e, e, e});
                }
            const Result result = run(p, gaussian(1.5f));
            tapped[way] += result.stats.tilesTapped;
        }
    EXPECT_GT(tapped[0], 0u);
    EXPECT_LT(tapped[0], 2u * contrasts);
    EXPECT_EQ(tapped[1], tapped[0]) << "mirrored";
    EXPECT_EQ(tapped[2], tapped[0]) << "transposed";
}

// Finite values whose sums overflow are treated as NaN and Inf are: the pixel keeps its value, and is
// counted.
TEST(SmallPictures, LightTooLargeToSumStaysWhereItIs) {
    for (const auto& [method, taps] : {std::pair{screen, 0u}, {screen, 16u}, {separable, 9u}}) {
        PelScatterControls controls = pelScatterControlsDefaults();
        controls.scattering = method;
        controls.scatterTaps = taps;
        Picture p = plane(40, 40, 0.2, [](double x, double) { return x < 4 ? Vec3{1, 1, 1} : Vec3{}; });
        const size_t bright = p.at(19, 21);
        p.irradiance[3 * bright + 1] = 3e38f;
        Scatter object(device());
        const std::vector<float> result = scatter(object, {"", p, gaussian(1), 1}, controls);
        EXPECT_EQ(object.stats().pixelsInvalid, 1u) << int(method);
        for (size_t i = 0; i < result.size(); ++i)
            ASSERT_TRUE(i == 3 * bright + 1 ? result[i] == 3e38f : result[i] >= 0 && result[i] < 1.001f)
                << int(method) << ", value " << i << ": " << result[i];
    }
}
