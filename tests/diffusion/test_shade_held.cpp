// Frames, tables and passes that are submitted behind an event that their caller sets later: calls return,
// and give the same; nothing behind the end of an output is written. Which calls allocate device memory when
// they are repeated (docs/guide/hosts.md, "What a call may do").
#include "diffusion/lit_ball.h"
#include "held_queue.h"
#include "shading/pass_scene.h"

namespace held_calls {

using namespace pellucid;
using fixture::expectReturns;
using shade_test::Frame;

namespace {

// Memory for this many floats, and more behind them, which no call may write.
Buffer guarded(size_t floats) {
    return Buffer(device(), std::vector<float>(floats + 4096, -7.0f));
}
std::vector<float> checked(const Buffer& buffer, size_t floats, const char* what) {
    std::vector<float> all = buffer.readAll<float>();
    EXPECT_EQ(std::count(all.begin() + long(floats), all.end(), -7.0f), 4096) << what;
    all.resize(floats);
    return all;
}

template <class Work>
uint64_t buffersMadeBy(const Work& work) {
    const uint64_t before = spy::counts().buffersMade;
    work();
    return spy::counts().buffersMade - before;
}

// Commits and executes twice behind the event, with `change` between; the second frame is that of a shader
// that never waited. The next frame of that one makes no buffer, unless `change` does.
template <class Make, class Change>
void expectFrames(const char* what, size_t floats, const Make& make, const Change& change,
                  bool changeMakesBuffers) {
    const Buffer held = guarded(floats), plain = guarded(floats);
    Shader shader(device());
    make(shader, held);
    expectReturns(device(), what, [&](const PelSubmit* submit) {
        shader.commit().execute(submit);
        change(shader);
        shader.commit().execute(submit);
    });
    Shader other(device());
    make(other, plain);
    change(other);
    other.commit().execute();
    EXPECT_EQ(checked(held, floats, what), checked(plain, floats, what)) << what;
    if (changeMakesBuffers) return;
    EXPECT_EQ(buffersMadeBy([&] {
                  change(other);
                  other.commit().execute();
              }),
              0u)
        << what;
}

// The result of a call behind the event, compared with an immediate call. `makesBuffers`: also when repeated.
template <class Call>
void expectHeld(const char* what, size_t floats, bool makesBuffers, const Call& call) {
    const Buffer held = guarded(floats), plain = guarded(floats);
    expectReturns(device(), what, [&](const PelSubmit* submit) { call(held, submit); });
    call(plain, nullptr);
    EXPECT_EQ(buffersMadeBy([&] { call(plain, nullptr); }) > 0, makesBuffers) << what;
    EXPECT_EQ(checked(held, floats, what), checked(plain, floats, what)) << what;
}

TEST(ShadeHeld, FramesInBandsWithPasses) {
    using namespace shade_test;
    Frame f = reliefFrame(1, 70, 61, 0.4f);
    f.lights.push_back(mapLight(1, false, false, {0.5, 0.2, 0.9}, {24, 10, 5}, 70, 61).light);
    f.curvatureLut = f.shadowLut = true;
    f.slots[PEL_SLOT_CURVATURE] = f.slots[PEL_SLOT_MATERIAL];
    const Tables made = makeTables(device(), 24, 16);
    for (uint64_t budget : {uint64_t{0}, uint64_t{f.width} * 4 * 20}) {
        f.options.scratchBudget = budget;
        f.options.blurNormals = budget == 0;  // they would need all rows
        expectFrames(
            budget ? "a frame in bands" : "a frame", f.pixels() * 3,
            [&](Shader& shader, const Buffer& out) {
                setFrame(device(), shader, f, made);
                shader.set(PEL_SLOT_RADIANCE, imageDesc(out, PEL_FORMAT_RGB32F, f.width, f.height));
            },
            [&](Shader& shader) {
                Frame other = f;
                other.ambient.constant[1] = 0.7f;
                other.materials[1].albedo[0] = 0.3f;
                setFrame(device(), shader, other, made);
            },
            true);
    }
}

// Tables, widths and transmission that the commit makes; scattering by every method that the screen has.
TEST(ShadeHeld, FramesWithProfilesThatScatter) {
    using namespace lit_ball;
    const LitBall ball = makeBall(Form::parallel, {0.3, 0.2, 1}, 48);
    const Picture p = pictureOf(ball, 24);
    std::vector<float> normals = p.positions, curvature(p.pixels(), 0.5f);
    for (float& n : normals) n /= float(radius);
    const Profile skin = Profile::skin();
    const Buffer map(device(), ball.maps[0]);
    for (PelScattering method : {PEL_SCATTERING_PREINTEGRATED, PEL_SCATTERING_SCREEN, PEL_SCATTERING_LIGHT,
                                 PEL_SCATTERING_SEPARABLE, PEL_SCATTERING_AUTO}) {
        const auto lit = [&](Shader& shader, float red, float diffusionRadius) {
            PelMaterial material = whiteMaterial(skin, method);
            material.specular = 0, material.diffusionRadius = diffusionRadius;
            PelLight light = ball.light, lamp = pellucid::pointLight({0, 40, 20}, {200, red, 200});
            light.color[0] = red;
            light.shadowMapVersion = 1;
            lamp.type = PEL_LIGHT_SPHERE, lamp.radius = 5;
            PelShaderOptions options = pelShaderOptionsDefaults();
            options.historyWeight = method == PEL_SCATTERING_SEPARABLE ? 0.5f : 0.0f;
            options.historyCut = uint32_t(diffusionRadius);
            shader.set(options).setMaterial(1, material).set({light, lamp});
            shader.set(0, PEL_LIGHT_SHADOW_MAP, imageDesc(map, PEL_FORMAT_R32F, ball.width, ball.height));
        };
        expectFrames(("scattering method " + std::to_string(method)).c_str(), p.pixels() * 3,
                     [&](Shader& shader, const Buffer& out) {
                         const auto set = [&](PelImageSlot slot, const auto& values, PelFormat format) {
                             shader.set(slot, imageDesc(Buffer(device(), values), format, p.width, p.height));
                         };
                         set(PEL_SLOT_POSITION, p.positions, PEL_FORMAT_RGB32F);
                         set(PEL_SLOT_NORMAL_SHADING, normals, PEL_FORMAT_RGB32F);
                         set(PEL_SLOT_NORMAL_GEOMETRIC, normals, PEL_FORMAT_RGB32F);
                         set(PEL_SLOT_IRRADIANCE, p.irradiance, PEL_FORMAT_RGB32F);
                         set(PEL_SLOT_MATERIAL, p.ids, PEL_FORMAT_R8_UINT);
                         set(PEL_SLOT_CURVATURE, curvature, PEL_FORMAT_R32F);
                         lit(shader, ball.light.color[0], 0);
                         shader.set(PEL_SLOT_RADIANCE, imageDesc(out, PEL_FORMAT_RGB32F, p.width, p.height));
                     },
                     [&](Shader& shader) { lit(shader, 0.5f, 1.5f); }, false);
    }
}

TEST(ShadeHeld, ScatteringAlone) {
    using namespace scatter_scene;
    const Picture p = ball(24, 10, 0.9, reference::normalized(Vec3{1, 0.3, 0.2}));
    const Buffer e(device(), p.irradiance), x(device(), p.positions), ids(device(), p.ids);
    const auto rgb = [&](const Buffer& b) { return imageDesc(b, PEL_FORMAT_RGB32F, p.width, p.height); };
    const auto id = imageDesc(ids, PEL_FORMAT_R8_UINT, p.width, p.height);
    const Profile skin = Profile::skin();
    for (PelScattering method : {PEL_SCATTERING_SCREEN, PEL_SCATTERING_SEPARABLE}) {
        Scatter scatter(device());
        expectHeld("pelScatterExecute", p.pixels() * 3, false,
                   [&](const Buffer& out, const PelSubmit* submit) {
                       PelScatterControls controls = pelScatterControlsDefaults();
                       controls.scattering = method;
                       scatter.setMaterial(1, skin);
                       scatter.setControls(1, controls);
                       PelScatterParams params = p.params;
                       for (const float targetError : {0.05f, 0.001f}) {
                           params.targetError = targetError, params.frameIndex = targetError < 0.01f;
                           scatter.execute(params, rgb(e), rgb(x), nullptr, id, rgb(out), submit);
                       }
                   });
    }
}

TEST(ShadeHeld, OtherSubmissions) {
    using namespace shade_test;
    const Frame f = reliefFrame(2, 40, 30, 0.4f);
    const auto image = [&](PelImageSlot slot, PelFormat format) {
        return imageDesc(upload(device(), f.slots[slot]), format, f.width, f.height);
    };
    const auto normals = image(PEL_SLOT_NORMAL_GEOMETRIC, PEL_FORMAT_RGB32F),
               positions = image(PEL_SLOT_POSITION, PEL_FORMAT_RGB32F);
    expectHeld("pelScreenCurvature", f.pixels(), true, [&](const Buffer& out, const PelSubmit* submit) {
        screenCurvature(device(), pelScreenCurvatureParamsDefaults(), normals, positions, nullptr, nullptr,
                        imageDesc(out, PEL_FORMAT_R32F, f.width, f.height), submit);
    });

    // A square of two triangles, which is the whole texture.
    const std::vector<float> corners{0, 0, 0, 4, 0, 0, 4, 4, 0, 0, 4, 0}, uvs{0, 0, 1, 0, 1, 1, 0, 1},
        light(12, 0.5f), points{1, 1, 0, 2, 3, 0};
    const std::vector<uint32_t> triangles{0, 1, 2, 0, 2, 3};
    PelSurfaceIntegralDesc integral = pelSurfaceIntegralDescDefaults();
    integral.numVertices = 4, integral.positions = corners.data();
    integral.numIndices = 6, integral.indices = triangles.data();
    integral.irradiance = light.data(), integral.irradianceAt = PEL_IRRADIANCE_VERTEX;
    const Buffer at(device(), points);
    expectHeld("pelSurfaceIntegral", 6, true, [&](const Buffer& out, const PelSubmit* submit) {
        integral.points = vertexView(at, 2), integral.result = vertexView(out, 2);
        surfaceIntegral(device(), integral, submit);
    });

    PelTextureScatterDesc desc = pelTextureScatterDescDefaults();
    desc.width = 31, desc.height = 29;
    desc.numVertices = 4, desc.uvs = uvs.data();
    desc.numIndices = 6, desc.indices = triangles.data();
    const Buffer vertices(device(), corners), values(device(), light), drawn = guarded(31 * 29 * 3);
    const PelImageDesc from = imageDesc(drawn, PEL_FORMAT_RGB32F, 31, 29);
    TextureScatter texture(device(), desc);
    expectHeld("texture scattering", 31 * 29 * 3, true, [&](const Buffer& out, const PelSubmit* submit) {
        for (int i = 0; i < 2; ++i) {
            texture.setPositions(vertexView(vertices, 4), submit);
            texture.draw(vertexView(values, 4), false, from, submit);
            texture.execute(pelTextureScatterParamsDefaults(), from, nullptr,
                            imageDesc(out, PEL_FORMAT_RGB32F, 31, 29), submit);
        }
    });
    checked(drawn, 31 * 29 * 3, "texture drawing");
}

TEST(ShadeHeld, Tables) {
    PelCurvatureLutDesc curvature = pelCurvatureLutDescFaceWorks();
    PelShadowLutDesc shadow = pelShadowLutDescFaceWorks();
    curvature.width = shadow.width = 24, curvature.height = shadow.height = 8;
    PelSpecularLutDesc specular = pelSpecularLutDescDefaults();
    specular.width = specular.height = 16;
    const Profile burley = Profile::burleyDistance({1, 0.5f, 0.25f});
    const auto expectTable = [&](const char* what, const auto& desc) {
        Lut lut;
        size_t bytes = 0;
        std::vector<float> texels;
        expectReturns(device(), what, [&](const PelSubmit* submit) {
            lut = Lut(device(), desc, submit);
            check(pelLutGetSize(lut.get(), PEL_LUT_FLOAT, &bytes));
            texels.resize(bytes / sizeof(float));
            check(pelLutRead(lut.get(), PEL_LUT_FLOAT, texels.data(), bytes, submit));
        });
        EXPECT_EQ(texels, Lut(device(), desc).template read<float>(PEL_LUT_FLOAT)) << what;
        Lut copy;
        expectReturns(device(), "pelLutCreateFromTexels",
                      [&](const PelSubmit*) { copy = Lut(device(), lut.info(), texels); });
        EXPECT_EQ(copy.read<float>(PEL_LUT_FLOAT), texels) << what;
    };
    expectTable("pelCurvatureLutCreate", curvature);
    expectTable("pelShadowLutCreate", shadow);
    expectTable("pelSpecularLutCreate", specular);
    curvature.profile = shadow.profile = burley.get();
    expectTable("pelCurvatureLutCreate of a tabulated profile", curvature);
    expectTable("pelShadowLutCreate of a tabulated profile", shadow);
}

}  // namespace

}  // namespace held_calls
