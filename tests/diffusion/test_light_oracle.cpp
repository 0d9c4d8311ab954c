// Light scattered from shadow maps: the kernels' pyramids against the sum over every texel and every pixel,
// for every form of map, and several lights at a time.
#include <gtest/gtest.h>

#include <cmath>

#include "diffusion/lit_ball.h"
#include "reference/diffusion_light.h"
#include "tolerances.h"

using namespace lit_ball;

namespace {

reference::Matrix4 matrixOf(const float* rows) {
    reference::Matrix4 m;
    for (size_t r = 0; r < 4; ++r)
        for (size_t c = 0; c < 4; ++c) m[r][c] = rows[4 * r + c];
    return m;
}

// What a caller's texel says: its depth, NaN where it shows nothing.
double depthOf(const LitBall& ball, float value) {
    const double z = ball.light.shadowContent == PEL_SHADOW_CONTENT_EXPONENTIAL
                         ? std::log(double(value)) / ball.light.shadowExponent
                         : value;
    return z > 0 && z < 1 - 1e-6 ? z : std::nan("");
}

reference::MappedLight exactLight(const LitBall& ball) {
    const PelLight& l = ball.light;
    reference::MappedLight light;
    for (int k = 0; k < 3; ++k) light.color[k] = l.color[k];
    light.directional = l.type == PEL_LIGHT_DIRECTIONAL;
    light.toLight = ball.toLight;
    light.position = ball.position;
    light.spot = l.type == PEL_LIGHT_SPOT;
    light.spotDirection = -1 * ball.toLight;
    light.cosInner = l.spotCosInner, light.cosOuter = l.spotCosOuter;
    const bool cube = l.shadowProjection == PEL_SHADOW_CUBE || l.shadowProjection == PEL_SHADOW_CUBE_RADIAL;
    const size_t texels = size_t(ball.width) * ball.width;
    for (size_t k = 0; k < (cube ? 6 : ball.maps.size()); ++k) {
        reference::LightDepths map;
        map.width = map.height = int(ball.width);
        const std::vector<float>& values = ball.maps[cube ? 0 : k];
        for (size_t i = 0; i < texels; ++i)
            map.depth.push_back(depthOf(ball, values[((cube ? k * texels : 0) + i) * ball.components]));
        map.worldToShadow = matrixOf(k == 0 || cube ? l.worldToShadow : l.cascadeToShadow[k - 1]);
        map.face = cube ? int(k) : -1;
        map.radial = l.shadowProjection == PEL_SHADOW_CUBE_RADIAL;
        map.decoding = {l.shadowProjection == PEL_SHADOW_CUBE, l.shadowDepthRange, l.shadowDepthA,
                        l.shadowDepthB};
        light.maps.push_back(map);
    }
    return light;
}

struct Difference {
    double rms = 0, most = 0, mean = 0;  // over the root of the mean square, or the mean, of the truth
};
template <class Take>
Difference difference(const Picture& p, const std::vector<float>& a, const Take& exact) {
    Difference d;
    double whole = 0, sum = 0, squares = 0;
    for (size_t i = 0; i < p.pixels(); ++i) {
        if (!p.ids[i]) continue;
        for (int c = 0; c < 3; ++c) {
            const double e = a[3 * i + c] - exact(i, c);
            squares += e * e, whole += exact(i, c) * exact(i, c);
            d.most = std::max(d.most, std::abs(e));
            d.mean += e, sum += exact(i, c);
        }
    }
    d.rms = std::sqrt(squares / whole);
    d.mean /= sum;
    return d;
}

struct Case {
    const char* name;
    Profile profile;
    reference::ProfilePtr exact;
    double most;  // relative, RMS
};
// Far wider than the ball, so that only flux counts; as wide as it, so that places count; and skin, whose
// narrow Gaussians have tails.
std::vector<Case> cases() {
    return {{"flux", Profile::gaussians({{900, {1, 1, 1}}}), reference::gaussiansProfile({{900, {1, 1, 1}}}),
             tolerance::lightFlux},
            {"wide", Profile::gaussians({{4, {1, 0.8f, 0.6f}}, {1.5f, {0, 0.2f, 0.4f}}}),
             reference::gaussiansProfile({{4, {1, 0.8, 0.6}}, {1.5, {0, 0.2, 0.4}}}), tolerance::lightPlaces},
            {"skin", Profile::skin(), reference::skinProfile(), tolerance::lightTails}};
}

std::vector<LitBall> lightsFrom(std::initializer_list<Vec3> directions, uint32_t mapSide) {
    std::vector<LitBall> lights;
    for (Vec3 d : directions) lights.push_back(makeBall(Form::parallel, normalized(d), mapSide));
    return lights;
}

}  // namespace

TEST(LightOracle, EveryFormOfMapIsTheSumOverItsTexels) {
    const uint32_t side = sized(24u, 10u), mapSide = sized(128u, 48u);
    for (Form form : forms)
        for (const Case& c : cases()) {
            const bool cube = form == Form::cube || form == Form::radial;  // a face is 90 degrees wide
            const LitBall ball =
                makeBall(form, normalized(Vec3{0.7, 0.2, -0.5}), cube ? 2 * mapSide : mapSide);
            const Picture p = pictureOf(ball, side);
            const auto truth = reference::scatterFromLights(p.exact(), {exactLight(ball)}, *c.exact);
            const Lit lit = shaded(p, std::vector{ball}, c.profile, {PEL_SCATTERING_LIGHT, 0, 0});
            const Difference d = difference(p, lit.light, [&](size_t i, int k) { return truth[i][k]; });
            std::printf("form %d, %s: rms %.4f, most %.4f, mean %+.4f\n", int(form), c.name, d.rms, d.most,
                        d.mean);
            EXPECT_LT(d.rms, c.most) << "form " << int(form) << ", " << c.name;
        }
}

