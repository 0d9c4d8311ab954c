// The oracle's mesh curvature: hand-made meshes, surfaces of known curvature, scale, and FaceWorks' results
// on real meshes.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "npy.h"
#include "reference/curvature.h"
#include "reference/surfaces.h"
#include "tolerances.h"

using namespace reference;
namespace {

std::vector<std::pair<const char*, Surface>> allSurfaces() {
    return {{"plane", planeSurface(2)},          {"sphere", sphereSurface(2)},
            {"cylinder", cylinderSurface(2, 5)}, {"cone", coneSurface(0.4, 1, 3)},
            {"torus", torusSurface(3, 1)},       {"ellipsoid", ellipsoidSurface(3, 2, 1.5)},
            {"monkey saddle", monkeySaddle(1)}};
}

// Root mean square of both principal curvatures' error over inner vertices, relative to their own root mean
// square.
double relativeError(const AnalyticMesh& m, const std::vector<PrincipalCurvatures>& estimate) {
    std::vector<int> edges(m.truth.size(), 0), corners(m.truth.size(), 0);
    std::set<std::pair<int, int>> seen;
    for (const Triangle& t : m.mesh.triangles)
        for (int i = 0; i < 3; ++i) {
            ++corners[t[i]];
            if (seen.insert(std::minmax(t[i], t[(i + 1) % 3])).second) ++edges[t[i]], ++edges[t[(i + 1) % 3]];
        }
    double error = 0, size = 0;
    for (size_t v = 0; v < m.truth.size(); ++v) {
        if (edges[v] != corners[v]) continue;  // on the border
        const auto& truth = m.truth[v].curvature;
        error +=
            std::pow(estimate[v].first - truth.first, 2) + std::pow(estimate[v].second - truth.second, 2);
        size += truth.first * truth.first + truth.second * truth.second;
    }
    return std::sqrt(error / size);
}

TEST(ReferenceSurfaces, NormalsAndCurvaturesAgreeWithDifferencesOfPositions) {
    std::mt19937 random(3);
    for (const auto& [name, s] : allSurfaces())
        for (int i = 0; i < 20; ++i) {
            const double u = std::uniform_real_distribution<>(s.uBegin, s.uEnd)(random);
            const double v = std::uniform_real_distribution<>(s.vBegin, s.vEnd)(random), h = 1e-4;
            auto p = [&](double du, double dv) { return s.at(u + du, v + dv).position; };
            const Vec3 pu = (p(h, 0) - p(-h, 0)) / (2 * h), pv = (p(0, h) - p(0, -h)) / (2 * h);
            const Vec3 puu = (p(h, 0) - 2 * p(0, 0) + p(-h, 0)) / (h * h);
            const Vec3 pvv = (p(0, h) - 2 * p(0, 0) + p(0, -h)) / (h * h);
            const Vec3 puv = (p(h, h) - p(h, -h) - p(-h, h) + p(-h, -h)) / (4 * h * h);
            const SurfacePoint at = s.at(u, v);
            EXPECT_NEAR(length(at.normal), 1, tolerance::oracleExact) << name;
            EXPECT_NEAR(std::abs(dot(normalized(cross(pu, pv)), at.normal)), 1, tolerance::finiteDifference)
                << name;
            // First and second fundamental forms; minus, since positive means away from the normal.
            const double E = dot(pu, pu), F = dot(pu, pv), G = dot(pv, pv);
            const double L = -dot(puu, at.normal), M = -dot(puv, at.normal), N = -dot(pvv, at.normal);
            const double gaussian = (L * N - M * M) / (E * G - F * F);
            const double mean = (E * N - 2 * F * M + G * L) / (2 * (E * G - F * F));
            EXPECT_NEAR(at.curvature.gaussian(), gaussian, tolerance::finiteDifference) << name;
            EXPECT_NEAR(at.curvature.mean(), mean, tolerance::finiteDifference) << name;
            EXPECT_GE(at.curvature.first, at.curvature.second) << name;
        }
}

TEST(ReferenceCurvature, EdgeIsExactOnSpheresAndHalfOnCylinders) {
    const auto ball = icosphere(2, 2, 2, 3);
    for (double c : edgeCurvature(ball.mesh)) EXPECT_NEAR(c, 0.5, tolerance::oracleExact);
    // On a regular cylinder the straight edges have 0; the level ones |dn|/|dp| = 1/r.
    const auto tube = tessellate(cylinderSurface(2, 5), 40, 20, Tessellation::regular);
    for (double c : edgeCurvature(tube.mesh)) EXPECT_NEAR(c, 0.25, tolerance::oracleExact);
    const auto flat = tessellate(planeSurface(1), 8, 8, Tessellation::irregular);
    for (double c : edgeCurvature(flat.mesh)) EXPECT_EQ(c, 0);
}

TEST(ReferenceCurvature, SmoothingCountsInteriorEdgesTwice) {
    // Two triangles over the edge 1-2; vertex 4 is in none.
    Mesh mesh;
    mesh.positions.resize(5);
    mesh.triangles = {{0, 1, 2}, {2, 1, 3}};
    const auto once = smoothed(mesh, {1, 2, 4, 8, 16}, 1);
    EXPECT_DOUBLE_EQ(once[0], (2 + 4) / 2.0);
    EXPECT_DOUBLE_EQ(once[1], (1 + 4 + 4 + 8) / 4.0);
    EXPECT_DOUBLE_EQ(once[2], (1 + 2 + 2 + 8) / 4.0);
    EXPECT_DOUBLE_EQ(once[3], (2 + 4) / 2.0);
    EXPECT_EQ(once[4], 0);
    EXPECT_EQ(smoothed(mesh, {1, 2, 4, 8, 16}, 0), (std::vector<double>{1, 2, 4, 8, 16}));
    EXPECT_EQ(smoothed(mesh, once, 1), smoothed(mesh, {1, 2, 4, 8, 16}, 2));
    const auto ball = icosphere(1, 1, 1, 2);
    for (double c : smoothed(ball.mesh, std::vector<double>(ball.truth.size(), 3.0), 5))
        EXPECT_NEAR(c, 3, tolerance::oracleExact);
}

TEST(ReferenceCurvature, DegenerateEdgesAndLooseVerticesCountForNothing) {
    auto ball = icosphere(2, 2, 2, 1);
    auto& mesh = ball.mesh;
    const int loose = int(mesh.positions.size()), twin = loose + 1;
    mesh.positions.push_back({9, 9, 9});
    mesh.normals.push_back({0, 0, 1});
    mesh.positions.push_back(mesh.positions[0]);
    mesh.normals.push_back(-1.0 * mesh.normals[0]);
    mesh.triangles.push_back({0, 0, twin});  // only edges of no length
    const auto edge = edgeCurvature(mesh);
    const auto tensor = tensorCurvature(mesh);
    for (int v = 0; v < loose; ++v) {
        EXPECT_NEAR(edge[v], 0.5, tolerance::oracleExact);
        EXPECT_NEAR(tensor[v].second, 0.5, tolerance::oracleExact);
    }
    for (int v : {loose, twin}) {
        EXPECT_EQ(edge[v], 0);
        EXPECT_EQ(tensor[v].first, 0);
    }
}

TEST(ReferenceCurvature, VoronoiAreasArePointsNearestToACorner) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int shape = 0; shape < 6; ++shape) {
        Vec3 p[3];
        for (Vec3& corner : p) corner = {2 * uniform(random), 0.4 * uniform(random), uniform(random)};
        const auto areas = voronoiAreas(p[0], p[1], p[2]);
        const double area = 0.5 * length(cross(p[1] - p[0], p[2] - p[0]));
        EXPECT_NEAR(areas[0] + areas[1] + areas[2], area, tolerance::oracleExact);
        const int n = 400;  // centroids of n² equal cells of barycentric coordinates
        double nearest[3] = {};
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                double a = (i + 0.5) / n, b = (j + 0.5) / n;
                if (a + b > 1) a = 1 - a, b = 1 - b;
                const Vec3 x = (1 - a - b) * p[0] + a * p[1] + b * p[2];
                int best = 0;
                for (int k = 1; k < 3; ++k)
                    if (length(x - p[k]) < length(x - p[best])) best = k;
                nearest[best] += area / (double(n) * n);
            }
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(areas[k] / area, nearest[k] / area, tolerance::countedArea);
    }
}

