// Light scattered from shadow maps: the kernels' pyramids against the sum over every texel and every pixel,
// for every form of map and several lights at a time; light that comes through a ball and a thin strip,
// against the surface integral; and what must hold for any input.
#include "diffusion/lit_ball.h"
#include "reference/diffusion_light.h"
#include "reference/random_walk.h"
#include "test.h"

using namespace lit_ball;

namespace {

reference::MappedLight exactLight(const LitBall& ball) {
    const PelLight& l = ball.light;
    reference::MappedLight light;
    light.color = {l.color[0], l.color[1], l.color[2]};
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
        for (size_t i = 0; i < texels; ++i) {
            const float value = ball.maps[cube ? 0 : k][((cube ? k * texels : 0) + i) * ball.components];
            const double z = l.shadowContent == PEL_SHADOW_CONTENT_EXPONENTIAL
                                 ? std::log(double(value)) / l.shadowExponent
                                 : value;
            map.depth.push_back(z > 0 && z < 1 - 1e-6 ? z : std::nan(""));
        }
        const float* rows = k == 0 || cube ? l.worldToShadow : l.cascadeToShadow[k - 1];
        for (size_t i = 0; i < 16; ++i) map.worldToShadow[i / 4][i % 4] = rows[i];
        map.face = cube ? int(k) : -1;
        map.radial = l.shadowProjection == PEL_SHADOW_CUBE_RADIAL;
        map.decoding = {l.shadowProjection == PEL_SHADOW_CUBE, l.shadowDepthRange, l.shadowDepthA,
                        l.shadowDepthB};
        light.maps.push_back(map);
    }
    return light;
}

// Along +z, over `extent` mm and from 20 mm below the plane z = 0.
LitBall lampFromBehind(double extent) {
    LitBall lamp;
    lamp.width = lamp.height = sized(256u, 128u);
    lamp.light.toLight[0] = lamp.light.toLight[1] = 0, lamp.light.toLight[2] = -1;
    lamp.light.shadowDepthRange = 20;
    setRow(lamp.light.worldToShadow, 0, {1 / extent, 0, 0}, 0.5);
    setRow(lamp.light.worldToShadow, 1, {0, -1 / extent, 0}, 0.5);
    setRow(lamp.light.worldToShadow, 2, {0, 0, 0.05}, 1);
    setRow(lamp.light.worldToShadow, 3, {}, 1);
    return lamp;
}

// The sheet in front of a lamp from behind: pixels of 0.1 mm round the origin.
Frame sheet(uint32_t side, PelScattering method) {
    Frame f(plane(side, side, 0.1, [](double, double) { return Vec3{}; }), method);
    for (size_t i = 0; i < f.picture.positions.size(); ++i)
        if (i % 3 < 2) f.picture.positions[i] -= 0.05f * float(side);
    f.options.targetError = 0;
    return f;
}

// Irradiance of a ball over its lit part, by midpoints in the angles round the light. `directed`: of the
// factor for the way through the ball, 1 + directed t with t the cosine to the inward normal.
reference::Rgb surfaceIntegral(const LitBall& ball, const reference::Profile& profile, Vec3 at, int steps,
                               double directed) {
    const Vec3 right = normalized(cross(Vec3{0, 1, 0}, ball.toLight)), up = cross(ball.toLight, right);
    reference::Rgb sum;
    for (int j = 0; j < steps; ++j)
        for (int i = 0; i < 2 * steps; ++i) {
            const double z = (j + 0.5) / steps, turn = std::numbers::pi * (i + 0.5) / steps,
                         s = std::sqrt(1 - z * z);
            const Vec3 y =
                radius * (z * ball.toLight + (s * std::cos(turn)) * right + (s * std::sin(turn)) * up);
            const double e = ball.irradiance(y), area = radius * radius / steps * std::numbers::pi / steps,
                         way = 1 + directed * length(at - y) / (2 * radius);
            if (e > 0) sum = sum + (e * area * way) * profile.radial(length(at - y));
        }
    return sum;
}

}  // namespace

