// The memory that objects report equals the memory requested from OpenCL, and is freed with them.
#include "cl/cl_spy.h"
#include "diffusion/lit_ball.h"
#include "mesh/mesh_fixture.h"
#include "mesh/reference_meshes.h"

using namespace lit_ball;
using pellucid::LiveMesh;
using pellucid::MeshTopology;
using pellucid::Shader;

// Bytes that `release` gives back.
static uint64_t freed(const std::function<void()>& release) {
    const int64_t before = spy::counts().memoryBytes;
    release();
    return uint64_t(before - spy::counts().memoryBytes);
}

// What is said may leave out small lists.
static void expectSaid(uint64_t said, uint64_t held, const std::string& of) {
    EXPECT_LE(said, held) << of;
    EXPECT_GE(double(said), (1 - tolerance::heldMemory) * double(held)) << of;
}

TEST(HeldMemory, OfAShaderByMethod) {
    constexpr uint32_t side = 160;
    const LitBall lamp = makeBall(Form::parallel, {0.8, 0.3, 0.5}, 128);
    const Picture p = pictureOf(lamp, side);
    std::vector<float> normals = p.positions;
    for (float& n : normals) n /= float(radius);
    const Buffer positions(device(), p.positions), shading(device(), normals),
        irradiance(device(), p.irradiance), ids(device(), p.ids), map(device(), lamp.maps[0]),
        out(device(), std::vector<float>(3 * p.pixels()));
    // By method, with the host's irradiance, and with the shader's own at half rate.
    for (int k = 2 * PEL_SCATTERING_PREINTEGRATED; k < 2 * PEL_SCATTERING_AUTO + 2; ++k) {
        const int scattering = k / 2;
        if (scattering == PEL_SCATTERING_TEXTURE) continue;
        Shader shader(device());
        const auto image = [&](PelImageSlot slot, const Buffer& pixels, PelFormat format) {
            shader.set(slot, pellucid::imageDesc(pixels, format, side, side));
        };
        image(PEL_SLOT_POSITION, positions, PEL_FORMAT_RGB32F);
        image(PEL_SLOT_NORMAL_SHADING, shading, PEL_FORMAT_RGB32F);
        if (k % 2 == 0) image(PEL_SLOT_IRRADIANCE, irradiance, PEL_FORMAT_RGB32F);
        image(PEL_SLOT_MATERIAL, ids, PEL_FORMAT_R8_UINT);
        image(PEL_SLOT_RADIANCE, out, PEL_FORMAT_RGB32F);
        const Profile skin = Profile::skin();
        PelMaterial material = whiteMaterial(skin, PelScattering(scattering));
        if (scattering == PEL_SCATTERING_SCREEN && k % 2) material.scatterTaps = 16;
        shader.setMaterial(1, material);
        PelShaderOptions options = pelShaderOptionsDefaults();
        options.halfRate = k % 2;
        shader.set(options);
        shader.set(std::vector{lamp.light});
        shader.set(0, PEL_LIGHT_SHADOW_MAP,
                   pellucid::imageDesc(map, PEL_FORMAT_R32F, lamp.width, lamp.height));
        // The memory of a commit is known before it, without an allocation, and equals the actual memory.
        const std::vector<PelPassMemory> before = shader.memory();
        const spy::Counts counts = spy::counts();
        const std::vector<PelPassMemory> again = shader.memory();
        EXPECT_EQ(spy::counts().memoryBytes, counts.memoryBytes) << "nothing is kept";
        EXPECT_EQ(spy::counts().bytesCopied, counts.bytesCopied) << "nothing is sent";
        shader.commit().execute();
        const std::vector<PelPassMemory> after = shader.memory();
        ASSERT_EQ(before.size(), after.size());
        ASSERT_EQ(before.size(), again.size());
        uint64_t sum = 0;
        for (size_t i = 0; i < after.size(); ++i) {
            EXPECT_STREQ(before[i].name, after[i].name);
            EXPECT_EQ(before[i].held, 0u) << before[i].name;
            EXPECT_EQ(before[i].needed, after[i].held) << before[i].name << " of method " << scattering;
            EXPECT_EQ(after[i].needed, after[i].held) << before[i].name << " of method " << scattering;
            EXPECT_EQ(again[i].needed, before[i].needed);
            EXPECT_EQ(after[i].held % sizeof(float), 0u) << before[i].name << ": images and tables of words";
            sum += after[i].held;
        }
        EXPECT_EQ(sum, shader.stats().scratchBytes);
        EXPECT_EQ(std::ranges::any_of(after,
                                      [](const PelPassMemory& pass) {
                                          return pass.held > 0 && !std::strcmp(pass.name, "scatter_light");
                                      }),
                  scattering == PEL_SCATTERING_LIGHT)
            << "the light has a map";
        // In C, the first structure says how long all of them are.
        PelPassMemory plain[24] = {pelPassMemoryDefaults()};
        uint32_t count = 24;
        ASSERT_EQ(pelShaderGetMemory(shader.get(), plain, &count), PEL_SUCCESS) << pelGetErrorMessage();
        ASSERT_EQ(count, after.size());
        EXPECT_STREQ(plain[count - 1].name, after[count - 1].name);
        const uint64_t said = shader.stats().scratchBytes, held = freed([&] { shader = Shader(); });
        if (scattering != PEL_SCATTERING_PREINTEGRATED) {
            expectSaid(said, held, "method " + std::to_string(scattering));
            continue;
        }
        // The tables of the profile, which other shaders may share, are not said; their copy is.
        EXPECT_LE(said, held);
        EXPECT_GE(said, held / 2.05);
    }
}

