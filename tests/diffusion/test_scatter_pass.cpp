// Materials that scatter on the screen: the shader's pass gives what scattering alone gives.
#include <gtest/gtest.h>

#include "diffusion/scatter_scene.h"
#include "diffusion/shown_images.h"
#include "tolerances.h"

using namespace scatter_scene;

namespace {

std::vector<float> shaded(const Picture& p, PelScattering scattering, PelShaderStats* stats = nullptr) {
    ShownImages shown(device(), p.width, p.height);
    std::vector<float> normals = p.positions;
    for (float& n : normals) n /= 10;
    shown.set(PEL_SLOT_POSITION, p.positions);
    shown.set(PEL_SLOT_NORMAL_SHADING, normals);
    shown.set(PEL_SLOT_IRRADIANCE, p.irradiance);
    shown.set(PEL_SLOT_MATERIAL, p.ids);
    const Profile skin = Profile::skin();
    PelMaterial material = whiteMaterial(skin, scattering);
    if (scattering != PEL_SCATTERING_AUTO) material.profile = nullptr;  // skin's without one
    material.specular = 0;
    for (float& a : material.albedo) a = 0.5f;
    shown.shader.setMaterial(1, material);
    std::vector<float> radiance = shown.execute();
    if (stats) *stats = shown.shader.stats();
    return radiance;
}

}  // namespace

TEST(ScatterPass, IsScatteringAloneTimesAlbedo) {
    const Picture p = ball(100, 10, 0.21, normalized(Vec3{1, 0.3, 0.2}));
    const Result alone = run(p, Profile::skin());
    for (PelScattering method : {PEL_SCATTERING_SCREEN, PEL_SCATTERING_AUTO}) {
        const std::vector<float> radiance = shaded(p, method);
        for (size_t i = 0; i < p.pixels(); ++i)
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(radiance[3 * i + c], p.ids[i] ? 0.5f * alone.scattered[3 * i + c] : 0, 1e-6) << i;
    }
    const std::vector<float> plain = shaded(p, PEL_SCATTERING_NONE);
    for (size_t i = 0; i < plain.size(); ++i) ASSERT_NEAR(plain[i], 0.5f * p.irradiance[i], 1e-6) << i;
}