// Every form of map; three lights at a time, each with its own colour; and lights along the axes, whose
// matrices are full of zeros.
TEST(LightSpace, IsTheSumOverAllTexelsOfAllLights) {
    const uint32_t mapSide = sized(96u, 48u);
    std::vector<std::vector<LitBall>> scenes;
    const Vec3 from{0.7, 0.2, -0.5};
    for (Form form : forms) scenes.push_back({evenBall(form, from, mapSide)});
    scenes.push_back({makeBall(Form::parallel, from, mapSide),
                      makeBall(Form::parallel, {-0.6, 0.5, -0.2}, mapSide),
                      makeBall(Form::spot, {-0.2, -0.6, 0.5}, mapSide)});
    const size_t firstAxis = scenes.size();
    for (Form form : {Form::parallel, Form::perspective, Form::cube})
        for (Vec3 axis : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}})
            scenes.push_back({evenBall(form, axis, sized(64u, 48u))});
    // Far wider than the ball, so that only flux counts; as wide as it, so that places count; and skin, whose
    // narrow Gaussians have tails.
    const struct {
        const char* name;
        Profile profile;
        reference::ProfilePtr exact;
        double most;  // relative, RMS
    } cases[] = {
        {"flux", Profile::gaussians({{900, {1, 1, 1}}}), reference::gaussiansProfile({{900, {1, 1, 1}}}),
         tolerance::lightFlux},
        {"wide", Profile::gaussians({{4, {1, 0.8f, 0.6f}}, {1.5f, {0, 0.2f, 0.4f}}}),
         reference::gaussiansProfile({{4, {1, 0.8, 0.6}}, {1.5, {0, 0.2, 0.4}}}), tolerance::lightPlaces},
        {"skin", Profile::skin(), reference::skinProfile(), tolerance::lightTails}};
    for (size_t k = 0; k < scenes.size(); ++k) {
        std::vector<reference::MappedLight> exact;
        for (const LitBall& light : scenes[k]) exact.push_back(exactLight(light));
        for (const auto& c : cases) {
            if (k >= firstAxis && c.profile.get() != cases[1].profile.get()) continue;
            Frame f = frameOf(scenes[k], sized(16u, 10u), byLight, 0, c.profile);
            f.options.targetError = 0;
            const auto truth = reference::scatterFromLights(f.picture.exact(), exact, *c.exact);
            EXPECT_LT(difference(f.picture, f.shade().light, truth).relative, c.most)
                << "scene " << k << ", " << c.name;
        }
    }
}

// Only texels within the profile's reach of scattering pixels become lit surface; if no pixel scatters, none
// do.
TEST(LightSpace, OnlyTexelsWithinReachAreMade) {
    constexpr uint32_t mapSide = 384;
    const Profile profile = Profile::gaussians({{0.002f, {1, 0.8f, 0.6f}}});
    constexpr uint32_t side = 48;
    for (const auto& [method, form] : {std::pair{byLight, Form::parallel}, {byAuto, Form::perspective}}) {
        const LitBall light = makeBall(form, {0.7, 0.2, 0.5}, mapSide);
        Frame whole = frameOf({light}, side, method, 0, profile);
        whole.options.targetError = 0;
        const uint64_t all = whole.shade().stats.texelsReached;
        EXPECT_GT(all, mapSide * mapSide / 5);  // auto takes texels together
        EXPECT_LE(all, mapSide * mapSide);
        ShownImages images(device(), 1, 1);
        const auto patch = [&](uint32_t left) {
            Frame f = whole;
            for (size_t i = 0; i < f.picture.pixels(); ++i)
                if (i % side < left || i % side >= left + 3 || i / side < side / 2 ||
                    i / side >= side / 2 + 3)
                    f.picture.ids[i] = 0;
            return f.shade(images).stats.texelsReached;
        };
        for (uint32_t left = 6; left < side - 8; left += 6) {
            const uint64_t reached = patch(left);
            EXPECT_GT(reached, 0u) << left;
            EXPECT_LT(reached, all / 2) << left;
        }
        EXPECT_EQ(patch(side), 0u);
    }
}

// These texels suffice: further pixels on all sides, for which more of the map is used, change no bit.
TEST(LightSpace, TexelsBeyondReachDoNotCount) {
    constexpr uint32_t side = 48, middle = side / 2, row = middle + 1;  // of three pixels
    const LitBall ball = makeBall(Form::parallel, {0.7, 0.2, 0.5}, sized(768u, 192u));
    // The second: of the radius, by pixel.
    for (const auto& [sigma, factor] : {std::pair{0.05f, 1.0f}, {0.4f, 1.0f}, {0.1f, 4.0f}}) {
        const Profile profile = Profile::gaussians({{sigma * sigma, {1, 0.8f, 0.6f}}});
        std::vector<float> patches[2];  // alone, and beside others
        for (const bool others : {false, true}) {
            Frame f = frameOf({ball}, side, byLight, 0, profile);
            f.options.targetError = 0;
            for (uint32_t i = 0; i < f.picture.pixels(); ++i) {
                const auto is = [&](uint32_t left, uint32_t top) {
                    return i % side - left < 3 && i / side == top;
                };
                const bool other = is(4, row) || is(side - 7, row) || is(middle, 5) || is(middle, side - 7);
                if (!is(middle, row) && !(others && other)) f.picture.ids[i] = 0;
                if (factor != 1)
                    for (const float w : {1.0f, factor}) f.images[PEL_SLOT_SCATTER_WEIGHT].push_back(w);
            }
            const std::vector<float> light = f.shade().light;
            const float* first = &light[3 * f.picture.at(middle, row)];
            patches[others].assign(first, first + 9);
        }
        EXPECT_EQ(patches[0], patches[1]) << "sigma " << sigma << ", factor " << factor;
        EXPECT_GT(patches[0][0], 0.01f);
    }
}

