// A deforming mesh: its connectivity is analysed once; each frame then only sends positions and normals and submits one
// asynchronous curvature, while the host prepares the next frame in the other set of buffers.
#include <cmath>
#include <cstdio>
#include <pellucid/pellucid.hpp>
#include <vector>

namespace {

constexpr uint32_t rows = 96, columns = 192, count = rows * columns;

std::vector<uint32_t> tubeTriangles() {
    std::vector<uint32_t> t;
    for (uint32_t y = 0; y + 1 < rows; ++y)
        for (uint32_t x = 0; x < columns; ++x) {
            const uint32_t a = y * columns + x, b = y * columns + (x + 1) % columns;
            t.insert(t.end(), {a, b, a + columns, b, b + columns, a + columns});
        }
    return t;
}

// A cylinder that breathes: its radius in this frame, xyz and normal per vertex.
std::vector<float> tube(float radius) {
    std::vector<float> v;
    for (uint32_t i = 0; i < count; ++i) {
        const float angle = 6.2831853f * float(i % columns) / columns, c = std::cos(angle), s = std::sin(angle);
        v.insert(v.end(), {radius * c, radius * s, float(i / columns), c, s, 0.0f});
    }
    return v;
}

struct Frame {
    std::vector<float> vertices;
    std::vector<float> curvature = std::vector<float>(count);
    pellucid::Buffer input, output;
    pellucid::Event done;
};

}  // namespace

int main() try {
    const pellucid::Device device("");
    const std::vector<uint32_t> triangles = tubeTriangles();
    PelMeshTopologyDesc mesh = pelMeshTopologyDescDefaults();
    mesh.numVertices = count;
    mesh.indices = triangles.data();
    mesh.numIndices = triangles.size();
    const pellucid::MeshTopology topology(device, mesh);
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.estimator = PEL_CURVATURE_TENSOR;
    params.quantity = PEL_QUANTITY_ABSOLUTE_MAX;  // a cylinder of radius r counts as 1/r

    Frame frames[2];
    for (Frame& f : frames) {
        f.input = pellucid::Buffer(device, count * 6 * sizeof(float));
        f.output = pellucid::Buffer(device, count * sizeof(float));
    }
    double worst = 0;
    const auto radiusOf = [](int i) { return 20 + 5 * std::sin(0.4f * float(i)); };
    for (int i = 0; i <= 12; ++i) {
        if (i < 12) {
            Frame& f = frames[i % 2];
            f.vertices = tube(radiusOf(i));
            const PelSubmit queued{nullptr, 0, nullptr};  // in order: no events needed between the three
            f.input.write(f.vertices.data(), f.vertices.size() * sizeof(float), 0, &queued);
            topology.curvature(params, pellucid::vertexView(f.input, count, 0, 24),
                               pellucid::vertexView(f.input, count, 12, 24), pellucid::vertexView(f.output, count), nullptr,
                               &queued);
            PelEvent done = nullptr;
            const PelSubmit last{nullptr, 0, &done};
            f.output.read(f.curvature.data(), count * sizeof(float), 0, &last);
            f.done = pellucid::Event(done);
        }
        if (i == 0) continue;
        Frame& previous = frames[(i - 1) % 2];
        previous.done.wait();
        const float middle = previous.curvature[count / 2 + columns / 2];
        worst = std::max(worst, std::abs(double(middle) * radiusOf(i - 1) - 1));
    }
    std::printf("12 frames of %u vertices, curvature within %.2g of 1/radius\n", count, worst);
    return worst > 0.01;
} catch (const pellucid::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
}
