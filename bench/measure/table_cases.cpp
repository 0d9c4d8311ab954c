// Look-up tables against adaptive quadrature in double precision, at texels drawn once.
#include <random>

#include "measure.h"
#include "reference/lut.h"

namespace pellucid::bench {
namespace {

// `texelOf`: makes the true texels of a table.
template <class Desc, class TexelOf>
Case tableCase(const Device& device, Desc desc, uint32_t side, int samples, const TexelOf& texelOf,
               const std::string& what) {
    desc.width = desc.height = side;
    const auto lut = std::make_shared<Lut>();
    Case c;
    c.what = std::to_string(side) + "x" + std::to_string(side) + what;
    c.items = double(side) * side;
    c.unit = "texels";
    c.bytes = 16 * c.items;  // float4, written
    c.run = [=] { *lut = Lut(device, desc); };
    c.error = [=] {
        const std::vector<float> values = lut->read<float>(PEL_LUT_FLOAT);
        const auto texel = texelOf(lut->info());
        std::mt19937 random(1);
        ErrorSum sum;
        for (int i = 0; i < samples; ++i) {
            const auto x = uint32_t(random() % side), y = uint32_t(random() % side);
            const reference::Rgb truth = texel(int(x), int(y));
            for (int c = 0; c < 3; ++c) sum.add(values[3 * (size_t(y) * side + x) + size_t(c)] - truth[c]);
        }
        return sum.result();
    };
    c.truth = "adaptive quadrature in double precision at drawn texels; absolute";
    return c;
}

constexpr float burleyMeanFreePath[3] = {1.0f, 0.4f, 0.2f}, burleyAlbedo[3] = {0.8f, 0.6f, 0.5f};

}  // namespace

std::vector<Factory> tableCases(const Device& device, bool quick) {
    const uint32_t side = quick ? 128 : 512;
    const int samples = quick ? 60 : 300;
    using Texel = std::function<reference::Rgb(int, int)>;
    const auto rgb = [](const float(&v)[3]) { return reference::Rgb{v[0], v[1], v[2]}; };
    const auto curvature = [=](PelCurvatureForm form, reference::Form truth, bool burley) {
        return [=] {
            PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
            desc.form = form;
            const Profile profile =
                burley ? Profile::burley(burleyMeanFreePath, burleyAlbedo) : Profile::skin();
            if (burley) desc.profile = profile.get(), desc.diffusionRadius = 0;  // its own
            const auto texel = [=](const PelLutInfo& info) -> Texel {
                (void)profile;  // lives as long as the case
                const PelCurvatureLutDesc& made = info.curvature;
                const reference::CurvatureLutSpec spec{truth, int(side), int(side), made.radiusMin,
                                                       made.radiusMax};
                const reference::ProfilePtr p =
                    burley ? reference::burleyProfile(rgb(burleyMeanFreePath), rgb(burleyAlbedo))
                           : reference::profileForRadius(reference::skinProfile(), made.diffusionRadius);
                return [=](int x, int y) { return reference::curvatureTexel(spec, *p, x, y); };
            };
            return tableCase(device, desc, side, burley ? samples / 3 : samples, texel,
                             burley ? ", Christensen-Burley profile" : ", skin");
        };
    };
    const auto shadow = [=] {
        const auto texel = [=](const PelLutInfo& info) -> Texel {
            const PelShadowLutDesc& made = info.shadow;
            const reference::ShadowLutSpec spec{
                int(side), int(side), made.widthMin, made.widthMax, made.diffusionRadius, made.sharpening};
            const reference::ProfilePtr skin = reference::skinProfile();
            return [=](int x, int y) { return reference::shadowTexel(spec, *skin, x, y); };
        };
        return tableCase(device, pelShadowLutDescFaceWorks(), side, samples, texel, ", skin");
    };
    const auto specular = [=] {
        const auto texel = [=](const PelLutInfo&) -> Texel {
            return [=](int x, int y) {
                const double v = reference::beckmannEncoded((x + 0.5) / side, (y + 0.5) / side);
                return reference::Rgb{v, v, v};
            };
        };
        return tableCase(device, pelSpecularLutDescDefaults(), side, samples, texel, "");
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
