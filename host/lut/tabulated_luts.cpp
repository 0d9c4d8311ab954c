// Beside kernels/lut/tabulated_curvature_lut.cl and kernels/lut/tabulated_shadow_lut.cl.
#include "lut/tabulated_luts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/launch_policy.h"
#include "lut/tabulated_integrals.h"

namespace pel {
namespace {

// Corners of tabulated profiles need a finer mesh than Gaussians do.
constexpr int meshIntervals = 256;
// Rows are integrated in parts, so that the records of one part stay below this many bytes.
constexpr size_t recordBytes = size_t(64) << 20;

std::vector<TableColumn> columnsOf(const PelCurvatureLutDesc& desc) {
    std::vector<TableColumn> columns;
    for (uint32_t x = 0; x < (desc.width + 1) / 2; ++x) {
        const double elevation = columnElevation(x, desc.width, desc.axis);
        columns.push_back({float(std::asin(elevation)), float(elevation)});
    }
    return columns;
}

// Rows on spheres so large that the table ends before a quarter of the way round share their points.
struct SpherePoints {
    std::vector<cl_float4> points;
    std::vector<TablePoints> ofRow;
};

SpherePoints spherePoints(const Profile& profile, const PelCurvatureLutDesc& desc, const RowAxis& axis) {
    const std::vector<cl_float4> knots = tableKnots(profile);
    const double end = knots.back().s[3];
    SpherePoints all;
    bool shared = false;  // rows go from large spheres to small ones
    for (uint32_t row = 0; row < desc.height; ++row) {
        const double value = axis.min + (row + 0.5) * axis.step;
        const double diameter = 2 / (desc.axis == PEL_AXIS_ROOT ? value * value : value);
        const bool large = diameter / std::numbers::sqrt2 >= end;
        if (shared && large) {
            all.ofRow.push_back(all.ofRow.back());
            continue;
        }
        const std::vector<cl_float4> points = tablePoints(knots, diameter);
        all.ofRow.push_back({uint32_t(all.points.size()), uint32_t(points.size())});
        all.points.insert(all.points.end(), points.begin(), points.end());
        shared = large;
    }
    return all;
}

}  // namespace

void integrateTabulatedCurvature(Lut& lut, double curvatureMin, double curvatureMax) {
    Device& device = lut.device();
    const Profile& profile = *lut.profile();
    const PelCurvatureLutDesc& desc = lut.info().curvature;
    const bool ring = desc.form == PEL_FORM_RING || desc.form == PEL_FORM_HALF_RING;
    const RowAxis axis = rowAxis(desc.axis, desc.height, curvatureMin, curvatureMax);

    TabulatedCurvatureLutParams params{};
    params.width = desc.width;
    params.height = desc.height;
    params.axis = uint32_t(desc.axis);
    params.nodes = meshIntervals + 1;
    params.rowMin = float(axis.min);
    params.rowStep = float(axis.step);
    const bool chord = desc.form == PEL_FORM_PENNER_RING;
    const double end = chord ? tableReach(profile) : tableEnd(profile);
    params.end = float(end);

    // What the rows of each form read.
    cl::Memory source, ofRow;
    if (ring) {
        const std::vector<cl_float4> knots = tableKnots(profile);
        params.knots = uint32_t(knots.size() - 1);
        source = upload(device, knots);
    } else if (desc.form == PEL_FORM_SPHERE) {
        const SpherePoints sphere = spherePoints(profile, desc, axis);
        source = upload(device, sphere.points);
        ofRow = upload(device, sphere.ofRow);
    } else {
        source = upload(device, tableTails(profile, end));
    }
    params.slots = params.nodes + params.knots + 1;
    if (!ring) params.slots = params.nodes;

    const uint32_t lanes = device.info().mathWidth;
    const auto [group, columnsPerItem, unused] = launchPolicy(device);
    cl::Defines options{{"PEL_GROUP", std::to_string(group)}, {"PEL_COLUMNS", std::to_string(columnsPerItem)}};
    if (desc.form == PEL_FORM_HALF_RING) options.emplace("PEL_HALF", "1");
    if (chord) options.emplace("PEL_CHORD", "1");
    const cl::Program program = device.programs().get("lut/tabulated_curvature_lut.cl", options);
    const std::vector<TableColumn> columnList = columnsOf(desc);
    const cl::Memory nodes = upload(device, meshOfNodes(meshIntervals)), columns = upload(device, columnList);

    const size_t record = PEL_TABLE_RECORD(size_t(params.slots)) * sizeof(cl_float4);
    const uint32_t part = uint32_t(std::clamp<size_t>(recordBytes / record, 1, desc.height));
    const cl::Memory rows = device.allocate(record * part);
    for (params.firstRow = 0; params.firstRow < desc.height; params.firstRow += part) {
        params.rows = std::min(part, desc.height - params.firstRow);
        const char* name = ring                           ? "tabulated_ring_rows"
                           : desc.form == PEL_FORM_SPHERE ? "tabulated_sphere_rows"
                                                          : "tabulated_arc_rows";
        cl::Launch rowLaunch(program, name);
        rowLaunch.arg(params).arg(nodes);
        if (desc.form == PEL_FORM_SPHERE) rowLaunch.arg(ofRow);
        rowLaunch.arg(source).arg(rows);
        if (desc.form == PEL_FORM_SPHERE)
            device.launch(rowLaunch, {{(params.nodes + lanes - 1) / lanes, params.rows, 1}, {group, 1, 1}});
        else
            device.launch(rowLaunch, {{params.rows, 1, 1}, {group, 1, 1}});

        cl::Launch texelLaunch(program, "tabulated_texels");
        texelLaunch.arg(params).arg(rows).arg(columns).arg(lut.texels());
        const bool last = params.firstRow + params.rows == desc.height;  // includes the copied row
        device.launch(texelLaunch, {{(columnList.size() + columnsPerItem - 1) / columnsPerItem,
                                     params.rows + (last ? 1 : 0), 1},
                                    {group, 1, 1}});
    }
}

void integrateTabulatedShadow(Lut& lut, double reciprocalMin, double reciprocalMax) {
    Device& device = lut.device();
    const PelShadowLutDesc& desc = lut.info().shadow;
    const double end = tableEnd(*lut.profile());
    const RowAxis axis = rowAxis(desc.axis, desc.height, reciprocalMin, reciprocalMax);
    const TabulatedShadowLutParams params{desc.width,      desc.height, float(axis.min),     float(axis.step),
                                          desc.sharpening, float(end),  uint32_t(desc.axis), desc.closedEnds};
    const auto [group, unused, columnsPerItem] = launchPolicy(device);
    const cl::Program program = device.programs().get(
        "lut/tabulated_shadow_lut.cl",
        {{"PEL_GROUP", std::to_string(group)}, {"PEL_COLUMNS", std::to_string(columnsPerItem)}});
    const cl::Memory tails = upload(device, tableTails(*lut.profile(), end));
    cl::Launch launch(program, "table_shadow_texels");
    launch.arg(params).arg(tails).arg(lut.texels());
    const size_t lit = desc.width - desc.width / 2;
    device.launch(launch,
                  {{(lit + columnsPerItem - 1) / columnsPerItem, desc.height + size_t(1), 1}, {group, 1, 1}});
}

}  // namespace pel