// Texels of a cascade that the border of a finer one crosses count by the part outside of it: light does not
// jump where that border passes their middles.
TEST(LightSpace, BordersOfCascadesShowNoSteps) {
    const uint32_t side = sized(96u, 32u);
    const auto lightAt = [&](double border) {  // mm from the axis
        LitBall ball = makeBall(Form::parallel, {0.3, 0.2, 1}, 40);
        const LitBall fine = ball;
        ball.maps.insert(ball.maps.begin(),
                         parallelMap(ball.light.worldToShadow, ball.toLight, 2 * border, 40, false));
        std::copy_n(fine.light.worldToShadow, 16, ball.light.cascadeToShadow[0]);
        ball.light.shadowCascades = 2;
        ball.light.cascadeDepthRange[0] = 20;
        return frameOf({ball}, side, byLight, 1.5f).shade().light;
    };
    // Of 5 / 40 mm: with their borders, their middles, and just before and after those.
    const std::vector<float> aligned = lightAt(1), before = lightAt(1.0624), after = lightAt(1.0626);
    for (size_t i = 0; i < aligned.size(); ++i) {
        ASSERT_NEAR(before[i], after[i], 0.002) << i;
        ASSERT_NEAR(before[i], aligned[i], 0.02) << i;
    }
}

// A profile that is narrower than a texel leaves light where it falls.
TEST(LightSpace, ANarrowProfileLeavesLightWhereItFalls) {
    const uint32_t side = sized(96u, 32u);
    for (const uint32_t mapSide : {16u, 64u}) {
        const LitBall ball = makeBall(Form::parallel, {0.3, 0.2, 1}, mapSide);
        const Picture p = pictureOf(ball, side);
        for (const float width : {0.03f, 0.06f, 0.12f, 0.24f}) {
            const std::vector<float> light = frameOf({ball}, side, byLight, width).shade().light;
            for (size_t i = 0; i < light.size(); ++i)
                if (p.ids[i / 3] && p.irradiance[i] > 0.6f) {
                    ASSERT_NEAR(light[i], p.irradiance[i], 0.05) << "map " << mapSide << ", radius " << width;
                }
        }
    }
}

// Texels of a surface that the camera sees as another object are left out, whether it scatters or not. No
// pixel is dark, because a dark pixel would mark nothing.
TEST(LightSpace, TexelsOfOtherObjectsDoNotCount) {
    constexpr uint32_t side = 32;
    // Single texels of a narrow profile, clusters of texels of a wide one.
    for (const float width : {0.4f, 2.7f}) {
        const auto lightBeside = [width](uint8_t other) {
            Frame f = frameOf({makeBall(Form::parallel, {0, 0, 1}, 128)}, side, byLight, width);
            f.options.targetError = 0;
            f.materials = 2;
            for (size_t i = 0; i < f.picture.pixels(); ++i)
                if (i % side >= side / 2 && f.picture.ids[i]) f.picture.ids[i] = other;
            std::vector<float> light = f.shade().light;
            for (size_t i = 0; i < light.size(); ++i)
                if (i / 3 % side >= side / 2) light[i] = 0;
            return light;
        };
        const auto beside = lightBeside(2), nothing = lightBeside(9), same = lightBeside(1);
        const Picture p = pictureOf(makeBall(Form::parallel, {0, 0, 1}, 16), side);
        EXPECT_LT(difference(p, beside, nothing).most, 0.01 * difference(p, same, nothing).most);
    }
}

// Light is additive: the result for two lights is the sum of the results for each alone.
TEST(LightSpace, TwoLightsAreTheSumOfEachAlone) {
    const uint32_t side = sized(64u, 20u);
    const std::vector<LitBall> both{makeBall(Form::parallel, {0.7, 0.2, -0.5}, sized(192u, 64u)),
                                    makeBall(Form::parallel, {-0.6, 0.5, -0.4}, sized(192u, 64u))};
    for (const float width : {0.4f, 2.7f})
        for (PelScattering method : {byLight, byAuto}) {
            const auto light = [&](const std::vector<LitBall>& lights) {
                Frame f = frameOf(lights, side, method, width);
                f.options.targetError = 0;
                return f.shade();
            };
            const Shown first = light({both[0]}), together = light(both);
            EXPECT_GT(together.stats.scatterTaps, first.stats.scatterTaps);
            std::vector<float> sum = first.light;
            std::ranges::transform(sum, light({both[1]}).light, sum.begin(), std::plus());
            const Difference d = difference(pictureOf(both, side), together.light, sum);
            // A small picture has too few tiles to choose the same ones for two lights as for each.
            if (!testsAreSmall() || method == byLight) {
                EXPECT_LT(d.relative, tolerance::lightsAddUp) << int(method) << ", radius " << width;
            }
        }
}

