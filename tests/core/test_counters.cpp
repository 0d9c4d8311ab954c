// The counters of a device against the driver's calls: a counter that never changes would pass any comparison
// with itself.
#include "test.h"

#include "cl/cl_spy.h"

using namespace pellucid;

namespace {

struct Change {
    PelDeviceStats stats;
    spy::Counts asked;
};

// The change by `work`. Reading the counters waits, and makes no call that is counted.
template <class Work>
Change changeBy(const Device& device, const Work& work) {
    const Change before{device.stats(), spy::counts()};
    work();
    const spy::Counts asked = spy::counts();
    Change c{device.stats(), asked};
    for (auto field : {&PelDeviceStats::launches, &PelDeviceStats::bytesToDevice,
                       &PelDeviceStats::bytesToHost, &PelDeviceStats::bytesAllocated})
        c.stats.*field -= before.stats.*field;
    c.stats.kernelMilliseconds -= before.stats.kernelMilliseconds;
    for (auto field : {&spy::Counts::buffersMade, &spy::Counts::bytesCopied, &spy::Counts::transfers,
                       &spy::Counts::launches})
        c.asked.*field -= before.asked.*field;
    return c;
}

class Counters : public testing::Test {
  protected:
    const Device device{""};
    void SetUp() override {
        const auto before = spy::counts().buffersMade;
        const Buffer probe(device, 16);
        if (spy::counts().buffersMade == before)
            GTEST_SKIP() << "another library stands before the spy (Oclgrind)";
    }
};

}  // namespace

TEST_F(Counters, TransfersAreTheDrivers) {
    const Buffer buffer(device, 4096);
    std::vector<char> bytes(4096, 3);
    Change c = changeBy(device, [&] { buffer.write(bytes.data(), 1000, 8); });
    EXPECT_EQ(c.asked.transfers, 1u);
    EXPECT_EQ(c.asked.bytesCopied, 1000u);
    EXPECT_EQ(c.stats.bytesToDevice, 1000u);
    EXPECT_EQ(c.stats.bytesToHost, 0u);
    c = changeBy(device, [&] { buffer.read(bytes.data(), 77); });
    EXPECT_EQ(c.asked.bytesCopied, 77u);
    EXPECT_EQ(c.stats.bytesToHost, 77u);
    EXPECT_EQ(c.stats.bytesToDevice, 0u);
    c = changeBy(device, [&] { Buffer(device, bytes); });
    EXPECT_EQ(c.stats.bytesToDevice, 4096u);
    EXPECT_EQ(c.stats.bytesAllocated, 4096u);
    EXPECT_EQ(c.asked.buffersMade, 1u);
    c = changeBy(device, [&] { Buffer(device, 100); });
    EXPECT_EQ(c.stats.bytesAllocated, 100u);
    EXPECT_EQ(c.asked.buffersMade, 1u);
}

TEST_F(Counters, LaunchesAreTheDrivers) {
    PelSpecularLutDesc desc = pelSpecularLutDescDefaults();
    desc.width = desc.height = 8;
    const Change c = changeBy(device, [&] { Lut(device, desc).read<uint16_t>(PEL_LUT_HALF); });
    EXPECT_GE(c.asked.launches, 2u);
    EXPECT_EQ(c.stats.launches, c.asked.launches);
    EXPECT_EQ(c.stats.bytesToHost, 3u * 64 * 2);
}

// A frame in the host's memory is read and written in place.
TEST_F(Counters, NothingIsCopiedOfAHostsFrame) {
    if (!device.info().sharedMemory) GTEST_SKIP() << "memory is not shared";
    constexpr uint32_t width = 64, height = 48, pixels = width * height;
    std::vector<float> frame(size_t(6) * pixels);
    for (uint32_t i = 0; i < pixels; ++i) frame[3 * i + 2] = 1;
    Shader shader(device);
    PelMaterial material = pelMaterialDefaults();
    std::fill_n(material.albedo, 3, 0.5f);
    PelAmbient ambient = pelAmbientDefaults();
    std::fill_n(ambient.constant, 3, 1.0f);
    const Change made = changeBy(device, [&] {
        const Buffer memory = Buffer::fromHost(device, frame.data(), frame.size() * sizeof(float));
        shader.setMaterial(1, material).set(ambient);
        shader.set(PEL_SLOT_NORMAL_SHADING, imageDesc(memory, PEL_FORMAT_RGB32F, width, height));
        shader.set(PEL_SLOT_RADIANCE, imageDesc(memory, PEL_FORMAT_RGB32F, width, height, 12ull * pixels));
        shader.commit().execute();
    });
    EXPECT_LT(made.asked.bytesCopied, 12u * pixels) << "constants, and no image";
    EXPECT_LT(made.stats.bytesToDevice + made.stats.bytesToHost, 12u * pixels);
    EXPECT_EQ(frame[3 * pixels], 0.5f) << "it was there, or this says nothing";
    // From then on not a byte, and no buffer.
    frame.assign(frame.size(), 1);
    const Change again = changeBy(device, [&] { shader.execute(); });
    EXPECT_GT(again.asked.launches, 0u);
    EXPECT_EQ(again.stats.launches, again.asked.launches);
    EXPECT_EQ(again.asked.transfers, 0u);
    EXPECT_NEAR(again.stats.kernelMilliseconds, shader.stats().deviceMilliseconds, 1e-9);
    EXPECT_GT(again.stats.kernelMilliseconds, 0);
    EXPECT_EQ(again.asked.buffersMade, 0u);
    EXPECT_EQ(again.stats.bytesToDevice + again.stats.bytesToHost + again.stats.bytesAllocated, 0u);
    EXPECT_EQ(frame[3 * pixels], 0.5f);
}

// Every object that a call creates is released with its owner, also after failures.
TEST_F(Counters, NothingIsLeft) {
    const auto work = [&] {
        PelEvent done = nullptr;
        const Buffer buffer(device, 64);
        const PelSubmit submit{nullptr, 0, &done};
        buffer.read(nullptr, 0, 0, &submit);
        const Event first(done);
        PelEvent then = nullptr;
        const PelSubmit after{&done, 1, &then};
        int value = 0;
        buffer.read(&value, 4, 0, &after);
        Event(then).wait();
        PelSpecularLutDesc desc = pelSpecularLutDescDefaults();
        desc.width = desc.height = 4;
        Lut(device, desc).read<float>(PEL_LUT_FLOAT);
        EXPECT_EQ(pelBufferRead(buffer.get(), 60, 8, &value, &submit), PEL_ERROR_INVALID_ARGUMENT);
    };
    work();
    device.stats();
    const spy::Counts before = spy::counts();
    for (int i = 0; i < 5; ++i) work();
    device.stats();  // forgets the events of finished launches
    const spy::Counts now = spy::counts();
    for (auto field : {&spy::Counts::events, &spy::Counts::memory, &spy::Counts::kernels,
                       &spy::Counts::programs, &spy::Counts::queues, &spy::Counts::contexts})
        EXPECT_EQ(now.*field, before.*field);
}
