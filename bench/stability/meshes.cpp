// Curvature of meshes by each estimator and in each quantity, smoothing, normals, UV scale.
#include "reference/surfaces.h"

#include "stability.h"

namespace stability {
namespace {

constexpr const char* meshRange =
    "size 1e-5 to 1e7 units, up to 500 sizes away from the origin, flattened down to 0.02";

// A torus stretched, scaled and moved away from the origin, so that float positions lose digits.
struct MovedMesh {
    reference::Mesh mesh;
    std::vector<float> positions, normals, uvs;
    MeshTopology topology;
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    double scale;
    std::string place;

    MovedMesh(const Point& p, reference::Tessellation kind) {
        scale = logBetween(p[0], 1e-6, 1e6);
        const double away = p[1] < 0.1 ? 0 : logBetween(p[1], 1e-3, 1e3), flat = logBetween(p[2], 0.02, 1);
        mesh =
            reference::tessellate(reference::torusSurface(3, 1), 24, 14, kind, uint32_t(1 + p[3] * 8)).mesh;
        for (auto& v : mesh.positions) {
            v = {scale * (v.x + 4 * away), scale * v.y, scale * flat * v.z};
            for (int i = 0; i < 3; ++i) positions.push_back(float(v[i]));
        }
        accept();
        for (auto& n : reference::estimatedNormals(mesh))
            for (int i = 0; i < 3; ++i) normals.push_back(float(n[i]));
        accept();
        std::vector<uint32_t> indices;
        for (const auto& t : mesh.triangles)
            indices.insert(indices.end(), {uint32_t(t[0]), uint32_t(t[1]), uint32_t(t[2])});
        PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
        desc.numVertices = count();
        desc.indices = indices.data();
        desc.numIndices = indices.size();
        topology = MeshTopology(device(), desc);
        params.smoothingPasses = 0;
        place = text("size %.2g, distance from the origin %.2g sizes, flattened to %.2g", 8 * scale, away / 2,
                     flat);
    }
    uint32_t count() const { return uint32_t(mesh.positions.size()); }
    // The oracle gets the floats.
    void accept() {
        mesh.normals.resize(normals.size() / 3);
        mesh.uvs.resize(uvs.size() / 2);
        for (size_t i = 0; i < positions.size(); ++i) mesh.positions[i / 3][int(i % 3)] = positions[i];
        for (size_t i = 0; i < normals.size(); ++i) mesh.normals[i / 3][int(i % 3)] = normals[i];
        for (size_t i = 0; i < uvs.size(); i += 2) mesh.uvs[i / 2] = {uvs[i], uvs[i + 1]};
    }
    void move(Jitter& j) {
        j(positions), j(normals), j(uvs);
        if (params.smoothingRadius > 0) params.smoothingRadius = j(params.smoothingRadius);
        if (params.smoothingCrease > 0) params.smoothingCrease = j(params.smoothingCrease);
        accept();
    }
    std::vector<float> curvature(uint32_t floats = 1) const {
        const Buffer at(device(), positions), n(device(), normals), out(device(), count() * floats * 4);
        topology.curvature(params, vertexView(at, count()), vertexView(n, count()), vertexView(out, count()));
        return out.readAll<float>();
    }
};

using Prepare = std::function<void(MovedMesh&, const Point&)>;
using Measured = std::function<std::vector<float>(const MovedMesh&)>;
using Truth = std::function<std::vector<double>(const MovedMesh&)>;

// `prepare` sets what the operation needs beside the mesh.
Operation mesh(Header header, const Prepare& prepare, const Measured& measured, const Truth& truth,
               reference::Tessellation kind = reference::Tessellation::irregular) {
    header.range = meshRange + header.range;
    return {header, [=](const std::vector<Point>& points) {
                const auto m = std::make_shared<MovedMesh>(points[0], kind);
                prepare(*m, points[0]);
                return Case{[=](Jitter& j) { m->move(j); }, [=] { return measured(*m); },
                            [=] { return truth(*m); }, m->place};
            }};
}

Prepare estimated(PelCurvatureEstimator estimator, PelCurvatureQuantity quantity = PEL_QUANTITY_ABSOLUTE) {
    return [=](MovedMesh& m, const Point&) {
        m.params.estimator = estimator;
        m.params.quantity = quantity;
    };
}

std::vector<float> oneFloat(const MovedMesh& m) {
    return m.curvature();
}

// A quantity of the principal curvatures a >= b.
struct Quantity {
    const char* name;
    PelCurvatureQuantity quantity;
    std::vector<double> (*of)(double a, double b);
};
using Values = std::vector<double>;
const Quantity quantities[] = {
    {"absolute mean", PEL_QUANTITY_ABSOLUTE, [](double a, double b) { return Values{std::abs(a + b) / 2}; }},
    {"absolute largest", PEL_QUANTITY_ABSOLUTE_MAX,
     [](double a, double b) { return Values{std::max(std::abs(a), std::abs(b))}; }},
    {"curvedness", PEL_QUANTITY_CURVEDNESS,
     [](double a, double b) { return Values{std::sqrt((a * a + b * b) / 2)}; }},
    {"mean", PEL_QUANTITY_MEAN, [](double a, double b) { return Values{(a + b) / 2}; }},
    {"Gaussian", PEL_QUANTITY_GAUSSIAN, [](double a, double b) { return Values{a * b}; }},
    {"first", PEL_QUANTITY_FIRST, [](double a, double) { return Values{a}; }},
    {"second", PEL_QUANTITY_SECOND, [](double, double b) { return Values{b}; }},
    {"both principal", PEL_QUANTITY_PRINCIPAL, [](double a, double b) {
         return Values{a, b};
     }}};

Operation tensor(const Quantity& q) {
    return mesh(
        {std::string("curvature, tensor: ") + q.name, "", Unit::largest, tolerance::tensorCurvature, 4, 250},
        estimated(PEL_CURVATURE_TENSOR, q.quantity),
        [=](const MovedMesh& m) { return m.curvature(q.quantity == PEL_QUANTITY_PRINCIPAL ? 2 : 1); },
        [=](const MovedMesh& m) {
            Values t;
            for (const auto& k : reference::tensorCurvature(m.mesh))
                for (const double v : q.of(k.first, k.second)) t.push_back(v);
            return t;
        });
}

// Vertices whose fit comes too near a yes-or-no decision, or has fewer points than terms, are not compared.
std::vector<reference::QuadricCurvature> decided(const reference::Mesh& mesh) {
    auto all = reference::quadricCurvature(mesh);
    for (auto& k : all)
        if (k.margin < tolerance::quadricDecision || k.points < 9) k.first = k.second = NAN;
    return all;
}

// How far the first direction lies off the true one, times the difference of the curvatures over the larger:
// where they are alike, any direction is right.
double offDirection(const reference::QuadricCurvature& k, reference::Vec3 direction) {
    const double largest = std::max(std::abs(k.first), std::abs(k.second));
    return largest > 0
               ? reference::length(cross(k.firstDirection, direction)) * (k.first - k.second) / largest
               : 0;
}

Operation principalDirections() {
    return {{"principal directions, quadric", std::string(meshRange) + "; regular triangles", Unit::absolute,
             tolerance::quadricCurvature, 4, 300},
            [](const std::vector<Point>& points) {
                const auto m = std::make_shared<MovedMesh>(points[0], reference::Tessellation::regular);
                estimated(PEL_CURVATURE_QUADRIC, PEL_QUANTITY_FRAME)(*m, points[0]);
                const auto before = decided(m->mesh);
                const auto measured = [=] {
                    const auto values = m->curvature(8);
                    std::vector<float> off;
                    for (size_t i = 0; i < before.size(); ++i)
                        off.push_back(float(offDirection(
                            before[i], {values[8 * i + 2], values[8 * i + 3], values[8 * i + 4]})));
                    return off;
                };
                // Of the moved inputs against those before.
                const auto truth = [=] {
                    std::vector<double> off;
                    const auto now = decided(m->mesh);
                    for (size_t i = 0; i < now.size(); ++i)
                        off.push_back(std::isnan(now[i].first) || std::isnan(before[i].first)
                                          ? NAN
                                          : offDirection(before[i], now[i].firstDirection));
                    return off;
                };
                return Case{[=](Jitter& j) { m->move(j); }, measured, truth, m->place};
            }};
}

std::vector<float> normals(const MovedMesh& m) {
    const Buffer at(device(), m.positions), out(device(), m.count() * 12);
    m.topology.normals(vertexView(at, m.count()), vertexView(out, m.count()));
    return out.readAll<float>();
}
std::vector<double> trueNormals(const MovedMesh& m) {
    std::vector<double> t;
    for (const auto& n : reference::estimatedNormals(m.mesh)) t.insert(t.end(), {n.x, n.y, n.z});
    return t;
}

void addUvs(MovedMesh& m, const Point& p) {
    const double across = logBetween(p[4], 1e-6, 1e6);
    for (const auto& v : m.mesh.positions)
        m.uvs.insert(m.uvs.end(),
                     {float(across * std::sin(v.x / m.scale)), float(across * std::cos(v.y / m.scale))});
    m.accept();
    m.place += text(", UVs %.2g across", across);
}
std::vector<float> uvScale(const MovedMesh& m) {
    const Buffer at(device(), m.positions), uvs(device(), m.uvs);
    return {m.topology.uvScale(vertexView(at, m.count()), vertexView(uvs, m.count()))};
}

std::vector<double> smoothed(const MovedMesh& m) {
    // Whether a triangle has a plane depends on a threshold.
    for (const auto& t : m.mesh.triangles)
        for (int i = 0; i < 3; ++i) {
            const reference::Vec3 p = m.mesh.positions[size_t(t[i])],
                                  a = m.mesh.positions[size_t(t[(i + 1) % 3])] - p,
                                  b = m.mesh.positions[size_t(t[(i + 2) % 3])] - p;
            const double sine2 = dot(cross(a, b), cross(a, b)) / (dot(a, a) * dot(b, b));
            if (std::abs(sine2 / reference::flatTriangle - 1) < 0.1)
                return std::vector<double>(m.count(), NAN);
        }
    const PelCurvatureParams& p = m.params;
    const auto values = reference::smoothed(m.mesh, reference::edgeCurvature(m.mesh), int(p.smoothingPasses));
    if (p.smoothingRadius == 0) return values;
    auto smooth = reference::smoothedToRadius(m.mesh, values,
                                              {p.smoothingRadius, p.smoothingCrease, int(p.smoothingStages),
                                               p.smoothingWeights == PEL_SMOOTHING_AREA});
    for (double& v : smooth) v = std::abs(v);  // slivers carry values below 0
    return smooth;
}

// Values of the edge estimator, which is exact to 2e-7, so that the error comes from the smoothing.
Operation passes() {
    return mesh(
        {"smoothing passes", "; 1 to 32 passes", Unit::largest, tolerance::edgeCurvature, 5, 400},
        [](MovedMesh& m, const Point& p) {
            m.params.estimator = PEL_CURVATURE_EDGE;
            m.params.smoothingPasses = uint32_t(logBetween(p[4], 1, 32.99));
            m.place += text(", %.0f passes", m.params.smoothingPasses);
        },
        oneFloat, smoothed);
}

Operation toRadius(const std::string& by, PelSmoothingWeights weights, bool crease) {
    return mesh(
        {"smoothing to a radius, " + by,
         std::string("; radius 0.001 to 1 sizes, 4 to 64 stages") +
             (crease ? ", creases of 0.1 to 2 radians" : ""),
         Unit::largest, tolerance::radiusSmoothing, 7, 300},
        [=](MovedMesh& m, const Point& p) {
            const double sizes = logBetween(p[4], 1e-3, 1);
            m.params.estimator = PEL_CURVATURE_EDGE;
            m.params.smoothingWeights = weights;
            m.params.smoothingRadius = float(8 * m.scale * sizes);
            m.params.smoothingStages = 4 * uint32_t(logBetween(p[5], 1, 16.99));
            m.params.smoothingCrease = crease ? float(logBetween(p[6], 0.1, 2)) : 0;
            m.place += text(", radius %.2g sizes in %.0f stages", sizes, m.params.smoothingStages) +
                       (crease ? text(", creases of %.2g", m.params.smoothingCrease) : "");
        },
        oneFloat, smoothed);
}

}  // namespace

std::vector<Operation> meshOperations() {
    const auto edge = [](const MovedMesh& m) { return reference::edgeCurvature(m.mesh); };
    const auto quadric = [](const MovedMesh& m) {
        std::vector<double> t;
        for (const auto& k : decided(m.mesh)) t.push_back(std::abs(k.mean()));
        return t;
    };
    std::vector<Operation> all{
        mesh({"curvature, edge", "", Unit::largest, tolerance::edgeCurvature, 4},
             estimated(PEL_CURVATURE_EDGE), oneFloat, edge),
        mesh(
            {"curvature, quadric", "; regular triangles", Unit::largest, tolerance::quadricCurvature, 4, 300},
            estimated(PEL_CURVATURE_QUADRIC), oneFloat, quadric, reference::Tessellation::regular),
        principalDirections(),
        mesh(
            {"normals", "", Unit::absolute, tolerance::stretchedNormals, 4}, [](auto&...) {}, normals,
            trueNormals),
        mesh({"UV scale", "; UVs of 1e-6 to 1e6 across", Unit::largest, tolerance::uvScale, 5}, addUvs,
             uvScale, [](const MovedMesh& m) { return std::vector{reference::uvScale(m.mesh)}; })};
    for (const Quantity& q : quantities) all.push_back(tensor(q));
    for (Operation& o : all)
        if (o.header.name == "normals" || o.header.name.ends_with("Gaussian"))
            o.axis = Axis{2, 0.02, 1, "height over width"};
    all.insert(all.end(), {passes(), toRadius("cotangents", PEL_SMOOTHING_COTANGENT, false),
                           toRadius("areas", PEL_SMOOTHING_AREA, false),
                           toRadius("creases", PEL_SMOOTHING_COTANGENT, true)});
    return all;
}

}  // namespace stability