// Where the ball is dark, all light has come through it: every texel counts, and no pixel does. This also
// holds for a known medium: surface as deep as on a sphere of that curvature is not the far side of a slab.
TEST(LightSpace, ThroughABallIsTheSurfaceIntegralForEveryFormOfMap) {
    const float d = 0.8f, paths[] = {1.1f * d, 1.1f * d, 1.1f * d}, white[] = {0.8f, 0.8f, 0.8f};
    const Profile burley = Profile::burley(paths, white);
    const auto skin = reference::skinProfile(),
               medium = reference::burleyProfile({paths[0], paths[1], paths[2]}, {0.8, 0.8, 0.8});
    const Vec3 toLight = normalized(Vec3{0.3, 0.2, -1});
    std::vector<reference::Rgb> truths[3];  // of parallel light, of a point's, of parallel light in a medium
    for (size_t which = 0; which <= std::size(forms); ++which) {
        const bool known = which == std::size(forms);
        const Form form = known ? Form::parallel : forms[which];
        if (form == Form::spot) continue;  // a point's, but darker
        const LitBall ball = evenBall(form, toLight, sized(256u, 96u));
        const Picture p = pictureOf(ball, sized(24u, 16u));
        std::vector<size_t> dark;  // away from the lit rim
        for (size_t i = 0; i < p.pixels(); ++i)
            if (p.ids[i] && dot(p.place(i), toLight) < -0.25 * radius) dark.push_back(i);
        ASSERT_GT(dark.size(), 50u);
        std::vector<reference::Rgb>& truth = truths[known ? 2 : ball.point];
        // Section 12: the gain of a curved body, over what the factor makes of even light, 1.16 at most.
        const double directed = known ? 0.92 : 0, h = known ? 1.085 * d / radius : 0,
                     even = std::min(1 + directed / 2 * 2.5 * d / radius, 1.16),
                     gain = reference::curvatureGain(h, 1.087) / even;
        if (truth.empty())
            for (size_t i : dark)
                truth.push_back(gain *
                                surfaceIntegral(ball, known ? *medium : *skin, p.place(i), 48, directed));
        for (PelScattering method : {byLight, byAuto}) {
            Frame f = frameOf({ball}, p.width, method);
            ShownImages shown(device(), 1, 1);
            if (known) {
                f.profile = burley;
                f.material.curvatureGain = 1;
                f.images[PEL_SLOT_MEAN_CURVATURE].assign(p.pixels(), float(1 / radius));
                shown.shader.set(standingAt({0, 0, 60}));
            }
            const std::vector<float> light = f.shade(shown).light;
            double square = 0, whole = 0;
            for (size_t k = 0; k < dark.size(); ++k)
                square += std::pow(light[3 * dark[k]] - truth[k].x, 2), whole += truth[k].x * truth[k].x;
            EXPECT_GT(std::sqrt(whole / double(dark.size())), 0.03);
            EXPECT_LT(std::sqrt(square / whole),
                      method == byLight ? tolerance::lightThroughBall : tolerance::hiddenThroughBall)
                << "form " << int(form) << ", method " << int(method);
        }
    }
}

