// Devices, buffers, errors and events, which all other objects use.
#include <CL/cl.h>

#include <cstring>

#include "variable.h"

using namespace pellucid;

TEST(Device, EnumeratesAndSelects) {
    const std::vector<PelDeviceInfo> all = Device::all();
    ASSERT_FALSE(all.empty()) << "no OpenCL device: install pocl-opencl-icd";
    for (const PelDeviceInfo& info : all) {
        EXPECT_GT(info.computeUnits, 0u) << info.name;
        EXPECT_GT(info.globalMemoryBytes, 0u) << info.name;
        EXPECT_TRUE(info.mathWidth == 1 || info.mathWidth == 8 || info.mathWidth == 16) << info.name;
        EXPECT_EQ(Device(std::to_string(info.index)).info().index, info.index);
        EXPECT_STREQ(Device(std::string(info.name)).info().name, info.name);
    }
}

TEST(Device, UnknownSelectorListsWhatThereIs) {
    const std::string first = Device::all()[0].name;
    expectRefused(PEL_ERROR_NO_DEVICE, {"no such device", first.c_str()}, [] { Device("no such device"); });
    EXPECT_THROW(Device("4000000000"), Error);
}

TEST(Device, EnvironmentSelects) {
    const Variable device("PELLUCID_DEVICE"), width("PELLUCID_MATH_WIDTH");
    device.set("no such device");
    EXPECT_THROW(Device(""), Error);
    EXPECT_NO_THROW(Device("0")) << "a selector goes before the environment";
    device.set("0");
    EXPECT_EQ(Device("").info().index, 0u);
    width.set("1");
    const PelDeviceInfo oneLane = Device("").info();
    EXPECT_EQ(oneLane.mathWidth, 1u);
    EXPECT_FALSE(std::strstr(oneLane.quirks, "-wide arithmetic")) << oneLane.quirks;
    width.set("8");
    EXPECT_TRUE(std::strstr(Device("").info().quirks, "explicit 8-wide arithmetic"));
    width.set("7");
    expectRefused("PELLUCID_MATH_WIDTH", [] { Device(""); });
}

TEST(Device, CallersContextAndQueue) {
    const Device first("");
    void *context = nullptr, *id = nullptr, *queue = nullptr;
    check(pelDeviceGetCl(first.get(), &context, &id, &queue));
    const Device second = Device::fromCl(context, id, queue);
    const Buffer buffer(second, std::vector<float>{1, 2, 3});
    EXPECT_EQ(buffer.readAll<float>(), (std::vector<float>{1, 2, 3}));
    EXPECT_EQ(second.info().index, UINT32_MAX);
    EXPECT_THROW(Device::fromCl(context, id, nullptr), Error);
}

TEST(Handles, OlderCallersGetTheFieldsTheyKnow) {
    const Device device("");
    PelDeviceInfo info = pelDeviceInfoDefaults();
    info.structSize = offsetof(PelDeviceInfo, clockMhz);
    info.clockMhz = 12345;
    check(pelDeviceGetInfo(device.get(), &info));
    EXPECT_GT(info.computeUnits, 0u);
    EXPECT_EQ(info.clockMhz, 12345u) << "written beyond the caller's structure";
}

