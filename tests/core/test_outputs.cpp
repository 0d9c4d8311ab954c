// Outputs of calls: only requested outputs are written, and none if the call is refused.
#include "mesh/mesh_calls.h"

using namespace pellucid;

TEST(Outputs, AnyPointerOfGetClMayBeNull) {
    const Device device("");
    void *context = nullptr, *id = nullptr, *queue = nullptr;
    check(pelDeviceGetCl(device.get(), &context, &id, &queue));
    for (int asked = 0; asked < 8; ++asked) {
        void* got[3] = {};
        check(pelDeviceGetCl(device.get(), asked & 1 ? &got[0] : nullptr, asked & 2 ? &got[1] : nullptr,
                             asked & 4 ? &got[2] : nullptr));
        EXPECT_EQ(got[0], asked & 1 ? context : nullptr);
        EXPECT_EQ(got[1], asked & 2 ? id : nullptr);
        EXPECT_EQ(got[2], asked & 4 ? queue : nullptr);
    }
}

// A report that cannot be filled is refused before any work: what is in the result stays there.
TEST(Outputs, AReportOfNoSizeIsRefusedBeforeAnyWork) {
    const Device device("");
    const fixture::Mesh mesh = fixture::torus(24, 12);
    const MeshTopology topology(device, fixture::topologyDesc(mesh));
    const uint32_t count = mesh.vertices();
    const Buffer positions(device, mesh.positions), normals(device, mesh.normals),
        out(device, std::vector<float>(count, -7.0f));
    const PelVertexView p = vertexView(positions, count), n = vertexView(normals, count),
                        c = vertexView(out, count);
    const PelCurvatureParams params = fixture::edgeParams(1);
    PelMeshReport report = pelMeshReportDefaults();
    for (const uint32_t size : {0u, 1u << 20}) {
        report.structSize = size;
        EXPECT_EQ(pelMeshCurvature(topology.get(), &params, &p, &n, &c, &report, nullptr),
                  PEL_ERROR_INVALID_ARGUMENT);
        for (const float value : out.readAll<float>()) ASSERT_EQ(value, -7.0f);
    }
    report = pelMeshReportDefaults();
    check(pelMeshCurvature(topology.get(), &params, &p, &n, &c, &report, nullptr));
    for (const float value : out.readAll<float>()) ASSERT_NE(value, -7.0f);
    PelCurvatureParams endless = params;
    endless.smoothingRadius = 1e30f;
    report.vertices = 7;
    EXPECT_NE(pelMeshCurvature(topology.get(), &endless, &p, &n, &c, &report, nullptr), PEL_SUCCESS);
    EXPECT_EQ(report.vertices, 7u);
}

