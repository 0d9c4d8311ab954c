// Packed images, read and written, with every code of every component: codes are few, so none is left to chance.
#include <gtest/gtest.h>

#include "half_bits.h"
#include "shade_scene.h"
#include "tolerances.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::imageDesc;
using pellucid::Shader;

namespace {

constexpr uint32_t side = 256, pixels = side * side;  // as many as 16 bits have codes

// Code k of pixel i. Odd factors take each code of up to 16 bits once as i counts through them.
uint32_t code(uint32_t i, uint32_t k, uint32_t count) {
    constexpr uint32_t odd[] = {1, 40503, 27291, 14011, 60493, 33391};
    return (i * odd[k] & 65535) % count;
}
template <class T>
void append(std::vector<uint8_t>& bytes, T value) {
    const auto* from = reinterpret_cast<const uint8_t*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof value);
}
double fromSrgb(double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
double signedUnit(uint32_t code) {
    return std::max(-1.0, int16_t(code) / 32767.0);
}

// What the codes of a pixel stand for, and all pixels' bytes.
struct Pixel {
    Rgb albedo;
    double occlusion;
    Vec3 normal;
};
struct Bytes {
    std::vector<uint8_t> albedo, occlusion, normal;
};
struct Formats {
    const char* name;
    PelFormat albedo, occlusion, normal;
    Pixel (*pack)(uint32_t i, Bytes& to);
};

const Formats formats[] = {
    {"Srgb8Unorm16Octahedral", PEL_FORMAT_RGBA8_SRGB, PEL_FORMAT_R16_UNORM, PEL_FORMAT_OCT16X2_SNORM,
     [](uint32_t i, Bytes& to) {
         Pixel out;
         for (uint32_t c = 0; c < 3; ++c)
             append(to.albedo, uint8_t(code(i, c, 256))),
                 out.albedo[int(c)] = fromSrgb(to.albedo.back() / 255.0);
         append(to.albedo, uint8_t(9));
         append(to.occlusion, uint16_t(code(i, 3, 65536)));
         out.occlusion = code(i, 3, 65536) / 65535.0;
         for (uint32_t k = 4; k < 6; ++k) append(to.normal, uint16_t(code(i, k, 65536)));
         const double u = signedUnit(code(i, 4, 65536)), v = signedUnit(code(i, 5, 65536)),
                      z = 1 - std::abs(u) - std::abs(v);
         out.normal = {z < 0 ? (1 - std::abs(v)) * std::copysign(1, u) : u,
                       z < 0 ? (1 - std::abs(u)) * std::copysign(1, v) : v, z};
         return out;
     }},
    {"Half3Unorm8A2B10G10R10", PEL_FORMAT_RGB16F, PEL_FORMAT_R8_UNORM, PEL_FORMAT_A2B10G10R10_UNORM,
     [](uint32_t i, Bytes& to) {
         Pixel out;
         for (uint32_t c = 0; c < 3; ++c) {
             const auto h = uint16_t(code(i, c, 0x3c01));  // 0 to 1
             append(to.albedo, h), out.albedo[int(c)] = fromHalf(h);
         }
         append(to.occlusion, uint8_t(code(i, 3, 256)));
         out.occlusion = to.occlusion.back() / 255.0;
         const uint32_t n[3] = {code(i, 4, 1024), code(i, 5, 1024), code(i / 64 + 31 * i, 3, 1024)};
         append(to.normal, n[0] | n[1] << 10 | n[2] << 20);
         for (int c = 0; c < 3; ++c) out.normal[c] = 2 * (n[c] / 1023.0) - 1;
         return out;
     }},
    {"Unorm8HalfUnorm8Normal", PEL_FORMAT_RGBA8_UNORM, PEL_FORMAT_R16F, PEL_FORMAT_RGBA8_UNORM,
     [](uint32_t i, Bytes& to) {
         Pixel out;
         for (uint32_t c = 0; c < 3; ++c)
             append(to.albedo, uint8_t(code(i, c, 256))), out.albedo[int(c)] = to.albedo.back() / 255.0;
         append(to.albedo, uint8_t(9));
         const auto h = uint16_t(code(i, 3, 0x3c01));
         append(to.occlusion, h);
         out.occlusion = fromHalf(h);
         const uint32_t n[3] = {code(i, 4, 256), code(i, 5, 256), code(i / 256 + 7 * i, 3, 256)};
         for (int c = 0; c < 3; ++c) append(to.normal, uint8_t(n[c])), out.normal[c] = 2 * (n[c] / 255.0) - 1;
         append(to.normal, uint8_t(9));
         return out;
     }}};

struct Packed {
    Bytes bytes;
    std::vector<Pixel> pixels;
    PelAmbient ambient = pelAmbientDefaults();

    explicit Packed(const Formats& f) {
        for (uint32_t i = 0; i < ::pixels; ++i) pixels.push_back(f.pack(i, bytes));
        const float strength[3] = {0.5f, 0.25f, 0.75f};
        std::copy_n(strength, 3, ambient.constant);
        for (int c = 0; c < 3; ++c) ambient.sh[1 + c][c] = 0.3f;
    }
    // NaN where the normal has no direction.
    Rgb radiance(size_t i) const {
        const Pixel& p = pixels[i];
        if (reference::length(p.normal) < 1e-3) return {NAN, NAN, NAN};
        reference::Ambient a{{ambient.constant[0], ambient.constant[1], ambient.constant[2]}, {}};
        for (int k = 0; k < 9; ++k)
            a.harmonics[size_t(k)] = {ambient.sh[k][0], ambient.sh[k][1], ambient.sh[k][2]};
        return p.occlusion * (p.albedo * reference::irradiance(a, reference::normalized(p.normal)));
    }
    Buffer shade(const Formats& f, PelFormat target) const {
        Shader shader(device());
        const Buffer out(device(), pixels.size() * 12);
        PelMaterial m = fixture::faceworksMaterial();
        std::fill_n(m.normalBlend, 3, 1.0f);
        shader.set(ambient).setMaterial(1, m, pellucid::Lut(), pellucid::Lut());
        const auto set = [&](PelImageSlot slot, const std::vector<uint8_t>& values, PelFormat format) {
            shader.set(slot, imageDesc(Buffer(device(), values), format, side, side));
        };
        set(PEL_SLOT_ALBEDO, bytes.albedo, f.albedo);
        set(PEL_SLOT_AMBIENT_OCCLUSION, bytes.occlusion, f.occlusion);
        set(PEL_SLOT_NORMAL_SHADING, bytes.normal, f.normal);
        shader.set(PEL_SLOT_RADIANCE, imageDesc(out, target, side, side));
        shader.commit().execute();
        return out;
    }
};

class FormatCodes : public ::testing::TestWithParam<Formats> {};

}  // namespace

