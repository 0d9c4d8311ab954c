// Shaders used from several threads, on one device and on several; objects that outlive the caller's device;
// progress and cancelling; and the cost of a second frame.
#include "held_queue.h"
#include "pass_scene.h"
#include "shader_ready.h"

using namespace shade_test;

namespace {

// A shader of its own, executed again and again; every frame must be the same to the bit.
void shadeOften(const Device& device, const Tables& tables, const Frame& f, const std::vector<float>& right,
                int* wrong) {
    for (int i = 0; i < 3; ++i) {
        auto [shader, target] = shaderOf(f, device, tables);
        shader.commit();
        for (int k = 0; k < 4; ++k) {
            shader.execute();
            *wrong += target.readAll<float>() != right;
        }
        *wrong += shader.stats().pixelsShaded == 0;
    }
}

// Frames that one variant shades.
std::vector<Frame> frames(uint32_t count) {
    std::vector<Frame> made;
    for (uint32_t seed = 1; seed <= count; ++seed) {
        made.push_back(randomFrame(seed, 150, 20 + seed, 1));
        made.back().lights[0].params.type = PEL_LIGHT_DIRECTIONAL;
    }
    return made;
}

TEST(ShadeThreads, ShadersOnOneDeviceAndOnTwo) {
    const std::vector<Frame> all = frames(4);
    std::vector<std::vector<float>> right;
    for (const Frame& f : all) right.push_back(shade(f));
    const Device first(""), second("");
    const Tables firstTables = makeTables(first), secondTables = makeTables(second);
    for (const bool two : {false, true}) {
        int wrong[4] = {};
        const uint32_t before = first.stats().programsBuilt;
        {
            std::vector<std::jthread> threads;
            for (size_t i = 0; i < 4; ++i)
                threads.emplace_back([&, i] {
                    const bool other = two && i % 2;
                    shadeOften(other ? second : first, other ? secondTables : firstTables, all[i], right[i],
                               &wrong[i]);
                });
        }
        for (int i = 0; i < 4; ++i)
            EXPECT_EQ(wrong[i], 0) << "thread " << i << (two ? ", two devices" : ", one device");
        EXPECT_EQ(first.stats().programsBuilt - before, two ? 0u : 2u)
            << "shading and classification: whoever comes second waits for the first";
    }
}

// Constants are written between the bands of a frame. Another shader's must not be overwritten.
TEST(ShadeThreads, SubmissionsOfSeveralShadersInOneQueue) {
    const std::vector<Frame> all = frames(3);
    std::vector<FrameShader> made;
    for (const Frame& f : all) made.emplace_back(shaderOf(f)).shader.commit();
    const PelSubmit submit{};
    for (int round = 0; round < 3; ++round)
        for (const FrameShader& each : made) each.shader.execute(&submit);
    for (size_t i = 0; i < all.size(); ++i) EXPECT_EQ(made[i].target.readAll<float>(), shade(all[i])) << i;
}

// Work that is queued when its objects are released is done all the same.
TEST(ReleasedDevice, QueuedWorkIsDone) {
    const Frame f = randomFrame(1, 60, 20, 1);
    const auto right = shade(f);
    std::vector<float> result(f.pixels() * 3);
    {
        const Device own("");
        const Tables ownTables = makeTables(own);
        Shader shader(own);
        const Buffer target = Buffer::fromHost(own, result.data(), result.size() * 4);
        setFrame(own, shader, f, ownTables);
        shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, f.width, f.height)).commit();
        const PelSubmit submit{};
        shader.execute(&submit);
        if (!own.info().sharedMemory) target.read(result.data(), result.size() * 4);
    }
    EXPECT_EQ(result, right);
}

// --- progress ---

struct Listener {
    int calls = 0, stopAt = 0;
    double last = -1;
};
int listen(void* user, double fraction, const char* what) {
    auto& listener = *static_cast<Listener*>(user);
    EXPECT_STREQ(what, "shading");
    EXPECT_GT(fraction, listener.last);
    listener.last = fraction;
    return ++listener.calls != listener.stopAt;
}

