// Tensor and quadric: against the oracle, against surfaces whose curvature is known, and what must hold for
// any mesh.
#include <algorithm>
#include <map>

#include "mesh_fixture.h"
#include "reference_meshes.h"
#include "tolerances.h"

using namespace fixture;
using reference::AnalyticMesh;
using reference::Tessellation;

namespace {

constexpr PelCurvatureEstimator estimators[] = {PEL_CURVATURE_TENSOR, PEL_CURVATURE_QUADRIC};

PelCurvatureParams paramsOf(PelCurvatureEstimator estimator, PelCurvatureQuantity quantity,
                            uint32_t passes = 0) {
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.estimator = estimator;
    params.quantity = quantity;
    params.smoothingPasses = passes;
    return params;
}

std::vector<float> principal(const Mesh& mesh, PelCurvatureEstimator estimator, uint32_t passes = 0) {
    return curvature(mesh, topologyDesc(mesh), paramsOf(estimator, PEL_QUANTITY_PRINCIPAL, passes), 2).values;
}

std::vector<bool> onBorder(const Mesh& mesh, int rings) {
    std::map<std::pair<uint32_t, uint32_t>, int> count;
    for (size_t t = 0; t < mesh.indices.size(); t += 3)
        for (int c = 0; c < 3; ++c) ++count[std::minmax(mesh.indices[t + c], mesh.indices[t + (c + 1) % 3])];
    std::vector<bool> border(mesh.vertices());
    for (const auto& [edge, triangles] : count)
        if (triangles == 1) border[edge.first] = border[edge.second] = true;
    for (int r = 1; r < rings; ++r) {
        const std::vector<bool> before = border;
        for (const auto& [edge, triangles] : count)
            if (before[edge.first] || before[edge.second]) border[edge.first] = border[edge.second] = true;
    }
    return border;
}

// RMS error of both principal curvatures over the RMS of the largest true one, without the border.
double rmsError(const AnalyticMesh& truth, const Mesh& mesh, PelCurvatureEstimator estimator) {
    const std::vector<float> values = principal(mesh, estimator);
    const std::vector<bool> skip = onBorder(mesh, 2);
    double error = 0, total = 0;
    for (size_t v = 0; v < truth.truth.size(); ++v) {
        if (skip[v]) continue;
        const auto& c = truth.truth[v].curvature;
        error += std::pow(values[2 * v] - c.first, 2) + std::pow(values[2 * v + 1] - c.second, 2);
        total += c.first * c.first + c.second * c.second;
    }
    return std::sqrt(error / total);
}

double torusError(int n, Tessellation kind, bool exactNormals, PelCurvatureEstimator estimator) {
    AnalyticMesh torus = tessellate(reference::torusSurface(3, 1), 2 * n, n, kind);
    if (!exactNormals) torus.mesh.normals = reference::estimatedNormals(torus.mesh);
    return rmsError(torus, pairOf(torus.mesh).mesh, estimator);
}

}  // namespace

TEST(CurvatureTensor, EqualsTheOracle) {
    const std::pair<const char*, reference::Surface> surfaces[] = {
        {"sphere", reference::sphereSurface(5)},  {"cylinder", reference::cylinderSurface(2, 6)},
        {"torus", reference::torusSurface(3, 1)}, {"cone", reference::coneSurface(0.5, 1, 4)},
        {"saddle", reference::monkeySaddle(2)},   {"ellipsoid", reference::ellipsoidSurface(1, 2, 3)},
    };
    for (const auto& [name, surface] : surfaces)
        for (auto kind : {Tessellation::regular, Tessellation::irregular, Tessellation::valenceVarying})
            for (bool noisy : {false, true}) {
                reference::Mesh mesh = tessellate(surface, sized(24, 8), sized(17, 6), kind).mesh;
                if (noisy) addNoise(mesh, 0.02, 3);
                const Pair pair = pairOf(mesh);
                std::vector<double> expected;
                for (const auto& c : reference::tensorCurvature(pair.exact)) {
                    expected.push_back(c.first);
                    expected.push_back(c.second);
                }
                EXPECT_LE(relativeError(principal(pair.mesh, PEL_CURVATURE_TENSOR), expected),
                          tolerance::tensorCurvature)
                    << name << " " << int(kind) << " " << noisy;
            }
}

