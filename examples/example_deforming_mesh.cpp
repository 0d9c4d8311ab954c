// A deforming mesh: its connectivity is analysed once; each frame then only sends positions and normals and
// submits one asynchronous curvature, while the host prepares the next frame in the other set of buffers.
// Then a dent moves over the tube: each frame sends and measures only the rows of vertices that changed.
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

// A cylinder whose radius changes from frame to frame: xyz and normal per vertex for this radius.
std::vector<float> tube(float radius) {
    std::vector<float> v;
    for (uint32_t i = 0; i < count; ++i) {
        const float angle = 6.2831853f * float(i % columns) / columns, c = std::cos(angle),
                    s = std::sin(angle);
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
                               pellucid::vertexView(f.input, count, 12, 24),
                               pellucid::vertexView(f.output, count), nullptr, &queued);
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

    // One tube whose row `dented` is 2 % wider; the row before springs back.
    const pellucid::LiveMesh live(topology, params);
    std::vector<float> vertices = tube(20);
    const pellucid::Buffer input(device, vertices), output(device, count * sizeof(float));
    const PelVertexView positions = pellucid::vertexView(input, count, 0, 24),
                        normals = pellucid::vertexView(input, count, 12, 24);
    live.update(positions, &normals, pellucid::vertexView(output, count));
    const auto scaleRow = [&](uint32_t row, float by) {
        for (uint32_t i = row * columns; i < (row + 1) * columns; ++i)
            vertices[6 * i] *= by, vertices[6 * i + 1] *= by;
    };
    for (uint32_t dented = 30; dented < 40; ++dented) {
        scaleRow(dented, 1.02f);
        if (dented > 30) scaleRow(dented - 1, 1 / 1.02f);
        const std::vector<PelVertexRange> changed{{(dented - 1) * columns, 2 * columns}};
        const size_t offset = changed[0].first * 24;
        const PelSubmit queued{nullptr, 0, nullptr};
        input.write(reinterpret_cast<const char*>(vertices.data()) + offset, changed[0].count * 24, offset,
                    &queued);
        live.update(positions, &normals, pellucid::vertexView(output, count), changed, &queued);
        device.finish();
    }
    const PelLiveMeshStats stats = live.stats();
    std::printf("a moving dent: %llu of %u rows measured, %llu written\n",
                (unsigned long long)stats.rowsEstimated, count, (unsigned long long)stats.rowsStored);
    return worst > 0.01 || stats.rowsStored > count / 8;
} catch (const pellucid::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
}
