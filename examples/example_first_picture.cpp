// A renderer's first frames while kernels are still being built: skin on a ball, as an engine draws it. The
// first frame is shaded by a stand-in that builds quickly, until the material's own kernels are ready.
//
// Run it twice: the second time everything is on disk. With --wait the first frame waits instead.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <pellucid/pellucid.hpp>
#include <thread>
#include <vector>

using namespace pellucid;

int main(int argc, char** argv) try {
    const auto start = std::chrono::steady_clock::now();
    const auto seconds = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    const Device device("");

    // A ball of 80 mm in the middle of the frame.
    constexpr uint32_t side = 256;
    std::vector<float> positions(size_t(3) * side * side), normals(positions.size());
    std::vector<uint32_t> ids(size_t(side) * side);
    for (uint32_t i = 0; i < side * side; ++i) {
        const float x = 2.2f * float(i % side) / side - 1.1f, y = 1.1f - 2.2f * float(i / side) / side;
        const float square = 1 - x * x - y * y;
        if (square <= 0) continue;
        const float n[3] = {x, y, std::sqrt(square)};
        for (int c = 0; c < 3; ++c) normals[3 * i + c] = n[c], positions[3 * i + c] = 80 * n[c];
        ids[i] = 1;
    }

    Shader shader(device);
    const Buffer radiance(device, positions.size() * sizeof(float));
    shader.set(PEL_SLOT_RADIANCE, imageDesc(radiance, PEL_FORMAT_RGB32F, side, side));
    const Buffer p(device, positions), n(device, normals), id(device, ids);
    shader.set(PEL_SLOT_POSITION, imageDesc(p, PEL_FORMAT_RGB32F, side, side));
    shader.set(PEL_SLOT_NORMAL_SHADING, imageDesc(n, PEL_FORMAT_RGB32F, side, side));
    shader.set(PEL_SLOT_MATERIAL, imageDesc(id, PEL_FORMAT_R32_UINT, side, side));

    const Profile skin = Profile::skin();
    PelMaterial material = pelMaterialDefaults();
    material.profile = skin.get();
    material.specular = 0.2f;
    shader.setMaterial(1, material);
    PelLight light = pelLightDefaults();
    light.toLight[0] = 0.8f, light.toLight[1] = 0.3f, light.toLight[2] = 0.52f;
    shader.set(light);
    PelShaderOptions options = pelShaderOptionsDefaults();
    options.buildInBackground = argc < 2 || std::strcmp(argv[1], "--wait") != 0;
    shader.set(options);

    for (uint32_t frame = 0;; ++frame) {
        PelCamera camera = pelCameraDefaults();  // which moves a little
        camera.position[0] = 0.1f * float(frame);
        camera.position[2] = 500;
        shader.set(camera).commit().execute();
        const PelShaderStats stats = shader.stats();
        if (frame == 0 || !stats.standsIn)
            std::printf("frame %u after %.2f s: %s\n", frame, seconds(),
                        stats.standsIn ? "stands in" : "the material's own method");
        if (!stats.standsIn) return 0;
        std::this_thread::sleep_for(std::chrono::milliseconds(16));  // the screen is not faster
    }
} catch (const Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
}
