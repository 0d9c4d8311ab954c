// Packed images, tight and padded, with every code of every component.
#include "shade_scene.h"
#include "test.h"

using namespace shade_test;

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

// Appends code k of pixel i to the bytes: what it stands for, 0 to 1; halves that are signed, -1 to 1.
double component(PelFormat format, std::vector<uint8_t>& to, uint32_t i, uint32_t k, bool isSigned = false) {
    switch (format) {
        case PEL_FORMAT_RGBA8_UNORM:
        case PEL_FORMAT_R8_UNORM:
        case PEL_FORMAT_RGBA8_SRGB:
            append(to, uint8_t(code(i, k, 256)));
            return format == PEL_FORMAT_RGBA8_SRGB ? fromSrgb(to.back() / 255.0) : to.back() / 255.0;
        case PEL_FORMAT_R16_UNORM:
            append(to, uint16_t(code(i, k, 65536)));
            return code(i, k, 65536) / 65535.0;
        case PEL_FORMAT_R32F:
        case PEL_FORMAT_RGB32F:
            append(to, float(code(i, k, 65536)) / 65535);
            return float(code(i, k, 65536)) / 65535;
        default:
            const auto h = uint16_t(code(i, k, 0x3c01) | isSigned * code(i, (k + 1) % 6, 2) << 15);
            append(to, h);
            return fromHalf(h);
    }
}
void appendAlpha(PelFormat format, std::vector<uint8_t>& to) {
    if (format == PEL_FORMAT_RGBA8_UNORM || format == PEL_FORMAT_RGBA8_SRGB) append(to, uint8_t(9));
    if (format == PEL_FORMAT_RGBA16F) append(to, uint16_t(0x7e00));  // NaN: alpha is not read
}
Vec3 normalOf(PelFormat format, std::vector<uint8_t>& to, uint32_t i) {
    if (format == PEL_FORMAT_OCT16X2_SNORM) {
        for (uint32_t k = 4; k < 6; ++k) append(to, uint16_t(code(i, k, 65536)));
        const double u = signedUnit(code(i, 4, 65536)), v = signedUnit(code(i, 5, 65536)),
                     z = 1 - std::abs(u) - std::abs(v);
        return {z < 0 ? (1 - std::abs(v)) * std::copysign(1, u) : u,
                z < 0 ? (1 - std::abs(u)) * std::copysign(1, v) : v, z};
    }
    if (format == PEL_FORMAT_A2B10G10R10_UNORM) {
        const uint32_t n[3] = {code(i, 4, 1024), code(i, 5, 1024), code(i / 64 + 31 * i, 3, 1024)};
        append(to, n[0] | n[1] << 10 | n[2] << 20);
        return {2 * (n[0] / 1023.0) - 1, 2 * (n[1] / 1023.0) - 1, 2 * (n[2] / 1023.0) - 1};
    }
    if (format == PEL_FORMAT_RGB32F) {  // taken as unit vectors
        std::vector<uint8_t> other;
        const Vec3 n = normalized(normalOf(PEL_FORMAT_A2B10G10R10_UNORM, other, i));
        for (int c = 0; c < 3; ++c) append(to, float(n[c]));
        return n;
    }
    Vec3 out;
    for (uint32_t c = 0; c < 3; ++c) {
        const double v = component(format, to, c < 2 ? i : i / 256 + 7 * i, c < 2 ? 4 + c : 3, true);
        out[int(c)] = format == PEL_FORMAT_RGBA16F ? v : 2 * v - 1;
    }
    appendAlpha(format, to);
    return out;
}

// What the codes of a pixel stand for.
struct Pixel {
    Rgb albedo;
    double occlusion;
    Vec3 normal;
};
struct Formats {
    const char* name;
    PelFormat albedo, occlusion, normal, id;
};

const Formats formats[] = {
    {"Srgb8Unorm16Octahedral", PEL_FORMAT_RGBA8_SRGB, PEL_FORMAT_R16_UNORM, PEL_FORMAT_OCT16X2_SNORM,
     PEL_FORMAT_R8_UINT},
    {"Half3Unorm8A2B10G10R10", PEL_FORMAT_RGB16F, PEL_FORMAT_R8_UNORM, PEL_FORMAT_A2B10G10R10_UNORM,
     PEL_FORMAT_R16_UINT},
    {"Unorm8HalfUnorm8Normal", PEL_FORMAT_RGBA8_UNORM, PEL_FORMAT_R16F, PEL_FORMAT_RGBA8_UNORM,
     PEL_FORMAT_R32_UINT},
    {"HalvesWithAlpha", PEL_FORMAT_RGBA16F, PEL_FORMAT_R32F, PEL_FORMAT_RGBA16F, PEL_FORMAT_R32F},
    {"Floats", PEL_FORMAT_RGB32F, PEL_FORMAT_R32F, PEL_FORMAT_RGB32F, PEL_FORMAT_R8_UINT}};