// With all else as it should be.
TEST(Outputs, NowhereToPutAResultIsRefused) {
    const Device device("");
    const fixture::Mesh mesh = fixture::torus(12, 6);
    const PelMeshTopologyDesc desc = fixture::topologyDesc(mesh);
    const MeshTopology topology(device, desc);
    const uint32_t count = mesh.vertices();
    const Buffer buffer(device, mesh.positions);
    const PelVertexView positions = vertexView(buffer, count);
    const PelCurvatureParams params = fixture::edgeParams(1);
    size_t size = 0;
    check(pelMeshTopologySave(topology.get(), nullptr, &size));
    std::vector<uint8_t> saved(size);
    check(pelMeshTopologySave(topology.get(), saved.data(), &size));
    const Profile profile = Profile::skin();
    const PelCurvatureLutDesc curvature = pelCurvatureLutDescDefaults();
    const PelShadowLutDesc shadow = pelShadowLutDescDefaults();
    const PelSpecularLutDesc specular = pelSpecularLutDescDefaults();
    const PelEyeLutDesc eye = pelEyeLutDescDefaults();
    const Lut lut(device, specular);
    const PelLutInfo info = lut.info();
    const std::vector<float> texels = lut.read<float>(PEL_LUT_FLOAT);
    const PelTextureScatterDesc texture = [&] {
        PelTextureScatterDesc d = pelTextureScatterDescDefaults();
        d.width = d.height = 8;
        static const uint32_t triangle[] = {0, 1, 2};
        static const float corners[] = {0, 0, 1, 0, 0, 1};
        d.indices = triangle, d.numIndices = 3, d.uvs = corners, d.numVertices = 3;
        return d;
    }();
    const Shader shader(device);
    PelEvent event = nullptr;
    PelSubmit submit{};
    submit.done = &event;
    uint8_t byte = 0;
    check(pelBufferRead(buffer.get(), 0, 1, &byte, &submit));
    void *context = nullptr, *id = nullptr, *queue = nullptr, *memory = nullptr;
    check(pelDeviceGetCl(device.get(), &context, &id, &queue));
    check(pelBufferGetCl(buffer.get(), &memory));
    const float ones[] = {1, 1, 1}, host[] = {0};
    const PelGaussian gaussian{1, {1, 1, 1}};
    const float distances[] = {0, 1}, values[] = {1, 1, 1, 0, 0, 0};
    const std::pair<const char*, PelError> calls[] = {
        {"pelDeviceCount", pelDeviceCount(nullptr)},
        {"pelDeviceCreate", pelDeviceCreate("", nullptr)},
        {"pelDeviceCreateFromCl", pelDeviceCreateFromCl(context, id, queue, nullptr)},
        {"pelEventGetCl", pelEventGetCl(event, nullptr)},
        {"pelEventIsDone", pelEventIsDone(event, nullptr)},
        {"pelBufferCreate", pelBufferCreate(device.get(), 4, nullptr, nullptr)},
        {"pelBufferCreateFromHost",
         pelBufferCreateFromHost(device.get(), const_cast<float*>(host), sizeof host, nullptr)},
        {"pelBufferCreateFromCl", pelBufferCreateFromCl(device.get(), memory, nullptr)},
        {"pelBufferGetSize", pelBufferGetSize(buffer.get(), nullptr)},
        {"pelBufferGetCl", pelBufferGetCl(buffer.get(), nullptr)},
        {"pelBufferRead", pelBufferRead(buffer.get(), 0, 1, nullptr, nullptr)},
        {"pelBufferMap", pelBufferMap(buffer.get(), nullptr)},
        {"pelMeshTopologyCreate", pelMeshTopologyCreate(device.get(), &desc, nullptr, nullptr)},
        {"pelMeshTopologySave", pelMeshTopologySave(topology.get(), saved.data(), nullptr)},
        {"pelMeshTopologyLoad", pelMeshTopologyLoad(device.get(), saved.data(), size, nullptr, nullptr)},
        {"pelMeshUvScale", pelMeshUvScale(topology.get(), &positions, &positions, nullptr)},
        {"pelLiveMeshCreate", pelLiveMeshCreate(topology.get(), &params, nullptr)},
        {"pelProfileCreateSkin", pelProfileCreateSkin(nullptr)},
        {"pelProfileCreateGaussians", pelProfileCreateGaussians(&gaussian, 1, nullptr)},
        {"pelProfileCreateBurley", pelProfileCreateBurley(ones, ones, PEL_BURLEY_SEARCHLIGHT, nullptr)},
        {"pelProfileCreateBurleyDistance", pelProfileCreateBurleyDistance(ones, nullptr)},
        {"pelProfileCreateDipole", pelProfileCreateDipole(ones, ones, 1.3f, nullptr)},
        {"pelProfileCreateTable", pelProfileCreateTable(distances, values, 2, nullptr)},
        {"pelProfileCreateNamed", pelProfileCreateNamed("skin", nullptr)},
        {"pelProfileGetInfo", pelProfileGetInfo(profile.get(), nullptr)},
        {"pelCurvatureLutCreate", pelCurvatureLutCreate(device.get(), &curvature, nullptr, nullptr)},
        {"pelShadowLutCreate", pelShadowLutCreate(device.get(), &shadow, nullptr, nullptr)},
        {"pelSpecularLutCreate", pelSpecularLutCreate(device.get(), &specular, nullptr, nullptr)},
        {"pelEyeLutCreate", pelEyeLutCreate(device.get(), &eye, nullptr, nullptr)},
        {"pelLutGetInfo", pelLutGetInfo(lut.get(), nullptr)},
        {"pelLutGetSize", pelLutGetSize(lut.get(), PEL_LUT_FLOAT, nullptr)},
        {"pelLutRead", pelLutRead(lut.get(), PEL_LUT_FLOAT, nullptr, texels.size() * sizeof(float), nullptr)},
        {"pelLutCountClipped", pelLutCountClipped(lut.get(), nullptr)},
        {"pelLutCreateFromTexels",
         pelLutCreateFromTexels(device.get(), &info, texels.data(), texels.size() * sizeof(float), nullptr)},
        {"pelShaderCreate", pelShaderCreate(device.get(), nullptr)},
        {"pelShaderGetWarnings", pelShaderGetWarnings(shader.get(), nullptr)},
        {"pelShaderGetStats", pelShaderGetStats(shader.get(), nullptr)},
        {"pelScatterCreate", pelScatterCreate(device.get(), nullptr)},
        {"pelTextureScatterCreate", pelTextureScatterCreate(device.get(), &texture, nullptr)}};
    for (const auto& [name, code] : calls) EXPECT_EQ(code, PEL_ERROR_INVALID_ARGUMENT) << name;
    EXPECT_EQ(pelBufferUnmap(buffer.get()), PEL_ERROR_INVALID_STATE) << "it was mapped all the same";
    pelEventRelease(event);
}
