// Shaders used from several threads, on one device and on several; and objects that outlive the caller's
// device.
#include <gtest/gtest.h>

#include <thread>

#include "shade_scene.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::Device;
using pellucid::imageDesc;
using pellucid::Shader;

namespace {

// A shader of its own, executed again and again; every frame must be the same to the bit.
void shadeOften(const Device& device, const Tables& tables, const Frame& f, const std::vector<float>& right,
                int* wrong) {
    for (int i = 0; i < 3; ++i) {
        Shader shader(device);
        setFrame(device, shader, f, tables);
        const auto target = setTarget(device, shader, f);
        shader.commit();
        for (int k = 0; k < 4; ++k) {
            shader.execute();
            *wrong += target.readAll<float>() != right;
        }
        *wrong += shader.stats().pixelsShaded == 0;
    }
}

TEST(ShadeThreads, ShadersOnOneDeviceAndOnTwo) {
    std::vector<Frame> frames;
    std::vector<std::vector<float>> right;
    for (uint32_t seed = 1; seed <= 4; ++seed) {
        frames.push_back(randomFrame(seed, 150, 20 + seed, 1));
        frames.back().lights[0].params.type = PEL_LIGHT_DIRECTIONAL;  // one variant
        frames.back().options.countPixels = 1;
        right.push_back(shade(device(), frames.back(), tables()));
    }
    const Device first(""), second("");
    const Tables firstTables = makeTables(first), secondTables = makeTables(second);
    for (const bool two : {false, true}) {
        int wrong[4] = {};
        PelDeviceStats before = pelDeviceStatsDefaults(), after = before;
        pellucid::check(pelDeviceGetStats(first.get(), &before));
        {
            std::vector<std::jthread> threads;
            for (size_t i = 0; i < 4; ++i)
                threads.emplace_back([&, i] {
                    const bool other = two && i % 2;
                    shadeOften(other ? second : first, other ? secondTables : firstTables, frames[i],
                               right[i], &wrong[i]);
                });
        }
        for (int i = 0; i < 4; ++i)
            EXPECT_EQ(wrong[i], 0) << "thread " << i << (two ? ", two devices" : ", one device");
        pellucid::check(pelDeviceGetStats(first.get(), &after));
        EXPECT_EQ(after.programsBuilt - before.programsBuilt, two ? 0u : 1u)
            << "whoever comes second waits for the first";
    }
}

// Constants are written between the bands of a frame. Another shader's must not be overwritten.
TEST(ShadeThreads, SubmissionsOfSeveralShadersInOneQueue) {
    std::vector<Frame> frames;
    std::vector<Shader> shaders;
    std::vector<Buffer> targets;
    for (uint32_t seed = 1; seed <= 3; ++seed) {
        frames.push_back(randomFrame(seed, 150, 20 + seed, 1));
        frames.back().lights[0].params.type = PEL_LIGHT_DIRECTIONAL;
        frames.back().options.countPixels = 1;
        shaders.emplace_back(device());
        targets.emplace_back(device(), frames.back().pixels() * 12);
        setFrame(device(), shaders.back(), frames.back(), tables());
        shaders.back()
            .set(PEL_SLOT_RADIANCE, imageDesc(targets.back(), PEL_FORMAT_RGB32F, 150, 20 + seed))
            .commit();
    }
    const PelSubmit submit{};
    for (int round = 0; round < 3; ++round)
        for (const Shader& shader : shaders) shader.execute(&submit);
    for (size_t i = 0; i < frames.size(); ++i)
        EXPECT_EQ(targets[i].readAll<float>(), shade(device(), frames[i], tables())) << i;
}

TEST(ReleasedDevice, IsKeptByWhatIsMadeOfIt) {
    const Frame f = randomFrame(1, 60, 20, 1);
    const auto right = shade(device(), f, tables());
    PelDevice handle = nullptr;
    Tables own;
    Shader shader;
    Buffer target;
    {
        const Device ours("");
        handle = ours.get();
        own = makeTables(ours);
        shader = Shader(ours);
        target = Buffer(ours, f.pixels() * 12);
        setFrame(ours, shader, f, own);
        shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, f.width, f.height));
    }  // the caller's last reference
    shader.commit().execute();
    EXPECT_EQ(target.readAll<float>(), right);
    EXPECT_EQ(shader.stats().tilesTotal, 10u);
    target = {};  // the shader keeps the image, too
    shader.execute();
    own = {};
    shader.execute();
    shader = {};
    // Nothing is left: the handle is refused, not followed.
    PelDeviceInfo info = pelDeviceInfoDefaults();
    EXPECT_EQ(pelDeviceGetInfo(handle, &info), PEL_ERROR_INVALID_ARGUMENT);
    PelShader late = nullptr;
    EXPECT_EQ(pelShaderCreate(handle, &late), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_FALSE(std::string(pelGetErrorMessage()).empty());
    pelDeviceRelease(handle);  // does nothing
}

// Work that is queued when its objects are released is done all the same.
TEST(ReleasedDevice, QueuedWorkIsDone) {
    const Frame f = randomFrame(1, 60, 20, 1);
    const auto right = shade(device(), f, tables());
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

}  // namespace
