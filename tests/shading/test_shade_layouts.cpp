// Images in every layout: the same pixels give the same bits, packed formats give what their decoded values
// give.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "half_bits.h"
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
    const Buffer target(device(), f.pixels() * 3 * sizeof(float));
    shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, f.width, f.height));
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
                    memory[at + size_t(y) * row + x * words + c] = float(image.at(size_t(y) * f.width + x, c));
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
    shader.set(PEL_SLOT_NORMAL_SHADING, imageDesc(Buffer(device(), four), PEL_FORMAT_RGBA32F, f.width, f.height));
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
        EXPECT_EQ(result[i], f.slots[PEL_SLOT_MATERIAL].values[i / 3] != 0 ? expected[i]
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

// --- packed formats: shading decoded values in float must agree ---

struct Packed {
    const char* name;
    PelFormat format;
    PelImageSlot slot;
    // Replaces the image's values by what the format keeps of them, and returns the format's bytes.
    std::vector<uint8_t> (*pack)(Image& image);
};
void PrintTo(const Packed& p, std::ostream* out) {
    *out << p.name;
}

template <class T>
void append(std::vector<uint8_t>& bytes, T value) {
    const auto* from = reinterpret_cast<const uint8_t*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof value);
}

void renormalize(Image& image) {
    for (size_t i = 0; i < image.values.size(); i += 3) {
        const double length = reference::length(image.vec(i / 3));
        for (int c = 0; c < 3; ++c) image.values[i + c] = float(image.values[i + c] / length);
    }
}

template <uint32_t Components>
std::vector<uint8_t> packHalf(Image& image) {
    std::vector<uint8_t> bytes;
    for (size_t i = 0; i < image.values.size(); ++i) {
        const uint16_t h = toHalf(image.values[i]);
        append(bytes, h);
        image.values[i] = fromHalf(h);
        if (Components == 4 && i % 3 == 2) append(bytes, uint16_t(0x7e00));  // alpha: NaN, of no concern
    }
    return bytes;
}

template <uint32_t Components>
std::vector<uint8_t> packHalfNormal(Image& image) {
    auto bytes = packHalf<Components>(image);
    renormalize(image);
    return bytes;
}

template <class T, bool Vector, uint32_t Components>
std::vector<uint8_t> packUnorm(Image& image) {
    std::vector<uint8_t> bytes;
    const float most = std::numeric_limits<T>::max();
    for (size_t i = 0; i < image.values.size(); ++i) {
        const float value = Vector ? 0.5f * image.values[i] + 0.5f : image.values[i];
        const T code = T(std::lrint(std::clamp(value, 0.0f, 1.0f) * most));
        append(bytes, code);
        image.values[i] = Vector ? 2 * (code / most) - 1 : code / most;
        if (Components == 4 && i % 3 == 2) append(bytes, T(77));
    }
    if (Vector) renormalize(image);
    return bytes;
}

