// Tensor and quadric against surfaces whose curvature is known.
#include "mesh_fixture.h"
#include "reference/scattered.h"
#include "reference_meshes.h"

using namespace fixture;
using reference::AnalyticMesh;
using reference::Tessellation;

namespace {

constexpr PelCurvatureEstimator estimators[] = {PEL_CURVATURE_TENSOR, PEL_CURVATURE_QUADRIC};
constexpr Tessellation kinds[] = {Tessellation::regular, Tessellation::irregular,
                                  Tessellation::valenceVarying};

std::vector<float> principal(const Mesh& mesh, PelCurvatureEstimator estimator = PEL_CURVATURE_QUADRIC) {
    return valuesOf(mesh, paramsOf(estimator, 0, PEL_QUANTITY_PRINCIPAL), 2);
}

// RMS error of both principal curvatures over the RMS of the largest true one, without the border.
double errorOf(const AnalyticMesh& mesh, PelCurvatureEstimator estimator = PEL_CURVATURE_QUADRIC) {
    const std::vector<float> values = principal(pairOf(mesh.mesh).mesh, estimator);
    const std::vector<bool> skip = nearBorder(mesh.mesh, 2);
    double error = 0, total = 0;
    for (size_t v = 0; v < mesh.truth.size(); ++v) {
        if (skip[v]) continue;
        const auto& c = mesh.truth[v].curvature;
        error += std::pow(values[2 * v] - c.first, 2) + std::pow(values[2 * v + 1] - c.second, 2);
        total += c.first * c.first + c.second * c.second;
    }
    return std::sqrt(error / total);
}

AnalyticMesh torusOf(int n) {
    return tessellate(reference::torusSurface(3, 1), 2 * n, n, Tessellation::irregular);
}

}  // namespace

TEST(CurvatureAccuracy, IrregularTorus) {
    AnalyticMesh torus = torusOf(100);
    EXPECT_LE(errorOf(torus), tolerance::torusQuadric);
    torus.mesh.normals = reference::estimatedNormals(torus.mesh);
    EXPECT_LE(errorOf(torus), tolerance::torusQuadric);
    EXPECT_LE(errorOf(torusOf(140), PEL_CURVATURE_TENSOR), tolerance::torusExactNormals);
}

TEST(CurvatureAccuracy, EverySurface) {
    const std::pair<const char*, reference::Surface> surfaces[] = {
        {"sphere", reference::sphereSurface(5)},
        {"cylinder", reference::cylinderSurface(2, 6)},
        {"cone", reference::coneSurface(0.5, 2, 4)},
        {"saddle", reference::monkeySaddle(2)},
        {"ellipsoid", reference::ellipsoidSurface(1, 1.5, 2)},
    };
    const Mesh plane = sampled(reference::planeSurface(4), 30, 30);
    for (auto estimator : estimators) {
        for (const auto& [name, surface] : surfaces)
            for (auto kind : kinds)
                EXPECT_LE(errorOf(tessellate(surface, 120, 80, kind), estimator), tolerance::surfaceCurvature)
                    << name << " " << int(kind) << " " << int(estimator);
        for (float value : principal(plane, estimator)) EXPECT_NEAR(value, 0, tolerance::planeCurvature);
    }
}

// At a pole the coordinates of the fit are isotropic, and the wide circle round it is not part of its
// neighbourhood. Cells up to 16 times longer than wide: their fourth-order terms must not count as curvature
// across.
TEST(CurvatureAccuracy, SliversAndLongCellsOfASphere) {
    for (auto [rings, columns, radius, bound] : {std::tuple(200, 400, 1.0, tolerance::sliverSphere),
                                                 {200, 400, 1e-6, tolerance::sliverSphere},
                                                 {200, 400, 1e6, tolerance::sliverSphere},
                                                 {400, 50, 1.0, tolerance::longCells}}) {
        double worst = 0;
        for (float value : principal(latLongSphere(uint32_t(rings), uint32_t(columns), radius)))
            worst = std::max(worst, std::abs(value * radius - 1));
        EXPECT_LE(worst, bound) << "radius " << radius;
    }
}

TEST(CurvatureAccuracy, DirectionsOfACylinder) {
    const AnalyticMesh cylinder =
        tessellate(reference::cylinderSurface(2, 6), 60, 30, Tessellation::irregular);
    const Mesh mesh = pairOf(cylinder.mesh).mesh;
    const std::vector<bool> skip = nearBorder(cylinder.mesh, 2);
    for (auto estimator : estimators) {
        const auto frames = valuesOf(mesh, paramsOf(estimator, 1, PEL_QUANTITY_FRAME), 8);
        for (size_t v = 0; v < mesh.vertices(); ++v) {
            if (skip[v]) continue;
            const float *f = &frames[8 * v], *n = &mesh.normals[3 * v];
            EXPECT_NEAR(std::hypot(f[2], f[3], f[4]), 1, tolerance::direction);
            EXPECT_NEAR(f[2] * f[5] + f[3] * f[6] + f[4] * f[7], 0, tolerance::direction);
            // The second direction is the axis, the first goes round.
            EXPECT_GT(std::abs(f[7]), 1 - tolerance::directionIrregular) << v;
            EXPECT_LT(std::abs(f[2] * n[0] + f[3] * n[1] + f[4] * n[2]), tolerance::directionIrregular) << v;
        }
    }
}
