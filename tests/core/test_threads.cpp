// Objects that several threads use at a time give each thread the same results as alone. The check for data
// races (./run check tsan) also finds races here that happen to be harmless.
#include "core/on_threads.h"
#include "mesh/mesh_fixture.h"

namespace {

using namespace pellucid;

constexpr int callers = 4;

TEST(Threads, OneTopologyAndOneLiveMesh) {
    const fixture::Mesh mesh = fixture::torus(24, 16);
    const uint32_t n = mesh.vertices();
    const MeshTopology topology(device(), fixture::topologyDesc(mesh));
    const Buffer positions(device(), mesh.positions), normals(device(), mesh.normals),
        uvs(device(), mesh.uvs);
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.smoothingRadius = 0.1f;
    const std::vector<float> right = fixture::curvature(mesh, fixture::topologyDesc(mesh), params).values;
    const float scale = fixture::uvScale(mesh);
    const LiveMesh live(topology, params);
    const std::vector<char> saved = topology.save();
    std::atomic<int> wrong{0};
    onThreads(callers, [&](int t) {
        const Buffer out(device(), n * sizeof(float));
        const PelVertexView p = vertexView(positions, n), normal = vertexView(normals, n),
                            o = vertexView(out, n);
        for (int i = 0; i < 5; ++i) {
            if (t % 2)
                topology.curvature(params, p, normal, o);
            else
                live.update(p, &normal, o);
            wrong += out.readAll<float>() != right;
            wrong += topology.uvScale(p, vertexView(uvs, n)) != scale;
            wrong += topology.save() != saved || live.stats().rowsTotal == 0;
        }
    });
    EXPECT_EQ(wrong, 0);
}

TEST(Threads, OneProfileAndOneTable) {
    const Profile profile = Profile::gaussians({{0.5f, {1, 1, 1}}});
    const std::set<std::string> names{"gaussians", "cheek", "a name much longer than cheek"};
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.width = desc.height = 16;
    desc.profile = profile.get();
    const Lut table(device(), desc);
    const std::vector<float> right = table.read<float>(PEL_LUT_FLOAT);
    std::atomic<int> wrong{0};
    onThreads(callers, [&](int t) {
        for (int i = 0; i < 10; ++i) {
            if (t == 0) profile.setName(i % 2 ? "cheek" : "a name much longer than cheek");
            wrong += !names.contains(profile.info().name);
            const Lut own(device(), desc);
            wrong += !names.contains(own.info().profile);
            wrong += own.read<float>(PEL_LUT_FLOAT) != right || table.read<float>(PEL_LUT_FLOAT) != right;
        }
    });
    EXPECT_EQ(wrong, 0);
}

TEST(Threads, OneBufferAndOneDevice) {
    const Device device("");
    std::vector<uint32_t> memory(1024, 7);
    const Buffer own(device, memory), host = Buffer::fromHost(device, memory.data(), 4096);
    std::atomic<int> wrong{0};
    std::atomic<uint64_t> told{0};
    onThreads(callers, [&](int t) {
        std::vector<Event> events;
        for (int i = 0; i < 20; ++i) {
            const auto* mapped = static_cast<const uint32_t*>(host.map());
            wrong += mapped[t] != 7;
            host.unmap();
            PelEvent done = nullptr;
            uint32_t value = 0;
            const PelSubmit submit{nullptr, 0, &done};
            own.read(&value, 4, 4 * size_t(t), &submit);
            events.emplace_back(done);
            events.back().wait();
            wrong += value != 7 || !events.back().isDone();
            device.setProgress(t % 2 ? +[](void* user, double, const char*) {
                ++*static_cast<std::atomic<uint64_t>*>(user);
                return 1;
            } : nullptr, &told);
            wrong += device.stats().bytesToHost == 0;
            void *context, *id, *queue;
            check(pelDeviceGetCl(device.get(), &context, &id, &queue));
            const Device same = Device::fromCl(context, id, queue);
            wrong += same.info().mathWidth != device.info().mathWidth;
        }
    });
    EXPECT_EQ(wrong, 0);
}

// Each thread has its own message; the callback is one for all of them.
TEST(Threads, Errors) {
    static std::atomic<int> heard{0};
    std::atomic<int> wrong{0};
    onThreads(callers, [&](int t) {
        const std::string name = "no such device " + std::to_string(t);
        for (int i = 0; i < 20; ++i) {
            if (t == 0)
                pelSetErrorCallback(
                    i % 2 ? nullptr : +[](void*, PelError, const char*) { ++heard; }, nullptr);
            PelDevice device = nullptr;
            wrong += pelDeviceCreate(name.c_str(), &device) != PEL_ERROR_NO_DEVICE;
            wrong += std::string(pelGetErrorMessage()).find(name) == std::string::npos;
            wrong += pelDeviceFinish(reinterpret_cast<PelDevice>(&device)) != PEL_ERROR_INVALID_ARGUMENT;
        }
    });
    pelSetErrorCallback(nullptr, nullptr);
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(heard.load(), 0);
}

}  // namespace