uint32_t idOf(uint32_t i) {
    return code(i, 2, 65536) % 3;  // 0 is background
}
void appendId(PelFormat format, std::vector<uint8_t>& bytes, uint32_t id) {
    if (format == PEL_FORMAT_R8_UINT) append(bytes, uint8_t(id));
    if (format == PEL_FORMAT_R16_UINT) append(bytes, uint16_t(id));
    if (format == PEL_FORMAT_R32_UINT) append(bytes, id);
    if (format == PEL_FORMAT_R32F) append(bytes, float(id));
}

struct Packed {
    std::vector<uint8_t> albedo, occlusion, normal, ids;
    std::vector<Pixel> pixels = std::vector<Pixel>(::pixels);
    PelAmbient ambient = pelAmbientDefaults();

    explicit Packed(const Formats& f) {
        for (uint32_t i = 0; i < ::pixels; ++i) {
            Pixel& p = pixels[i];
            for (uint32_t c = 0; c < 3; ++c) p.albedo[int(c)] = component(f.albedo, albedo, i, c);
            appendAlpha(f.albedo, albedo);
            p.occlusion = component(f.occlusion, occlusion, i, 3);
            p.normal = normalOf(f.normal, normal, i);
            appendId(f.id, ids, idOf(i));
        }
        copyTo(ambient.constant, {0.5, 0.25, 0.75});
        for (int c = 0; c < 3; ++c) ambient.sh[1 + c][c] = 0.3f;
    }
    // NaN where the normal has no direction.
    Rgb radiance(size_t i) const {
        const Pixel& p = pixels[i];
        if (idOf(uint32_t(i)) == 0) return {0, 0, 0};
        if (length(p.normal) < 1e-3) return {NAN, NAN, NAN};
        reference::Ambient a{vectorOf(ambient.constant), {}};
        for (size_t k = 0; k < 9; ++k) a.harmonics[k] = vectorOf(ambient.sh[k]);
        return p.occlusion * (p.albedo * reference::irradiance(a, normalized(p.normal)));
    }
    // `padded`: each pixel is followed by as many bytes of something else.
    std::vector<float> shade(const Formats& f, bool padded) const {
        Shader shader(device());
        const Buffer out(device(), pixels.size() * 12);
        PelMaterial m = fixture::faceworksMaterial();
        std::fill_n(m.normalBlend, 3, 1.0f);
        shader.set(ambient);
        for (uint32_t id : {1u, 2u}) shader.setMaterial(id, m, pellucid::Lut(), pellucid::Lut());
        const auto set = [&](PelImageSlot slot, std::vector<uint8_t> values, PelFormat format) {
            const size_t bytes = values.size() / pixels.size();
            if (padded) {
                std::vector<uint8_t> wide(2 * values.size(), 0xa5);
                for (size_t i = 0; i < pixels.size(); ++i)
                    std::copy_n(&values[i * bytes], bytes, &wide[2 * i * bytes]);
                values = wide;
            }
            const Buffer buffer(device(), values);
            PelImageDesc desc = imageDesc(buffer, format, side, side);
            desc.pixelStride = uint32_t((1 + padded) * bytes);
            desc.rowStride = side * desc.pixelStride;
            shader.set(slot, desc);
        };
        set(PEL_SLOT_ALBEDO, albedo, f.albedo);
        set(PEL_SLOT_AMBIENT_OCCLUSION, occlusion, f.occlusion);
        set(PEL_SLOT_NORMAL_SHADING, normal, f.normal);
        set(PEL_SLOT_MATERIAL, ids, f.id);
        shader.set(PEL_SLOT_RADIANCE, imageDesc(out, PEL_FORMAT_RGB32F, side, side));
        shader.commit().execute();
        return out.readAll<float>();
    }
};

class FormatCodes : public ::testing::TestWithParam<std::tuple<Formats, bool>> {};

}  // namespace

TEST_P(FormatCodes, AreReadAsDefined) {
    const auto& [set, padded] = GetParam();
    const Packed packed(set);
    const auto shown = packed.shade(set, padded);
    double worst = 0;
    for (size_t i = 0; i < pixels; ++i) {
        const Rgb truth = packed.radiance(i);
        for (int c = 0; c < 3; ++c)
            if (!std::isnan(truth[c]))
                worst =
                    std::max(worst, std::abs(shown[3 * i + size_t(c)] - truth[c]) / std::max(1.0, truth[c]));
    }
    EXPECT_LE(worst, tolerance::decodedImage);
    EXPECT_GT(*std::max_element(shown.begin(), shown.end()), 0.5f);
}

INSTANTIATE_TEST_SUITE_P(All, FormatCodes,
                         ::testing::Combine(::testing::ValuesIn(formats), ::testing::Bool()),
                         [](const auto& info) {
                             return std::string(std::get<0>(info.param).name) +
                                    (std::get<1>(info.param) ? "Padded" : "Tight");
                         });