TEST(CurvatureAccuracy, IrregularTorus) {
    EXPECT_LE(torusError(100, Tessellation::irregular, true, PEL_CURVATURE_QUADRIC),
              tolerance::torusExactNormals);
    EXPECT_LE(torusError(100, Tessellation::irregular, false, PEL_CURVATURE_QUADRIC),
              tolerance::torusEstimatedNormals);
    for (bool exactNormals : {true, false})
        EXPECT_LE(torusError(100, Tessellation::irregular, exactNormals, PEL_CURVATURE_QUADRIC),
                  tolerance::torusQuadric);
    EXPECT_LE(torusError(140, Tessellation::irregular, true, PEL_CURVATURE_TENSOR),
              tolerance::torusExactNormals);
}

TEST(CurvatureAccuracy, ConvergesUnderRefinement) {
    for (auto kind : {Tessellation::regular, Tessellation::irregular, Tessellation::valenceVarying}) {
        const auto order = [&](PelCurvatureEstimator estimator) {
            return std::log2(torusError(40, kind, true, estimator) / torusError(80, kind, true, estimator));
        };
        EXPECT_GE(order(PEL_CURVATURE_QUADRIC), tolerance::orderQuadric) << int(kind);
        EXPECT_GE(order(PEL_CURVATURE_TENSOR),
                  kind == Tessellation::irregular ? tolerance::orderTensorIrregular : tolerance::orderTensor)
            << int(kind);
    }
}

TEST(CurvatureAccuracy, EverySurface) {
    const std::pair<const char*, reference::Surface> surfaces[] = {
        {"sphere", reference::sphereSurface(5)},
        {"cylinder", reference::cylinderSurface(2, 6)},
        {"cone", reference::coneSurface(0.5, 2, 4)},
        {"saddle", reference::monkeySaddle(2)},
        {"ellipsoid", reference::ellipsoidSurface(1, 1.5, 2)},
    };
    for (const auto& [name, surface] : surfaces)
        for (auto kind : {Tessellation::regular, Tessellation::irregular, Tessellation::valenceVarying})
            for (auto estimator : estimators) {
                const AnalyticMesh mesh = tessellate(surface, 120, 80, kind);
                EXPECT_LE(rmsError(mesh, pairOf(mesh.mesh).mesh, estimator), tolerance::surfaceCurvature)
                    << name << " " << int(kind) << " " << int(estimator);
            }
    const Pair plane = pairOf(tessellate(reference::planeSurface(4), 30, 30, Tessellation::irregular).mesh);
    for (auto estimator : estimators)
        for (float value : principal(plane.mesh, estimator)) EXPECT_NEAR(value, 0, tolerance::planeCurvature);
}

TEST(CurvatureAccuracy, SliversAtThePolesOfASphere) {
    // At a pole the coordinates of the fit are as wide as long, and the wide circle round it is not part of
    // its neighbourhood.
    for (double radius : {1.0, 1e-6, 1e6}) {
        const Mesh mesh = latLongSphere(200, 400, radius);
        const std::vector<float> k = principal(mesh, PEL_CURVATURE_QUADRIC);
        double worst = 0;
        for (float value : k) worst = std::max(worst, std::abs(value * radius - 1));
        EXPECT_LE(worst, tolerance::sliverSphere) << "radius " << radius;
    }
}

TEST(CurvatureAccuracy, LongCellsOfASphere) {
    // Cells up to 16 times longer than wide. What bends along them in fourth order must not count as
    // bending across.
    const std::vector<float> k = principal(latLongSphere(400, 50, 1), PEL_CURVATURE_QUADRIC);
    double worst = 0;
    for (float value : k) worst = std::max(worst, std::abs(value - 1.0));
    EXPECT_LE(worst, tolerance::longCells);
}

TEST(CurvatureAccuracy, TiltedNormalsOnlySayWhichWayIsUp) {
    const AnalyticMesh truth = tessellate(reference::torusSurface(3, 1), 160, 80, Tessellation::irregular);
    Mesh mesh = pairOf(truth.mesh).mesh;
    for (size_t v = 0; v < mesh.vertices(); ++v) {
        // About an axis that differs from vertex to vertex.
        float* n = &mesh.normals[3 * v];
        const reference::Vec3 normal{n[0], n[1], n[2]};
        const reference::Vec3 sideways = normalized(
            cross(normal, reference::Vec3{std::sin(0.7 * double(v)), std::cos(0.7 * double(v)), 0.3}));
        const reference::Vec3 tilted = std::cos(0.17) * normal + std::sin(0.17) * sideways;
        for (int c = 0; c < 3; ++c) n[c] = float(tilted[c]);
    }
    EXPECT_LE(rmsError(truth, mesh, PEL_CURVATURE_QUADRIC), tolerance::tiltedNormals);
}