// A size that no header has had would split a field between the caller's value and the default. Structures of
// a later header are longer; their further fields are not touched.
TEST(Handles, StructuresAreWholeFields) {
    const Device device("");
    const Shader shader(device);
    const auto accepted = [](auto defaults, const auto& call) {
        struct Longer {
            decltype(defaults) now;
            char later[8];
        };
        std::set<uint32_t> sizes;
        for (uint32_t size = 0; size <= sizeof(Longer); ++size) {
            Longer longer{defaults, {7, 7, 7, 7, 7, 7, 7, 7}};
            longer.now.structSize = size;
            if (call(&longer.now) == PEL_SUCCESS)
                sizes.insert(size);
            else
                EXPECT_NE(std::strstr(pelGetErrorMessage(), "structSize"), nullptr)
                    << size << ": " << pelGetErrorMessage();
            for (char c : longer.later) EXPECT_EQ(c, 7) << size;
        }
        return sizes;
    };
    const auto camera = [&](const PelCamera* c) { return pelShaderSetCamera(shader.get(), c); };
    EXPECT_EQ(accepted(pelCameraDefaults(), camera), (std::set<uint32_t>{16, 80, 84, 88}));
    EXPECT_EQ(accepted(pelAmbientDefaults(),
                       [&](const PelAmbient* a) { return pelShaderSetAmbient(shader.get(), a); }),
              (std::set<uint32_t>{16, 124, 128, 132}));
    EXPECT_EQ(accepted(pelDeviceStatsDefaults(),
                       [&](PelDeviceStats* s) { return pelDeviceGetStats(device.get(), s); }),
              (std::set<uint32_t>{8, 16, 24, 32, 40, 48, 56, 60, 64, 68, 72}));
    PelCamera huge = pelCameraDefaults();
    for (const uint32_t size : {1u << 17, UINT32_MAX, UINT32_MAX - 3}) {
        huge.structSize = size;
        EXPECT_EQ(camera(&huge), PEL_ERROR_INVALID_ARGUMENT) << size;
    }
}