// A thin strip that is lit from behind, in front of a bright and distant surface: light comes through it,
// also where most pixels of a tile show the background.
TEST(LightSpace, LightComesThroughAStripInEveryTile) {
    constexpr double pixel = 0.25, halfWidth = 1, thickness = 0.8, extent = 16;  // mm
    const uint32_t side = sized(64u, 32u);
    const auto exact = reference::skinProfile();
    LitBall lamp = lampFromBehind(extent);  // its map shows the strip's back
    lamp.maps = {texelsOf(lamp.width, [&](double s, double, int) {
        return std::abs(s * extent / 2) < halfWidth ? 1 - 0.05 * thickness : 1;
    })};
    // The transmitted light at x: the sum over the strip's back, infinitely long.
    const auto through = [&](double x) {
        constexpr double step = 0.05, far = 12;
        reference::Rgb sum;
        for (double u = -halfWidth + step / 2; u < halfWidth; u += step)
            for (double v = step / 2; v < far; v += step)
                sum = sum + 2 * step * step * exact->radial(std::hypot(u - x, v, thickness));
        return sum;
    };
    for (double shift : {0.0, 1.0, 1.75, -1.5}) {  // over the borders of tiles
        Picture p(side, side);
        for (size_t i = 0; i < p.pixels(); ++i) {
            const double u = (double(i % side) + 0.5 - 0.5 * side) * pixel - shift,
                         v = (0.5 * side - double(i / side) - 0.5) * pixel;
            const bool strip = std::abs(u) < halfWidth;
            p.set(i, {u, v, strip ? 0.0 : -50.0}, strip ? Vec3{} : Vec3{1, 1, 1});
        }
        Frame f(p, byAuto, radius);
        f.lamps = {lamp};
        const Shown lit = f.shade();
        EXPECT_GT(lit.stats.tilesByScattering[byLight], 0u);
        EXPECT_LT(lit.stats.tilesByScattering[byLight], side * side / 256u);
        for (size_t i = side / 4 * side; i < size_t(3) * side / 4 * side; ++i) {
            if (p.irradiance[3 * i] > 0) continue;
            const reference::Rgb truth = through(p.positions[3 * i]);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(lit.light[3 * i + size_t(c)], truth[c],
                            tolerance::throughSheet * truth[0] + tolerance::neverWorse)
                    << "pixel " << i % side << " " << i / side << ", channel " << c << ", shift " << shift;
        }
    }
}

// A slab that is lit from behind, all of it or a disk as wide as it is thick: where the medium is known, as
// much comes through as a random walk has.
TEST(LightSpace, SlabsLetThroughWhatRandomWalksDo) {
    constexpr double d = 0.3, path = 1.085 * d, extent = 24;  // mm
    const uint32_t side = sized(48u, 24u);
    const float paths[] = {1.1f * d, 1.1f * d, 1.1f * d}, white[] = {0.8f, 0.8f, 0.8f};
    LitBall lamp = lampFromBehind(extent);
    for (double thickness : {0.3, 1.0, 4.0}) {
        const reference::WalkResult walked =
            reference::walkSlab({path, 0.99055}, thickness, 1, 1, sized(100000, 1000), 7);
        for (const int k : {0, 1, 2, 3}) {
            const PelScattering method = k % 2 ? byLight : byAuto;
            const bool disk = k / 2;
            if (disk && thickness < 1) continue;  // few texels
            const double truth = (disk ? walked.straight : walked.transmitted) / 0.8;
            lamp.maps = {texelsOf(lamp.width, [&](double s, double t, int) {
                return disk && std::hypot(s, t) * extent / 2 > thickness ? 1 : 1 - 0.05 * thickness;
            })};
            Frame f = sheet(side, method);
            f.profile = Profile::burley(paths, white);
            f.material.curvatureGain = 1;
            f.lamps = {lamp};
            ShownImages shown(device(), 1, 1);
            shown.shader.set(standingAt({0, 0, 60}));
            const auto middle = [&] { return f.shade(shown).light[3 * (side / 2 * side + side / 2)]; };
            const float light = middle();
            EXPECT_NEAR(light, truth,
                        testsAreSmall() ? 0.1 : tolerance::throughSlab + tolerance::throughSlabPart * truth)
                << thickness << " mm, method " << int(method) << ", disk " << disk;
            // Half of a profile twice as wide, by a radius per pixel; coarser blocks make the thinnest .06.
            f.material.diffusionRadius = 2 * f.profile.info().radius;
            for (size_t i = 0; i < f.picture.pixels(); ++i)
                for (const float weight : {1.0f, 0.5f}) f.images[PEL_SLOT_SCATTER_WEIGHT].push_back(weight);
            EXPECT_NEAR(middle(), light, 0.07 * truth)
                << thickness << " mm, method " << int(method) << ", disk " << disk;
        }
    }
}

