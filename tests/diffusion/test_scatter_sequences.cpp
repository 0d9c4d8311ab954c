// Objects keep memory, tables and levels from one picture to the next. Each picture of a sequence must equal,
// to the bit, the picture of a new object.
#include "device_lanes.h"
#include "diffusion/lit_ball.h"

using namespace lit_ball;
using pellucid::TextureScatter;

namespace {

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
    Picture halfRate = stripes(61, 43, 4, 2);
    halfRate.params.halfRate = 1;
    const auto half = [](double edge, Vec3 lit, Vec3 dark) {
        return [=](double x, double) { return x < edge ? lit : dark; };
    };
    const Picture small = plane(48, 32, 0.2, half(4.8, {1, 1, 1}, {})),
                  edge = plane(160, 96, 0.2, half(15.9, {1, 0.5, 0.25}, {0.3, 0.3, 0.3}));
    return {{"stripes by a wide profile", stripes(160, 96, 9, 1), gaussian(3), 1},
            {"an edge by a narrow one", edge, gaussian(0.1f), 1},
            {"other ids", stripes(160, 96, 5, 4), gaussian(1), 1},
            {"a smaller picture", small, gaussian(1), 1},
            // As many bytes in every level, but other widths.
            {"another shape of the same size", stripes(33, 32, 2, 1), gaussian(1), 1},
            {"the shape before", small, gaussian(1), 1},
            {"another scale", small, gaussian(1), 0.3f},
            {"weights", small, gaussian(1), 0.3f, true},
            {"every tile", everywhere, gaussian(0.4f), 2},
            {"half rate", halfRate, gaussian(0.4f), 2},
            {"half rate with weights", halfRate, gaussian(0.4f), 1, true},
            {"another profile", stripes(60, 44, 3, 2), Profile::skin(), 1},
            {"a ball", ball(50, 10, 0.42, normalized(Vec3{1, 0.3, 0.2})), Profile::skin(), 1}};
}

std::vector<float> scatter(Scatter& object, const Step& step, const PelScatterControls& controls) {
    Extra extra;
    for (size_t i = 0; step.weights && i < step.picture.pixels(); ++i)
        extra.weights.push_back(float(i % 5) / 4);
    return run(object, step.picture,
               {{1, step.profile, step.scale, controls}, {2, step.profile, step.scale, controls}, {3, {}}},
               extra)
        .scattered;
}

}  // namespace

TEST(ScatterSequences, EachPictureEqualsThatOfANewObject) {
    for (const auto& [method, taps] : {std::pair{screen, 0u}, {screen, 16u}, {separable, 9u}}) {
        const PelScatterControls controls = controlsOf(method, taps);
        Scatter kept(device());
        for (const Step& step : steps()) {
            Scatter fresh(device());
            const std::vector<float> expected = scatter(fresh, step, controls);
            EXPECT_EQ(scatter(kept, step, controls), expected)
                << "method " << int(method) << ", " << taps << " taps: " << step.name;
            EXPECT_NE(expected, step.picture.irradiance) << step.name;
        }
    }
}

// The shader, with methods, sizes, ids, lights, maps, textures and materials that follow one another.
TEST(ScatterSequences, EachFrameEqualsThatOfANewShader) {
    const Vec3 side = normalized(Vec3{0.8, 0.2, 0.1}), behind = normalized(Vec3{-0.5, 0.1, -0.8});
    const LitBall one = makeBall(Form::parallel, side, 128), two = makeBall(Form::parallel, behind, 128);
    LitBall wide = two, narrow = one;  // 48 x 32 texels and 33 x 32 take the same memory
    wide.width = 48, wide.height = 32, wide.maps[0].resize(48 * 32);
    narrow.width = 33, narrow.height = 32, narrow.maps[0].resize(33 * 32);
    LitBall nothing = two;  // parts of a light's pyramid that hold nothing are not written
    std::ranges::fill(nothing.maps[0], 1.0f);
    const std::vector<std::vector<LitBall>> lights{
        {one}, {two},     {one, two}, {wide}, {narrow}, {makeBall(Form::cascades, side, 64)},
        {two}, {nothing}, {nothing},  {one}};
    ShownImages kept(device(), 1, 1);
    size_t frame = 0;
    for (PelScattering method : {byAuto, byLight, PEL_SCATTERING_TEXTURE, screen, separable, byLight,
                                 PEL_SCATTERING_TEXTURE, byAuto})
        for (const std::vector<LitBall>& lit : lights) {
            Frame f = frameOf(lit, frame % 5 == 2 ? 24 : 40, method, frame % 2 ? 0.0f : 0.6f,
                              frame % 3 ? Profile::skin() : gaussian(0.5f));
            Picture& p = f.picture;
            f.materials = 2;
            f.options.halfRate = frame % 5 < 2;
            for (size_t i = 0; i < p.pixels(); ++i) {
                const bool left = i % p.width < p.width / 2;
                if (p.ids[i] && !left) p.ids[i] = frame % 4 == 3 ? 0 : frame % 3 == 1 ? 2 : 1;
            }
            if (method == PEL_SCATTERING_TEXTURE) {
                std::vector<float>& uvs = f.images[PEL_SLOT_UV];
                for (size_t i = 0; i < 2 * p.pixels(); ++i) uvs.push_back(float((i * 37 + frame) % 101) / 50);
                const size_t texels = frame % 2 ? 64 : 256;
                for (size_t i = 0; i < 3 * texels; ++i) f.texture.push_back(float((7 * i + frame) % 11) / 10);
            }
            EXPECT_EQ(f.shade(kept).light, f.shade().light)
                << "frame " << frame << ", method " << int(method);
            ++frame;
        }
}

