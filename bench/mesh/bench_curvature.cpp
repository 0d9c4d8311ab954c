// Curvature of tori with 2:1 rings: the device against a plain loop, by order and number of vertices, and the
// analysis of a topology.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <random>

#include "baselines.h"
#include "benchmarks.h"
#include "mesh/mesh_calls.h"

using namespace pellucid;

namespace benchmarks {
namespace {

// shuffled: neighbours in space lie far apart in memory. irregular: each cell is cut along either diagonal,
// so that vertices have four to eight neighbours.
enum Order { ordered = 0, shuffled = 1, irregular = 2 };

fixture::Mesh makeMesh(uint32_t vertices, Order order) {
    const uint32_t sides = uint32_t(std::lround(std::sqrt(double(vertices) / 2)));
    fixture::Mesh mesh = fixture::torus(2 * sides, sides);
    std::mt19937 random(1);
    if (order == irregular)
        for (size_t cell = 0; cell < mesh.indices.size(); cell += 6) {
            uint32_t* i = &mesh.indices[cell];
            const uint32_t q = i[1], r = i[2], s = i[5];
            if (random() & 1) i[2] = s, i[3] = q, i[4] = r;
        }
    if (order != shuffled) return mesh;
    mesh = fixture::shuffleVertices(mesh, 1).mesh;
    for (size_t t = 0; t < mesh.indices.size() / 3; ++t) {
        const size_t other = t + random() % (mesh.indices.size() / 3 - t);
        std::swap_ranges(&mesh.indices[3 * t], &mesh.indices[3 * t] + 3, &mesh.indices[3 * other]);
    }
    return mesh;
}

struct Torus {
    fixture::Mesh mesh;
    MeshTopology topology;
    Buffer positions, normals, curvature;
    uint32_t vertices;

    Torus(uint32_t count, Order order)
        : mesh(makeMesh(count, order)),
          topology(device(), fixture::topologyDesc(mesh)),
          positions(device(), mesh.positions),
          normals(device(), mesh.normals),
          curvature(device(), mesh.vertices() * sizeof(float)),
          vertices(mesh.vertices()) {}
    PelVertexView view(const Buffer& buffer) const { return vertexView(buffer, vertices); }
    void run(const PelCurvatureParams& params) const {
        topology.curvature(params, view(positions), view(normals), view(curvature));
    }
};

const Torus& torus(uint32_t vertices, Order order = ordered) {
    static std::map<std::pair<uint32_t, Order>, std::unique_ptr<Torus>> made;
    auto& slot = made[{vertices, order}];
    if (!slot) slot = std::make_unique<Torus>(vertices, order);
    return *slot;
}

PelCurvatureParams estimated(PelCurvatureEstimator estimator, uint32_t passes) {
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.estimator = estimator;
    params.smoothingPasses = passes;
    return params;
}

// Adds a case of a torus: `work(torus)` is timed.
template <class Work>
void addCase(const std::string& name, uint32_t vertices, Order order, const std::string& more,
             const Work& work) {
    add(name + "/vertices:" + std::to_string(vertices) + "/order:" + std::to_string(order) + more,
        [=](benchmark::State& state) {
            const Torus& t = torus(vertices, order);
            time(state, [&] { work(t); });
        });
}

void addBaseline(uint32_t vertices, Order order, uint32_t passes) {
    add("edgeBaseline/vertices:" + std::to_string(vertices) + "/order:" + std::to_string(order) +
            "/passes:" + std::to_string(passes),
        [=](benchmark::State& state) {
            const Torus& t = torus(vertices, order);
            baseline::CurvatureScratch scratch;
            std::vector<float> result;
            for (auto _ : state)
                baseline::edgeCurvature(t.mesh.positions, t.mesh.normals, t.mesh.indices, passes, scratch,
                                        result);
            t.run(fixture::edgeParams(passes));
            const std::vector<float> ours = t.curvature.readAll<float>();
            double difference = 0;
            for (size_t v = 0; v < ours.size(); ++v)
                difference = std::max(difference, double(std::abs(ours[v] - result[v])));
            state.counters["difference"] = difference / *std::ranges::max_element(result);
        });
}

void addByOrder(uint32_t vertices, Order order) {
    for (const uint32_t passes : {0, 2}) {
        addCase("edgeDevice", vertices, order, "/passes:" + std::to_string(passes),
                [=](const Torus& t) { t.run(fixture::edgeParams(passes)); });
        addBaseline(vertices, order, passes);
    }
    for (const auto estimator : {PEL_CURVATURE_EDGE, PEL_CURVATURE_TENSOR, PEL_CURVATURE_QUADRIC})
        addCase("estimatorDevice", vertices, order, "/estimator:" + std::to_string(estimator),
                [=](const Torus& t) { t.run(estimated(estimator, 0)); });
    // To a radius of three edges, on top of the cheapest estimator.
    addCase("smoothedToRadius", vertices, order, "", [](const Torus& t) {
        PelCurvatureParams params = fixture::edgeParams(0);
        params.smoothingRadius = float(3 * std::sqrt(4 * M_PI * M_PI * 3 / double(t.vertices)));
        t.run(params);
    });
    addCase("madeNormals", vertices, order, "", [](const Torus& t) {
        const Buffer normals(device(), t.mesh.normals);
        t.topology.normals(t.view(t.positions), t.view(normals));
    });
    for (const auto weld : {PEL_WELD_NONE, PEL_WELD_EXACT})
        addCase("topologyAnalysis", vertices, order, "/weld:" + std::to_string(weld), [=](const Torus& t) {
            PelMeshTopologyDesc desc = fixture::topologyDesc(t.mesh);
            desc.weld = weld;
            MeshTopology(device(), desc);
        });
}

// The default estimator and two passes, as in a frame of a deforming head: of all vertices, and of a part
// that moved.
void addMoving() {
    constexpr uint32_t vertices = 100000;
    addCase("deformingFrame", vertices, ordered, "",
            [](const Torus& t) { t.run(estimated(pelCurvatureParamsDefaults().estimator, 2)); });
    for (const uint32_t part : {100u, 1000u, 10000u})
        add("livePart/vertices:100000/order:0/part:" + std::to_string(part), [=](benchmark::State& state) {
            const Torus& t = torus(vertices);
            const LiveMesh live(t.topology, estimated(pelCurvatureParamsDefaults().estimator, 2));
            const PelVertexView normals = t.view(t.normals);
            live.update(t.view(t.positions), &normals, t.view(t.curvature));
            const std::vector<PelVertexRange> moved{{vertices / 2, part}};
            time(state, [&] { live.update(t.view(t.positions), &normals, t.view(t.curvature), moved); });
        });
}

}  // namespace

void addMeshes() {
    for (const Order order : {ordered, shuffled, irregular}) addByOrder(1000000, order);
    addMoving();
    for (const uint32_t vertices : {1000u, 10000u, 100000u, 1000000u, 20000000u})
        for (const bool quadric : {false, true})
            add("vertices/vertices:" + std::to_string(vertices) + "/quadric:" + std::to_string(quadric),
                [=](benchmark::State& state) {
                    const Torus t(vertices, ordered);
                    const PelCurvatureParams params =
                        quadric ? estimated(PEL_CURVATURE_QUADRIC, 0) : estimated(PEL_CURVATURE_EDGE, 2);
                    time(state, [&] { t.run(params); });
                    countCopies(state, double(t.positions.bytes() + t.normals.bytes() + t.curvature.bytes()));
                });
}

}  // namespace benchmarks