// The lit side of a slab whose thickness the host gives: the light that does not leave on the far side. An
// unknown or infinite thickness changes nothing.
TEST(LightSpace, SlabsReflectWhatRandomWalksDo) {
    struct Kind {
        float albedo;          // of a half-space
        double single, paths;  // its medium: albedo of a scattering, mean free path over Burley's d
        double tolerated = tolerance::slabReflects;
    };
    constexpr Kind kinds[] = {{0.95f, 0.999505, 0.769, tolerance::brightSlabReflects},
                              {0.8f, 0.99059, 1.084},
                              {0.5f, 0.91171, 1.795, tolerance::darkSlabReflects},
                              {0.2f, 0.61335, 2.921, tolerance::darkSlabReflects}};
    constexpr float distance = 0.5f;  // mm
    const uint32_t side = 24, middle = 3 * (side / 2 * side + side / 2);
    const auto reflected = [](double single, double paths) {
        return reference::walkSlab({1, single}, paths, 1, 1, sized(60000, 1000), 7).reflected;
    };
    const auto sheetOf = [&](PelScattering method, const Kind& kind) {
        Frame f = sheet(side, method);
        f.giveIrradiance = false;
        const float path[] = {distance / 2, distance, 2 * distance};
        const float albedo[] = {kind.albedo, kind.albedo, kind.albedo};
        f.profile = Profile::burley(path, albedo, PEL_BURLEY_SEARCHLIGHT);
        f.material.curvatureGain = 1;
        f.lamps = {lampFromBehind(24)};
        f.lamps[0].light.toLight[2] = 1;  // from above, and 10 mm away
        setRow(f.lamps[0].light.worldToShadow, 2, {0, 0, -0.05}, 0.5);
        if (method == byLight)
            f.lamps[0].maps = {texelsOf(f.lamps[0].width, [](double, double, int) { return 0.5; })};
        return f;
    };
    const auto shade = [](Frame& f) {
        ShownImages shown(device(), 1, 1);
        shown.shader.set(standingAt({0, 0, 60}));
        return f.shade(shown).light;
    };
    constexpr PelScattering methods[] = {PEL_SCATTERING_SCREEN, PEL_SCATTERING_SEPARABLE, byAuto, byLight};
    for (const Kind& kind : kinds) {
        const double half = reflected(kind.single, INFINITY);
        EXPECT_NEAR(half, kind.albedo, testsAreSmall() ? 0.1 : 2 * tolerance::walkReflected);
        std::map<double, double> slabs;  // by the thickness in mean free paths
        for (const PelScattering method : methods) {
            Frame f = sheetOf(method, kind);
            const PelProfileInfo info = f.profile.info();
            const std::vector<float> endless = shade(f);
            for (float thickness : {0.1f, 1.0f, 10.0f}) {
                f.images[PEL_SLOT_THICKNESS].assign(f.picture.pixels(), thickness);
                const std::vector<float> light = shade(f);
                for (size_t c = 0; c < 3; ++c) {
                    const double paths = thickness * std::sqrt(7.0) / (kind.paths * info.width[c]);
                    if (!slabs.contains(paths)) slabs[paths] = reflected(kind.single, paths) / half;
                    EXPECT_NEAR(light[middle + c] / endless[middle + c], slabs[paths],
                                testsAreSmall() ? 0.1 : kind.tolerated)
                        << "albedo " << kind.albedo << ", " << paths << " mean free paths, method "
                        << int(method) << ", channel " << c;
                }
            }
        }
    }
    for (const PelScattering method : methods) {
        Frame f = sheetOf(method, kinds[1]);
        const std::vector<float> endless = shade(f);
        const auto lightOf = [&](float thickness) {
            f.images[PEL_SLOT_THICKNESS].assign(f.picture.pixels(), thickness);
            return shade(f);
        };
        for (float unknown : {0.0f, -1.0f, notANumber, infinity, 1e30f})
            EXPECT_EQ(lightOf(unknown), endless) << unknown << ", method " << int(method);
        f.material.curvatureGain = 0;
        EXPECT_EQ(lightOf(0.3f), endless) << "no medium, method " << int(method);
    }
    Frame behind = sheetOf(byLight, kinds[1]);  // what comes through does not change
    behind.lamps = {lampFromBehind(24)};
    behind.lamps[0].maps = {texelsOf(behind.lamps[0].width, [](double, double, int) { return 0.95; })};
    const std::vector<float> through = shade(behind);
    behind.images[PEL_SLOT_THICKNESS].assign(behind.picture.pixels(), 1);
    EXPECT_GT(through[middle], 0);
    EXPECT_EQ(shade(behind), through);
}

// Too thin for the share that stays to differ from 0 in single precision: dark, but lit.
TEST(LightSpace, TheThinnestSlabsAreLit) {
    const float path[] = {0.5f, 0.5f, 0.5f}, albedo[] = {0.8f, 0.8f, 0.8f};
    Frame f = frameOf({makeBall(Form::parallel, {1, 0, 0.5}, 96)}, 48, byAuto, 0,
                      Profile::burley(path, albedo, PEL_BURLEY_SEARCHLIGHT));
    f.giveIrradiance = false;
    f.material.curvatureGain = 1;
    const auto brightest = [&](float thickness) {
        f.images[PEL_SLOT_THICKNESS].assign(f.picture.pixels(), thickness);
        return std::ranges::max(f.shade().light);
    };
    EXPECT_NEAR(brightest(1e-12f), brightest(1e-5f), 0.01);
    EXPECT_GT(brightest(1e-12f), 0);
}

