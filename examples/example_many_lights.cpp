// Skin, jade and wax in one frame under sixteen coloured lamps: materials with tables of their own, chosen by
// an id per pixel.
#include <cmath>
#include <cstdio>
#include <pellucid/pellucid.hpp>

using namespace pellucid;

constexpr uint32_t width = 480, height = 160, lamps = 16;

// A table of a profile, and its own radius in the material that uses it.
Lut table(const Device& device, const Profile& profile, PelMaterial& material) {
    PelCurvatureLutDesc desc = pelCurvatureLutDescDefaults();
    desc.profile = profile.get();
    const PelProfileInfo info = profile.info();
    material.diffusionRadius = info.radius;
    for (int c = 0; c < 3; ++c) material.normalBlend[c] = info.normalBlend[c];
    return Lut(device, desc);
}

int main() try {
    // Three spheres of 10 mm side by side, ids 1 to 3.
    std::vector<float> position, normal, curvature;
    std::vector<uint8_t> id;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            const float px = (float(x % 160) - 79.5f) / 72, py = (79.5f - float(y)) / 72,
                        rest = 1 - px * px - py * py;
            const float z = rest > 0 ? std::sqrt(rest) : 0, centre = 24.0f * (float(x / 160) - 1);
            id.push_back(rest > 0 ? uint8_t(x / 160 + 1) : 0);
            normal.insert(normal.end(), {px, py, z});
            position.insert(position.end(), {centre + 10 * px, 10 * py, 10 * z});
            curvature.push_back(0.1f);
        }
    const Device device("");
    // Measured in [Jensen et al. 2001], table "measured parameters", per millimetre: skin1, and of the
    // dipole's making wax and jade.
    PelMaterial skin = pelMaterialDefaults(), jade = skin, wax = skin;
    const float one[3][3] = {{0.75f, 0.5f, 0.4f}, {0.35f, 0.6f, 0.45f}, {0.9f, 0.85f, 0.7f}};
    for (int c = 0; c < 3; ++c)
        skin.albedo[c] = one[0][c], jade.albedo[c] = one[1][c], wax.albedo[c] = one[2][c];
    skin.specular = jade.specular = wax.specular = 1;
    jade.roughness = 0.15f;
    const float jadeAbsorption[3] = {0.03f, 0.01f, 0.02f}, jadeScattering[3] = {0.8f, 1.2f, 1.0f};
    const Lut skinTable = table(device, Profile::skin(), skin);
    const Lut jadeTable = table(device, Profile::dipole(jadeAbsorption, jadeScattering, 1.5f), jade);
    const Lut waxTable =
        table(device, Profile::gaussians({{4.0f, {1, 0.8f, 0.5f}}, {0.3f, {0.2f, 0.5f, 1}}}), wax);

    std::vector<PelLight> lights(lamps, pelLightDefaults());
    for (uint32_t i = 0; i < lamps; ++i) {
        PelLight& l = lights[i];
        const float a = 6.2831853f * float(i) / lamps;
        l.type = i % 4 == 3 ? PEL_LIGHT_SPOT : PEL_LIGHT_POINT;
        l.position[0] = 45 * std::cos(a), l.position[1] = 30 * std::sin(a), l.position[2] = 20;
        for (int c = 0; c < 3; ++c) {
            l.spotDirection[c] = -l.position[c] / std::sqrt(45 * 45 * std::cos(a) * std::cos(a) +
                                                            900 * std::sin(a) * std::sin(a) + 400);
            l.color[c] = 150 * (1 + std::cos(3 * a + 2.094395f * float(c)));  // three times round the colours
        }
        l.range = 70;
    }
    PelCamera camera = pelCameraDefaults();
    camera.position[2] = 100;
    const Buffer target(device, width * height * 3 * sizeof(float));
    Shader shader(device);
    const auto set = [&](PelImageSlot slot, const Buffer& b, PelFormat f) {
        shader.set(slot, imageDesc(b, f, width, height));
    };
    set(PEL_SLOT_RADIANCE, target, PEL_FORMAT_RGB32F);
    set(PEL_SLOT_MATERIAL, Buffer(device, id), PEL_FORMAT_R8_UINT);
    set(PEL_SLOT_POSITION, Buffer(device, position), PEL_FORMAT_RGB32F);
    set(PEL_SLOT_NORMAL_SHADING, Buffer(device, normal), PEL_FORMAT_RGB32F);
    set(PEL_SLOT_CURVATURE, Buffer(device, curvature), PEL_FORMAT_R32F);
    shader.setMaterial(1, skin, skinTable).setMaterial(2, jade, jadeTable).setMaterial(3, wax, waxTable);
    shader.set(lights).set(camera).commit().execute();

    const std::vector<float> radiance = target.readAll<float>();
    FILE* file = std::fopen("example_many_lights.ppm", "wb");
    if (!file) return std::perror("example_many_lights.ppm"), 1;
    std::fprintf(file, "P6 %u %u 255\n", width, height);
    for (const float v : radiance) std::fputc(int(255 * std::pow(std::fmin(v, 1.0f), 1 / 2.2f) + 0.5f), file);
    std::fclose(file);
    // In the middle of the three balls: the same light, three colours.
    double mean[3][3] = {};
    for (size_t i = 0; i < id.size(); ++i)
        for (size_t c = 0; c < 3 && id[i]; ++c) mean[id[i] - 1][c] += radiance[3 * i + c] / 16000;
    const char* names[] = {"skin", "jade", "wax"};
    for (int m = 0; m < 3; ++m)
        std::printf("%s: %.3f %.3f %.3f\n", names[m], mean[m][0], mean[m][1], mean[m][2]);
    return mean[0][0] > mean[0][1] && mean[1][1] > mean[1][0] && mean[2][0] > mean[0][0] && radiance[0] == 0
               ? 0
               : 1;
} catch (const Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
}
