// Eyes: the table of a cornea's caustics against the flux that enters it, and a frame that shows an eye
// against the tracer of tests/reference, with the same table.
#include <random>

#include "eye/reference_eye.h"
#include "measure.h"

namespace pellucid::bench {
namespace {

using reference::Vec3;

constexpr double toLight[3] = {0.6, 0, 0.8}, camera[3] = {0, 0, 400}, share = 0.05;
constexpr float irisColor = 0.4f, scleraAlbedo = 0.7f;

// Share of a texel within the iris' rim.
double covered(const PelEyeLutDesc& desc, uint32_t i, uint32_t j) {
    int on = 0;
    for (int k = 0; k < 64; ++k)
        on += std::hypot((i + (k % 8 + 0.5) / 8) / desc.width * 2 - 1,
                         (j + (k / 8 + 0.5) / 8) / desc.height) < 1;
    return on / 64.0;
}

Case tableCase(const Device& device, bool quick) {
    PelEyeLutDesc desc = pelEyeLutDescDefaults();
    if (quick) desc.width = desc.height = 32, desc.depth = 16;
    const auto lut = std::make_shared<Lut>();
    Case c;
    c.what =
        std::to_string(desc.width) + "x" + std::to_string(desc.height) + "x" + std::to_string(desc.depth);
    c.items = double(desc.width) * desc.height * desc.depth;
    c.unit = "texels";
    c.bytes = 16 * c.items;
    c.run = [=] { *lut = Lut(device, desc); };
    c.error = [=] {
        const reference::Eye eye = eye_test::referenceOf(pelEyeDefaults());
        const std::vector<float> texels = lut->read<float>(PEL_LUT_FLOAT);
        const size_t slice = size_t(desc.width) * desc.height;
        ErrorSum sum;
        for (uint32_t z = 0; z < desc.depth * 3 / 4; z += desc.depth / 8) {
            double flux = 0;
            for (size_t k = 0; k < slice; ++k)
                flux += texels[3 * (z * slice + k)] *
                        covered(desc, uint32_t(k) % desc.width, uint32_t(k) / desc.width);
            flux *= 4 * eye.iris / desc.width * eye.iris / desc.height;  // both halves
            sum.add(flux / fluxOnIris(eye, largestAngle(eye) * z / (desc.depth - 1), 400) - 1);
        }
        return sum.result();
    };
    c.truth = "flux that enters the cornea and ends on the iris, in double precision; relative";
    return c;
}

// Skin everywhere, except for a square of 5 % of the pixels that shows the front of a ball, an eye.
struct EyeFrame {
    uint32_t width, height;
    std::vector<float> position;  // xyz per pixel
    std::vector<uint8_t> id;
    Shader shader;
    Buffer target;
    Lut caustics;
    PelEyeLutDesc desc{};

    EyeFrame(const Device& device, bool quick)
        : width(quick ? 480 : 1920), height(quick ? 270 : 1080), shader(device) {
        const double side = std::sqrt(share * double(size_t(width) * height));
        std::vector<float> normal;
        for (uint32_t y = 0; y < height; ++y)
            for (uint32_t x = 0; x < width; ++x) {
                const double u = (x - 0.5 * width) / side * 2, v = (0.5 * height - y) / side * 2;
                const bool inside = std::abs(u) < 1 && std::abs(v) < 1;
                const double px = 8.4 * u, py = 8.4 * v,
                             pz = std::sqrt(std::max(144 - px * px - py * py, 1.0));
                for (const double c : {px, py, inside ? pz : -10.0}) position.push_back(float(c));
                const double length = std::hypot(px, py, pz);
                for (const double c : {px, py, pz}) normal.push_back(float(c / length));
                id.push_back(inside ? 2 : 1);
            }
        target = Buffer(device, size_t(width) * height * 12);
        PelEye eye = pelEyeDefaults();
        std::fill_n(eye.irisColor, 3, irisColor);
        desc = pelEyeLutDescOf(&eye);
        caustics = Lut(device, desc);
        PelMaterial skin = pelMaterialDefaults();
        skin.scattering = PEL_SCATTERING_NONE;
        PelMaterial sclera = skin;
        skin.specular = 1;
        std::fill_n(sclera.albedo, 3, scleraAlbedo);
        PelCamera from = pelCameraDefaults();
        PelLight light = pelLightDefaults();
        for (int i = 0; i < 3; ++i) from.position[i] = float(camera[i]), light.toLight[i] = float(toLight[i]);
        const Buffer texture(device, std::vector<float>(4 * 4 * 3, 1.0f));
        shader.set(from).setMaterial(1, skin).setMaterial(2, sclera).setEye(2, eye, caustics);
        shader.setIrisTexture(2, imageDesc(texture, PEL_FORMAT_RGB32F, 4, 4));
        shader.set(std::vector{light});
        const auto set = [&](PelImageSlot slot, const Buffer& image, PelFormat format) {
            shader.set(slot, imageDesc(image, format, width, height));
        };
        set(PEL_SLOT_RADIANCE, target, PEL_FORMAT_RGB32F);
        set(PEL_SLOT_POSITION, Buffer(device, position), PEL_FORMAT_RGB32F);
        set(PEL_SLOT_NORMAL_SHADING, Buffer(device, normal), PEL_FORMAT_RGB32F);
        set(PEL_SLOT_MATERIAL, Buffer(device, id), PEL_FORMAT_R8_UINT);
        shader.commit();
    }