TEST(ReferenceCurvature, TensorIsExactOnTheSphereAndConvergesElsewhere) {
    const auto ball = icosphere(2, 2, 2, 3);
    for (const auto& c : tensorCurvature(ball.mesh)) {
        EXPECT_NEAR(c.first, 0.5, tolerance::icosphereTensor);
        EXPECT_NEAR(c.second, 0.5, tolerance::icosphereTensor);
    }
    for (const auto& [name, surface] : allSurfaces()) {
        if (std::string(name) == "plane") continue;
        for (Tessellation kind :
             {Tessellation::regular, Tessellation::irregular, Tessellation::valenceVarying}) {
            const auto coarse = tessellate(surface, 24, 12, kind), fine = tessellate(surface, 96, 48, kind);
            const double before = relativeError(coarse, tensorCurvature(coarse.mesh));
            const double after = relativeError(fine, tensorCurvature(fine.mesh));
            EXPECT_LE(after, tolerance::tensorOnAnalytic) << name << ' ' << int(kind);
            EXPECT_LE(after, 0.5 * before + tolerance::oracleExact)
                << name << ' ' << int(kind);  // at least order 1/2
        }
    }
}

TEST(ReferenceCurvature, EdgeOnATorusIsFarFromItsMeanCurvatureHoweverFine) {
    // Why other estimators exist: the error does not shrink with the mesh.
    for (int n : {48, 192}) {
        const auto m = tessellate(torusSurface(3, 1), n, n / 3, Tessellation::regular);
        const auto edge = edgeCurvature(m.mesh);
        double error = 0, size = 0;
        for (size_t v = 0; v < edge.size(); ++v) {
            const double truth = std::abs(m.truth[v].curvature.mean());
            error += (edge[v] - truth) * (edge[v] - truth);
            size += truth * truth;
        }
        EXPECT_GT(std::sqrt(error / size), tolerance::edgeOnTorus);
    }
}

