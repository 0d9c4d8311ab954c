// Programs built ahead of their first use: nothing is left to build, nothing of the caller's is touched,
// and it can be stopped.
//
// This program defines clBuildProgram itself, which is linked before libOpenCL's, and counts the calls.
#include <CL/cl.h>
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "cl/cl_spy.h"
#include "mesh/mesh_calls.h"
#include "refusal.h"
#include "shading/pass_scene.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::Device;
using pellucid::imageDesc;
using pellucid::Shader;

namespace {
std::atomic<int> builds{0};
}

extern "C" {
#pragma GCC visibility push(default)
cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id* devices, const char* options,
                      void (*notify)(cl_program, void*), void* user) {
    ++builds;
    return reinterpret_cast<decltype(clBuildProgram)*>(dlsym(RTLD_NEXT, "clBuildProgram"))(
        program, count, devices, options, notify, user);
}
#pragma GCC visibility pop
}

namespace {

PelWarmUp workOf(const std::vector<PelShader>& shaders, uint32_t groups = 0) {
    PelWarmUp work = pelWarmUpDefaults();
    work.groups = groups;
    work.shaders = shaders.data();
    work.numShaders = uint32_t(shaders.size());
    return work;
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
    pellucid::check(pelDeviceSetProgress(own.get(), Telling::tell, &telling));
    builds = 0;
    const std::vector<PelShader> shaders{small.shader.get()};
    const PelWarmUp work = workOf(shaders);
    uint32_t built = 0;
    pellucid::check(pelWarmUpPrograms(own.get(), &work, &built));
    EXPECT_EQ(built, 4u) << "two variants, blur, wide shadow";
    EXPECT_EQ(int(built), builds.load());
    ASSERT_GE(telling.fractions.size(), 2u);
    EXPECT_EQ(telling.fractions.front(), 0);
    EXPECT_EQ(telling.fractions.back(), 1);
    EXPECT_TRUE(std::is_sorted(telling.fractions.begin(), telling.fractions.end()));
    for (float v : small.target.readAll<float>()) ASSERT_EQ(v, -3) << "nothing is shaded";
    EXPECT_THROW(small.shader.execute(), pellucid::Error) << "it is no commit";

    pellucid::check(pelDeviceSetProgress(own.get(), nullptr, nullptr));
    builds = 0;
    large.shader.commit().execute();
    small.shader.commit().execute();
    EXPECT_EQ(builds.load(), 0);
    EXPECT_EQ(large.shader.stats().programsBuilt, 0u);
    const auto shaded = large.target.readAll<float>();
    EXPECT_GT(*std::max_element(shaded.begin(), shaded.end()), 0.01f);
    pellucid::check(pelWarmUpPrograms(own.get(), &work, &built));
    EXPECT_EQ(built, 0u) << "all is there";
}

TEST(WarmUp, TablesAndCurvatureFindEverythingBuilt) {
    const Device own("");
    Telling telling;
    pellucid::check(pelDeviceSetProgress(own.get(), Telling::tell, &telling));
    const uint32_t built = pellucid::warmUpPrograms(
        own, PEL_PROGRAMS_LUTS | PEL_PROGRAMS_TABULATED_LUTS | PEL_PROGRAMS_CURVATURE);
    EXPECT_GE(built, 10u);
    EXPECT_TRUE(std::is_sorted(telling.fractions.begin(), telling.fractions.end()));
    pellucid::check(pelDeviceSetProgress(own.get(), nullptr, nullptr));
    builds = 0;
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
    EXPECT_EQ(builds.load(), 0);
}

TEST(WarmUp, CanBeStoppedAndGoneOnWith) {
    const Device own("");
    Telling telling;
    telling.stopAt = 3;
    pellucid::check(pelDeviceSetProgress(own.get(), Telling::tell, &telling));
    PelWarmUp work = workOf({}, PEL_PROGRAMS_LUTS);
    work.threads = 2;
    uint32_t built = 77;
    EXPECT_EQ(pelWarmUpPrograms(own.get(), &work, &built), PEL_ERROR_CANCELLED);
    EXPECT_EQ(built, 77u) << "no output is written on an error";
    pellucid::check(pelDeviceSetProgress(own.get(), nullptr, nullptr));
    pellucid::check(pelWarmUpPrograms(own.get(), &work, &built));
    EXPECT_LT(built, 7u) << "what was built before the stop is kept: all of it, where builders were faster "
                            "than the one who tells";
}

// Here two devices stand in for two processes.
TEST(WarmUp, ProcessesThatShareAFolderLaunchEachKernelOnce) {
    char folder[] = "/tmp/pellucid-share-XXXXXX";
    ASSERT_NE(::mkdtemp(folder), nullptr);
    std::vector<float> pictures[2];
    for (const std::string prefix : {"", "helper:"}) {
        const Device own("");
        const Tables tables = makeTables(own, 32, 32);
        Scene small(own, tables, 16, 2);
        const PelShader handle = small.shader.get();
        PelWarmUp work = workOf({});
        work.shaders = &handle, work.numShaders = 1;
        const uint64_t before = spy::launchesOf("shade") + spy::launchesOf("wide_shadow");
        ::setenv("PELLUCID_BUILD_SHARE", (prefix + folder).c_str(), 1);
        pellucid::check(pelWarmUpPrograms(own.get(), &work, nullptr));
        ::unsetenv("PELLUCID_BUILD_SHARE");
        const uint64_t launched = spy::launchesOf("shade") + spy::launchesOf("wide_shadow") - before;
        if (prefix.empty())
            EXPECT_GE(launched, 2u);
        else
            EXPECT_EQ(launched, 0u) << "another process has begun them";
        small.shader.commit().execute();
        pictures[!prefix.empty()] = small.target.readAll<float>();
    }
    EXPECT_EQ(pictures[0], pictures[1]);
    EXPECT_GT(*std::max_element(pictures[0].begin(), pictures[0].end()), 0.01f);
    std::filesystem::remove_all(folder);
}

TEST(WarmUp, SaysWhatIsWrong) {
    const Device own(""), other("");
    Shader empty(own), foreign(other);
    const PelShader foreignHandle = foreign.get(), emptyHandle = empty.get();
    const auto refused = [&](const char* words, uint32_t groups, const PelShader* shaders, uint32_t count) {
        PelWarmUp work = workOf({}, groups);
        work.shaders = shaders, work.numShaders = count;
        expectRefused(words, [&] { return pelWarmUpPrograms(own.get(), &work, nullptr); });
    };
    refused("PelProgramGroup", 64, nullptr, 0);
    refused("shaders", 0, nullptr, 1);
    refused("another PelDevice", 0, &foreignHandle, 1);
    refused("radiance image is needed", 0, &emptyHandle, 1);
    EXPECT_EQ(pelWarmUpPrograms(own.get(), nullptr, nullptr), PEL_ERROR_INVALID_ARGUMENT);
    const PelWarmUp nothing = workOf({});
    uint32_t built = 9;
    EXPECT_EQ(pelWarmUpPrograms(own.get(), &nothing, &built), PEL_SUCCESS);
    EXPECT_EQ(built, 0u);
}

}  // namespace
