// Images in every layout: the same pixels give the same bits. Packed formats: test_format_codes.cpp.
#include <gtest/gtest.h>

#include "shade_scene.h"
#include "tolerances.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::imageDesc;
using pellucid::Shader;

namespace {

constexpr PelImageSlot floatSlots[] = {
    PEL_SLOT_POSITION,  PEL_SLOT_NORMAL_GEOMETRIC, PEL_SLOT_NORMAL_SHADING, PEL_SLOT_NORMAL_BLURRED,
    PEL_SLOT_CURVATURE, PEL_SLOT_ALBEDO,           PEL_SLOT_ROUGHNESS,      PEL_SLOT_AMBIENT_OCCLUSION,
    PEL_SLOT_SPECULAR,  PEL_SLOT_MATERIAL};

std::vector<float> shadeInto(Shader& shader, const Frame& f) {
    const auto target = setTarget(device(), shader, f);
    shader.commit().execute();
    return target.readAll<float>();
}

// One interleaved record per pixel, rows padded, an odd start: the G-buffer of a host that keeps structures.
TEST(ShadeLayouts, InterleavedAndPaddedGivesTheSameBits) {
    const Frame f = randomFrame(3, 101, 37, 2);
    uint32_t words = 1;
    for (PelImageSlot slot : floatSlots) words += f.slots[slot].components;
    const uint32_t row = words * f.width + 5;
    std::vector<float> memory(3 + size_t(row) * f.height, NAN);
    uint32_t at = 3, offsets[PEL_SLOT_COUNT] = {};
    for (PelImageSlot slot : floatSlots) {
        const Image& image = f.slots[slot];
        offsets[slot] = at;
        for (uint32_t y = 0; y < f.height; ++y)
            for (uint32_t x = 0; x < f.width; ++x)
                for (uint32_t c = 0; c < image.components; ++c)
                    memory[at + size_t(y) * row + x * words + c] =
                        float(image.at(size_t(y) * f.width + x, c));
        at += image.components;
    }
    const Buffer buffer(device(), memory);
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    for (PelImageSlot slot : floatSlots) {
        PelImageDesc desc =
            imageDesc(buffer, floatFormats[f.slots[slot].components], f.width, f.height, offsets[slot] * 4);
        desc.pixelStride = words * 4;
        desc.rowStride = row * 4;
        shader.set(slot, desc);
    }
    EXPECT_EQ(shadeInto(shader, f), shade(device(), f, tables()));
}

TEST(ShadeLayouts, PlanarAndRgbaGiveTheSameBits) {
    const Frame f = randomFrame(4, 90, 21, 1);
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    for (PelImageSlot slot : {PEL_SLOT_POSITION, PEL_SLOT_ALBEDO, PEL_SLOT_NORMAL_BLURRED}) {
        std::vector<float> planes(f.pixels() * 3);
        for (size_t i = 0; i < f.pixels(); ++i)
            for (int c = 0; c < 3; ++c) planes[c * f.pixels() + i] = float(f.slots[slot].at(i, c));
        shader.set(slot, imageDesc(Buffer(device(), planes), PEL_FORMAT_PLANAR_RGB32F, f.width, f.height));
    }
    std::vector<float> four(f.pixels() * 4, NAN);
    for (size_t i = 0; i < f.pixels(); ++i)
        for (int c = 0; c < 3; ++c) four[4 * i + c] = float(f.slots[PEL_SLOT_NORMAL_SHADING].at(i, c));
    shader.set(PEL_SLOT_NORMAL_SHADING,
               imageDesc(Buffer(device(), four), PEL_FORMAT_RGBA32F, f.width, f.height));
    const auto expected = shade(device(), f, tables());
    EXPECT_EQ(shadeInto(shader, f), expected);

    const Buffer planar(device(), f.pixels() * 3 * sizeof(float));
    shader.set(PEL_SLOT_RADIANCE, imageDesc(planar, PEL_FORMAT_PLANAR_RGB32F, f.width, f.height));
    shader.commit().execute();
    const auto planes = planar.readAll<float>();
    for (size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(planes[i % 3 * f.pixels() + i / 3], expected[i]);
}

TEST(ShadeLayouts, OutputOverAnInput) {
    const Frame f = randomFrame(6, 75, 30, 1);
    const auto expected = shade(device(), f, tables());
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    const Buffer both = upload(device(), f.slots[PEL_SLOT_ALBEDO]);
    const PelImageDesc desc = imageDesc(both, PEL_FORMAT_RGB32F, f.width, f.height);
    shader.set(PEL_SLOT_ALBEDO, desc).set(PEL_SLOT_RADIANCE, desc).commit().execute();
    const auto result = both.readAll<float>();
    for (size_t i = 0; i < result.size(); ++i)
        EXPECT_EQ(result[i], f.slots[PEL_SLOT_MATERIAL].values[i / 3] != 0
                                 ? expected[i]
                                 : f.slots[PEL_SLOT_ALBEDO].values[i]);
    PelImageDesc shifted = desc;
    shifted.height = f.height - 1;
    shifted.byteOffset = 12;
    Shader small(device());
    Frame g = randomFrame(6, 75, 29, 1);
    setFrame(device(), small, g, tables());
    PelImageDesc top = desc;
    top.height = 29;
    small.set(PEL_SLOT_ALBEDO, shifted).set(PEL_SLOT_RADIANCE, top);
    EXPECT_THROW(small.commit(), pellucid::Error) << "one pixel later in the same memory";
}

// Depth of a perspective camera, ordinary and reversed, instead of positions.
TEST(ShadeLayouts, PositionsFromDepth) {
    for (const bool reversed : {false, true}) {
        Frame f = randomFrame(14, 64, 40, 2);
        // Camera at z = 500 looking down -z: x_clip = 4 x / w, w = 500 - z, depth = A + B / w.
        const float nearPlane = reversed ? 1000 : 100, farPlane = reversed ? 100 : 1000;
        const float a = farPlane / (farPlane - nearPlane), b = -nearPlane * a;
        const float inverse[16] = {0.25f, 0, 0,     0,     0, 0.25f, 0, 0, 0, 0, 500 / b, -500 * a / b - 1,
                                   0,     0, 1 / b, -a / b};
        std::copy_n(inverse, 16, f.camera.inverseViewProjection);
        Image depth{1, std::vector<float>(f.pixels())};
        for (size_t i = 0; i < f.pixels(); ++i) {
            float* p = &f.slots[PEL_SLOT_POSITION].values[3 * i];
            const double d = depth.values[i] = a + b / (500 - p[2]);
            const double w = b / (d - a);
            p[0] = float(((double(i % f.width) + 0.5) * 2 / f.width - 1) * w / 4);
            p[1] = float((1 - (double(i / f.width) + 0.5) * 2 / f.height) * w / 4);
            p[2] = float(500 - w);
        }
        Shader shader(device());
        setFrame(device(), shader, f, tables());
        shader.clear(PEL_SLOT_POSITION);
        shader.set(PEL_SLOT_DEPTH, imageDesc(upload(device(), depth), PEL_FORMAT_R32F, f.width, f.height));
        const auto result = shadeInto(shader, f);
        EXPECT_LE(worstError(f, result), tolerance::shadeFromDepth) << "reversed " << reversed;
        // A NaN in the depth makes its own pixel invalid and no other.
        size_t at = 0;
        while (f.slots[PEL_SLOT_MATERIAL].values[at] == 0) ++at;
        for (const float bad : {NAN, INFINITY}) {
            depth.values[at] = bad;
            f.options.invalidColor[2] = -7;
            shader.set(f.options);
            shader.set(PEL_SLOT_DEPTH,
                       imageDesc(upload(device(), depth), PEL_FORMAT_R32F, f.width, f.height));
            const auto corrupted = shadeInto(shader, f);
            for (size_t i = 0; i < result.size(); ++i)
                EXPECT_EQ(corrupted[i], i / 3 != at ? result[i] : i % 3 == 2 ? -7 : 0) << i;
        }
    }
}

}  // namespace