TEST(CurvatureAccuracy, NormalsOfAMeshWithFoldedTriangles) {
    // The jitter folds some triangles; normals made from them are off by tens of degrees, however fine the
    // mesh.
    const std::pair<const char*, reference::Surface> surfaces[] = {
        {"cone", reference::coneSurface(0.5236, 1, 4)},
        {"ellipsoid", reference::ellipsoidSurface(3, 2, 1.5)}};
    for (const auto& [name, surface] : surfaces) {
        AnalyticMesh mesh = tessellate(surface, 120, 80, Tessellation::irregular);
        mesh.mesh.normals = reference::estimatedNormals(mesh.mesh);
        EXPECT_LE(rmsError(mesh, pairOf(mesh.mesh).mesh, PEL_CURVATURE_QUADRIC), tolerance::foldedNormals)
            << name;
    }
}

TEST(CurvatureAccuracy, ANormalInItsOwnPlaneIsReplaced) {
    // A normal as noise leaves it that folds a sliver over. The normals of its neighbours show what is right.
    const Mesh mesh =
        pairOf(tessellate(reference::torusSurface(3, 1), 100, 60, Tessellation::irregular).mesh).mesh;
    Mesh broken = mesh;
    std::vector<size_t> faulty;
    for (size_t v = 37; v < mesh.vertices(); v += 407) {
        const size_t next = v + 1;  // the step to it lies about in the plane
        double length = 0;
        float step[3];
        for (int c = 0; c < 3; ++c) {
            step[c] = mesh.positions[3 * next + c] - mesh.positions[3 * v + c];
            length += step[c] * step[c];
        }
        for (int c = 0; c < 3; ++c) broken.normals[3 * v + c] = float(step[c] / std::sqrt(length));
        faulty.push_back(v);
    }
    const std::vector<float> expected = principal(mesh, PEL_CURVATURE_QUADRIC),
                             values = principal(broken, PEL_CURVATURE_QUADRIC);
    for (size_t v : faulty)
        for (int i = 0; i < 2; ++i)
            EXPECT_NEAR(values[2 * v + i], expected[2 * v + i], tolerance::replacedNormal) << v;
}

namespace {

// Noise of 2 % of an edge, smoothed to three edges: RMS error of mean curvature over the RMS curvedness of
// the truth, away from the border and in its outermost two rows.
std::pair<double, double> noisyErrors(const reference::Surface& surface) {
    AnalyticMesh noisy = tessellate(surface, 140, 140, Tessellation::irregular);
    addNoise(noisy.mesh, 0.02, 11);
    const Mesh mesh = pairOf(noisy.mesh).mesh;
    double edge = 0;
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        double square = 0;
        for (int c = 0; c < 3; ++c)
            square += std::pow(
                mesh.positions[3 * mesh.indices[i] + c] - mesh.positions[3 * mesh.indices[i + 1] + c], 2);
        edge += std::sqrt(square) / (double(mesh.indices.size()) / 3);
    }
    PelCurvatureParams params = paramsOf(PEL_CURVATURE_QUADRIC, PEL_QUANTITY_MEAN);
    params.smoothingRadius = float(3 * edge);
    const std::vector<float> values = curvature(mesh, topologyDesc(mesh), params).values;
    const std::vector<bool> border = onBorder(mesh, 2);
    double error[2] = {0, 0}, total[2] = {0, 0};
    for (size_t v = 0; v < values.size(); ++v) {
        const auto& k = noisy.truth[v].curvature;
        error[border[v]] += std::pow(values[v] - k.mean(), 2);
        total[border[v]] += (k.first * k.first + k.second * k.second) / 2;
    }
    return {std::sqrt(error[0] / total[0]), std::sqrt(error[1] / total[1])};
}

}  // namespace

TEST(CurvatureAccuracy, NoisySphereAndItsBorder) {
    const auto [inside, border] = noisyErrors(reference::sphereSurface(1));
    EXPECT_LE(inside, tolerance::noisySphere);
    EXPECT_LE(border, tolerance::noisyBorder);
}

TEST(CurvatureAccuracy, EverySurfaceUnderNoise) {
    const std::pair<const char*, reference::Surface> surfaces[] = {
        {"cylinder", reference::cylinderSurface(1, 6)}, {"cone", reference::coneSurface(0.5236, 1, 4)},
        {"torus", reference::torusSurface(3, 1)},       {"ellipsoid", reference::ellipsoidSurface(3, 2, 1.5)},
        {"saddle", reference::monkeySaddle(1)},
    };
    for (const auto& [name, surface] : surfaces)
        EXPECT_LE(noisyErrors(surface).first, tolerance::noisySurface) << name;
}