    // Irradiance on the iris by the table, between the slices of the nearest angles (section 13).
    reference::Caustic onIris(const reference::Eye& eye) const {
        const std::vector<float> texels = caustics.read<float>(PEL_LUT_FLOAT);
        const double z = std::acos(toLight[2]) / largestAngle(eye) * (desc.depth - 1);
        const size_t slice = size_t(desc.width) * desc.height, first = size_t(z) * slice;
        reference::Caustic between{int(desc.width), int(desc.height), {}};
        for (size_t k = first; k < first + slice; ++k)
            between.texels.push_back(
                std::lerp(double(texels[3 * k]), texels[3 * (k + slice)], z - std::floor(z)));
        return between;
    }

    Error error(int samples) const {
        const reference::Eye eye = eye_test::referenceOf(pelEyeDefaults());
        const reference::Caustic light = onIris(eye);
        const std::vector<float> out = target.readAll<float>();
        const Vec3 l{toLight[0], toLight[1], toLight[2]}, from{camera[0], camera[1], camera[2]};
        std::mt19937 random(1);
        ErrorSum sum;
        for (int s = 0; s < samples;) {
            const size_t i = random() % id.size();
            if (id[i] != 2) continue;
            ++s;
            const Vec3 p{position[3 * i], position[3 * i + 1], position[3 * i + 2]};
            const Vec3 v = reference::normalized(from - p), ball = reference::normalized(p);
            const reference::EyeHit h = traceEye(eye, from, -1.0 * v);
            const Vec3 n = h.share > 0
                               ? reference::normalized((1 - h.share) * ball +
                                                       h.share * eye.corneaNormal(h.point.x, h.point.y))
                               : ball;
            double expected = (1 - h.share) * scleraAlbedo * std::max(0.0, dot(ball, l)) +
                              tearGloss(n, l, v, eye.tearRoughness, eye.nTear);
            if (h.share > 0)
                expected += h.share * irisVisible(eye, h) * h.transmittance / (eye.nAqueous * eye.nAqueous) *
                            irisColor * light.at(h.px, h.py, eye.iris);
            sum.add(out[3 * i] - expected);
        }
        return sum.result();
    }
};

}  // namespace

std::vector<Factory> eyeCases(const Device& device, bool quick) {
    const auto frame = [=] {
        const auto made = std::make_shared<EyeFrame>(device, quick);
        return Case{.what = std::to_string(made->width) + "x" + std::to_string(made->height) + ", 5 % an eye",
                    .items = double(made->width) * made->height,
                    .unit = "pixels",
                    .run = [=] { made->shader.execute(); },
                    .error = [=] { return made->error(quick ? 200 : 1000); },
                    .truth =
                        "the tracer in double precision with the same table, at drawn pixels of the eye; "
                        "absolute"};
    };
    return {{"table-eye", "tables", [=] { return tableCase(device, quick); }},
            {"shade-eye", "shading", frame}};
}

}  // namespace pellucid::bench
