// One process of bench_first_use: shades the frame that lies in a folder as plain memory, and prints the milliseconds of each
// stage, from pelDeviceCreate on. It links nothing but the library, as a small host would.
#include <pellucid/pellucid.hpp>

#include <array>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <utility>

using namespace pellucid;

namespace {

template <class T>
std::vector<T> read(const std::string& path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    std::vector<T> values(file ? size_t(file.tellg()) / sizeof(T) : 0);
    file.seekg(0);
    file.read(reinterpret_cast<char*>(values.data()), std::streamsize(values.size() * sizeof(T)));
    return values;
}

// The host's memory as it lies.
PelImageDesc image(const Device& device, std::vector<float>& values, uint32_t width, uint32_t height) {
    static std::vector<Buffer> buffers;
    buffers.push_back(Buffer::fromHost(device, values.data(), values.size() * sizeof(float)));
    const bool color = values.size() > size_t(width) * height;
    return imageDesc(buffers.back(), color ? PEL_FORMAT_RGB32F : PEL_FORMAT_R32F, width, height);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const std::string folder = std::string(argv[1]) + "/";
    const auto size = read<uint32_t>(folder + "size");
    std::array<std::vector<float>, PEL_SLOT_COUNT> images;
    for (int slot = 1; slot < PEL_SLOT_COUNT; ++slot)
        images[slot] = read<float>(folder + "slot" + std::to_string(slot));
    images[PEL_SLOT_RADIANCE].assign(size_t(size[0]) * size[1] * 3, 0);
    auto wide = read<float>(folder + "wide"), map = read<float>(folder + "map");
    const auto curvature = read<float>(folder + "curvature"), shadow = read<float>(folder + "shadow");
    const PelLight light = read<PelLight>(folder + "light").at(0);
    const PelMaterial material = read<PelMaterial>(folder + "material").at(0);
    const PelAmbient ambient = read<PelAmbient>(folder + "ambient").at(0);
    const PelCamera camera = read<PelCamera>(folder + "camera").at(0);
    PelLutInfo curvatureInfo = pelLutInfoDefaults(), shadowInfo = curvatureInfo;
    shadowInfo.kind = PEL_LUT_SHADOW;

    auto last = std::chrono::steady_clock::now();
    const auto lap = [&] {
        const auto now = std::chrono::steady_clock::now();
        return std::chrono::duration<double, std::milli>(now - std::exchange(last, now)).count();
    };
    const Device device("");
    const double deviceTime = lap();
    const Lut curvatureLut(device, curvatureInfo, curvature), shadowLut(device, shadowInfo, shadow);
    const double tableTime = lap();
    Shader shader(device);
    for (int slot = 0; slot < PEL_SLOT_COUNT; ++slot)
        if (!images[slot].empty())
            shader.set(PelImageSlot(slot), image(device, images[slot], size[0], size[1]));
    shader.set(std::vector{light}).set(camera).set(ambient).setMaterial(1, material, curvatureLut, shadowLut);
    shader.set(0, PEL_LIGHT_WIDE_SHADOW, image(device, wide, size[0], size[1]));
    shader.set(0, PEL_LIGHT_SHADOW_MAP, image(device, map, size[2], size[2]));
    shader.commit();
    const double commitTime = lap();
    shader.execute();
    const double executeTime = lap();
    for (int i = 0; i < 3; ++i) shader.execute();
    const double frameTime = lap() / 3;
    std::printf("%f %f %f %f %f\n", deviceTime, tableTime, commitTime, executeTime, frameTime);
    return 0;
}