TEST(CurvatureAccuracy, DoesNotDependOnTheUnitOfLength) {
    // Powers of two, so that positions round alike: every bit but the exponent must stay.
    const AnalyticMesh sphere =
        tessellate(reference::sphereSurface(1), sized(48, 9), sized(32, 7), Tessellation::irregular);
    const Mesh base = pairOf(sphere.mesh).mesh;
    for (auto estimator : {PEL_CURVATURE_EDGE, PEL_CURVATURE_TENSOR, PEL_CURVATURE_QUADRIC}) {
        const auto params = paramsOf(estimator, PEL_QUANTITY_ABSOLUTE, 2);
        const std::vector<float> expected = curvature(base, topologyDesc(base), params).values;
        for (float radius : {0x1p-20f, 0x1p-7f, 0x1p7f, 0x1p20f}) {
            Mesh mesh = base;
            for (float& x : mesh.positions) x *= radius;
            std::vector<float> values = curvature(mesh, topologyDesc(mesh), params).values;
            for (float& c : values) c *= radius;
            EXPECT_EQ(values, expected) << "radius " << radius << ", estimator " << estimator;
        }
    }
}

TEST(CurvatureAccuracy, FarFromTheOriginOnlyTheRoundingOfPositionsShows) {
    // Positions that float holds exactly both near and far: moving them must change nothing at all.
    Mesh mesh =
        pairOf(tessellate(reference::torusSurface(3, 1), sized(48, 9), sized(24, 7), Tessellation::irregular)
                   .mesh)
            .mesh;
    for (float& x : mesh.positions) x = std::round(x * 4096) / 4096;
    Mesh far = mesh;
    for (size_t i = 0; i < far.positions.size(); i += 3) {
        far.positions[i] += 1024;
        far.positions[i + 1] -= 2048;
    }
    for (auto estimator : {PEL_CURVATURE_EDGE, PEL_CURVATURE_TENSOR, PEL_CURVATURE_QUADRIC}) {
        const auto params = paramsOf(estimator, PEL_QUANTITY_ABSOLUTE);
        EXPECT_EQ(curvature(far, topologyDesc(far), params).values,
                  curvature(mesh, topologyDesc(mesh), params).values)
            << estimator;
    }
}

TEST(CurvatureQuantities, AreWhatTheyAreOfThePrincipalOnes) {
    const Mesh mesh =
        pairOf(tessellate(reference::torusSurface(3, 1), sized(40, 9), sized(30, 7), Tessellation::irregular)
                   .mesh)
            .mesh;
    for (auto estimator : estimators)
        for (uint32_t passes : {0u, 2u}) {
            const std::vector<float> k = principal(mesh, estimator, passes);
            const auto expectQuantity = [&](PelCurvatureQuantity quantity, auto&& of) {
                const auto values =
                    curvature(mesh, topologyDesc(mesh), paramsOf(estimator, quantity, passes)).values;
                std::vector<double> expected;
                for (size_t v = 0; v < values.size(); ++v)
                    expected.push_back(of(double(k[2 * v]), double(k[2 * v + 1])));
                EXPECT_LE(relativeError(values, expected), tolerance::quantity)
                    << quantity << " of " << estimator;
            };
            expectQuantity(PEL_QUANTITY_ABSOLUTE, [](double a, double b) { return std::abs(a + b) / 2; });
            expectQuantity(PEL_QUANTITY_ABSOLUTE_MAX,
                           [](double a, double b) { return std::max(std::abs(a), std::abs(b)); });
            expectQuantity(PEL_QUANTITY_CURVEDNESS,
                           [](double a, double b) { return std::sqrt((a * a + b * b) / 2); });
            expectQuantity(PEL_QUANTITY_MEAN, [](double a, double b) { return (a + b) / 2; });
            expectQuantity(PEL_QUANTITY_GAUSSIAN, [](double a, double b) { return a * b; });
            expectQuantity(PEL_QUANTITY_FIRST, [](double a, double) { return a; });
            expectQuantity(PEL_QUANTITY_SECOND, [](double, double b) { return b; });
            for (size_t v = 0; v < k.size(); v += 2) EXPECT_GE(k[v], k[v + 1]);
        }
}