// Of a frame of more than two million pixels, and of one in bands.
TEST(ShadeProgress, IsToldAndMayCancel) {
    const Device own("");
    const Tables ownTables = makeTables(own, 32, 32);
    for (const bool bands : {false, true}) {
        Frame f = bands ? reliefFrame(4, 64, 40, 0.4f) : randomFrame(9, 2100, 1024, 1);
        if (bands) f.lights = {mapLight(4).light};
        f.options.scratchBudget = bands ? 64 * 4 * 8 : 0;
        for (auto& [id, m] : f.materials) m.thicknessTaps = 0;
        const auto right = shade(own, f, ownTables);
        Shader shader(own);
        setFrame(own, shader, f, ownTables);
        const Buffer target(own, std::vector<float>(f.pixels() * 3, -3));
        shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, f.width, f.height)).commit();
        // Pixels that are made, and those that are not.
        const auto made = [&] {
            size_t is[2] = {};
            const auto shown = target.readAll<float>();
            for (size_t i = 0; i < shown.size(); ++i) {
                if (f.slots[PEL_SLOT_MATERIAL].values[i / 3] == 0) continue;
                ++is[shown[i] != -3];
                if (shown[i] != -3 && shown[i] != right[i])
                    ADD_FAILURE() << "the same bits in parts as at once";
            }
            return std::pair(is[0], is[1]);
        };
        Listener listener{0, 3};
        pellucid::check(pelDeviceSetProgress(own.get(), listen, &listener));
        expectRefused(PEL_ERROR_CANCELLED, {"shading"}, [&] { shader.execute(); });
        EXPECT_GT(made().first, 0u) << "not all";
        EXPECT_GT(made().second, 0u) << "what was made before";
        listener = {};
        shader.execute();
        EXPECT_EQ(listener.calls, bands ? 6 : 4);
        EXPECT_EQ(listener.last, 1);
        EXPECT_EQ(made().first, 0u);
        // Work that is submitted without waiting reports no progress, so it cannot be cancelled.
        listener = {};
        PelEvent done = nullptr;
        const PelSubmit submit{nullptr, 0, &done};
        shader.execute(&submit);
        pellucid::Event(done).wait();
        EXPECT_EQ(listener.calls, 0);
        pellucid::check(pelDeviceSetProgress(own.get(), nullptr, nullptr));
        EXPECT_EQ(made().first, 0u);
    }
}

