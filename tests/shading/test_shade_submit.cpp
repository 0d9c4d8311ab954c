// Threads, events, progress and what a second frame costs.
#include <thread>

#include "cl/cl_spy.h"
#include "shader_ready.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::imageDesc;
using pellucid::Shader;

namespace {

TEST(ShadeSubmit, EventsAndKeptObjects) {
    const Frame f = randomFrame(5, 120, 60, 1);
    const auto expected = shade(device(), f, tables());
    const Buffer target(device(), f.pixels() * 12);
    PelEvent done = nullptr;
    {
        Shader shader(device());
        setFrame(device(), shader, f, tables());  // its images are released here, and kept by the shader
        shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, f.width, f.height)).commit();
        const PelSubmit submit{nullptr, 0, &done};
        shader.execute(&submit);
    }
    pellucid::Event event(done);
    event.wait();
    EXPECT_EQ(target.readAll<float>(), expected);
}

// --- progress and cancelling ---

struct Listener {
    std::vector<double> heard;
    double stopAt = 2;
};
int listen(void* user, double fraction, const char* what) {
    auto& listener = *static_cast<Listener*>(user);
    EXPECT_STREQ(what, "shading");
    listener.heard.push_back(fraction);
    return fraction < listener.stopAt;
}

TEST(ShadeProgress, IsToldAndMayCancel) {
    const pellucid::Device own("");
    const Tables ownTables = makeTables(own);
    Frame f = randomFrame(9, 2100, 1024, 1);  // more than two million pixels
    f.materials.erase(7);
    for (auto& [id, m] : f.materials) m.thicknessTaps = 0;
    const auto right = shade(own, f, ownTables);
    Listener patient, impatient;
    impatient.stopAt = 0.3;
    Shader shader(own);
    setFrame(own, shader, f, ownTables);
    const Buffer target(own, std::vector<float>(f.pixels() * 3, -3));
    shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, f.width, f.height)).commit();
    pellucid::check(pelDeviceSetProgress(own.get(), listen, &impatient));
    expectError(PEL_ERROR_CANCELLED, {"shading"}, [&] { shader.execute(); });
    const auto part = target.readAll<float>();
    size_t done = 0, left = 0;
    for (size_t i = 0; i < part.size(); ++i) {
        if (f.slots[PEL_SLOT_MATERIAL].values[i / 3] == 0 || f.slots[PEL_SLOT_MATERIAL].values[i / 3] == 7)
            continue;
        (part[i] == -3 ? left : done)++;
    }
    EXPECT_GT(done, 0u) << "the first million";
    EXPECT_GT(left, done / 2) << "not the rest";

    pellucid::check(pelDeviceSetProgress(own.get(), listen, &patient));
    shader.execute();
    EXPECT_GE(patient.heard.size(), 4u);
    EXPECT_EQ(patient.heard.front(), 0);
    EXPECT_EQ(patient.heard.back(), 1);
    EXPECT_TRUE(std::is_sorted(patient.heard.begin(), patient.heard.end()));
    // Work that is submitted without waiting tells no progress, so it cannot be cancelled.
    patient.heard.clear();
    PelEvent done_ = nullptr;
    PelSubmit submit{};
    submit.done = &done_;
    shader.execute(&submit);
    EXPECT_TRUE(patient.heard.empty());
    pellucid::check(pelDeviceSetProgress(own.get(), nullptr, nullptr));
    const auto all = target.readAll<float>();
    pelEventRelease(done_);
    for (size_t i = 0; i < all.size(); ++i)
        if (all[i] != -3) {
            ASSERT_EQ(all[i], right[i]) << "the same bits in parts as at once";
        }
}

TEST(ShadeStats, NothingIsSentOrBuiltTwice) {
    Frame f = randomFrame(5, 120, 60, 1);
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    const auto target = setTarget(device(), shader, f);
    shader.commit().execute();
    PelShaderStats stats = shader.stats();
    EXPECT_GT(stats.bytesUploaded, 0u);
    EXPECT_EQ(stats.launches, 2u);
    const uint64_t built = stats.programsBuilt;
    const uint64_t sent = device().stats().bytesToDevice, allocated = device().stats().bytesAllocated;
    const spy::Counts asked = spy::counts();
    shader.set(f.ambient).commit().execute();
    shader.execute();
    EXPECT_EQ(spy::counts().transfers, asked.transfers);
    EXPECT_EQ(spy::counts().buffersMade, asked.buffersMade);
    stats = shader.stats();
    EXPECT_EQ(stats.bytesUploaded, 0u);
    EXPECT_EQ(stats.programsBuilt, built);
    EXPECT_EQ(device().stats().bytesToDevice, sent);
    EXPECT_EQ(device().stats().bytesAllocated, allocated);
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