TEST(ScatterSequences, AShaderTakesHalfRate) {
    for (PelScattering method : {separable, byLight}) {
        Frame f = frameOf({makeBall(Form::parallel, {0.8, 0.2, 0.1}, 128)}, 48, method, 1, Profile::skin());
        const auto whole = f.shade();
        f.options.halfRate = 1;
        const auto half = f.shade();
        EXPECT_LT(double(half.stats.pixelsScattered), 0.4 * double(whole.stats.pixelsScattered));
        const Difference d = difference(f.picture, half.light, whole.light);
        EXPECT_LT(d.rms, tolerance::scatterHalfRate);
        EXPECT_GT(d.rms, 1e-5);
    }
}

// A texture with two islands, whose mesh moves: lights, profiles, scales, Gaussians and albedo that follow
// one another, in textures of several sizes.
TEST(ScatterSequences, EachTextureEqualsThatOfANewObject) {
    const std::vector<float> uvs{.05f, .1f, .4f,  .1f, .4f,  .9f, .05f, .9f,
                                 .5f,  .2f, .95f, .2f, .95f, .8f, .5f,  .8f};
    const std::vector<uint32_t> triangles{0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
    const struct {
        const char* name;
        float size;  // mm
        uint32_t light;
        Profile profile;
        float scale = 1;
        uint32_t gaussians = 6, albedo = 0;  // 1: before, 2: after
    } frames[] = {{"skin", 10, 5, Profile::skin()},
                  {"a narrow profile", 10, 5, gaussian(0.1f)},
                  {"a wide one", 10, 9, gaussian(4)},
                  {"another light", 10, 3, gaussian(4)},
                  {"a larger mesh", 40, 3, gaussian(1)},
                  {"another scale", 40, 3, gaussian(1), 3},
                  {"many Gaussians", 40, 3, Profile::burleyDistance({1, 0.4f, 0.2f}), 1, 12},
                  {"few of them", 40, 3, Profile::burleyDistance({1, 0.4f, 0.2f}), 1, 3},
                  {"albedo before", 10, 5, Profile::skin(), 1, 6, 1},
                  {"albedo after", 10, 7, Profile::skin(), 1, 6, 2},
                  {"no texel is covered", 0, 7, Profile::skin()},
                  {"skin again", 10, 5, Profile::skin()}};
    for (const auto& size : {std::pair{64u, 48u}, {33u, 17u}, {16u, 128u}}) {
        const uint32_t width = size.first, height = size.second;
        PelTextureScatterDesc desc = pelTextureScatterDescDefaults();
        desc.width = width, desc.height = height;
        desc.numVertices = 8, desc.uvs = uvs.data();
        desc.numIndices = triangles.size(), desc.indices = triangles.data();
        TextureScatter kept(device(), desc);
        for (const auto& frame : frames) {
            const auto texture = [&](TextureScatter& object) {
                std::vector<float> corners, irradiance, albedo;
                for (size_t v = 0; v < 8; ++v)
                    for (float x : {uvs[2 * v], uvs[2 * v + 1], float(v % 3) / 5})
                        corners.push_back(frame.size * x);
                for (size_t i = 0; i < size_t(3) * width * height; ++i) {
                    irradiance.push_back(float(i / 3 / frame.light % 3) / 2);
                    albedo.push_back(i % 7 ? 0.6f : 0.1f);
                }
                object.setPositions(vertexView(Buffer(device(), corners), 8));
                PelTextureScatterParams params = pelTextureScatterParamsDefaults();
                params.profile = frame.profile.get();
                params.scale = frame.scale;
                params.gaussians = frame.gaussians;
                params.albedoBefore = frame.albedo == 1 ? 1 : 0;
                params.albedoAfter = frame.albedo == 2;
                const auto colors = imageOf(device(), albedo, width, height);
                const Buffer out(device(), std::vector<float>(irradiance.size(), -1.0f));
                object.execute(params, imageOf(device(), irradiance, width, height),
                               frame.albedo ? &colors : nullptr,
                               pellucid::imageDesc(out, PEL_FORMAT_RGB32F, width, height));
                const std::vector<float> result = out.readAll<float>();
                EXPECT_NE(result, irradiance) << frame.name;
                return result;
            };
            TextureScatter fresh(device(), desc);
            EXPECT_EQ(texture(kept), texture(fresh)) << width << " wide: " << frame.name;
        }
    }
}

// Results do not depend on the number of lanes of the device.
TEST(ScatterSequences, WidthsAgree) {
    for (const auto& [form, method] : {std::pair{Form::parallel, byLight}, {Form::perspective, byAuto}}) {
        const Frame f =
            frameOf({makeBall(form, {0.9, 0.2, -0.1}, sized(512u, 64u))}, sized(96u, 24u), method, 0.3f);
        // By auto, pixels of one vector are left out together.
        const double most = method == byLight ? double(tolerance::widthsAgree)
                                              : tolerance::scatterLeftOut * double(f.options.targetError);
        Shown before;
        for (int lanes : {1, 8, 16}) {
            ShownImages shown(lanes::deviceOf(lanes), 1, 1);
            const Shown now = f.shade(shown);
            for (size_t i = 0; i < before.light.size(); ++i)
                ASSERT_NEAR(now.light[i], before.light[i], most)
                    << lanes << " lanes, method " << int(method) << ", value " << i;
            if (lanes > 1) {
                EXPECT_EQ(now.stats.pixelsKept, before.stats.pixelsKept) << lanes;
            }
            if (lanes > 1 && method == byLight) {
                EXPECT_EQ(now.stats.scatterTaps, before.stats.scatterTaps) << lanes;
            }
            before = now;
        }
    }
}