TEST(Buffers, ReadWriteMapAndRanges) {
    const Device device("");
    const Buffer buffer(device, 4 * sizeof(int));
    EXPECT_EQ(buffer.readAll<int>(), (std::vector<int>{0, 0, 0, 0}));
    const int values[2] = {7, 8};
    buffer.write(values, sizeof values, sizeof(int));
    int* mapped = static_cast<int*>(buffer.map());
    EXPECT_EQ(mapped[1], 7);
    mapped[3] = 9;
    buffer.unmap();
    EXPECT_EQ(buffer.readAll<int>(), (std::vector<int>{0, 7, 8, 9}));
    EXPECT_EQ(pelBufferUnmap(buffer.get()), PEL_ERROR_INVALID_STATE);
    EXPECT_EQ(pelBufferWrite(buffer.get(), 12, 8, values, nullptr), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(pelBufferWrite(buffer.get(), SIZE_MAX, 8, values, nullptr), PEL_ERROR_INVALID_ARGUMENT);
    PelBuffer none = nullptr;
    EXPECT_EQ(pelBufferCreate(device.get(), 0, nullptr, &none), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(none, nullptr);
    EXPECT_EQ(pelBufferCreate(device.get(), SIZE_MAX / 2, nullptr, &none), PEL_ERROR_OUT_OF_MEMORY);
}

TEST(Buffers, HostMemoryInPlace) {
    const Device device("");
    alignas(4096) static int memory[1024];
    for (int i = 0; i < 1024; ++i) memory[i] = i;
    const Buffer buffer = Buffer::fromHost(device, memory, sizeof memory);
    EXPECT_EQ(buffer.readAll<int>()[1023], 1023);
    const int value = -5;
    buffer.write(&value, sizeof value, 40);
    EXPECT_EQ(buffer.map(), memory);
    EXPECT_EQ(memory[10], -5);
    buffer.unmap();
}

TEST(Events, DoneAndWaits) {
    const Device device("");
    const Buffer buffer(device, 1 << 20);
    std::vector<char> source(1 << 20, 3), back(1 << 20);
    PelEvent written = nullptr, read = nullptr;
    const PelSubmit write{nullptr, 0, &written};
    buffer.write(source.data(), source.size(), 0, &write);
    const PelSubmit then{&written, 1, &read};
    buffer.read(back.data(), back.size(), 0, &then);
    Event(read).wait();
    int done = 0;
    check(pelEventIsDone(written, &done));
    EXPECT_EQ(done, 1);
    EXPECT_EQ(back, source);
    pelEventRelease(written);
    const PelSubmit broken{nullptr, 2, nullptr};
    EXPECT_EQ(pelBufferRead(buffer.get(), 0, 4, back.data(), &broken), PEL_ERROR_INVALID_ARGUMENT);
}

// PoCL aborts when a queued command waits for such an event.
TEST(Events, WaitingForAFailedEventIsAnError) {
    const Device device("");
    const Buffer buffer(device, std::vector<int>{1, 2});
    void *context = nullptr, *id = nullptr, *queue = nullptr;
    check(pelDeviceGetCl(device.get(), &context, &id, &queue));
    cl_int code = CL_SUCCESS;
    const cl_event failed = clCreateUserEvent(cl_context(context), &code);
    PelEvent event = nullptr;
    check(pelEventCreateFromCl(device.get(), failed, &event));
    ASSERT_EQ(clSetUserEventStatus(failed, -5), CL_SUCCESS);
    const PelSubmit after{&event, 1, nullptr};
    int back[2] = {};
    expectRefused(PEL_ERROR_OUT_OF_MEMORY, {"PelSubmit.waits[0]"},
                  [&] { return pelBufferRead(buffer.get(), 0, sizeof back, back, &after); });
    int done = 7;
    EXPECT_NE(pelEventIsDone(event, &done), PEL_SUCCESS);
    EXPECT_NE(pelEventWait(event), PEL_SUCCESS);
    pelEventRelease(event);
    clReleaseEvent(failed);
    EXPECT_EQ(buffer.readAll<int>(), (std::vector<int>{1, 2}));
}

TEST(Events, OfAnotherDeviceAreRefused) {
    const Device one(""), other("");
    const Buffer buffer(one, std::vector<int>{1, 2}), elsewhere(other, std::vector<int>{3, 4});
    int back[2] = {};
    PelEvent event = nullptr;
    PelSubmit submit{nullptr, 0, &event};
    check(pelBufferRead(elsewhere.get(), 0, sizeof back, back, &submit));
    submit = {&event, 1, nullptr};
    expectRefused(PEL_ERROR_INVALID_ARGUMENT, {"PelSubmit.waits[0]", "another device"},
                  [&] { return pelBufferRead(buffer.get(), 0, sizeof back, back, &submit); });
    check(pelEventWait(event));
    pelEventRelease(event);
}

TEST(Errors, HaveNames) {
    EXPECT_STREQ(pelErrorName(PEL_ERROR_NO_DEVICE), "PEL_ERROR_NO_DEVICE");
}

TEST(Errors, CallbacksMayFailAndThrow) {
    static int heard;
    heard = 0;
    pelSetErrorCallback(
        [](void*, PelError, const char* message) {
            ++heard;
            EXPECT_EQ(pelDeviceFinish(nullptr), PEL_ERROR_INVALID_ARGUMENT);  // tells nobody
            EXPECT_NE(std::string(message).find("no such device"), std::string::npos)
                << "still the outer one";
            throw std::runtime_error("from the callback");
        },
        nullptr);
    PelDevice device = nullptr;
    EXPECT_EQ(pelDeviceCreate("no such device", &device), PEL_ERROR_NO_DEVICE);
    pelSetErrorCallback(nullptr, nullptr);
    EXPECT_EQ(heard, 1);
    EXPECT_NE(std::string(pelGetErrorMessage()).find("no such device"), std::string::npos);
}

TEST(Errors, ProgressCallbacksMayThrow) {
    const Device device("");
    const uint32_t triangle[3] = {0, 1, 2};
    PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
    desc.numVertices = desc.numIndices = 3;
    desc.indices = triangle;
    device.setProgress([](void*, double, const char*) -> int { throw std::runtime_error("enough of it"); },
                       nullptr);
    expectRefused(PEL_ERROR_UNKNOWN, {"enough of it"}, [&] { MeshTopology(device, desc); });
    device.setProgress(nullptr, nullptr);
    MeshTopology(device, desc);
}

TEST(Errors, TheLogHearsNamesErrorsAndWarnings) {
    struct Heard {
        std::vector<std::string> lines;
        static void hear(void* user, PelLogLevel level, const char* object, const char* text) {
            static_cast<Heard*>(user)->lines.push_back(std::to_string(level) + "|" + object + "|" + text);
            pelBufferRelease(PelBuffer(user));  // wrong, and not heard
        }
    } heard;
    const Device device("");
    const Buffer buffer(device, 64);
    Shader shader(device);
    shader.setName("hero's shader");
    pelSetLogCallback(&Heard::hear, &heard);
    expectRefused({"hero's shader: "}, [&] { shader.commit(); });
    ASSERT_EQ(heard.lines.size(), 1u);
    EXPECT_EQ(heard.lines[0].rfind("0|hero's shader|", 0), 0u) << heard.lines[0];
    EXPECT_EQ(heard.lines[0].find("hero's shader", 16), std::string::npos) << "once: " << heard.lines[0];
    char byte;
    expectRefused({"the read"}, [&] { buffer.read(&byte, 1, 64); });
    EXPECT_EQ(heard.lines.at(1).rfind("0||the read", 0), 0u) << "the name was that of another call";
    shader.setName("");
    expectRefused({""}, [&] { shader.commit(); });
    EXPECT_EQ(heard.lines.at(2).rfind("0||", 0), 0u) << heard.lines[2];
    const std::vector<float> ones(3 * 16 * 16, 1);
    for (const PelImageSlot slot : {PEL_SLOT_NORMAL_SHADING, PEL_SLOT_RADIANCE})
        shader.set(slot, imageDesc(Buffer(device, ones), PEL_FORMAT_RGB32F, 16, 16));
    PelMaterial material = pelMaterialDefaults();
    material.borderColor[0] = 0.5f;  // needs a method that scatters irradiance
    material.scattering = PEL_SCATTERING_PREINTEGRATED;
    shader.setMaterial(1, material);
    shader.setName("face");
    shader.commit();
    pelSetLogCallback(nullptr, nullptr);
    ASSERT_GT(heard.lines.size(), 3u);
    std::string warnings;
    for (size_t i = 3; i < heard.lines.size(); ++i) {
        ASSERT_EQ(heard.lines[i].rfind("1|face|", 0), 0u) << heard.lines[i];
        warnings += (i > 3 ? "\n" : "") + heard.lines[i].substr(7);
    }
    EXPECT_EQ(warnings, shader.warnings());
    // The error callback, which is called first, removes the other one.
    pelSetLogCallback(&Heard::hear, &heard);
    pelSetErrorCallback([](void*, PelError, const char*) { pelSetLogCallback(nullptr, nullptr); }, nullptr);
    heard.lines.clear();
    expectRefused("cannot be named", [] { return pelSetName(nullptr, "nothing"); });
    pelSetErrorCallback(nullptr, nullptr);
    EXPECT_TRUE(heard.lines.empty());
}

TEST(Device, MemoryComesFromTheHost) {
    struct Host {
        size_t bytes = 0;
        bool full = false;
        static void* allocate(void* user, void* context, size_t bytes) {
            Host& host = *static_cast<Host*>(user);
            if (host.full) return nullptr;
            host.bytes += bytes;
            cl_mem memory =
                clCreateBuffer(cl_context(context), CL_MEM_READ_WRITE, bytes + 64, nullptr, nullptr);
            const cl_uchar garbage = 0xab;
            const auto queue = cl_command_queue(host.queue);
            clEnqueueFillBuffer(queue, memory, &garbage, 1, 0, bytes, 0, nullptr, nullptr);
            clFinish(queue);
            return memory;
        }
        void* queue = nullptr;
    } host;
    PelDeviceDesc desc = pelDeviceDescDefaults();
    desc.selector = "";
    desc.allocate = &Host::allocate;
    desc.allocateUser = &host;
    const Device device(desc);
    pellucid::check(pelDeviceGetCl(device.get(), nullptr, nullptr, &host.queue));
    const Buffer zeros(device, 4096), ones(device, std::vector<float>(100, 1));
    EXPECT_EQ(host.bytes, 4096u + 400u);
    EXPECT_EQ(device.stats().bytesAllocated, host.bytes);
    EXPECT_EQ(zeros.readAll<float>(), std::vector<float>(1024));
    EXPECT_EQ(ones.readAll<float>(), std::vector<float>(100, 1));
    const uint32_t corners[] = {0, 1, 2};
    PelMeshTopologyDesc triangle = pelMeshTopologyDescDefaults();
    triangle.numVertices = 3, triangle.indices = corners, triangle.numIndices = 3;
    const std::vector<char> saved = pellucid::MeshTopology(device, triangle).save();
    pellucid::MeshTopology::load(device, saved.data(), saved.size());  // the memory is longer than that
    host.full = true;
    expectRefused(PEL_ERROR_OUT_OF_MEMORY, {"PelDeviceDesc.allocate could not provide 64 bytes"},
                  [&] { Buffer(device, 64); });
}