// Names, launches, tiles and times of passes, of frames that the caller waits for and of frames in flight.
TEST(ShadeStats, PassesByName) {
    Frame f = randomFrame(5, 120, 60, 1);
    for (const uint32_t profiling : {1u, 0u}) {
        PelDeviceDesc desc = pelDeviceDescDefaults();
        desc.selector = device().info().name;
        desc.profiling = profiling;
        const pellucid::Device own(desc);
        auto [shader, target] = shaderOf(f, own, makeTables(own));
        shader.commit();
        own.finish();
        EXPECT_TRUE(shader.passes().empty()) << "nothing was executed";
        shader.execute();
        const PelShaderStats stats = shader.stats();
        std::vector<PelPassStats> passes = shader.passes();
        ASSERT_EQ(passes.size(), 2u);
        EXPECT_STREQ(passes[0].name, "classify_tiles");
        EXPECT_STREQ(passes[1].name, "shade");
        double milliseconds = 0;
        for (const PelPassStats& pass : passes) {
            EXPECT_EQ(pass.launches, 1u);
            EXPECT_EQ(pass.tiles, stats.tilesTotal);
            EXPECT_EQ(pass.execution, 1u);
            EXPECT_EQ(pass.milliseconds > 0, profiling == 1);
            milliseconds += pass.milliseconds;
        }
        EXPECT_GT(passes[0].bytes, stats.tilesTotal * sizeof(uint32_t));
        EXPECT_EQ(milliseconds, stats.deviceMilliseconds);
        if (!profiling) continue;
        // Frames held back: the newest that has finished is the first one until they go on.
        fixture::HeldQueue held(own);
        const spy::Counts before = spy::counts();
        PelEvent done = nullptr;
        const PelSubmit submit{nullptr, 0, &done};
        for (int i = 0; i < 3; ++i) {
            if (done) pelEventRelease(done);
            f.ambient.constant[1] += 0.125f;
            f.lights[0].params.color[0] += 0.125f;
            shader.set(f.lights[0].params).set(f.ambient).set(pelCameraDefaults()).commit();
            shader.execute(&submit);
            EXPECT_EQ(shader.passes().at(1).execution, 1u);
        }
        EXPECT_EQ(spy::counts().waits, before.waits) << "none of these calls waits";
        EXPECT_EQ(spy::counts().buffersMade, before.buffersMade) << "nor allocates";
        held.release();
        pellucid::Event(done).wait();
        EXPECT_EQ(shader.passes().at(1).execution, 4u);
    }
    uint32_t room = 1;
    PelPassStats one = pelPassStatsDefaults();
    FrameShader made = shaderOf(f);
    Shader& shader = made.shader;
    shader.commit().execute();
    expectRefused("2 structures", [&] { return pelShaderGetPasses(shader.get(), &one, &room); });
    PelPassStats two[2] = {one, {}};  // each is as long as the first says
    pellucid::check(pelShaderGetPasses(shader.get(), two, &(room = 2)));
    EXPECT_STREQ(two[1].name, "shade");
    expectRefused("count", [&] { return pelShaderGetPasses(shader.get(), &one, nullptr); });
    expectRefused("PelPassStats", [&] { return pelShaderGetPasses(shader.get(), nullptr, &(room = 9)); });
    PelDeviceDesc desc = pelDeviceDescDefaults();
    desc.profiling = 3;
    expectRefused("PelDeviceDesc.profiling is 3", [&] { pellucid::Device refused(desc); });
}

TEST(ShadeStats, NothingIsSentOrBuiltTwice) {
    Frame f = randomFrame(5, 120, 60, 1);
    auto [shader, target] = shaderOf(f);
    shader.commit().execute();
    const PelShaderStats first = shader.stats();
    EXPECT_GT(first.pixelsSpecular, 0u);
    EXPECT_GT(first.bytesUploaded, 0u);
    const PelDeviceStats before = device().stats();
    const spy::Counts asked = spy::counts();
    shader.set(f.ambient).commit().execute();
    shader.execute();
    EXPECT_EQ(spy::counts().transfers, asked.transfers);
    EXPECT_EQ(spy::counts().buffersMade, asked.buffersMade);
    const PelShaderStats stats = shader.stats();
    EXPECT_EQ(stats.bytesUploaded, 0u);
    EXPECT_EQ(stats.programsBuilt, first.programsBuilt);
    EXPECT_EQ(stats.launches, 2u);
    EXPECT_EQ(stats.pixelsSpecular, first.pixelsSpecular) << "an execution counts from 0";
    EXPECT_EQ(stats.tilesShaded, first.tilesShaded);
    EXPECT_EQ(device().stats().bytesToDevice, before.bytesToDevice);
    EXPECT_EQ(device().stats().bytesAllocated, before.bytesAllocated);
    f.ambient.constant[0] += 1;
    shader.set(f.ambient).commit().execute();
    EXPECT_GT(shader.stats().bytesUploaded, 0u);
    EXPECT_LT(shader.stats().bytesUploaded, 4096u) << "the tables are not sent again";

    f.slots[PEL_SLOT_MATERIAL].values.assign(f.pixels(), 0.0f);
    shader.set(PEL_SLOT_MATERIAL,
               imageDesc(upload(device(), f.slots[PEL_SLOT_MATERIAL]), PEL_FORMAT_R32F, f.width, f.height));
    shader.commit().execute();
    EXPECT_EQ(shader.stats().tilesShaded, 0u);
}

}  // namespace