TEST_P(FormatCodes, AreReadAsDefined) {
    const Packed packed(GetParam());
    const auto shown = packed.shade(GetParam(), PEL_FORMAT_RGB32F).readAll<float>();
    double worst = 0;
    for (size_t i = 0; i < pixels; ++i) {
        const Rgb truth = packed.radiance(i);
        for (int c = 0; c < 3; ++c)
            if (!std::isnan(truth[c]))
                worst = std::max(worst, std::abs(shown[3 * i + size_t(c)] - truth[c]) / std::max(1.0, truth[c]));
    }
    EXPECT_LE(worst, tolerance::decodedImage);
    EXPECT_GT(*std::max_element(shown.begin(), shown.end()), 0.5f);
}

INSTANTIATE_TEST_SUITE_P(All, FormatCodes, ::testing::ValuesIn(formats),
                         [](const auto& info) { return info.param.name; });

TEST(FormatCodesWritten, HalvesAreTheNearest) {
    const Formats& f = formats[2];
    const Packed packed(f);
    const auto halves = packed.shade(f, PEL_FORMAT_RGB16F).readAll<uint16_t>();
    for (size_t i = 0; i < pixels; ++i) {
        const Rgb truth = packed.radiance(i);
        for (int c = 0; c < 3; ++c) {
            if (std::isnan(truth[c])) continue;
            const int exponent = std::max(truth[c] == 0 ? -14 : std::ilogb(truth[c]), -14);
            ASSERT_LE(std::abs(double(fromHalf(halves[3 * i + size_t(c)])) - truth[c]),
                      std::ldexp(0.5, exponent - 10) + tolerance::decodedImage)
                << i;
        }
    }
}
