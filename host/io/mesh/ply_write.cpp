#include <bit>
#include <stdexcept>

#include "io/atomic_file.h"
#include "io/image/color_map.h"
#include "io/mesh/mesh_file.h"

namespace pellucid::io {

static_assert(std::endian::native == std::endian::little, "the PLY below is written as the memory lies");

void writePly(const std::string& path, const MeshData& mesh, std::span<const float> quality, float low,
              float high) {
    if (quality.size() != mesh.vertexCount()) {
        throw std::invalid_argument("writePly: " + std::to_string(quality.size()) + " values for " +
                                    std::to_string(mesh.vertexCount()) + " vertices; one each is needed");
    }
    const bool normals = !mesh.normals.empty();
    std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                      std::to_string(mesh.vertexCount()) +
                      "\nproperty float x\nproperty float y\nproperty float z\n";
    if (normals) out += "property float nx\nproperty float ny\nproperty float nz\n";
    out +=
        "property float quality\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement "
        "face " +
        std::to_string(mesh.triangleCount()) + "\nproperty list uchar int vertex_indices\nend_header\n";
    const auto append = [&out](const void* bytes, size_t count) {
        out.append(static_cast<const char*>(bytes), count);
    };
    for (size_t v = 0; v < mesh.vertexCount(); ++v) {
        append(&mesh.positions[3 * v], 12);
        if (normals) append(&mesh.normals[3 * v], 12);
        append(&quality[v], 4);
        const Srgb8 color = scaleColor(quality[v], low, high);
        append(color.data(), 3);
    }
    for (size_t t = 0; t < mesh.triangles.size(); t += 3) {
        out += '\3';
        append(&mesh.triangles[t], 12);
    }
    writeWholeFile(path, out);
}

}  // namespace pellucid::io