TEST(HeldMemory, OfScatteringAloneByMethod) {
    constexpr uint32_t side = 160;
    const Picture p = plane(side, side, 0.2, [](double x, double) {
        const double e = x < 16 ? 1 : 0.1;
        return Vec3{e, e, e};
    });
    const Buffer positions(device(), p.positions), irradiance(device(), p.irradiance), ids(device(), p.ids),
        out(device(), p.irradiance);
    const auto image = [&](const Buffer& pixels, PelFormat format) {
        return pellucid::imageDesc(pixels, format, side, side);
    };
    for (const PelScattering scattering : {PEL_SCATTERING_SEPARABLE, PEL_SCATTERING_SCREEN}) {
        Scatter scatter(device());
        scatter.setMaterial(1, Profile::skin());
        PelScatterControls controls = pelScatterControlsDefaults();
        controls.scattering = scattering;
        scatter.setControls(1, controls);
        scatter.execute(p.params, image(irradiance, PEL_FORMAT_RGB32F), image(positions, PEL_FORMAT_RGB32F),
                        nullptr, image(ids, PEL_FORMAT_R8_UINT), image(out, PEL_FORMAT_RGB32F));
        const uint64_t said = scatter.stats().scratchBytes;
        expectSaid(said, freed([&] { scatter = Scatter(); }), "method " + std::to_string(scattering));
    }
}

TEST(HeldMemory, OfALiveMesh) {
    using namespace fixture;
    const Mesh mesh =
        pairOf(tessellate(reference::torusSurface(3, 1), 128, 64, reference::Tessellation::irregular).mesh)
            .mesh;
    const uint32_t n = mesh.vertices();
    const MeshTopology topology(device(), topologyDesc(mesh));
    const Buffer positions(device(), mesh.positions), result(device(), n * sizeof(float));
    for (const PelCurvatureEstimator estimator :
         {PEL_CURVATURE_QUADRIC, PEL_CURVATURE_TENSOR, PEL_CURVATURE_EDGE}) {
        PelCurvatureParams params = pelCurvatureParamsDefaults();
        params.estimator = estimator;
        LiveMesh live(topology, params);
        const std::vector<PelVertexRange> some{{7, 100}};
        live.update(pellucid::vertexView(positions, n), nullptr, pellucid::vertexView(result, n));
        live.update(pellucid::vertexView(positions, n), nullptr, pellucid::vertexView(result, n), some);
        const uint64_t said = live.stats().deviceBytes;
        EXPECT_EQ(said, freed([&] { live = LiveMesh(); })) << estimator;
    }
}
