// Curvature of meshes whose vertices have any number of neighbours at any distance, and of slender cells.
#include "mesh_fixture.h"
#include "reference/scattered.h"
#include "reference_meshes.h"

using namespace fixture;

namespace scattered_meshes {

using namespace reference;

namespace {

struct Errors {
    double rms = 0, worst = 0;  // of mean curvature, in parts of the local curvedness
};

// Where a surface is flat, parts of a tenth of its RMS curvedness. Away from borders: the outermost triangles
// of scattered points are slivers along many edges of others.
Errors errorsOf(const AnalyticMesh& mesh, const FlatMesh* flat = nullptr) {
    const std::vector<float> values =
        valuesOf(pairOf(mesh.mesh).mesh, paramsOf(PEL_CURVATURE_QUADRIC, 0, PEL_QUANTITY_MEAN));
    std::vector<bool> border = nearBorder(mesh.mesh, 4);
    for (size_t v = 0; flat && v < border.size(); ++v) {
        const Vec2 p = flat->points[v];
        if (std::min({p.x, p.y, 1 - p.x, 1 - p.y}) < 0.03) border[v] = true;
    }
    double whole = 0, count = 0;
    const auto curvedness = [&](size_t v) {
        const auto& k = mesh.truth[v].curvature;
        return std::sqrt((k.first * k.first + k.second * k.second) / 2);
    };
    for (size_t v = 0; v < values.size(); ++v)
        if (!border[v]) whole += std::pow(curvedness(v), 2), ++count;
    EXPECT_GT(count, double(values.size()) / 2);
    Errors errors;
    for (size_t v = 0; v < values.size(); ++v) {
        if (border[v]) continue;
        const double part = std::abs(values[v] - mesh.truth[v].curvature.mean()) /
                            std::max(curvedness(v), 0.1 * std::sqrt(whole / count));
        errors.rms += part * part / count;
        errors.worst = std::max(errors.worst, part);
    }
    errors.rms = std::sqrt(errors.rms);
    return errors;
}

const std::pair<const char*, Surface> surfaces[] = {{"ellipsoid", ellipsoidCap(1, 1.5, 2)},
                                                    {"monkey saddle", monkeySaddle(1)}};

}  // namespace

TEST(CurvatureScattered, AnyNumberOfNeighboursAtAnyDistance) {
    const struct {
        const char* name;
        FlatMesh flat;
        bool alsoMade = true;  // by normals that are made, too
    } meshes[] = {
        {"Delaunay", delaunay(uniformPoints(20000, 1))},
        {"poked twice", poked(flatGrid(140, 140), 0.2, 2, 3)},
        // Each split triangle has a vertex of valence 3 inside.
        {"poked, coarse", poked(flatGrid(40, 40), 0.3, 1, 21)},
        // Normals averaged over slivers within slivers are off by 8 degrees: only exact ones.
        {"poked four times", poked(flatGrid(70, 70), 0.7, 4, 3), false},
        // Without the points of the three-ring the worst of these are 13 % off and more.
        {"random, poked three times", poked(delaunay(uniformPoints(2500, 23)), 0.5, 3, 23), false},
    };
    for (const auto& [name, flat, alsoMade] : meshes)
        for (const auto& [surface, shape] : surfaces)
            for (int made = 0; made <= int(alsoMade); ++made) {
                AnalyticMesh mesh = lifted(flat, shape);
                if (made) mesh.mesh.normals = estimatedNormals(mesh.mesh);
                const Errors errors = errorsOf(mesh, &flat);
                EXPECT_LE(errors.rms, tolerance::scatteredRms)
                    << name << ", " << surface << ", made " << made;
                EXPECT_LE(errors.worst, tolerance::scatteredWorst)
                    << name << ", " << surface << ", made " << made;
            }
}

TEST(CurvatureScattered, FitsOfLowerDegreeAreCounted) {
    const auto low = [](const fixture::Mesh& mesh, const PelMeshTopologyDesc& desc,
                        PelCurvatureEstimator estimator = PEL_CURVATURE_QUADRIC) {
        return curvature(mesh, desc, meanParams(estimator)).report.lowDegreeFits;
    };
    fixture::Mesh closed = torus(60, 40);
    EXPECT_EQ(low(closed, topologyDesc(closed)), 0u);
    // Eight triangles: no vertex has nine points. Measured twice, because each count must begin at 0.
    closed.positions = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    closed.normals = closed.positions;
    closed.indices = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    for (int again = 0; again < 2; ++again) EXPECT_EQ(low(closed, topologyDesc(closed)), 6u);
    for (auto other : {PEL_CURVATURE_EDGE, PEL_CURVATURE_TENSOR})
        EXPECT_EQ(low(closed, topologyDesc(closed), other), 0u);
    // The normals round each vertex cancel out. Turned, they leave a rounding error, which is no direction.
    fixture::Mesh turned = closed;
    for (size_t i = 0; i < turned.positions.size(); i += 3) {
        const float x = turned.positions[i], y = turned.positions[i + 1], z = turned.positions[i + 2];
        const float p[] = {0.6f * x - 0.8f * y, 0.48f * x + 0.36f * y - 0.8f * z,
                           0.64f * x + 0.48f * y + 0.6f * z};
        std::copy_n(p, 3, &turned.positions[i]);
    }
    turned.normals = turned.positions;
    const auto straight = valuesOf(closed, meanParams(PEL_CURVATURE_QUADRIC)),
               oblique = valuesOf(turned, meanParams(PEL_CURVATURE_QUADRIC));
    for (size_t v = 0; v < straight.size(); ++v) EXPECT_NEAR(oblique[v], straight[v], 0.1);
    const fixture::Mesh split = soupOf(closed);
    EXPECT_EQ(low(split, weldedDesc(split)), 6u) << "vertices that were split are one position";
    // The points of a strip lie on two curves, which leaves the bending across it undetermined.
    const auto lowOfGrid = [&](int rows) {
        const fixture::Mesh mesh = pairOf(lifted(flatGrid(24, rows), ellipsoidCap(1, 1.5, 2)).mesh).mesh;
        return low(mesh, topologyDesc(mesh));
    };
    EXPECT_EQ(lowOfGrid(1), 50u);
    EXPECT_LT(lowOfGrid(24), 50u);
}

TEST(CurvatureScattered, SlenderCellsOfATorus) {
    // A strip of a torus in cells 1 : 25 and 1 : 125, long round the tube. Positions are known to 2.4e-7
    // there, which counts over the square of the shorter edge.
    for (int columns : {4800, 24000}) {
        Surface strip = torusSurface(3, 1);
        strip.uEnd *= 60.0 / columns;
        strip.wrapsU = false;
        const Errors errors = errorsOf(tessellate(strip, 60, 64, Tessellation::regular));
        EXPECT_LE(errors.worst, tolerance::slenderTorus * std::pow(columns / 4800.0, 2)) << columns;
    }
}

TEST(CurvatureHub, AFanOfManyTrianglesIsQuickAndRight) {
    // A sphere whose poles have 30,000 neighbours each: an estimate, smoothing and updates that cost the
    // square of that would take minutes instead of a fraction of a second.
    const fixture::Mesh mesh = latLongSphere(4, 30000, 1);
    const uint32_t n = mesh.vertices();
    const auto begin = std::chrono::steady_clock::now();
    for (auto estimator : allEstimators) {
        PelCurvatureParams params = meanParams(estimator, 0.01f);
        params.smoothingPasses = 2;
        params.smoothingStages = 4;
        for (const auto& desc : {topologyDesc(mesh), weldedDesc(mesh, 1e-7f)})
            expectFinite(curvature(mesh, desc, params).values);
        const pellucid::LiveMesh live(pellucid::MeshTopology(device(), topologyDesc(mesh)), params);
        const pellucid::Buffer positions(device(), mesh.positions), out(device(), n * sizeof(float));
        live.update(vertexView(positions, n), nullptr, vertexView(out, n));
        live.update(vertexView(positions, n), nullptr, vertexView(out, n), std::vector{PelVertexRange{0, 1}});
        expectFinite(out.readAll<float>());
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    EXPECT_LT(seconds.count(), 60) << "kernels are compiled meanwhile, on machines that do other things";
}

TEST(CurvatureHub, TheRimOfAFanSeesItsNeighbours) {
    // A belt of a sphere below a pole of 60 neighbours, which only show what is near.
    const auto values = valuesOf(latLongSphere(40, 60, 1), meanParams(PEL_CURVATURE_QUADRIC));
    for (uint32_t v = 0; v < 61; ++v) EXPECT_NEAR(values[v], 1, tolerance::longCells) << v;
}

}  // namespace scattered_meshes
