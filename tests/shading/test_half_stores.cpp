// Colours written as halves: every half, and what lies between two of them, rounds to the nearest, at a tie
// to the even one.
#include <gtest/gtest.h>

#include "diffusion/scatter_scene.h"
#include "half_bits.h"

using namespace scatter_scene;

namespace {

// Irradiance given by the host, albedo 1, nothing else: what is written is what was given.
std::vector<uint16_t> written(const std::vector<float>& given, uint32_t width, uint32_t height) {
    ShownImages images(device(), width, height);
    const Buffer out(device(), std::vector<uint16_t>(given.size()));
    images.shader.set(PEL_SLOT_RADIANCE, pellucid::imageDesc(out, PEL_FORMAT_RGB16F, width, height));
    std::vector<float> normals(given.size());
    for (size_t i = 2; i < normals.size(); i += 3) normals[i] = 1;
    images.set(PEL_SLOT_NORMAL_SHADING, normals);
    images.set(PEL_SLOT_IRRADIANCE, given);
    images.set(PEL_SLOT_MATERIAL, std::vector<uint8_t>(given.size() / 3, 1));
    PelMaterial material = pelMaterialDefaults();
    material.scattering = PEL_SCATTERING_NONE;
    material.specular = 0;
    std::fill_n(material.albedo, 3, 1.0f);
    images.shader.setMaterial(1, material);
    images.shader.commit().execute();
    return out.readAll<uint16_t>();
}

}  // namespace

TEST(HalfStores, RoundToNearestEven) {
    constexpr uint16_t largest = 0x7bff;
    std::vector<float> values;
    for (uint16_t h = 0; h < largest; ++h) {
        const float low = fromHalf(h), high = fromHalf(uint16_t(h + 1)), tie = low + (high - low) / 2;
        values.insert(values.end(), {low, tie, std::nextafter(tie, low), std::nextafter(tie, high)});
    }
    constexpr uint32_t width = 211;  // no multiple of a vector
    const uint32_t height = uint32_t((values.size() / 3 + width) / width);
    values.resize(size_t(3) * width * height);
    const std::vector<uint16_t> halves = written(values, width, height);
    size_t wrong = 0;
    for (size_t i = 0; i < values.size(); ++i)
        if (halves[i] != toHalf(values[i]) && ++wrong <= 5)
            ADD_FAILURE() << values[i] << " is " << halves[i] << ", not " << toHalf(values[i]);
    EXPECT_EQ(wrong, 0u);
}