// A slab that is lit from behind as far as the point: half of the light of one that is lit beyond it, at each
// border of the map.
TEST(LightSpace, AllTexelsUpToABorderCount) {
    constexpr double extent = 24, thickness = 1;  // mm
    LitBall lamp = lampFromBehind(extent);
    lamp.maps = {texelsOf(lamp.width, [&](double, double, int) { return 1 - 0.05 * thickness; })};
    const auto at = [&](double u, double v) {
        constexpr uint32_t side = 17;
        Frame f = sheet(side, byAuto);
        f.lamps = {lamp};
        f.lamps[0].light.worldToShadow[3] = float(u);
        f.lamps[0].light.worldToShadow[7] = float(v);
        return f.shade().light[3 * (side / 2 * side + side / 2)];
    };
    const float whole = at(0.5, 0.5);
    EXPECT_GT(whole, 0.1f);
    for (const auto& [u, v] : {std::pair{0.0, 0.5}, {1.0, 0.5}, {0.5, 0.0}, {0.5, 1.0}})
        EXPECT_NEAR(at(u, v), whole / 2, tolerance::lightPlaces * whole) << u << ' ' << v;
}

// Texels that show three surfaces in turns, 2 mm before the sheet, and 2 and 6 mm behind it: nothing is lit
// in the air between, where the mean of two of them lies.
TEST(LightSpace, NothingIsLitBetweenSurfaces) {
    constexpr double variance = 1;  // mm^2
    LitBall lamp = lampFromBehind(24);
    setRow(lamp.light.worldToShadow, 2, {0, 0, 0.05}, 0.5);
    lamp.maps = {texelsOf(lamp.width, [&](double s, double t, int) {
        const int column = int((s + 1) / 2 * lamp.width), row = int((t + 1) / 2 * lamp.width);
        return 0.5 + 0.05 * (2 - 4 * ((column + 2 * row) % 3));
    })};
    const double exact = 2.0 / 3 * std::exp(-4 / (2 * variance));
    for (const PelScattering method : {byLight, byAuto}) {
        constexpr uint32_t side = 17;
        Frame f = sheet(side, method);
        f.profile = Profile::gaussians({{float(variance), {1, 1, 1}}});
        f.lamps = {lamp};
        const float light = f.shade().light[3 * (side / 2 * side + side / 2)];
        EXPECT_NEAR(light, exact, 0.8 * exact) << "method " << int(method);
    }
}

// Exchanging channels of lights and profile exchanges the channels of the result, to the bit.
TEST(LightSpace, ChannelsAreTreatedAlike) {
    for (const PelScattering method : {byLight, byAuto}) {
        Frame f = frameOf({makeBall(Form::parallel, {0.9, 0, -0.4}, sized(256u, 64u)),
                           makeBall(Form::perspective, {-0.8, 0.5, 0.2}, sized(256u, 64u))},
                          sized(96u, 24u), method);
        f.giveIrradiance = false;
        const auto shaded = [&](int first) {
            float distance[3];
            for (int c = 0; c < 3; ++c) {
                const int to = (c + first) % 3;
                f.lamps[0].light.color[to] = 0.2f + 0.4f * float(c);
                f.lamps[1].light.color[to] = 1 - 0.3f * float(c);
                distance[to] = 1.2f / float(1 + c);
            }
            f.profile = Profile::burleyDistance(distance);
            return f.shade().light;
        };
        const std::vector<float> as = shaded(0), turned = shaded(1);
        for (size_t k = 0; k < as.size(); ++k)
            ASSERT_EQ(turned[k / 3 * 3 + (k + 1) % 3], as[k]) << "method " << int(method) << ", " << k;
        EXPECT_GT(*std::ranges::max_element(as), 0.1f);
    }
}

// A camera that sees all that is lit needs no map.
TEST(LightSpace, TexelsThatTheCameraSeesCountOnce) {
    Frame f = frameOf({makeBall(Form::parallel, {0, 0, 1}, sized(256u, 64u))}, sized(96u, 24u), byAuto, 0.4f);
    const std::vector<float> with = f.shade().light;
    f.lamps[0].maps.clear();
    const std::vector<float> alone = f.shade().light;
    for (size_t i = 0; i < f.picture.pixels(); ++i)
        if (f.picture.ids[i] && f.picture.positions[3 * i + 2] > 0.3 * radius) {
            ASSERT_NEAR(with[3 * i], alone[3 * i], tolerance::lightSeenTwice) << i;
        }
}