std::vector<uint8_t> packSrgb(Image& image) {
    std::vector<uint8_t> bytes;
    for (size_t i = 0; i < image.values.size(); ++i) {
        const auto code = uint8_t(std::lrint(image.values[i] * 255));
        append(bytes, code);
        const double c = code / 255.0;
        image.values[i] = float(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
        if (i % 3 == 2) append(bytes, uint8_t(1));
    }
    return bytes;
}

std::vector<uint8_t> packTenTenTen(Image& image) {
    std::vector<uint8_t> bytes;
    for (size_t i = 0; i < image.values.size(); i += 3) {
        uint32_t word = 2u << 30;
        for (int c = 0; c < 3; ++c) {
            const auto code = uint32_t(std::lrint((0.5f * image.values[i + c] + 0.5f) * 1023));
            word |= code << 10 * c;
            image.values[i + c] = 2 * (code / 1023.0f) - 1;
        }
        append(bytes, word);
    }
    renormalize(image);
    return bytes;
}

std::vector<uint8_t> packOctahedral(Image& image) {
    std::vector<uint8_t> bytes;
    for (size_t i = 0; i < image.values.size(); i += 3) {
        float* n = &image.values[i];
        const float sum = std::fabs(n[0]) + std::fabs(n[1]) + std::fabs(n[2]);
        float x = n[0] / sum, y = n[1] / sum;
        if (n[2] < 0) {
            const float folded = (1 - std::fabs(y)) * std::copysign(1.0f, x);
            y = (1 - std::fabs(x)) * std::copysign(1.0f, y);
            x = folded;
        }
        const auto cx = int16_t(std::lrint(x * 32767)), cy = int16_t(std::lrint(y * 32767));
        append(bytes, cx);
        append(bytes, cy);
        x = cx / 32767.0f, y = cy / 32767.0f;
        n[2] = 1 - std::fabs(x) - std::fabs(y);
        n[0] = n[2] < 0 ? (1 - std::fabs(y)) * std::copysign(1.0f, x) : x;
        n[1] = n[2] < 0 ? (1 - std::fabs(x)) * std::copysign(1.0f, y) : y;
    }
    renormalize(image);
    return bytes;
}

template <class T>
std::vector<uint8_t> packUint(Image& image) {
    std::vector<uint8_t> bytes;
    for (float value : image.values) append(bytes, T(value));
    return bytes;
}

const Packed packs[] = {
    {"HalfRgbPosition", PEL_FORMAT_RGB16F, PEL_SLOT_POSITION, packHalf<3>},
    {"HalfRgbaAlbedo", PEL_FORMAT_RGBA16F, PEL_SLOT_ALBEDO, packHalf<4>},
    {"HalfRgbaNormal", PEL_FORMAT_RGBA16F, PEL_SLOT_NORMAL_SHADING, packHalfNormal<4>},
    {"HalfCurvature", PEL_FORMAT_R16F, PEL_SLOT_CURVATURE, packHalf<1>},
    {"Unorm8Occlusion", PEL_FORMAT_R8_UNORM, PEL_SLOT_AMBIENT_OCCLUSION, packUnorm<uint8_t, false, 1>},
    {"Unorm16Specular", PEL_FORMAT_R16_UNORM, PEL_SLOT_SPECULAR, packUnorm<uint16_t, false, 1>},
    {"Unorm8Normal", PEL_FORMAT_RGBA8_UNORM, PEL_SLOT_NORMAL_BLURRED, packUnorm<uint8_t, true, 4>},
    {"Unorm8Albedo", PEL_FORMAT_RGBA8_UNORM, PEL_SLOT_ALBEDO, packUnorm<uint8_t, false, 4>},
    {"SrgbAlbedo", PEL_FORMAT_RGBA8_SRGB, PEL_SLOT_ALBEDO, packSrgb},
    {"TenBitNormal", PEL_FORMAT_A2B10G10R10_UNORM, PEL_SLOT_NORMAL_SHADING, packTenTenTen},
    {"OctahedralNormal", PEL_FORMAT_OCT16X2_SNORM, PEL_SLOT_NORMAL_GEOMETRIC, packOctahedral},
    {"Id8", PEL_FORMAT_R8_UINT, PEL_SLOT_MATERIAL, packUint<uint8_t>},
    {"Id16", PEL_FORMAT_R16_UINT, PEL_SLOT_MATERIAL, packUint<uint16_t>},
    {"Id32", PEL_FORMAT_R32_UINT, PEL_SLOT_MATERIAL, packUint<uint32_t>},
};

// Formats of different slots are tested in one frame, for compiling the kernel takes seconds.
std::vector<std::vector<Packed>> frames() {
    std::vector<std::vector<Packed>> frames;
    for (const Packed& pack : packs) {
        const auto free = [&](const std::vector<Packed>& frame) {
            return std::ranges::none_of(frame, [&](const Packed& other) { return other.slot == pack.slot; });
        };
        auto frame = std::ranges::find_if(frames, free);
        if (frame == frames.end()) frame = frames.emplace(frames.end());
        frame->push_back(pack);
    }
    return frames;
}

class ShadePacked : public testing::TestWithParam<std::tuple<std::vector<Packed>, bool>> {};

TEST_P(ShadePacked, ShadesWhatItDecodesTo) {
    const auto& [packed, padded] = GetParam();
    Frame f = randomFrame(9, 70, 24, 1);
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    std::vector<Buffer> buffers;
    for (const Packed& one : packed) {
        std::vector<uint8_t> bytes = one.pack(f.slots[one.slot]);
        const size_t pixel = bytes.size() / f.pixels();
        const Buffer none;
        PelImageDesc desc = imageDesc(none, one.format, f.width, f.height);
        if (padded) {
            std::vector<uint8_t> wide(bytes.size() * 2, 0xa5);
            for (size_t i = 0; i < f.pixels(); ++i)
                std::memcpy(&wide[i * 2 * pixel], &bytes[i * pixel], pixel);
            bytes = wide;
            desc.pixelStride = 2 * pixel;
        }
        buffers.emplace_back(device(), bytes);
        desc.buffer = buffers.back().get();
        shader.set(one.slot, desc);
    }
    EXPECT_LE(worstError(f, shadeInto(shader, f)), tolerance::shadeSum);
}

INSTANTIATE_TEST_SUITE_P(Formats, ShadePacked, testing::Combine(testing::ValuesIn(frames()), testing::Bool()),
                         [](const auto& info) {
                             std::string name;
                             for (const Packed& one : std::get<0>(info.param)) name += one.name;
                             return name + (std::get<1>(info.param) ? "Padded" : "Tight");
                         });

TEST(ShadeLayouts, HalfOutputRoundsToNearest) {
    const Frame f = randomFrame(12, 50, 20, 1);
    const auto expected = shade(device(), f, tables());
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    const Buffer target(device(), f.pixels() * 8);
    shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGBA16F, f.width, f.height)).commit().execute();
    const auto halves = target.readAll<uint16_t>();
    for (size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(halves[i / 3 * 4 + i % 3], toHalf(expected[i]));
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
            shader.set(PEL_SLOT_DEPTH, imageDesc(upload(device(), depth), PEL_FORMAT_R32F, f.width, f.height));
            const auto spoiled = shadeInto(shader, f);
            for (size_t i = 0; i < result.size(); ++i)
                EXPECT_EQ(spoiled[i], i / 3 != at ? result[i] : i % 3 == 2 ? -7 : 0) << i;
        }
    }
}

}  // namespace
