// Beside kernels/lut/tabulated_curvature_lut.cl and kernels/lut/tabulated_shadow_lut.cl.
#include "lut/luts.h"

#include <numbers>

#include "core/launch_policy.h"
#include "lut/lut_terms.h"

namespace pel {
namespace {

// Intervals of the mesh. Corners of tabulated profiles need a finer one than Gaussians do.
constexpr int sweptNodes = 128, sphereNodes = 79;
// Cells of the sums of R, whose corners lie within cells; P is smoother, and more expensive.
constexpr int radialCells = 4096;
// Rows of shadow tables have nodes unless these outnumber the texels by this factor.
constexpr double nodesPerTexel = 2;

// The radius of each row, in diffusion radii.
std::vector<double> radiiOf(const PelCurvatureLutDesc& desc, const RowAxis& axis) {
    std::vector<double> radii;
    for (uint32_t row = 0; row < desc.height; ++row) {
        const double value = axis.min + (row + 0.5) * axis.step;
        radii.push_back(1 / (desc.axis == PEL_AXIS_ROOT ? value * value : value));
    }
    return radii;
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
    for (double radius : radiiOf(desc, axis)) {
        const double diameter = 2 * radius;
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

void integrateTabulatedCurvature(Lut& lut) {
    Device& device = lut.device();
    const Profile& profile = *lut.profile();
    const PelCurvatureLutDesc& desc = lut.info().curvature;
    const bool ring = desc.form == PEL_FORM_RING || desc.form == PEL_FORM_HALF_RING;
    const RowAxis axis = rowsOf(lut);

    const bool sphere = desc.form == PEL_FORM_SPHERE, chord = desc.form != PEL_FORM_ARC;
    const int intervals = sphere ? sphereNodes : sweptNodes;
    const double end = ring || desc.form == PEL_FORM_PENNER_RING ? tableReach(profile) : tableEnd(profile);
    TabulatedCurvatureLutParams params{};
    params.height = desc.height;
    params.axis = uint32_t(desc.axis);
    params.rowMin = float(axis.min);
    params.rowStep = float(axis.step);
    params.end = float(end);
    params.cells = ring ? radialCells : PEL_TAIL_CELLS;
    params.frontReach = float(chord ? std::numbers::sqrt2 : std::numbers::pi / 2);
    params.normalised = chord;

    const uint32_t lanes = device.info().mathWidth;
    const size_t group = launchPolicy(device).group, columnsPerItem = launchPolicy(device).columns;
    cl::Defines options{{"PEL_GROUP", group}, {"PEL_NODES", intervals}, {"PEL_COLUMNS", columnsPerItem}};
    if (desc.form == PEL_FORM_HALF_RING) options.emplace("PEL_HALF", "1");
    const cl::Program program = device.programs().get("lut/tabulated_curvature_lut.cl", options);
    const cl::Memory rows =
        device.allocate(PEL_CURVATURE_RECORD(size_t(intervals)) * desc.height * sizeof(cl_float4));
    if (sphere) {
        const SpherePoints of = spherePoints(profile, desc, axis);
        const cl::Memory nodes = device.upload(meshOfNodes(intervals)), ofRow = device.upload(of.ofRow),
                         points = device.upload(of.points);
        cl::Launch launch(program, "tabulated_sphere_rows", params, nodes, ofRow, points, rows);
        device.launch(launch, {{intervals / lanes + 1, desc.height, 1}, {group, 1, 1}});
    } else {
        const cl::Memory mesh = device.upload(tableMesh(intervals, chord)),
                         sums = device.upload(ring ? radialSums(profile, end, radialCells)
                                                   : lineSums(profile, end, PEL_TAIL_CELLS)),
                         opposite = device.upload(antipodes(profile, ring, radiiOf(desc, axis)));
        cl::Launch launch(program, "tabulated_rows", params, mesh, sums, opposite, rows);
        const size_t rowsPerItem = std::max(lanes / 4, 1u);
        device.launch(launch, {{(desc.height + rowsPerItem - 1) / rowsPerItem, 1, 1}, {group, 1, 1}});
    }
    const std::vector<LutColumn> columnWeights = curvatureColumns(desc.width, desc.axis, intervals);
    const cl::Memory columns = device.upload(columnWeights);
    cl::Launch texelLaunch(program, "curvature_texels", desc.width, desc.height, rows, columns, lut.texels());
    const size_t items = (columnWeights.size() + columnsPerItem - 1) / columnsPerItem;
    device.launch(texelLaunch, {{items, desc.height + size_t(1), 1}, {group, 1, 1}});
}

void integrateTabulatedShadow(Lut& lut) {
    Device& device = lut.device();
    const PelShadowLutDesc& desc = lut.info().shadow;
    const double end = tableEnd(*lut.profile());
    const RowAxis axis = rowsOf(lut);
    // Nodes reach to the ends of rows: PEL_RAMP_PARTS to a half width, of which `sharpening` are in half a
    // row.
    const double wanted = std::ceil(PEL_RAMP_PARTS * double(desc.sharpening) * (1 + 1e-6));
    const uint32_t nodes = wanted <= nodesPerTexel * desc.width ? uint32_t(wanted) : 0;
    const TabulatedShadowLutParams params{desc.width,          desc.height,     float(axis.min),
                                          float(axis.step),    desc.sharpening, float(end),
                                          uint32_t(desc.axis), desc.closedEnds, nodes};
    const size_t group = launchPolicy(device).group, columnsPerItem = launchPolicy(device).tableColumns;
    const cl::Program program = device.programs().get(
        "lut/tabulated_shadow_lut.cl", {{"PEL_GROUP", group}, {"PEL_COLUMNS", columnsPerItem}});
    const cl::Memory tails = device.upload(tableTails(*lut.profile(), end));
    const size_t record = PEL_RAMP_RECORD(size_t(nodes)), samples = 2 * PEL_RAMP_SAMPLES(size_t(nodes));
    const cl::Memory ofRows = device.allocate(record * desc.height * sizeof(cl_float4));
    if (nodes) {
        const cl::Memory weights = device.upload(rampWeights()),
                         scratch = device.allocate(samples * desc.height * sizeof(cl_float4));
        cl::Launch rows(program, "tabulated_shadow_rows", params, tails, weights, scratch, ofRows);
        device.launch(rows, {{(desc.height + group - 1) / group * group, 1, 1}, {group, 1, 1}});
    }
    cl::Launch launch(program, "tabulated_shadow_texels", params, tails, ofRows, lut.texels());
    const size_t lit = desc.width - desc.width / 2;
    device.launch(launch,
                  {{(lit + columnsPerItem - 1) / columnsPerItem, desc.height + size_t(1), 1}, {group, 1, 1}});
}

}  // namespace pel