TEST(ReferenceCurvature, ScalesInverselyWithTheMesh) {
    for (double k : {1e-6, 1e-3, 10.0, 1e6}) {
        const auto m = tessellate(torusSurface(3, 1), 24, 12, Tessellation::irregular);
        Mesh scaled = m.mesh;
        for (Vec3& p : scaled.positions) p = k * p;
        const auto edge = edgeCurvature(m.mesh), edgeScaled = edgeCurvature(scaled);
        const auto tensor = tensorCurvature(m.mesh), tensorScaled = tensorCurvature(scaled);
        for (size_t v = 0; v < edge.size(); ++v) {
            EXPECT_NEAR(edgeScaled[v] * k, edge[v], tolerance::scaledMesh);
            EXPECT_NEAR(tensorScaled[v].second * k, tensor[v].second, tolerance::scaledMesh);
        }
        EXPECT_NEAR(uvScale(scaled) / uvScale(m.mesh), k, k * tolerance::scaledMesh);
    }
}

TEST(ReferenceCurvature, UvScaleIsLengthPerUv) {
    const auto flat = tessellate(planeSurface(5), 7, 7, Tessellation::regular);
    EXPECT_NEAR(uvScale(flat.mesh), 5, tolerance::oracleClosedForm);
    Mesh mesh = flat.mesh;  // degenerate triangles, in space or in UV, do not count
    mesh.triangles.push_back({0, 0, 0});
    mesh.positions.push_back({1, 2, 3});
    mesh.normals.push_back({0, 0, 1});
    mesh.uvs.push_back(mesh.uvs[0]);
    const int last = int(mesh.positions.size()) - 1;
    mesh.triangles.push_back({0, last, last});
    EXPECT_NEAR(uvScale(mesh), 5, tolerance::oracleClosedForm);
    mesh.uvs.clear();
    EXPECT_EQ(uvScale(mesh), 0);
}

TEST(ReferenceCurvature, NoiseMovesVerticesByTheWantedShareOfAnEdge) {
    auto m = tessellate(planeSurface(1), 60, 60, Tessellation::regular);
    const auto before = m.mesh.positions;
    addNoise(m.mesh, 0.02, 9);
    double square = 0;
    for (size_t v = 0; v < before.size(); ++v) {
        const Vec3 moved = m.mesh.positions[v] - before[v];
        square += dot(moved, moved) / 3;
        EXPECT_NEAR(length(m.mesh.normals[v]), 1, tolerance::oracleExact);
    }
    const double meanEdge = (2 + std::sqrt(2.0)) / 3 / 60;
    EXPECT_NEAR(std::sqrt(square / before.size()) / (0.02 * meanEdge), 1, tolerance::sampledDeviation);
}

void compareWithFaceWorks(const std::string& name) {
    REQUIRE_ORACLE_DIRECTORY(directory);
    auto path = [&](const char* what) { return directory / ("mesh_" + name + "_" + what + ".npy"); };
    const auto positions = npy::read<float>(path("pos_f32")), normals = npy::read<float>(path("nrm_f32"));
    const auto uvs = npy::read<float>(path("uv_f32"));
    const auto indices = npy::read<int32_t>(path("idx_i32"));
    Mesh mesh;
    for (size_t v = 0; v < positions.data.size() / 3; ++v) {
        const float *p = &positions.data[3 * v], *n = &normals.data[3 * v];
        mesh.positions.push_back({p[0], p[1], p[2]});
        mesh.normals.push_back({n[0], n[1], n[2]});
        mesh.uvs.push_back({uvs.data[2 * v], uvs.data[2 * v + 1]});
    }
    for (size_t i = 0; i < indices.data.size(); i += 3)
        mesh.triangles.push_back({indices.data[i], indices.data[i + 1], indices.data[i + 2]});
    for (const auto& [file, passes] : {std::pair{"fwcurv0_f32", 0}, {"fwcurv2_f32", 2}}) {
        const auto theirs = npy::read<float>(path(file));
        const auto ours = smoothed(mesh, edgeCurvature(mesh), passes);
        ASSERT_EQ(theirs.data.size(), ours.size());
        double largest = 0, worst = 0;
        for (size_t v = 0; v < ours.size(); ++v) {
            largest = std::max(largest, ours[v]);
            worst = std::max(worst, std::abs(ours[v] - theirs.data[v]));
        }
        EXPECT_LE(worst, tolerance::edgeCurvature * largest);
    }
    const double theirs = npy::read<float>(path("fwuvscale_f32")).data.at(0);
    EXPECT_NEAR(uvScale(mesh) / theirs, 1, tolerance::faceWorksUvScale);
}
TEST(ReferenceCurvature, HeadEqualsFaceWorks) {
    compareWithFaceWorks("head");
}
TEST(ReferenceCurvature, SphereEqualsFaceWorks) {
    compareWithFaceWorks("sphere1cm");
}

}  // namespace