// Lights along the axes have maps whose matrices are full of zeros.
TEST(LightOracle, LightsAlongAnAxis) {
    const uint32_t side = sized(20u, 10u), mapSide = sized(64u, 48u);
    const Case c = cases()[1];
    for (Form form : {Form::parallel, Form::perspective, Form::cube})
        for (Vec3 toLight : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}}) {
            const LitBall ball = makeBall(form, toLight, form == Form::cube ? 2 * mapSide : mapSide);
            const Picture p = pictureOf(ball, side);
            const auto truth = reference::scatterFromLights(p.exact(), {exactLight(ball)}, *c.exact);
            const Lit lit = shaded(p, std::vector{ball}, c.profile, {PEL_SCATTERING_LIGHT, 0, 0});
            const Difference d = difference(p, lit.light, [&](size_t i, int k) { return truth[i][k]; });
            EXPECT_LT(d.rms, c.most) << "form " << int(form) << ", " << toLight.x << ' ' << toLight.z;
        }
}

// A parallel light, a spot with its map and a cube at a time, each of its own colour.
TEST(LightOracle, SeveralLightsAreTheSumOverAllTheirTexels) {
    const uint32_t side = sized(24u, 10u), mapSide = sized(128u, 48u);
    std::vector<LitBall> lights = lightsFrom({{0.7, 0.2, -0.5}, {-0.6, 0.5, -0.2}}, mapSide);
    lights.push_back(makeBall(Form::spot, normalized(Vec3{-0.2, -0.6, 0.5}), mapSide));
    for (const Case& c : cases()) {
        const Picture p = pictureOf(lights, side);
        std::vector<reference::MappedLight> exact;
        for (const LitBall& light : lights) exact.push_back(exactLight(light));
        const auto truth = reference::scatterFromLights(p.exact(), exact, *c.exact);
        const Lit lit = shaded(p, lights, c.profile, {PEL_SCATTERING_LIGHT, 0, 0});
        const Difference d = difference(p, lit.light, [&](size_t i, int k) { return truth[i][k]; });
        std::printf("three lights, %s: rms %.4f, most %.4f, mean %+.4f\n", c.name, d.rms, d.most, d.mean);
        EXPECT_LT(d.rms, c.most) << c.name;
    }
}

// One light in two halves is one light, also behind one that is switched off.
TEST(LightOracle, TwoHalvesOfALightAreTheWhole) {
    const uint32_t side = sized(48u, 16u);
    const std::vector<LitBall> whole = lightsFrom({{0.7, 0.2, -0.5}}, sized(128u, 48u));
    std::vector<LitBall> halves(2, whole[0]);
    for (LitBall& half : halves) std::fill_n(half.light.color, 3, 0.5f);
    halves.insert(halves.begin(), whole[0]);
    std::fill_n(halves[0].light.color, 3, 0.0f);
    const Picture p = pictureOf(whole, side);
    for (PelScattering method : {PEL_SCATTERING_LIGHT, PEL_SCATTERING_AUTO}) {
        const Lit one = shaded(p, whole, Profile::skin(), {method, 0.4f, 0}),
                  two = shaded(p, halves, Profile::skin(), {method, 0.4f, 0});
        for (size_t i = 0; i < one.light.size(); ++i)
            ASSERT_NEAR(two.light[i], one.light[i], tolerance::lightHalves) << int(method) << " " << i;
    }
}

// Light adds up: what two lights scatter is what each of them scatters alone.
TEST(LightOracle, TwoLightsAreTheSumOfEachAlone) {
    const uint32_t side = sized(64u, 20u);
    const std::vector<LitBall> both = lightsFrom({{0.7, 0.2, -0.5}, {-0.6, 0.5, -0.4}}, sized(192u, 64u));
    const std::vector<LitBall> first{both[0]}, second{both[1]};
    for (const float width : {0.4f, 2.7f})
        for (PelScattering method : {PEL_SCATTERING_LIGHT, PEL_SCATTERING_AUTO}) {
            const Profile skin = Profile::skin();
            const Lit a = shaded(pictureOf(first, side), first, skin, {method, width, 0}),
                      b = shaded(pictureOf(second, side), second, skin, {method, width, 0});
            const Picture p = pictureOf(both, side);
            const Lit sum = shaded(p, both, skin, {method, width, 0});
            const Difference d = difference(p, sum.light, [&](size_t i, int c) {
                return double(a.light[3 * i + size_t(c)]) + b.light[3 * i + size_t(c)];
            });
            std::printf("method %d, radius %g: rms %.4f, most %.4f, mean %+.4f\n", int(method), double(width),
                        d.rms, d.most, d.mean);
            // A small picture has too few tiles to choose the same ones for two lights as for each.
            if (!testsAreSmall() || method == PEL_SCATTERING_LIGHT) {
                EXPECT_LT(d.rms, tolerance::lightsAddUp) << int(method) << ", radius " << width;
            }
        }
}
