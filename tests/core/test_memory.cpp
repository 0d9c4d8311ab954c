// Memory that runs out is an error, never the end of the process. Each test runs in a fork, which is the
// first to use OpenCL there (and must not, itself, be the parent of others): limits of a process cannot be
// raised again.
#include <sys/resource.h>

#include "cl/error.h"
#include "cl/machine.h"
#include "cl/refused_buffer.h"
#include "core/in_fork.h"
#include "mesh/mesh_calls.h"

using namespace pellucid;

namespace {

// Reports a failure to the parent by the exit code; Google Test in a child would not do that.
#define CHILD_EXPECT(condition)                                                                            \
    do {                                                                                                   \
        if (!(condition)) {                                                                                \
            std::fprintf(stderr, "%s:%d: %s\n%s\n", __FILE__, __LINE__, #condition, pelGetErrorMessage()); \
            ::_exit(1);                                                                                    \
        }                                                                                                  \
    } while (false)

constexpr int notHere = 77;  // exit status of a child: the device has no memory that this test could limit

void expectInFork(const std::function<void()>& work) {
    const int status = inFork([&] {
        work();
        return 0;
    });
    if (status == notHere) GTEST_SKIP() << "the device is no CPU that shares the host's memory";
    EXPECT_EQ(status, 0);
}

struct Used {
    uint64_t addresses = 0, resident = 0;  // bytes
};
Used used() {
    Used u;
    std::ifstream("/proc/self/statm") >> u.addresses >> u.resident;
    const auto page = uint64_t(::sysconf(_SC_PAGESIZE));
    return {u.addresses * page, u.resident * page};
}

void limitAddressSpace(uint64_t more) {
    const rlim_t most = used().addresses + more;
    const rlimit limit{most, most};
    CHILD_EXPECT(::setrlimit(RLIMIT_AS, &limit) == 0);
}

bool sharesMemory(const Device& device) {
    return device.info().type == PEL_DEVICE_CPU && device.info().sharedMemory;
}

std::vector<float> table(const Device& device) {
    PelSpecularLutDesc desc = pelSpecularLutDescDefaults();
    desc.width = desc.height = 8;
    return Lut(device, desc).read<float>(PEL_LUT_FLOAT);
}

void requireSharedMemory(const Device& device) {
    if (!sharesMemory(device)) ::_exit(notHere);
}

}  // namespace

TEST(Memory, AddressSpaceRunsOut) {
    expectInFork([] {
        const Device device("");
        requireSharedMemory(device);
        { Buffer(device, 16).readAll<int>(); }
        limitAddressSpace(1200 << 20);
        for (const size_t bytes : {size_t(200) << 20, size_t(24) << 20, size_t(3) << 20, size_t(100) << 20}) {
            std::vector<Buffer> all;
            PelBuffer made = nullptr;
            PelError error = PEL_SUCCESS;
            for (int i = 0; i < 2000 && error == PEL_SUCCESS; ++i) {
                error = pelBufferCreate(device.get(), bytes, nullptr, &made);
                if (error == PEL_SUCCESS) all.emplace_back(made);
            }
            CHILD_EXPECT(error == PEL_ERROR_OUT_OF_MEMORY);
            CHILD_EXPECT(std::strstr(pelGetErrorMessage(), "memory") ||
                         std::strstr(pelGetErrorMessage(), "ulimit"));
            CHILD_EXPECT(all.size() * bytes > 500u << 20);
            // Existing objects go on working, and everything works again once there is memory.
            const int value = 7;
            all.back().write(&value, sizeof value, bytes - sizeof value);
            int back = 0;
            all.back().read(&back, sizeof back, bytes - sizeof back);
            CHILD_EXPECT(back == 7);
        }
        CHILD_EXPECT(table(device).size() == 3 * 64u);
    });
}

// All calls that allocate report it, not only buffers.
TEST(Memory, TablesAndTopologiesRunOutOfIt) {
    expectInFork([] {
        const Device device("");
        requireSharedMemory(device);
        table(device);
        limitAddressSpace(300 << 20);
        PelSpecularLutDesc desc = pelSpecularLutDescDefaults();
        desc.width = desc.height = 4096;  // 268 MB
        PelLut made = nullptr;
        CHILD_EXPECT(pelSpecularLutCreate(device.get(), &desc, &made, nullptr) == PEL_ERROR_OUT_OF_MEMORY);
        std::vector<uint32_t> indices(3 << 20);
        PelMeshTopologyDesc mesh = pelMeshTopologyDescDefaults();
        mesh.numVertices = 3;
        mesh.indices = indices.data();
        mesh.numIndices = indices.size();
        limitAddressSpace(8 << 20);
        PelMeshTopology topology = nullptr;
        CHILD_EXPECT(pelMeshTopologyCreate(device.get(), &mesh, &topology, nullptr) ==
                     PEL_ERROR_OUT_OF_MEMORY);
    });
}

TEST(Memory, MoreThanThereIsIsNeverPromised) {
    for (const uint64_t bytes : {UINT64_MAX, UINT64_MAX / 2, uint64_t(1) << 50}) {
        try {
            pel::cl::requireMemory(bytes, "a test");
            ADD_FAILURE() << bytes;
        } catch (const pel::Error& e) {
            EXPECT_TRUE(e.code() == PEL_ERROR_OUT_OF_MEMORY && std::strstr(e.what(), "a test")) << e.what();
        }
    }
    EXPECT_NO_THROW(pel::cl::requireMemory(1, "a test"));
    expectInFork([] {
        const Device device("");
        PelBuffer buffer = nullptr;
        for (const size_t bytes :
             {SIZE_MAX, SIZE_MAX / 2, size_t(1) << 50, size_t(device.info().globalMemoryBytes)})
            CHILD_EXPECT(pelBufferCreate(device.get(), bytes, nullptr, &buffer) == PEL_ERROR_OUT_OF_MEMORY);
    });
}

TEST(Memory, HoldsWhatWasAsked) {
    expectInFork([] {
        const Device device("");
        for (const size_t bytes : {1u, 127u, 4095u, 4096u, 4097u, 1u << 20, 33u << 20}) {
            for (int turn = 0; turn < 2; ++turn) {  // the second finds what the first left
                std::vector<char> pattern(bytes);
                for (size_t i = 0; i < bytes; ++i) pattern[i] = char(i * 31 + 1);
                const Buffer zeros(device, bytes), filled(device, pattern);
                CHILD_EXPECT(zeros.readAll<char>() == std::vector<char>(bytes, 0));
                CHILD_EXPECT(filled.readAll<char>() == pattern);
                zeros.write(pattern.data(), bytes);
            }
        }
    });
}

TEST(Memory, LargeMeshesGiveBackAllPages) {
    expectInFork([] {
        const Device device("");
        const fixture::Mesh mesh = fixture::torus(512, 512);
        uint64_t before = 0;
        for (int i = 0; i < 12; ++i) {
            if (i == 2) before = used().resident;  // the allocator keeps what the first ones took
            MeshTopology(device, fixture::topologyDesc(mesh));
        }
        CHILD_EXPECT(used().resident < before + (280u << 20));  // a sanitizer keeps 256 MB of what was freed
    });
}

TEST(Memory, LastsAsLongAsAnybodyHoldsTheMemory) {
    expectInFork([] {
        const Device device("");
        const uint64_t before = used().addresses;
        for (const size_t bytes : {size_t(1000), size_t(256) << 20}) {
            Buffer second;
            {
                const Buffer first(device, std::vector<char>(bytes, 5));
                void* memory = nullptr;
                check(pelBufferGetCl(first.get(), &memory));
                second = Buffer::fromCl(device, memory);
            }
            char last = 0;
            second.read(&last, 1, bytes - 1);
            CHILD_EXPECT(last == 5);
        }
        if (sharesMemory(device)) CHILD_EXPECT(used().addresses < before + (200u << 20));  // given back
    });
}

// Each clCreateBuffer in turn.
TEST(Memory, DriversThatRefuse) {
    expectInFork([] {
        const Device device("");
        const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
        std::vector<float> host(4096, 1), positions{0, 0, 0, 1, 0, 0, 1, 1, 0.5f, 0, 1, 0};
        PelMeshTopologyDesc mesh = pelMeshTopologyDescDefaults();
        mesh.numVertices = 4, mesh.numIndices = 6, mesh.indices = indices;
        PelSpecularLutDesc specular = pelSpecularLutDescDefaults();
        specular.width = specular.height = 4;
        PelCurvatureLutDesc curvature = pelCurvatureLutDescFaceWorks();
        curvature.width = curvature.height = 4;
        PelShadowLutDesc shadow = pelShadowLutDescFaceWorks();
        shadow.width = shadow.height = 4;
        PelCurvatureParams params = pelCurvatureParamsDefaults();
        params.smoothingRadius = 0.5f;
        const std::function<void()> calls[] = {
            [&] { Buffer(device, 100); },
            [&] { Buffer(device, positions); },
            [&] { Buffer(device, size_t(40) << 20); },
            [&] { Buffer::fromHost(device, host.data(), 4096); },
            [&] { Lut(device, specular).read<uint16_t>(PEL_LUT_HALF); },
            [&] { Lut(device, curvature).clippedTexels(); },
            [&] { Lut(device, shadow).read<uint8_t>(PEL_LUT_FACEWORKS8); },
            [&] {
                const MeshTopology topology(device, mesh);
                const Buffer p(device, positions), out(device, 64);
                topology.curvature(params, vertexView(p, 4), vertexView(out, 4));
                const LiveMesh live(topology, params);
                live.update(vertexView(p, 4), nullptr, vertexView(out, 4));
            },
        };
        for (size_t call = 0; call < std::size(calls); ++call) {
            calls[call]();
            const uint64_t before = used().addresses;
            int failures = 0;
            for (int n = 1; n < 100; ++n) {
                const auto [struck, error] = refuseBuffer(n, calls[call]);
                CHILD_EXPECT(error == (struck ? PEL_ERROR_OUT_OF_MEMORY : PEL_SUCCESS));
                calls[call]();  // as if nothing had been
                if (!struck) break;
                ++failures;
            }
            CHILD_EXPECT(failures > 0 && failures < 90);
            CHILD_EXPECT(used().addresses < before + (30u << 20));
        }
    });
}

// As with Wine's loader: memory is allocated by the driver, not by the library.
TEST(Memory, IsTheDriversWhereBuffersEndUnseen) {
    expectInFork([] {
        const Device device("");
        requireSharedMemory(device);
        const std::vector<float> expected = table(device);
        spy::failAt(spy::Call::destructorCallback, 1, true);
        for (const size_t bytes : {size_t(16), size_t(1) << 20, size_t(40) << 20}) {
            const Buffer buffer(device, bytes);
            CHILD_EXPECT(buffer.readAll<char>() == std::vector<char>(bytes));
            std::vector<int> numbers(bytes / sizeof(int));
            for (size_t i = 0; i < numbers.size(); ++i) numbers[i] = int(i * 7);
            CHILD_EXPECT(Buffer(device, numbers).readAll<int>() == numbers);
        }
        CHILD_EXPECT(table(device) == expected);
    });
}
