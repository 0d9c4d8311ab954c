// Frames with random fields, by every method and form of shadow map, compared with kept results.
#include "device_lanes.h"
#include "diffusion/lit_ball.h"
#include "kept_sums.h"
#include "test.h"

using namespace lit_ball;

namespace {

constexpr uint32_t structures = 9, copies = 3;  // as many as there are forms of maps, and more than methods

Vec3 directionOf(Draw& draw) {
    return normalized(Vec3{double(draw.in(-1, 1)), double(draw.in(-1, 1)), double(draw.in(-0.4f, 1)) + 0.05});
}

Profile profileOf(Draw& draw) {
    switch (draw.below(3)) {
        case 0:
            return Profile::skin();
        case 1:
            return Profile::burleyDistance({draw.in(0.5f, 2), draw.in(0.2f, 1), draw.in(0.1f, 0.5f)});
        default:
            return Profile::gaussians({{draw.in(0.1f, 2), {0.8f, 0.6f, 0.3f}}, {0.05f, {0.2f, 0.4f, 0.7f}}});
    }
}

// An occluder in front of a part of each map's surface: by 3 mm, or at a third of the way from the light.
void addOccluder(LitBall& ball, Form form, Draw& draw) {
    const PelLight& l = ball.light;
    const auto nearer = [&](float z) {
        switch (form) {
            case Form::perspective:
            case Form::spot:
            case Form::cube:
                return (1.5f * (l.shadowDepthA * z + l.shadowDepthB) - l.shadowDepthB) / l.shadowDepthA;
            case Form::radial:
                return z / 1.5f;
            case Form::exponential:
                return z * std::exp(-0.15f * l.shadowExponent);
            default:
                return l.shadowDepthRange < 0 ? z + 0.15f : z - 0.15f;
        }
    };
    const uint32_t left = draw.below(ball.width / 2), wide = ball.width / 4, period = 24 + draw.below(9);
    for (std::vector<float>& map : ball.maps)
        for (size_t i = 0; i < map.size(); i += ball.components) {
            const size_t texel = i / ball.components, x = texel % ball.width, y = texel / ball.width;
            if (x < left || x >= left + wide || y % period > period / 2) continue;
            map[i] = nearer(map[i]);
            if (ball.components == 2) map[i + 1] = map[i] * map[i];
        }
}

// Frames of one structure share their programs, which take most of the time. `behind`: all lights are.
Frame randomFrame(uint32_t structure, uint32_t copy, uint32_t side = 40, bool behind = false) {
    // Choices by `draw` may need another program; what `value` gives does not.
    Draw draw(structure), value(structure + 12 * copy + 1);
    constexpr PelScattering methods[] = {
        PEL_SCATTERING_AUTO,  PEL_SCATTERING_LIGHT,     PEL_SCATTERING_SCREEN, PEL_SCATTERING_AUTO,
        PEL_SCATTERING_LIGHT, PEL_SCATTERING_SEPARABLE, PEL_SCATTERING_AUTO,   PEL_SCATTERING_PREINTEGRATED};
    std::vector<LitBall> lights;
    const auto addLight = [&](Form form) {
        const Vec3 direction = directionOf(value);
        lights.push_back(evenBall(form, behind ? normalized(Vec3{0.05, 0.02, -1}) : direction, 48));
        if (!draw.oneOf(4)) addOccluder(lights.back(), form, value);
    };
    addLight(forms[structure % std::size(forms)]);
    // All lights must have maps of the same content.
    if (draw.oneOf(3) && structure % std::size(forms) < 7) addLight(forms[draw.below(7)]);
    Frame f = lit_ball::frameOf(lights, side, methods[structure % std::size(methods)],
                                draw.oneOf(4) ? 0 : value.in(0.2f, 3), profileOf(value));
    const size_t pixels = f.picture.pixels();
    PelMaterial& m = f.material;
    const PelScattering method = m.scattering;
    const bool screen = method == PEL_SCATTERING_SCREEN, separable = method == PEL_SCATTERING_SEPARABLE;
    for (float& albedo : m.albedo) albedo = value.in(0.2f, 1);
    m.curvatureGain = value.oneOf(3) ? value.in(0, 1) : 1;
    if ((screen || separable) && draw.oneOf(2)) m.scatterTaps = 8 + value.below(20);
    if (draw.oneOf(4)) m.albedoBefore = value.in(0, 1);
    if (draw.oneOf(2)) {
        f.materials = 2;
        for (size_t i = 0; i < pixels; ++i)
            if (f.picture.ids[i] && i % side + i / side > 11 * side / 10) f.picture.ids[i] = 2;
        for (float& color : m.borderColor)
            if (m.scatterTaps > 0 || separable) color = value.oneOf(2) ? value.in(0, 1) : 0;
    }
    f.giveIrradiance = draw.oneOf(3);
    for (Lamp& lamp : f.lamps) {
        for (float& color : lamp.light.color) color *= value.in(0.3f, 1);
        if (value.oneOf(4)) lamp.light.range = value.in(5, 12);
        if (lamp.light.type == PEL_LIGHT_POINT && !draw.oneOf(3))
            lamp.light.type = PEL_LIGHT_SPHERE, lamp.light.radius = value.in(0.3f, 3);
        if (value.oneOf(3)) lamp.light.shadowBias = value.in(0.02f, 0.2f);
    }
    if (draw.oneOf(4))
        f.images[PEL_SLOT_SCATTER_WEIGHT] = value.values(pixels, 0, 1);
    else if (draw.oneOf(4))
        f.images[PEL_SLOT_SCATTER_WEIGHT] = value.values(2 * pixels, 0.3f, 1);
    if (draw.oneOf(4) || method == PEL_SCATTERING_PREINTEGRATED)
        f.images[PEL_SLOT_CURVATURE] = value.values(pixels, 0, 0.6f);
    if (draw.oneOf(4)) f.images[PEL_SLOT_ALBEDO] = value.values(3 * pixels, 0.1f, 1);
    if (draw.oneOf(4)) f.images[PEL_SLOT_THICKNESS] = value.values(pixels, 0.2f, 5);
    if (draw.oneOf(4)) f.images[PEL_SLOT_MEAN_CURVATURE] = value.values(pixels, -0.1f, 0.6f);
    if (draw.oneOf(4)) f.images[PEL_SLOT_INDIRECT] = value.values(3 * pixels, 0, 0.3f);
    if (draw.oneOf(4) && method != PEL_SCATTERING_PREINTEGRATED) {
        m.thinThickness = value.in(0.1f, 1);
        if (f.giveIrradiance) f.images[PEL_SLOT_IRRADIANCE_BACK] = value.values(3 * pixels, 0, 1);
    }
    PelShaderOptions& o = f.options;
    o.targetError = value.oneOf(6) ? o.targetError : value.oneOf(10) ? 0.02f : 0;
    o.frameIndex = value.below(8);
    o.rotateTaps = draw.oneOf(3);
    o.halfRate = draw.oneOf(4);
    o.everyPixel = draw.oneOf(5);
    if (value.oneOf(5))
        o.regionX = side / 10, o.regionY = 3 * side / 40, o.regionWidth = 27 * side / 40,
        o.regionHeight = 3 * side / 4;
    return f;
}

// One frame of each method.
bool byOneLane(uint32_t index) {
    return index < 3 || index == 5 || index == 7;
}

// The work that skipping has left. Another number of lanes skips other tiles and blocks.
std::vector<uint64_t> workOf(const PelShaderStats& s) {
    std::vector<uint64_t> work{s.pixelsShaded,     s.pixelsIrradiance,   s.pixelsShadowLut,
                               s.pixelsWideShadow, s.pixelsShadowTexels, s.pixelsScattered,
                               s.pixelsKept,       s.scatterTaps,        s.texelsReached,
                               s.tilesShaded,      s.tilesPartial};
    work.insert(work.end(), std::begin(s.tilesByScattering), std::end(s.tilesByScattering));
    work.insert(work.end(), std::begin(s.pixelsByChoice), std::end(s.pixelsByChoice));
    return work;
}

std::string workFile(const Device& device) {
    return "work_" + std::to_string(device.info().mathWidth) + ".dat";
}

}  // namespace

