// Programs built ahead of their first use: afterwards nothing is left to build, the caller's data are
// untouched, and the warm-up can be stopped.
#include "cl/cl_spy.h"
#include "mesh/mesh_calls.h"
#include "shading/pass_scene.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::Device;
using pellucid::imageDesc;
using pellucid::Shader;

namespace {

uint64_t buildsSince(uint64_t before) {
    return spy::counts().builds - before;
}

struct Scene {
    Frame frame;
    Shader shader;
    Buffer target;

    Scene(const Device& device, const Tables& tables, uint32_t width, uint32_t height) {
        frame = reliefFrame(1, width, height, 0.4f);
        frame.lights.push_back(mapLight(1, false, false, {0.5, 0.2, 0.9}, {24, 10, 5}, 70, 61).light);
        frame.options.blurNormals = 1;
        frame.options.tileLists = PEL_TILES_PER_VARIANT;
        frame.curvatureLut = frame.shadowLut = true;
        frame.slots[PEL_SLOT_CURVATURE] = frame.slots[PEL_SLOT_MATERIAL];
        shader = Shader(device);
        setFrame(device, shader, frame, tables);
        target = Buffer(device, std::vector<float>(frame.pixels() * 3, -3));
        shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, width, height));
    }
};

struct Telling {
    std::vector<double> fractions;
    std::thread::id thread = std::this_thread::get_id();
    size_t stopAt = 0;
    static int tell(void* user, double fraction, const char* what) {
        auto& t = *static_cast<Telling*>(user);
        EXPECT_EQ(std::this_thread::get_id(), t.thread) << "on the calling thread";
        EXPECT_EQ(std::string(what).rfind("building kernels ", 0), 0u) << what;
        t.fractions.push_back(fraction);
        return t.fractions.size() != t.stopAt;
    }
};

TEST(WarmUp, ACommitAndAnExecutionFindEverythingBuilt) {
    const Device own("");
    const Tables tables = makeTables(own, 32, 32);
    // 16 x 2 pixels stand for a frame of the same formats.
    Scene small(own, tables, 16, 2), large(own, tables, 150, 40);
    // Another variant for some tiles.
    for (Scene* scene : {&small, &large}) scene->shader.setMaterial(2, scene->frame.materials.at(2));
    Telling telling;
    own.setProgress(Telling::tell, &telling);
    uint64_t before = buildsSince(0);
    const uint32_t built = pellucid::warmUpPrograms(own, 0, {small.shader});
    EXPECT_EQ(built, 5u) << "two variants, classification, blur, wide shadow";
    EXPECT_EQ(built, buildsSince(before));
    ASSERT_GE(telling.fractions.size(), 2u);
    EXPECT_EQ(telling.fractions.front(), 0);
    EXPECT_EQ(telling.fractions.back(), 1);
    EXPECT_TRUE(std::is_sorted(telling.fractions.begin(), telling.fractions.end()));
    for (float v : small.target.readAll<float>()) ASSERT_EQ(v, -3) << "nothing is shaded";
    EXPECT_THROW(small.shader.execute(), pellucid::Error) << "it is no commit";

    own.setProgress(nullptr, nullptr);
    before = buildsSince(0);
    large.shader.commit().execute();
    small.shader.commit().execute();
    EXPECT_EQ(buildsSince(before), 0u);
    EXPECT_EQ(large.shader.stats().programsBuilt, 0u);
    const auto shaded = large.target.readAll<float>();
    EXPECT_GT(*std::max_element(shaded.begin(), shaded.end()), 0.01f);
    EXPECT_EQ(pellucid::warmUpPrograms(own, 0, {small.shader}), 0u) << "all is there";
}

// Whose table is not there yet.
TEST(WarmUp, AnEyeFindsEverythingBuilt) {
    const Device own("");
    const Tables tables = makeTables(own, 32, 32);
    Scene scene(own, tables, 40, 24);
    scene.shader.setEye(2, pelEyeDefaults());
    EXPECT_GT(pellucid::warmUpPrograms(own, 0, {scene.shader}), 4u) << "more than without an eye";
    const uint64_t before = buildsSince(0);
    scene.shader.commit().execute();
    EXPECT_EQ(buildsSince(before), 0u);
}

TEST(WarmUp, TablesAndCurvatureFindEverythingBuilt) {
    const Device own("");
    Telling telling;
    own.setProgress(Telling::tell, &telling);
    const uint32_t built = pellucid::warmUpPrograms(
        own, PEL_PROGRAMS_LUTS | PEL_PROGRAMS_TABULATED_LUTS | PEL_PROGRAMS_CURVATURE);
    EXPECT_GE(built, 10u);
    EXPECT_TRUE(std::is_sorted(telling.fractions.begin(), telling.fractions.end()));
    own.setProgress(nullptr, nullptr);
    const uint64_t before = buildsSince(0);
    for (const PelCurvatureForm form :
         {PEL_FORM_ARC, PEL_FORM_RING, PEL_FORM_HALF_RING, PEL_FORM_SPHERE, PEL_FORM_PENNER_RING}) {
        PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
        desc.form = form;
        desc.width = 40, desc.height = 24;
        pellucid::Lut(own, desc).read<uint8_t>(PEL_LUT_FACEWORKS8);
    }
    PelShadowLutDesc shadow = pelShadowLutDescFaceWorks();
    shadow.width = 40;
    pellucid::Lut(own, shadow).read<float>(PEL_LUT_FLOAT);
    const auto table = pellucid::Profile::table({0, 4}, {1, 0.7f, 0.5f, 0, 0, 0});
    shadow.profile = table.get();
    pellucid::Lut(own, shadow).read<uint16_t>(PEL_LUT_HALF);
    const fixture::Mesh mesh = fixture::torus(4, 3);
    const pellucid::MeshTopology topology(own, fixture::topologyDesc(mesh));
    const Buffer where(own, mesh.positions), out(own, sizeof(float) * mesh.vertices());
    const auto positions = vertexView(where, mesh.vertices());
    for (const PelCurvatureEstimator e : fixture::allEstimators)
        topology.curvature(fixture::paramsOf(e), positions, positions, vertexView(out, mesh.vertices()));
    EXPECT_EQ(buildsSince(before), 0u);
}

