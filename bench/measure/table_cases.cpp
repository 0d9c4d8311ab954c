// Look-up tables against adaptive quadrature in double precision, at texels drawn once.
#include <random>

#include "case.h"
#include "reference/lut.h"

namespace pellucid::bench {
namespace {

template <class Texel>
Error atTexels(const Lut& lut, uint32_t width, uint32_t height, int samples, Texel&& texel) {
    const std::vector<float> values = lut.read<float>(PEL_LUT_FLOAT);
    std::mt19937 random(1);
    ErrorSum sum;
    for (int i = 0; i < samples; ++i) {
        const auto x = uint32_t(random() % width), y = uint32_t(random() % height);
        const reference::Rgb truth = texel(int(x), int(y));
        for (int c = 0; c < 3; ++c) sum.add(values[3 * (size_t(y) * width + x) + size_t(c)] - truth[c]);
    }
    return sum.result();
}

template <class Desc>
Case tableCase(const Device& device, const Desc& desc, std::function<Error(const Lut&)> error,
               const std::string& what) {
    const auto lut = std::make_shared<Lut>();
    Case c;
    c.what = std::to_string(desc.width) + "x" + std::to_string(desc.height) + what;
    c.items = double(desc.width) * desc.height;
    c.unit = "texels";
    c.bytes = 16 * c.items;  // float4, written
    c.run = [=] { *lut = Lut(device, desc); };
    c.error = [=] { return error(*lut); };
    c.truth = "adaptive quadrature in double precision at drawn texels; absolute";
    return c;
}

constexpr float burleyMeanFreePath[3] = {1.0f, 0.4f, 0.2f}, burleyAlbedo[3] = {0.8f, 0.6f, 0.5f};

}  // namespace

std::vector<Factory> tableCases(const Device& device, Size size) {
    const uint32_t side = size.quick ? 128 : 512;
    const int samples = size.quick ? 60 : 300;
    const auto curvature = [=](PelCurvatureForm form, reference::Form truth, bool burley) {
        return [=] {
            PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
            desc.width = desc.height = side;
            desc.form = form;
            const auto profile = std::make_shared<Profile>();
            if (burley) {
                *profile = Profile::burley(burleyMeanFreePath, burleyAlbedo);
                desc.profile = profile->get();
                desc.diffusionRadius = 0;  // its own
            }
            const auto error = [=](const Lut& lut) {
                const PelCurvatureLutDesc made = lut.info().curvature;
                reference::CurvatureLutSpec spec;
                spec.form = truth;
                spec.width = spec.height = int(side);
                spec.radiusMin = made.radiusMin, spec.radiusMax = made.radiusMax;
                const auto rgb = [](const float(&v)[3]) { return reference::Rgb{v[0], v[1], v[2]}; };
                const reference::ProfilePtr p =
                    burley ? reference::burleyProfile(rgb(burleyMeanFreePath), rgb(burleyAlbedo))
                           : reference::profileForRadius(reference::skinProfile(), made.diffusionRadius);
                return atTexels(lut, side, side, burley ? samples / 3 : samples,
                                [&](int x, int y) { return reference::curvatureTexel(spec, *p, x, y); });
            };
            Case c = tableCase(device, desc, error, burley ? ", Christensen-Burley profile" : ", skin");
            const auto keep = c.run;
            c.run = [=] { (void)profile, keep(); };
            return c;
        };
    };
    const auto shadow = [=] {
        PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
        desc.width = desc.height = side;
        return tableCase(
            device, desc,
            [=](const Lut& lut) {
                const PelShadowLutDesc made = lut.info().shadow;
                const reference::ShadowLutSpec spec{
                    int(side),      int(side), made.widthMin, made.widthMax, made.diffusionRadius,
                    made.sharpening};
                const reference::ProfilePtr skin = reference::skinProfile();
                return atTexels(lut, side, side, samples,
                                [&](int x, int y) { return reference::shadowTexel(spec, *skin, x, y); });
            },
            ", skin");
    };
    const auto specular = [=] {
        PelSpecularLutDesc desc = pelSpecularLutDescDefaults();
        desc.width = desc.height = side;
        return tableCase(
            device, desc,
            [=](const Lut& lut) {
                return atTexels(lut, side, side, samples, [&](int x, int y) {
                    const double v = reference::beckmannEncoded((x + 0.5) / side, (y + 0.5) / side);
                    return reference::Rgb{v, v, v};
                });
            },
            "");
    };
    return {{"table-arc", "tables", curvature(PEL_FORM_ARC, reference::Form::arc, false)},
            {"table-ring", "tables", curvature(PEL_FORM_RING, reference::Form::ring, false)},
            {"table-half-ring", "tables", curvature(PEL_FORM_HALF_RING, reference::Form::halfRing, false)},
            {"table-sphere", "tables", curvature(PEL_FORM_SPHERE, reference::Form::sphere, false)},
            {"table-sphere-burley", "tables", curvature(PEL_FORM_SPHERE, reference::Form::sphere, true)},
            {"table-shadow", "tables", shadow},
            {"table-specular", "tables", specular}};
}

}  // namespace pellucid::bench