TEST(CurvatureQuantities, ScaleMultipliesCurvatureAndGaussianTwice) {
    const Mesh mesh = torus(24, 16);
    for (auto [quantity, factor] :
         {std::pair(PEL_QUANTITY_MEAN, 4.0f), std::pair(PEL_QUANTITY_GAUSSIAN, 16.0f)}) {
        PelCurvatureParams params = paramsOf(PEL_CURVATURE_TENSOR, quantity);
        const auto one = curvature(mesh, topologyDesc(mesh), params).values;
        params.scale = 4;
        const auto four = curvature(mesh, topologyDesc(mesh), params).values;
        for (size_t v = 0; v < one.size(); ++v) EXPECT_EQ(four[v], factor * one[v]);
    }
}

TEST(CurvatureQuantities, DirectionsOfACylinder) {
    const AnalyticMesh cylinder =
        tessellate(reference::cylinderSurface(2, 6), 60, 30, Tessellation::irregular);
    const Mesh mesh = pairOf(cylinder.mesh).mesh;
    const std::vector<bool> skip = onBorder(mesh, 2);
    for (auto estimator : estimators) {
        const auto frames =
            curvature(mesh, topologyDesc(mesh), paramsOf(estimator, PEL_QUANTITY_FRAME, 1), 8).values;
        for (size_t v = 0; v < mesh.vertices(); ++v) {
            if (skip[v]) continue;
            const float* f = &frames[8 * v];
            const float* n = &mesh.normals[3 * v];
            const double first = std::hypot(std::hypot(f[2], f[3]), f[4]);
            EXPECT_NEAR(first, 1, tolerance::direction);
            EXPECT_NEAR(f[2] * f[5] + f[3] * f[6] + f[4] * f[7], 0, tolerance::direction);
            // The second direction is the axis, the first goes round. Whichever coordinate the axis is, the
            // normal has none of it.
            const double axis = std::abs(f[5 + 2]),
                         across = std::abs(f[2] * n[0] + f[3] * n[1] + f[4] * n[2]);
            EXPECT_GT(axis, 1 - tolerance::directionIrregular) << v;
            EXPECT_LT(across, tolerance::directionIrregular) << v;
        }
    }
}

TEST(CurvatureEstimators, ComeOutTheSameBitForBit) {
    const Mesh mesh =
        pairOf(tessellate(reference::torusSurface(3, 1), sized(60, 9), sized(40, 7), Tessellation::irregular)
                   .mesh)
            .mesh;
    for (auto estimator : estimators) {
        const std::vector<float> base = principal(mesh, estimator, 1);
        for (int run = 0; run < 3; ++run) EXPECT_EQ(principal(mesh, estimator, 1), base);
    }
}

TEST(CurvatureEstimators, BrokenDataStaysFiniteAndLocal) {
    const Mesh mesh = torus(sized(32, 14), sized(24, 12));
    const uint32_t faulty = sized(300u, 90u);
    for (auto estimator : estimators) {
        const std::vector<float> sound = principal(mesh, estimator, 1);
        for (int fault = 0; fault < 5; ++fault) {
            Mesh broken = mesh;
            float* p = &broken.positions[3 * faulty];
            float* n = &broken.normals[3 * faulty];
            if (fault == 0) p[0] = NAN;
            if (fault == 1) n[1] = INFINITY;
            if (fault == 2) std::fill_n(n, 3, 0.0f);
            if (fault == 3) std::copy_n(p + 3, 3, p);
            if (fault == 4) p[2] = 3e38f;
            const std::vector<float> values = principal(broken, estimator, 1);
            expectFinite(values);
            size_t changed = 0;
            for (size_t v = 0; v < sound.size(); ++v) changed += values[v] != sound[v];
            EXPECT_LE(changed, 2 * 37u) << "a three-ring has 37 vertices";
            EXPECT_GT(changed, 0u);
        }
    }
    Mesh none = mesh;
    std::fill(none.normals.begin(), none.normals.end(), 0.0f);
    for (auto estimator : estimators)
        for (float value : principal(none, estimator, 2)) EXPECT_EQ(value, 0);
}

TEST(CurvatureEstimators, EdgeHasOneQuantityOnly) {
    const Mesh mesh = torus(4, 4);
    try {
        curvature(mesh, topologyDesc(mesh), paramsOf(PEL_CURVATURE_EDGE, PEL_QUANTITY_GAUSSIAN));
        FAIL();
    } catch (const pellucid::Error& e) {
        EXPECT_NE(std::string(e.what()).find("edge estimator"), std::string::npos);
    }
    EXPECT_THROW(curvature(mesh, topologyDesc(mesh), paramsOf(PEL_CURVATURE_TENSOR, PelCurvatureQuantity(9))),
                 pellucid::Error);
}