// If a light has no map, the result is as by `screen`, with a warning. The same holds for more than 24 maps,
// counting each face of a cube.
TEST(LightSpace, WithoutAllMapsTheScreenDoes) {
    const auto said = [](const Shown& lit) {
        return lit.warnings.find("not all light comes from shadow maps") != std::string::npos;
    };
    Frame f = frameOf({makeBall(Form::parallel, {1, 0.2, 0.4}, 64)}, 40, byLight, 0.4f);
    f.lamps[0].maps.clear();
    const Shown light = f.shade();
    f.material.scattering = PEL_SCATTERING_SCREEN;
    const Shown screen = f.shade();
    EXPECT_EQ(light.light, screen.light);
    EXPECT_TRUE(said(light)) << light.warnings;
    EXPECT_FALSE(said(screen));
    const Vec3 toLight{0.3, 0.2, 1};
    std::vector<LitBall> lights;
    for (int cubes = 0; cubes <= 4; ++cubes) {
        EXPECT_EQ(said(frameOf(lights, 16, byLight).shade()), cubes == 0) << cubes;
        lights.push_back(makeBall(Form::cube, toLight, 8));
    }
    lights.back() = makeBall(Form::parallel, toLight, 16);
    EXPECT_TRUE(said(frameOf(lights, 16, byLight).shade()));
}

// `auto` uses a light's plain shadow image, like irradiance with that shadow. Other shadow images are ignored
// if there is a map, and without a map the material is shaded by tables.
TEST(LightSpace, PlainShadowImagesAreScatteredBy) {
    constexpr uint32_t side = 40;
    Frame f = frameOf({makeBall(Form::parallel, {0.5, 0.2, 0.8}, 64)}, side, byAuto, 0.4f);
    Frame exact = f;
    f.giveIrradiance = false;
    std::vector<float> shadow;
    for (size_t i = 0; i < f.picture.pixels(); ++i) {
        shadow.push_back(std::clamp(float(i % side) / side * 5 - 2, 0.0f, 1.0f));
        for (size_t c = 0; c < 3; ++c) exact.picture.irradiance[3 * i + c] *= shadow[i];
    }
    for (const bool map : {true, false}) {
        for (Frame* each : {&f, &exact})
            if (!map) each->lamps[0].maps.clear();
        f.lamps[0].light.plainShadow = 0, f.lamps[0].shadow.clear();
        const std::vector<float> without = f.shade().light;
        f.lamps[0].shadow = shadow;
        const Shown wide = f.shade();
        EXPECT_EQ(wide.light == without, map);
        EXPECT_EQ(wide.stats.pixelsByChoice[PEL_SCATTERING_PREINTEGRATED] > 0, !map);
        EXPECT_EQ(wide.warnings.find("PelLight.plainShadow") == std::string::npos, map) << wide.warnings;
        f.lamps[0].light.plainShadow = 1;
        EXPECT_LT(difference(f.picture, f.shade().light, exact.shade().light).most, 1e-4) << "map " << map;
    }
}

// PEL_SLOT_INDIRECT is irradiance as that of the lights is, and no occlusion dims it.
TEST(LightSpace, IndirectLightScattersAsThatOfLights) {
    constexpr uint32_t side = 40;
    Frame f = frameOf({makeBall(Form::parallel, {0.5, 0.2, 0.8}, 64)}, side, byAuto, 0.4f);
    Frame exact = f;
    f.giveIrradiance = false;
    std::vector<float>& indirect = f.images[PEL_SLOT_INDIRECT];
    for (size_t i = 0; i < f.picture.pixels(); ++i)
        for (size_t c = 0; c < 3; ++c) {
            indirect.push_back(i % side < side / 2 ? 0.1f * float(c + 1) : 0);
            exact.picture.irradiance[3 * i + c] += indirect.back();
        }
    f.images[PEL_SLOT_AMBIENT_OCCLUSION].assign(f.picture.pixels(), 0);
    for (const PelScattering method :
         {byAuto, PEL_SCATTERING_NONE, PEL_SCATTERING_SCREEN, PEL_SCATTERING_SEPARABLE}) {
        f.material.scattering = exact.material.scattering = method;
        EXPECT_LT(difference(f.picture, f.shade().light, exact.shade().light).most, 1e-4) << method;
    }
    f.material.scattering = byLight;  // whose maps do not hold it
    exact.material.scattering = PEL_SCATTERING_SCREEN;
    EXPECT_LT(difference(f.picture, f.shade().light, exact.shade().light).most, 1e-4);
}

TEST(LightSpace, ASingularMatrixIsAnError) {
    Frame f = frameOf({makeBall(Form::parallel, {0, 0, 1}, 16)}, 16, byLight);
    std::fill_n(f.lamps[0].light.worldToShadow + 4, 4, 0.0f);
    EXPECT_THROW(f.shade(), pellucid::Error);
}
