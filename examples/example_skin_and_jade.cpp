// A ball of skin beside a ball of jade, under a warm lamp and a cool one: the G-buffer that a renderer would
// have drawn, two materials of the library, two lights, a picture (example_skin_and_jade.ppm).
#include <cmath>
#include <cstdio>
#include <pellucid/pellucid.hpp>

using namespace pellucid;

constexpr uint32_t width = 400, height = 200;
constexpr float radius = 15;  // millimetres

int main() try {
    std::vector<float> positions, normals;
    std::vector<uint8_t> ids;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            const bool onTheRight = x >= width / 2;
            const float u = (float(x % 200) - 99.5f) / 90, v = (99.5f - float(y)) / 90;
            const float inside = 1 - u * u - v * v, w = std::sqrt(std::fmax(inside, 0.0f));
            const float centre = onTheRight ? 18.0f : -18.0f;
            ids.push_back(inside < 0 ? 0 : onTheRight ? 2 : 1);
            normals.insert(normals.end(), {u, v, w});
            positions.insert(positions.end(), {centre + radius * u, radius * v, radius * w});
        }
    const std::vector<float> curvature(ids.size(), 1 / radius);

    const Device device;
    const Buffer picture(device, ids.size() * 3 * sizeof(float));
    const auto image = [](Buffer pixels, PelFormat format) {
        return imageDesc(std::move(pixels), format, width, height);
    };
    Shader shader(device);
    shader.set(PEL_SLOT_RADIANCE, image(picture, PEL_FORMAT_RGB32F))
        .set(PEL_SLOT_MATERIAL, image(Buffer(device, ids), PEL_FORMAT_R8_UINT))
        .set(PEL_SLOT_POSITION, image(Buffer(device, positions), PEL_FORMAT_RGB32F))
        .set(PEL_SLOT_NORMAL_SHADING, image(Buffer(device, normals), PEL_FORMAT_RGB32F))
        .set(PEL_SLOT_CURVATURE, image(Buffer(device, curvature), PEL_FORMAT_R32F))
        .setMaterial(1, material(Profile::named("skin"), {0.75f, 0.5f, 0.4f}))
        .setMaterial(2, material(Profile::named("jade"), {0.35f, 0.6f, 0.45f}))
        .set({directionalLight({-3, 2, 1}, {1.0f, 0.85f, 0.7f}), pointLight({40, 0, 30}, {300, 400, 600})})
        .set(cameraAt({0, 0, 300}))
        .commit()
        .execute();

    const std::vector<float> radiance = picture.readAll<float>();
    FILE* file = std::fopen("example_skin_and_jade.ppm", "wb");
    if (!file) return std::perror("example_skin_and_jade.ppm"), 1;
    std::fprintf(file, "P6 %u %u 255\n", width, height);
    for (const float v : radiance) std::fputc(int(255 * std::pow(std::fmin(v, 1.0f), 1 / 2.2f) + 0.5f), file);
    std::fclose(file);
    // in the middle of each ball
    const float *skin = &radiance[3 * (width * 100 + 100)], *jade = skin + 3 * 200;
    std::printf("skin %.3f %.3f %.3f, jade %.3f %.3f %.3f\n", skin[0], skin[1], skin[2], jade[0], jade[1],
                jade[2]);
    return skin[0] > skin[1] && jade[1] > jade[0] && radiance[0] == 0 ? 0 : 1;
} catch (const Error& e) {
    return std::fprintf(stderr, "%s\n", e.what()), 1;
}
