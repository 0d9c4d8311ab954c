#include "sample/surface_light.h"

namespace pellucid::sample {

std::vector<float> scatteredAt(const Device& device, const LitMesh& lit, const std::vector<float>& points,
                               PelSurfaceIntegralDesc desc) {
    const auto count = uint32_t(points.size() / 3);
    if (count == 0) return {};
    const Buffer in(device, points), out(device, points.size() * sizeof(float));
    desc.numVertices = uint32_t(lit.positions.size() / 3);
    desc.positions = lit.positions.data();
    desc.indices = lit.triangles.data();
    desc.numIndices = lit.triangles.size();
    desc.irradiance = lit.irradiance.data();
    desc.points = vertexView(in, count);
    desc.result = vertexView(out, count);
    surfaceIntegral(device, desc);
    return out.readAll<float>();
}

}  // namespace pellucid::sample