TEST(KeptResults, OfFramesWithFieldsAtRandom) {
    if (testsAreSmall()) GTEST_SKIP() << "for whole pictures";
    KeptSums kept("frames.dat");
    const Device oneLane = lanes::deviceOf(1);  // as GPUs have
    for (uint32_t index = 0; index < structures * copies; ++index) {
        const Frame f = randomFrame(index % structures, index / structures);
        const Shown shown = f.shade();
        // Other widths leave other tiles alone.
        kept.expect(shown.light,
                    tolerance::keptResults + tolerance::scatterLeftOut * double(f.options.targetError),
                    "frame " + std::to_string(index) + ", method " + std::to_string(f.material.scattering) +
                        "; " + shown.warnings);
        if (!byOneLane(index)) continue;
        ShownImages narrow(oneLane, 1, 1);
        const std::vector<float> light = f.shade(narrow).light;
        for (size_t i = 0; i < light.size(); ++i)
            ASSERT_NEAR(light[i], shown.light[i],
                        tolerance::oneLaneAgrees + tolerance::scatterLeftOut * double(f.options.targetError))
                << "by one lane, frame " << index << ", value " << i;
    }
}

// Faults in skipping change the time of frames, not their pixels.
TEST(KeptResults, WorkOfFramesWithFieldsAtRandom) {
    if (testsAreSmall()) GTEST_SKIP() << "for whole pictures";
    const Device oneLane = lanes::deviceOf(1);  // as GPUs have
    KeptSums kept(workFile(device())), narrowKept("work_one_lane.dat");
    for (uint32_t index = 0; index < copies * structures; ++index) {
        const uint32_t copy = index / structures;
        Frame f = randomFrame(index % structures, copy, 200, copy == 2);
        f.options.targetError = (index % structures) % 2 == copy % 2 ? 0.004f : 0.05f;
        if (copy == 1) f.profile = Profile::burleyDistance({0.12f, 0.06f, 0.03f});
        const std::string what = "frame " + std::to_string(index);
        kept.expectCounts(workOf(f.shade().stats), tolerance::keptWork, what);
        if (!byOneLane(index)) continue;
        ShownImages narrow(oneLane, 1, 1);
        narrowKept.expectCounts(workOf(f.shade(narrow).stats), tolerance::keptWork, what);
    }
}
