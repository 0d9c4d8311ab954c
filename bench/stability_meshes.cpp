#include "reference/curvature.h"
#include "reference/curvature_quadric.h"
#include "reference/surfaces.h"

#include "stability.h"
#include "tolerances.h"

namespace stability {
namespace {

// A torus stretched, scaled and moved away from the origin: float positions lose what the distance takes.
struct MovedMesh {
    reference::Mesh mesh;
    std::vector<float> positions, normals;
    MeshTopology topology;
    std::string where;

    explicit MovedMesh(const Point& p, reference::Tessellation kind = reference::Tessellation::irregular) {
        const double scale = logBetween(p[0], 1e-6, 1e6), away = p[1] < 0.1 ? 0 : logBetween(p[1], 1e-3, 1e3),
                     flat = logBetween(p[2], 0.02, 1);
        mesh =
            reference::tessellate(reference::torusSurface(3, 1), 24, 14, kind, uint32_t(1 + p[3] * 8)).mesh;
        for (auto& v : mesh.positions) v = {scale * (v.x + 4 * away), scale * v.y, scale * flat * v.z};
        for (auto& v : mesh.positions)
            for (int i = 0; i < 3; ++i) positions.push_back(float(v[i])), v[i] = positions.back();
        mesh.normals = reference::estimatedNormals(mesh);
        for (auto& n : mesh.normals)
            for (int i = 0; i < 3; ++i) normals.push_back(float(n[i])), n[i] = normals.back();
        std::vector<uint32_t> indices;
        for (const auto& t : mesh.triangles)
            indices.insert(indices.end(), {uint32_t(t[0]), uint32_t(t[1]), uint32_t(t[2])});
        PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
        desc.numVertices = uint32_t(mesh.positions.size());
        desc.indices = indices.data();
        desc.numIndices = indices.size();
        topology = MeshTopology(device(), desc);
        where = text("size %.2g, distance from the origin %.2g sizes, flattened to %.2g", 8 * scale, away / 2,
                     flat);
    }
    uint32_t count() const { return uint32_t(mesh.positions.size()); }
};

double relative(const std::vector<float>& values, const std::vector<double>& truth) {
    double difference = 0, largest = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
        const double e = std::abs(values[i] - truth[i]);
        keepWorst(difference, e);
        largest = std::max(largest, std::abs(truth[i]));
    }
    return difference / largest;
}

constexpr const char* meshRange =
    "size 1e-5 to 1e7 units, up to 500 sizes away from the origin, flattened down to 0.02";

Operation meshCurvature(const char* name, PelCurvatureEstimator estimator) {
    return {name, meshRange, "of the largest", 4, [=](const Point& p, std::string& where) {
                const MovedMesh m(p);
                where = m.where;
                PelCurvatureParams params = pelCurvatureParamsDefaults();
                params.estimator = estimator;
                params.smoothingPasses = 0;
                const Buffer positions(device(), m.positions), normals(device(), m.normals),
                    out(device(), m.count() * 4);
                m.topology.curvature(params, vertexView(positions, m.count()), vertexView(normals, m.count()),
                                     vertexView(out, m.count()));
                std::vector<double> truth;
                if (estimator == PEL_CURVATURE_EDGE)
                    truth = reference::edgeCurvature(m.mesh);
                else
                    for (const auto& k : reference::tensorCurvature(m.mesh))
                        truth.push_back(std::abs(k.mean()));
                return relative(out.readAll<float>(), truth);
            }};
}

Operation meshNormals() {
    return {"normals", meshRange, "absolute", 4, [](const Point& p, std::string& where) {
                const MovedMesh m(p);
                where = m.where;
                const Buffer positions(device(), m.positions), out(device(), m.count() * 12);
                m.topology.normals(vertexView(positions, m.count()), vertexView(out, m.count()));
                std::vector<double> truth;
                for (const auto& n : reference::estimatedNormals(m.mesh))
                    truth.insert(truth.end(), {n.x, n.y, n.z});
                return relative(out.readAll<float>(), truth);
            }};
}

// Where a yes-or-no decision of the fit is nearer than float can tell, or fewer points than terms are there, nothing is compared.
Operation quadricCurvature() {
    return {"curvature, quadric", std::string(meshRange) + "; regular triangles", "of the largest", 4,
            [](const Point& p, std::string& where) {
                const MovedMesh m(p, reference::Tessellation::regular);
                where = m.where;
                PelCurvatureParams params = pelCurvatureParamsDefaults();
                params.smoothingPasses = 0;
                const Buffer positions(device(), m.positions), normals(device(), m.normals), out(device(), m.count() * 4);
                m.topology.curvature(params, vertexView(positions, m.count()), vertexView(normals, m.count()),
                                     vertexView(out, m.count()));
                std::vector<float> values = out.readAll<float>();
                std::vector<double> truth;
                for (const auto& k : reference::quadricCurvature(m.mesh)) {
                    truth.push_back(std::abs(k.mean()));
                    if (k.margin < tolerance::quadricDecision || k.points < 9) values[truth.size() - 1] = float(truth.back());
                }
                return relative(values, truth);
            }};
}

Operation meshUvScale() {
    return {"UV scale", std::string(meshRange) + "; UVs of 1e-6 to 1e6 across", "relative", 5,
            [](const Point& p, std::string& where) {
                MovedMesh m(p);
                m.mesh.uvs.clear();
                const double across = logBetween(p[4], 1e-6, 1e6), size = logBetween(p[0], 1e-6, 1e6);
                std::vector<float> uvs;
                for (const auto& v : m.mesh.positions) {
                    const float uv[2] = {float(across * std::sin(v.x / size)),
                                         float(across * std::cos(v.y / size))};
                    uvs.insert(uvs.end(), uv, uv + 2);
                    m.mesh.uvs.push_back({uv[0], uv[1]});
                }
                where = m.where + text(", UVs %.2g across", across);
                const Buffer positions(device(), m.positions), coordinates(device(), uvs);
                const double truth = reference::uvScale(m.mesh);
                return std::abs(m.topology.uvScale(vertexView(positions, m.count()),
                                                   vertexView(coordinates, m.count())) -
                                truth) /
                       truth;
            }};
}

}  // namespace

std::vector<Operation> meshOperations() {
    return {
        meshCurvature("curvature, edge", PEL_CURVATURE_EDGE),
        meshCurvature("curvature, tensor", PEL_CURVATURE_TENSOR),
        quadricCurvature(),
        meshNormals(),
        meshUvScale()};
}

}  // namespace stability
