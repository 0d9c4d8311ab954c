// Beside kernels/lut/curvature_lut.cl.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/launch_policy.h"
#include "lut/lut_check.h"
#include "lut/lut_terms.h"
#include "lut/luts.h"
#include "lut/tabulated_luts.h"
#include "shared/choices.h"

namespace pel {
namespace {

// What the kernel calls the forms.
#define NUMBER(name, number, key) {"PEL_FORM_" #name, #number},

CurvatureLutParams paramsOf(const PelCurvatureLutDesc& desc, double curvatureMin, double curvatureMax,
                            size_t terms) {
    CurvatureLutParams params{};
    params.width = desc.width;
    params.height = desc.height;
    params.gaussians = uint32_t(terms);
    params.axis = uint32_t(desc.axis);
    const RowAxis axis = rowAxis(desc.axis, desc.height, curvatureMin, curvatureMax);
    params.rowMin = float(axis.min);
    params.rowStep = float(axis.step);
    params.cut = float(profileCut);
    return params;
}

}  // namespace

Ref<Lut> integrateCurvatureLut(Ref<Device> device, const PelCurvatureLutDesc& desc,
                               const CurvatureQuality& quality) {
    checkCurvatureDesc(desc);
    PelLutInfo info = pelLutInfoDefaults();
    info.kind = PEL_LUT_CURVATURE;
    info.curvature = desc;
    Ref<Lut> lut = make<Lut>(device, info);

    const double radius = lut->diffusionRadius();
    const double curvatureMin = rowLimit(lut->info().curvature.radiusMax, radius),
                 curvatureMax = rowLimit(lut->info().curvature.radiusMin, radius);
    const Profile& profile = *lut->profile();
    if (profile.terms().empty()) {
        integrateTabulatedCurvature(*lut, curvatureMin, curvatureMax);
        return lut;
    }
    std::vector<LutGaussian> terms = deviceTerms(profile, curvatureMax);
    // 1/d has no finite integral along a ring. The limit of the ratio is a point.
    if (profile.shape().singular() && (desc.form == PEL_FORM_RING || desc.form == PEL_FORM_HALF_RING))
        terms = {{float(1e-8 / std::max(1.0, curvatureMax)), 1, 1, 1}};

    const uint32_t lanes = device->info().mathWidth;
    const size_t group = launchPolicy(*device).group, columnsPerItem = launchPolicy(*device).columns;
    const cl::Program program = device->programs().get(
        "lut/curvature_lut.cl", {PEL_EACH_CURVATURE_FORM(NUMBER){"PEL_FORM", std::to_string(int(desc.form))},
                                 {"PEL_GROUP", std::to_string(group)},
                                 {"PEL_NODES", std::to_string(quality.nodes)},
                                 {"PEL_POINTS", std::to_string(quality.points)},
                                 {"PEL_COLUMNS", std::to_string(columnsPerItem)}});
    const std::vector<LutColumn> columnWeights = curvatureColumns(desc.width, desc.axis, quality.nodes);
    const cl::Memory gaussians = upload(*device, terms), nodes = upload(*device, meshOfNodes(quality.nodes)),
                     columns = upload(*device, columnWeights);
    const size_t record = PEL_CURVATURE_RECORD(quality.nodes);
    const cl::Memory rows = device->allocate(record * desc.height * sizeof(cl_float4));
    const CurvatureLutParams params = paramsOf(desc, curvatureMin, curvatureMax, terms.size());

    cl::Launch rowLaunch(program, "curvature_rows");
    rowLaunch.arg(params).arg(gaussians).arg(nodes).arg(rows);
    device->launch(rowLaunch, {{(desc.height + lanes - 1) / lanes, 1, 1}, {group, 1, 1}});

    cl::Launch texelLaunch(program, "curvature_texels");
    texelLaunch.arg(desc.width).arg(desc.height).arg(rows).arg(columns).arg(lut->texels());
    const size_t items = (columnWeights.size() + columnsPerItem - 1) / columnsPerItem;
    device->launch(texelLaunch, {{items, desc.height + 1, 1}, {group, 1, 1}});
    return lut;
}

}  // namespace pel
