// Packed images, read and written: each pixel has codes of its own, shown by constant ambient light.
#include "faceworks_material.h"
#include "vectors.h"

namespace stability {
namespace {

using namespace shade_test;

template <class T>
void append(std::vector<uint8_t>& bytes, T value) {
    const auto* from = reinterpret_cast<const uint8_t*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof value);
}
double fromSrgb(double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
double signedUnit(uint16_t code) {
    return std::max(-1.0, int16_t(code) / 32767.0);
}

// Albedo, occlusion and normal from a point of six coordinates: their bytes, and what they stand for.
struct Packed {
    Rgb albedo;
    double occlusion;
    Vec3 normal;
};
struct Formats {
    const char *name, *range;
    PelFormat albedo, occlusion, normal;
    Packed (*pack)(const Point& p, std::vector<uint8_t>& albedo, std::vector<uint8_t>& occlusion,
                   std::vector<uint8_t>& normal);
};
uint32_t code(double t, uint32_t most) {
    return uint32_t(t * (most + 0.999999));
}

const Formats all[] = {
    {"sRGB8, unorm16 and octahedral 16x2, read", "all codes", PEL_FORMAT_RGBA8_SRGB, PEL_FORMAT_R16_UNORM,
     PEL_FORMAT_OCT16X2_SNORM,
     [](const Point& p, std::vector<uint8_t>& albedo, std::vector<uint8_t>& occlusion, std::vector<uint8_t>& normal) {
         Packed out;
         for (int c = 0; c < 3; ++c)
             append(albedo, uint8_t(code(p[size_t(c)], 255))), out.albedo[c] = fromSrgb(albedo.back() / 255.0);
         append(albedo, uint8_t(9));
         append(occlusion, uint16_t(code(p[3], 65535)));
         out.occlusion = code(p[3], 65535) / 65535.0;
         const uint16_t x = uint16_t(code(p[4], 65535)), y = uint16_t(code(p[5], 65535));
         append(normal, x), append(normal, y);
         const double u = signedUnit(x), v = signedUnit(y), z = 1 - std::abs(u) - std::abs(v);
         out.normal = {z < 0 ? (1 - std::abs(v)) * std::copysign(1, u) : u,
                       z < 0 ? (1 - std::abs(u)) * std::copysign(1, v) : v, z};
         return out;
     }},
    {"half floats, unorm8 and 10-10-10, read", "all codes up to 1", PEL_FORMAT_RGB16F, PEL_FORMAT_R8_UNORM,
     PEL_FORMAT_A2B10G10R10_UNORM,
     [](const Point& p, std::vector<uint8_t>& albedo, std::vector<uint8_t>& occlusion, std::vector<uint8_t>& normal) {
         Packed out;
         for (int c = 0; c < 3; ++c) {
             const uint16_t h = uint16_t(code(p[size_t(c)], 0x3c00));
             append(albedo, h);
             out.albedo[c] = fromHalf(h);
         }
         append(occlusion, uint8_t(code(p[3], 255)));
         out.occlusion = code(p[3], 255) / 255.0;
         const uint32_t n[3] = {code(p[4], 1023), code(p[5], 1023),
                                code(std::fmod(7 * p[4] + 3 * p[5], 1.0), 1023)};
         append(normal, n[0] | n[1] << 10 | n[2] << 20);
         for (int c = 0; c < 3; ++c) out.normal[c] = 2 * (n[c] / 1023.0) - 1;
         return out;
     }},
    {"unorm8 colours, half scalars and unorm8 normals, read", "all codes", PEL_FORMAT_RGBA8_UNORM,
     PEL_FORMAT_R16F, PEL_FORMAT_RGBA8_UNORM,
     [](const Point& p, std::vector<uint8_t>& albedo, std::vector<uint8_t>& occlusion, std::vector<uint8_t>& normal) {
         Packed out;
         for (int c = 0; c < 3; ++c)
             append(albedo, uint8_t(code(p[size_t(c)], 255))), out.albedo[c] = albedo.back() / 255.0;
         append(albedo, uint8_t(9));
         append(occlusion, uint16_t(code(p[3], 0x3c00)));
         out.occlusion = fromHalf(uint16_t(code(p[3], 0x3c00)));
         const uint32_t n[3] = {code(p[4], 255), code(p[5], 255), code(std::fmod(7 * p[4] + 3 * p[5], 1.0), 255)};
         for (int c = 0; c < 3; ++c) append(normal, uint8_t(n[c])), out.normal[c] = 2 * (n[c] / 255.0) - 1;
         append(normal, uint8_t(9));
         return out;
     }}};

class Read : public Pixels {
  public:
    Read(const Formats& formats, bool half, const std::vector<Point>& points)
        : formats_(formats), half_(half) {
        for (const Point& p : points) pixels_.push_back(formats.pack(p, albedo_, occlusion_, normal_));
        const float strength[3] = {0.5f, 0.25f, 0.75f};
        std::copy_n(strength, 3, ambient_.constant);
        for (int c = 0; c < 3; ++c) ambient_.sh[1 + c][c] = 0.3f;
    }
    void move(Jitter&) override {}  // codes
    std::vector<float> measured() override {
        const uint32_t width = uint32_t(pixels_.size());
        Shader shader(device());
        const Buffer albedo(device(), albedo_), occlusion(device(), occlusion_), normal(device(), normal_),
            out(device(), width * 12);
        PelMaterial m = fixture::faceworksMaterial();
        std::fill_n(m.normalBlend, 3, 1.0f);
        shader.set(ambient_).setMaterial(1, m, Lut(), Lut());
        shader.set(PEL_SLOT_ALBEDO, imageDesc(albedo, formats_.albedo, width, 1));
        shader.set(PEL_SLOT_AMBIENT_OCCLUSION, imageDesc(occlusion, formats_.occlusion, width, 1));
        shader.set(PEL_SLOT_NORMAL_SHADING, imageDesc(normal, formats_.normal, width, 1));
        shader.set(PEL_SLOT_RADIANCE, imageDesc(out, half_ ? PEL_FORMAT_RGB16F : PEL_FORMAT_RGB32F, width, 1));
        shader.commit().execute();
        if (!half_) return out.readAll<float>();
        std::vector<uint16_t> halves = out.readAll<uint16_t>();
        std::vector<float> beyond;
        for (size_t i = 0; i < 3 * pixels_.size(); ++i)
            beyond.push_back(float(beyondHalf(halves[i], radiance(i / 3)[int(i % 3)])));
        return beyond;
    }
    std::vector<double> truth(size_t i) override {
        Rgb r = radiance(i);
        if (half_) r = 0 * r;  // what is measured is a difference already
        return {r.x, r.y, r.z};
    }

  private:
    Rgb radiance(size_t i) const {
        const Packed& p = pixels_[i];
        if (reference::length(p.normal) < 1e-3) return {NAN, NAN, NAN};
        reference::Ambient ambient{{ambient_.constant[0], ambient_.constant[1], ambient_.constant[2]}, {}};
        for (int k = 0; k < 9; ++k)
            ambient.harmonics[size_t(k)] = {ambient_.sh[k][0], ambient_.sh[k][1], ambient_.sh[k][2]};
        return p.occlusion * (p.albedo * reference::irradiance(ambient, reference::normalized(p.normal)));
    }

    const Formats& formats_;
    bool half_;
    std::vector<Packed> pixels_;
    std::vector<uint8_t> albedo_, occlusion_, normal_;
    PelAmbient ambient_ = pelAmbientDefaults();
};

Operation read(const Formats& f, bool half) {
    return operation(
        {half ? "half floats, written" : f.name, f.range, half ? Unit::rounding : Unit::absolute,
         tolerance::decodedImage, 7, 100000},
        1,
        [&f, half](size_t, const std::vector<Point>& points) {
            return std::make_unique<Read>(f, half, points);
        },
        [&f](size_t, const Point& p) {
            std::vector<uint8_t> a, b, c;
            const Packed k = f.pack(p, a, b, c);
            return text("albedo %.3g %.3g %.3g, occlusion %.3g", k.albedo.x, k.albedo.y, k.albedo.z, k.occlusion);
        });
}

}  // namespace

std::vector<Operation> formatOperations() {
    return {read(all[0], false), read(all[1], false), read(all[2], false), read(all[2], true)};
}

}  // namespace stability
