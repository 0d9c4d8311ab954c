// Beside kernels/lut/shadow_lut.cl.
#include <cmath>

#include "core/launch_policy.h"
#include "lut/lut_check.h"
#include "lut/lut_terms.h"
#include "lut/luts.h"
#include "lut/tabulated_luts.h"

namespace pel {

Ref<Lut> integrateShadowLut(Ref<Device> device, const PelShadowLutDesc& desc) {
    checkShadowDesc(desc);
    PelLutInfo info = pelLutInfoDefaults();
    info.kind = PEL_LUT_SHADOW;
    info.shadow = desc;
    Ref<Lut> lut = make<Lut>(device, info);

    const Profile& profile = *lut->profile();
    const double radius = lut->diffusionRadius();
    const double reciprocalMin = rowLimit(lut->info().shadow.widthMax, radius),
                 reciprocalMax = rowLimit(lut->info().shadow.widthMin, radius);
    if (profile.terms().empty()) {
        integrateTabulatedShadow(*lut, reciprocalMin, reciprocalMax);
        return lut;
    }
    const std::vector<LutGaussian> terms = deviceTerms(profile, reciprocalMax);
    const RowAxis axis = rowAxis(desc.axis, desc.height, reciprocalMin, reciprocalMax);
    ShadowLutParams params{desc.width,          desc.height,     uint32_t(terms.size()), float(axis.min),
                           float(axis.step),    desc.sharpening, float(profileCut),      {},
                           uint32_t(desc.axis), desc.closedEnds};
    for (int channel = 0; channel < 3; ++channel) {
        double total = 0;
        for (const GaussianTerm& term : profile.terms())
            total +=
                term.weight[channel] * std::erf(profileCut * profile.radius() / std::sqrt(2 * term.variance));
        params.total[channel] = float(total);
    }

    const size_t group = launchPolicy(*device).group, columnsPerItem = launchPolicy(*device).columns;
    const cl::Program program = device->programs().get(
        "lut/shadow_lut.cl",
        {{"PEL_GROUP", std::to_string(group)}, {"PEL_COLUMNS", std::to_string(columnsPerItem)}});
    const cl::Memory gaussians = upload(*device, terms);
    cl::Launch launch(program, "shadow_texels");
    launch.arg(params).arg(gaussians).arg(lut->texels());
    const size_t lit = desc.width - desc.width / 2, items = (lit + columnsPerItem - 1) / columnsPerItem;
    device->launch(launch, {{items, desc.height + 1, 1}, {group, 1, 1}});
    return lut;
}

}  // namespace pel
