// Materials that scatter on the screen: the shader's pass gives what scattering alone gives.
#include <gtest/gtest.h>

#include "diffusion/scatter_scene.h"
#include "tolerances.h"

using namespace scatter_scene;

namespace {

std::vector<float> shaded(const Picture& p, PelScattering scattering, PelShaderStats* stats = nullptr) {
    const Buffer e(device(), p.irradiance), x(device(), p.positions), i(device(), p.ids);
    std::vector<float> normals = p.positions;
    for (float& n : normals) n /= 10;
    const Buffer n(device(), normals), out(device(), std::vector<float>(p.irradiance.size(), 0.0f));
    const auto rgb = [&](const Buffer& b) {
        return pellucid::imageDesc(b, PEL_FORMAT_RGB32F, p.width, p.height);
    };
    pellucid::Shader shader(device());
    shader.set(PEL_SLOT_RADIANCE, rgb(out));
    shader.set(PEL_SLOT_POSITION, rgb(x));
    shader.set(PEL_SLOT_NORMAL_SHADING, rgb(n));
    shader.set(PEL_SLOT_IRRADIANCE, rgb(e));
    shader.set(PEL_SLOT_MATERIAL, pellucid::imageDesc(i, PEL_FORMAT_R8_UINT, p.width, p.height));
    PelMaterial material = pelMaterialDefaults();
    material.scattering = scattering;
    const Profile skin = Profile::skin();
    if (scattering == PEL_SCATTERING_AUTO)
        material.profile = skin.get();  // the others have skin's without one
    material.specular = 0;
    for (float& a : material.albedo) a = 0.5f;
    shader.setMaterial(1, material);
    shader.commit();
    shader.execute();
    if (stats) *stats = shader.stats();
    return out.readAll<float>();
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
