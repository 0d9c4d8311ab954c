#include "reference/lut.h"

#include "stability.h"

namespace stability {
namespace {

Operation curvatureTable(const char* name, PelCurvatureForm form, reference::Form other) {
    return {name, "radii 0.01 to 10,000 mm, ratio of the two 1.1 to 10,000; diffusion radius 0.1 to 100 mm",
            "absolute", 3, [=](const Point& p, std::string& where) {
                PelCurvatureLutDesc desc = pelCurvatureLutDescDefaults();
                desc.form = form;
                desc.width = 15, desc.height = 6;
                desc.radiusMin = float(logBetween(p[0], 0.01, 1000));
                desc.radiusMax = std::min(1e4f, float(desc.radiusMin * logBetween(p[1], 1.1, 1e4)));
                if (desc.radiusMax < 1.1f * desc.radiusMin) desc.radiusMax = 1.1f * desc.radiusMin;
                desc.diffusionRadius = float(logBetween(p[2], 0.1, 100));
                const std::vector<float> texels = Lut(device(), desc).read<float>(PEL_LUT_FLOAT);
                reference::CurvatureLutSpec spec{other, 15, 6, desc.radiusMin, desc.radiusMax};
                const auto skin = reference::profileForRadius(reference::skinProfile(), desc.diffusionRadius);
                double worst = 0;
                for (int i = 0; i < 90; ++i) {
                    const reference::Rgb truth = reference::curvatureTexel(spec, *skin, i % 15, i / 15);
                    for (int c = 0; c < 3; ++c) {
                        const double e = std::abs(texels[size_t(3 * i + c)] - truth[c]);
                        keepWorst(worst, e);
                    }
                }
                where = text("radii %.3g to %.3g mm, diffusion radius %.3g mm", desc.radiusMin,
                             desc.radiusMax, desc.diffusionRadius);
                return worst;
            }};
}

Operation shadowTable() {
    return {"shadow table", "widths 0.1 to 10,000 mm; diffusion radius 0.1 to 100 mm; sharpening 1 to 100",
            "absolute", 4, [](const Point& p, std::string& where) {
                PelShadowLutDesc desc = pelShadowLutDescDefaults();
                desc.width = 31, desc.height = 6;
                desc.widthMin = float(logBetween(p[0], 0.1, 1000));
                desc.widthMax = float(desc.widthMin * logBetween(p[1], 1.1, 10));
                desc.diffusionRadius = float(logBetween(p[2], 0.1, 100));
                desc.sharpening = float(logBetween(p[3], 1, 100));
                const std::vector<float> texels = Lut(device(), desc).read<float>(PEL_LUT_FLOAT);
                const reference::ShadowLutSpec spec{
                    31, 6, desc.widthMin, desc.widthMax, desc.diffusionRadius, desc.sharpening};
                const auto skin = reference::skinProfile();
                double worst = 0;
                for (int i = 0; i < 186; ++i) {
                    const reference::Rgb truth = reference::shadowTexel(spec, *skin, i % 31, i / 31);
                    for (int c = 0; c < 3; ++c) {
                        const double e = std::abs(texels[size_t(3 * i + c)] - truth[c]);
                        keepWorst(worst, e);
                    }
                }
                where = text("widths %.3g to %.3g mm, diffusion radius %.3g mm, sharpening %.3g",
                             desc.widthMin, desc.widthMax, desc.diffusionRadius, desc.sharpening);
                return worst;
            }};
}

}  // namespace

std::vector<Operation> tableOperations() {
    return {curvatureTable("curvature table, arc", PEL_FORM_ARC, reference::Form::arc),
            curvatureTable("curvature table, ring", PEL_FORM_RING, reference::Form::ring),
            curvatureTable("curvature table, half-ring", PEL_FORM_HALF_RING, reference::Form::halfRing),
            curvatureTable("curvature table, sphere", PEL_FORM_SPHERE, reference::Form::sphere),
            shadowTable()};
}

}  // namespace stability
