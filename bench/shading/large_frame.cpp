// A frame of SIZE x SIZE pixels in small formats (ids of a byte, octahedral normals, depth and radiance in halves of a word),
// normals blurred on screen and a wide shadow filtered from a map, under a budget of scratch memory:
//     large_frame [SIZE] [BUDGET_MIB]...
// prints time, bands, scratch and peak memory, and a checksum that must not depend on the budget.
#include <pellucid/pellucid.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#define XXH_INLINE_ALL
#include <xxhash.h>

using namespace pellucid;

int main(int argc, char** argv) {
    const uint32_t size = argc > 1 ? uint32_t(std::atoi(argv[1])) : 16384;
    const size_t pixels = size_t(size) * size;
    const Device device("");
    std::vector<uint8_t> id(pixels);
    std::vector<uint16_t> normal(pixels * 2), depth(pixels), radiance(pixels * 3);
    const double radius = 0.35 * size;
    for (uint32_t y = 0; y < size; ++y)
        for (uint32_t x = 0; x < size; ++x) {  // a ball in an orthographic view, 200 mm across the frame
            const size_t i = size_t(y) * size + x;
            const double u = (x + 0.5 - 0.5 * size) / radius, v = (0.5 * size - y - 0.5) / radius,
                         r2 = u * u + v * v;
            if (r2 >= 1) continue;
            id[i] = 1;
            const double z = std::sqrt(1 - r2), sum = std::fabs(u) + std::fabs(v) + z;
            normal[2 * i] = uint16_t(int16_t(std::lround(32767 * u / sum)));
            normal[2 * i + 1] = uint16_t(int16_t(std::lround(32767 * v / sum)));
            depth[i] = uint16_t(std::lround(65535 * (1 - 0.5 * z)));
        }
    Shader shader(device);
    std::vector<Buffer> buffers;
    const auto set = [&](PelImageSlot slot, auto& values, PelFormat format) {
        buffers.push_back(Buffer::fromHost(device, values.data(), values.size() * sizeof values[0]));
        shader.set(slot, imageDesc(buffers.back(), format, size, size));
    };
    set(PEL_SLOT_RADIANCE, radiance, PEL_FORMAT_RGB16F);
    set(PEL_SLOT_MATERIAL, id, PEL_FORMAT_R8_UINT);
    set(PEL_SLOT_NORMAL_SHADING, normal, PEL_FORMAT_OCT16X2_SNORM);
    set(PEL_SLOT_DEPTH, depth, PEL_FORMAT_R16_UNORM);
    PelMaterial material = pelMaterialDefaults();
    shader.setMaterial(1, material);
    PelLight light = pelLightDefaults();
    light.shadowFilterTexels = 8;
    const float toWorld[16] = {100, 0, 0, 0, 0, 100, 0, 0, 0, 0, -140, 70, 0, 0, 0, 1};
    const float toShadow[16] = {0.005f, 0, 0, 0.5f, 0, -0.005f, 0, 0.5f, 0, 0, -0.005f, 0.5f, 0, 0, 0, 1};
    std::copy_n(toShadow, 16, light.worldToShadow);
    light.shadowDepthRange = 200;
    light.toLight[0] = 0.6f, light.toLight[1] = 0, light.toLight[2] = 0.8f;
    shader.set(std::vector{light});
    const Buffer map(device, std::vector<float>(256 * 256, 0.4f));
    shader.set(0, PEL_LIGHT_SHADOW_MAP, imageDesc(map, PEL_FORMAT_R32F, 256, 256));
    PelCamera camera = pelCameraDefaults();
    std::copy_n(toWorld, 16, camera.inverseViewProjection);
    PelAmbient ambient = pelAmbientDefaults();
    ambient.constant[0] = 0.2f, ambient.sh[2][1] = 0.3f;
    shader.set(camera).set(ambient);
    for (int i = 2; i < std::max(argc, 3); ++i) {
        PelShaderOptions options = pelShaderOptionsDefaults();
        options.blurNormals = 1;
        options.scratchBudget = uint64_t(argc > 2 ? std::atoi(argv[i]) : 1024) << 20;
        const auto start = std::chrono::steady_clock::now();
        shader.set(options).commit().execute();
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        void* mapped = nullptr;
        check(pelBufferMap(buffers[0].get(), &mapped));
        const uint64_t sum = XXH64(radiance.data(), radiance.size() * sizeof radiance[0], 0);
        check(pelBufferUnmap(buffers[0].get()));
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        const PelShaderStats stats = shader.stats();
        std::printf(
            "%u x %u, budget %llu MiB: %.1f s, %llu bands, %.0f MiB scratch, peak %.0f MiB, %llu of %llu "
            "tiles, checksum %016llx\n",
            size, size, static_cast<unsigned long long>(options.scratchBudget >> 20), seconds,
            static_cast<unsigned long long>(stats.bands), double(stats.scratchBytes) / (1 << 20),
            double(usage.ru_maxrss) / 1024, static_cast<unsigned long long>(stats.tilesShaded),
            static_cast<unsigned long long>(stats.tilesTotal), static_cast<unsigned long long>(sum));
        std::fflush(stdout);
    }
    return 0;
}