TEST(WarmUp, CanBeStoppedAndGoneOnWith) {
    const Device own("");
    Telling telling;
    telling.stopAt = 3;
    own.setProgress(Telling::tell, &telling);
    PelWarmUp work = pelWarmUpDefaults();
    work.groups = PEL_PROGRAMS_LUTS, work.threads = 2;
    uint32_t built = 77;
    EXPECT_EQ(pelWarmUpPrograms(own.get(), &work, &built), PEL_ERROR_CANCELLED);
    EXPECT_EQ(built, 77u) << "no output is written on an error";
    own.setProgress(nullptr, nullptr);
    EXPECT_LT(pellucid::warmUpPrograms(own, PEL_PROGRAMS_LUTS), 7u)
        << "what was built before the stop is kept: all of it, where builders were faster "
           "than the one who tells";
}

TEST(WarmUp, AScattersExecutionFindsEverythingBuilt) {
    const Device own(""), other("");
    const auto skin = pellucid::Profile::skin();
    const auto scattered = [&](const Device& on, bool warm, bool lines) {
        pellucid::Scatter scatter(on);
        scatter.setMaterial(1, skin);
        if (lines) {
            PelScatterControls controls = pelScatterControlsDefaults();
            controls.scattering = PEL_SCATTERING_SEPARABLE;
            scatter.setControls(1, controls);
        }
        constexpr uint32_t width = 40, height = 30;
        std::vector<float> light, places;
        for (uint32_t i = 0; i < width * height; ++i) {
            light.insert(light.end(), 3, i % width < width / 2 ? 1.0f : 0.0f);
            places.insert(places.end(), {float(i % width), float(i / width), 0});
        }
        const Buffer in(on, light), at(on, places), out(on, std::vector<float>(light.size(), -3));
        const auto image = [](const Buffer& buffer) {
            return imageDesc(buffer, PEL_FORMAT_RGB32F, width, height);
        };
        const PelScatterParams params = pelScatterParamsDefaults();
        if (warm) {
            EXPECT_GE(scatter.warmUp(on, params, image(in), image(at), nullptr, nullptr, image(out)), 1u);
            for (float v : out.readAll<float>()) EXPECT_EQ(v, -3) << "nothing is written";
            EXPECT_EQ(in.readAll<float>(), light);
            EXPECT_EQ(scatter.warmUp(on, params, image(in), image(at), nullptr, nullptr, image(out)), 0u);
        }
        const uint64_t before = buildsSince(0);
        scatter.execute(params, image(in), image(at), nullptr, nullptr, image(out));
        if (warm) {
            EXPECT_EQ(buildsSince(before), 0u);
        }
        return out.readAll<float>();
    };
    for (const bool lines : {false, true})
        EXPECT_EQ(scattered(own, true, lines), scattered(other, false, lines));
}

TEST(WarmUp, SaysWhatIsWrong) {
    const Device own(""), other("");
    Shader empty(own), foreign(other);
    const PelShader foreignHandle = foreign.get(), emptyHandle = empty.get();
    const auto refused = [&](const char* words, uint32_t groups, const PelShader* shaders, uint32_t count) {
        PelWarmUp work = pelWarmUpDefaults();
        work.groups = groups, work.shaders = shaders, work.numShaders = count;
        expectRefused(words, [&] { return pelWarmUpPrograms(own.get(), &work, nullptr); });
    };
    refused("PelProgramGroup", 64, nullptr, 0);
    refused("shaders", 0, nullptr, 1);
    refused("another PelDevice", 0, &foreignHandle, 1);
    refused("radiance image is needed", 0, &emptyHandle, 1);
    EXPECT_EQ(pelWarmUpPrograms(own.get(), nullptr, nullptr), PEL_ERROR_INVALID_ARGUMENT);
    PelScatterWork scatter = pelScatterWorkDefaults();
    const auto scatterRefused = [&](const char* words) {
        PelWarmUp work = pelWarmUpDefaults();
        work.scatters = scatter.scatter ? &scatter : nullptr;
        work.numScatters = 1;
        expectRefused(words, [&] { return pelWarmUpPrograms(own.get(), &work, nullptr); });
    };
    scatterRefused("PelWarmUp.scatters is NULL");
    const pellucid::Scatter mine(own), theirs(other);
    scatter.scatter = theirs.get();
    scatterRefused("another PelDevice");
    scatter.scatter = mine.get();
    scatterRefused("`irradiance` is needed");
    EXPECT_EQ(pellucid::warmUpPrograms(own, 0), 0u);
}

}  // namespace
