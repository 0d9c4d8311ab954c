// Mesh data on a torus with moved vertices, whose curvature is known in closed form.
#include "measure.h"
#include "reference/surfaces.h"

namespace pellucid::bench {
namespace {

struct Torus {
    reference::AnalyticMesh truth;  // positions and normals as float32 holds them
    std::vector<uint32_t> indices;
    MeshTopology topology;
    Buffer positionBuffer, normalBuffer, uvBuffer, scalars, vectors;
    uint32_t vertices = 0;

    PelMeshTopologyDesc describe() const {
        PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
        desc.numVertices = vertices;
        desc.indices = indices.data();
        desc.numIndices = indices.size();
        return desc;
    }
    Torus(const Device& device, int columns)
        : truth(reference::tessellate(reference::torusSurface(30, 10), columns, columns / 2,
                                      reference::Tessellation::irregular)) {
        reference::Mesh& mesh = truth.mesh;
        vertices = uint32_t(mesh.positions.size());
        const auto rounded = [](std::vector<reference::Vec3>& vectors) {
            std::vector<float> floats;
            for (reference::Vec3& v : vectors)
                for (int i = 0; i < 3; ++i) {
                    floats.push_back(float(v[i]));
                    v[i] = double(floats.back());
                }
            return floats;
        };
        std::vector<float> uvs;
        for (reference::Vec2& t : mesh.uvs) {
            uvs.insert(uvs.end(), {float(t.x), float(t.y)});
            t = {double(float(t.x)), double(float(t.y))};
        }
        for (const reference::Triangle& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
        topology = MeshTopology(device, describe());
        positionBuffer = Buffer(device, rounded(mesh.positions));
        normalBuffer = Buffer(device, rounded(mesh.normals));
        uvBuffer = Buffer(device, uvs);
        scalars = Buffer(device, vertices * sizeof(float));
        vectors = Buffer(device, vertices * 3 * sizeof(float));
    }
    PelVertexView view(const Buffer& buffer) const { return vertexView(buffer, vertices); }
};

Error against(const Buffer& result, const std::vector<double>& truth) {
    const std::vector<float> values = result.readAll<float>();
    double largest = 0;
    ErrorSum sum;
    for (size_t i = 0; i < truth.size(); ++i) {
        sum.add(values[i] - truth[i]);
        largest = std::max(largest, std::abs(truth[i]));
    }
    return sum.result(largest);
}

}  // namespace

std::vector<Factory> meshCases(const Device& device, bool quick) {
    const auto made = std::make_shared<std::shared_ptr<Torus>>();
    const auto torus = [=] {
        if (!*made) *made = std::make_shared<Torus>(device, quick ? 200 : 800);
        return *made;
    };
    const auto begin = [](const Torus& t, const std::string& more) {
        return Case{std::to_string(t.vertices) + " vertices" + more, double(t.vertices), "vertices"};
    };
    // Positions, normals, two triangles per vertex, one result.
    constexpr double bytes = 12 + 12 + 24 + 4;
    constexpr const char* estimator = "the estimator in double precision";
    const auto curvature = [=](PelCurvatureEstimator by, uint32_t passes, double operations,
                               std::function<std::vector<double>(const Torus&)> truth, const char* of) {
        return [=] {
            const auto t = torus();
            Case c = begin(*t, passes ? ", " + std::to_string(passes) + " smoothing passes" : "");
            PelCurvatureParams params = pelCurvatureParamsDefaults();
            params.estimator = by;
            params.smoothingPasses = passes;
            c.bytes = (bytes + passes * (24.0 + 8)) * t->vertices;
            c.operations = (operations + passes * 13.0) * t->vertices;
            c.run = [=] {
                t->topology.curvature(params, t->view(t->positionBuffer), t->view(t->normalBuffer),
                                      t->view(t->scalars));
            };
            c.error = [=] { return against(t->scalars, truth(*t)); };
            c.truth = std::string(of) + "; relative to the largest";
            return c;
        };
    };
    const auto edge = [](const Torus& t) { return reference::edgeCurvature(t.truth.mesh); };
    const auto smooth = [](const Torus& t) {
        return reference::smoothed(t.truth.mesh, reference::edgeCurvature(t.truth.mesh), 2);
    };
    const auto tensor = [](const Torus& t) {
        std::vector<double> values;
        for (const auto& k : reference::tensorCurvature(t.truth.mesh)) values.push_back(std::abs(k.mean()));
        return values;
    };
    const auto surface = [](const Torus& t) {
        std::vector<double> values;
        for (const auto& p : t.truth.truth) values.push_back(std::abs(p.curvature.mean()));
        return values;
    };
    const auto normals = [=] {
        const auto t = torus();
        Case c = begin(*t, "");
        c.bytes = (12.0 + 24 + 12) * t->vertices;
        c.operations = 2.0 * 70 * t->vertices;  // per triangle: three angles and a cross product
        c.run = [=] { t->topology.normals(t->view(t->positionBuffer), t->view(t->vectors)); };
        c.error = [=] {
            const std::vector<reference::Vec3> truth = reference::estimatedNormals(t->truth.mesh);
            const std::vector<float> values = t->vectors.readAll<float>();
            ErrorSum sum;
            for (size_t i = 0; i < values.size(); ++i) sum.add(values[i] - truth[i / 3][int(i % 3)]);
            return sum.result();
        };
        c.truth = "double precision; absolute";
        return c;
    };
    const auto uvScale = [=] {
        const auto t = torus();
        const auto result = std::make_shared<float>();
        Case c = begin(*t, "");
        c.bytes = (12.0 + 8 + 24) * t->vertices;
        c.operations = 2.0 * 40 * t->vertices;
        c.run = [=] { *result = t->topology.uvScale(t->view(t->positionBuffer), t->view(t->uvBuffer)); };
        c.error = [=] {
            const double truth = reference::uvScale(t->truth.mesh), e = std::abs(*result - truth) / truth;
            return Error{e, e};
        };
        c.truth = "double precision; relative";
        return c;
    };
    const auto topology = [=] {
        const auto t = torus();
        Case c = begin(*t, ", on the host");
        c.run = [=] { MeshTopology(device, t->describe()); };
        return c;
    };
    return {{"topology", "mesh", topology},
            {"normals", "mesh", normals},
            {"uv-scale", "mesh", uvScale},
            {"curvature-edge", "mesh", curvature(PEL_CURVATURE_EDGE, 0, 3 * 18, edge, estimator)},
            {"curvature-edge-smoothed", "mesh", curvature(PEL_CURVATURE_EDGE, 2, 3 * 18, smooth, estimator)},
            {"curvature-tensor", "mesh", curvature(PEL_CURVATURE_TENSOR, 0, 2 * 180, tensor, estimator)},
            {"curvature-quadric", "mesh",
             curvature(PEL_CURVATURE_QUADRIC, 0, 18 * 65 + 150, surface,
                       "the torus itself, the mesh's coarseness included")}};
}

}  // namespace pellucid::bench
