// Host side of kernels/diffusion/surface_integral.cl.
#include "diffusion/surface_integral.h"

#include <numbers>

#include "core/handle_table.h"
#include "core/launch_policy.h"
#include "diffusion/surface_tree.h"

namespace pel {
namespace {

constexpr size_t pointsPerLaunch = 1 << 14;

size_t irradiances(const PelSurfaceIntegralDesc& desc) {
    switch (desc.irradianceAt) {
        case PEL_IRRADIANCE_VERTEX:
            return desc.numVertices;
        case PEL_IRRADIANCE_TRIANGLE:
            return desc.numIndices / 3;
        case PEL_IRRADIANCE_CORNER:
            return desc.numIndices;
    }
    invalidArgument("PelSurfaceIntegralDesc.irradianceAt is ", int(desc.irradianceAt),
                    "; it must be 0, 1 or 2");
}

void checkFinite(const char* what, float value, bool zero) {
    if (!std::isfinite(value) || value < 0 || (value == 0 && !zero))
        invalidArgument("PelSurfaceIntegralDesc.", what, " is ", value, "; a finite number ",
                        zero ? "of 0 or more" : "above 0", " is needed");
}

std::vector<SurfaceTriangle> litTriangles(const PelSurfaceIntegralDesc& desc) {
    std::vector<SurfaceTriangle> lit;
    for (size_t i = 0; i < desc.numIndices / 3; ++i) {
        SurfaceTriangle t{};
        float most = 0;
        for (int k = 0; k < 3; ++k) {
            const size_t vertex = desc.indices[3 * i + k];
            const size_t light = desc.irradianceAt == PEL_IRRADIANCE_VERTEX     ? vertex
                                 : desc.irradianceAt == PEL_IRRADIANCE_TRIANGLE ? i
                                                                                : 3 * i + k;
            for (int c = 0; c < 3; ++c) {
                t.corner[3 * k + c] = desc.positions[3 * vertex + c];
                t.irradiance[3 * k + c] = desc.irradiance[3 * light + c];
                most = std::max(most, t.irradiance[3 * k + c]);
            }
        }
        if (most == 0) continue;
        const Three a = threeAt(t.corner), ab = threeAt(t.corner + 3) - a, ac = threeAt(t.corner + 6) - a;
        const double longest = std::max(length(ab), length(ac));
        // Skips triangles that are degenerate in float.
        if (length(cross(ab, ac)) > 1e-7 * longest * longest) lit.push_back(t);
    }
    return lit;
}

}  // namespace

void checkSurfaceIntegral(const PelSurfaceIntegralDesc& desc) {
    const size_t lights = irradiances(desc);
    checkFinite("diffusionRadius", desc.diffusionRadius, true);
    checkFinite("millimetresPerUnit", desc.millimetresPerUnit, false);
    for (float cut : desc.cut) checkFinite("cut", cut, true);
    if (!(desc.tolerance >= 1e-7f && desc.tolerance <= 1))
        invalidArgument("PelSurfaceIntegralDesc.tolerance is ", desc.tolerance,
                        "; a part of the largest irradiance from 1e-7 to 1 "
                        "is needed, 1e-3 is typical");
    if (desc.numIndices % 3 != 0)
        invalidArgument("PelSurfaceIntegralDesc.numIndices is ", desc.numIndices,
                        "; three per triangle are needed");
    if (desc.numIndices / 3 >= 1u << 30)
        fail(PEL_ERROR_UNSUPPORTED, "the mesh has ", desc.numIndices / 3,
             " triangles; fewer than 2^30 are supported");
    if (desc.numIndices > 0 && (!desc.indices || !desc.positions || !desc.irradiance))
        invalidArgument("PelSurfaceIntegralDesc.",
                        !desc.indices     ? "indices"
                        : !desc.positions ? "positions"
                                          : "irradiance",
                        " is NULL; a mesh of ", desc.numIndices / 3, " triangles needs it");
    for (size_t i = 0; i < desc.numIndices; ++i) {
        if (desc.indices[i] >= desc.numVertices)
            invalidArgument("triangle ", i / 3, " has vertex ", desc.indices[i], "; the mesh has ",
                            desc.numVertices);
        for (int c = 0; c < 3; ++c)
            if (!(std::abs(desc.positions[3 * size_t(desc.indices[i]) + c]) < 1e15f))
                invalidArgument("the position of vertex ", desc.indices[i], " of triangle ", i / 3, " holds ",
                                desc.positions[3 * size_t(desc.indices[i]) + c],
                                "; lengths below 1e15 are needed");
    }
    for (size_t i = 0; desc.numIndices > 0 && i < 3 * lights; ++i)
        if (!(desc.irradiance[i] >= 0 && desc.irradiance[i] < 1e15f))
            invalidArgument("irradiance ", i / 3, " holds ", desc.irradiance[i],
                            "; numbers from 0 to 1e15 are needed");
}

void surfaceIntegral(Device& device, const PelSurfaceIntegralDesc& desc, const VertexView& points,
                     const VertexView& result, bool blocking) {
    if (points.layout.count == 0) return;
    const Ref<Profile> profile = desc.profile ? fromHandle<Profile>(desc.profile) : Profile::skin();
    // Lengths of the profile are in millimetres if a unit is given, and in units of positions by default.
    const double scale =
        (desc.diffusionRadius > 0 ? desc.diffusionRadius / profile->radius() : 1) / desc.millimetresPerUnit;
    const auto cut = threeOf([&](int c) { return desc.cut[c] / desc.millimetresPerUnit; });
    const char* const preparing = "sorting triangles";
    device.progress(0, preparing);
    const SurfaceProfile table = tabulateProfile(profile->shape(), scale, cut);
    const SurfaceTree tree =
        buildSurfaceTree(litTriangles(desc), table, double(desc.tolerance),
                         [&](double fraction) { device.progress(0.2 * fraction, preparing); });
    SurfaceSum sum{};
    sum.nodes = PelUint32(tree.nodes.size());
    sum.rows = PelUint32(table.count());
    sum.firstLog2 = float(table.firstLog2);
    sum.reach = float(table.reach);
    for (int c = 0; c < 3; ++c) sum.cut[c] = float(table.cut[c]);
    sum.whole = float(0.5 / std::numbers::pi);
    sum.piecesPerU = float(1 / table.piece);
    const cl::Memory nodes = device.upload(tree.nodes), triangles = device.upload(tree.triangles),
                     rows = device.upload(table.rows);
    const uint32_t lanes = device.info().mathWidth;
    const size_t group = launchPolicy(device).group;
    const cl::Program program =
        device.programs().get("diffusion/surface_integral.cl", {{"PEL_GROUP", text(group)}});
    const uint32_t count = points.layout.count;
    for (uint32_t first = 0; first < count; first += pointsPerLaunch) {
        const uint32_t end = uint32_t(std::min<size_t>(count, size_t(first) + pointsPerLaunch));
        cl::Launch launch(program, "surface_integral", sum, nodes, triangles, rows, points, result, first,
                          end);
        device.launch(launch, {{(end - first + lanes - 1) / lanes, 1, 1}, {group, 1, 1}});
        if (!blocking) continue;
        if (device.hasProgress()) device.finish();
        device.progress(0.2 + 0.8 * end / count, "adding up light");
    }
}

}  // namespace pel
