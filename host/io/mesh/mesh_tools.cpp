#include <Imath/ImathBox.h>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/LoopT.hh>
#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "io/atomic_file.h"
#include "io/file_error.h"
#include "io/image/color_map.h"
#include "io/mesh/mesh_file.h"
#include "io/mesh/quiet_open_mesh.h"

namespace pellucid::io {
namespace {

using OpenMesh::Vec3d;

// For each vertex, the first vertex with exactly its position.
std::vector<uint32_t> firstAtPosition(const std::vector<float>& positions) {
    const size_t count = positions.size() / 3;
    std::vector<uint32_t> order(count), first(count);
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](uint32_t v) {
        return std::array<float, 3>{positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]};
    };
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        const auto ka = key(a), kb = key(b);
        return ka != kb ? ka < kb : a < b;
    });
    for (size_t i = 0; i < count; ++i)
        first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
    return first;
}

}  // namespace

void computeNormals(MeshData& mesh) {
    const std::vector<uint32_t> first = firstAtPosition(mesh.positions);
    std::vector<Vec3d> sums(mesh.vertexCount(), Vec3d(0));
    for (size_t t = 0; t < mesh.triangles.size(); t += 3) {
        const uint32_t* corner = &mesh.triangles[t];
        const auto at = [&](int i) {
            const float* p = &mesh.positions[3 * corner[i % 3]];
            return Vec3d(p[0], p[1], p[2]);
        };
        const Vec3d normal = (at(1) - at(0)) % (at(2) - at(0));  // % is the cross product, | the inner one
        const double size = normal.norm();
        if (!(size > 0)) continue;
        for (int c = 0; c < 3; ++c) {
            const Vec3d a = at(c + 1) - at(c), b = at(c + 2) - at(c);
            sums[first[corner[c]]] += normal / size * std::atan2((a % b).norm(), a | b);
        }
    }
    mesh.normals.resize(mesh.positions.size());
    for (size_t v = 0; v < sums.size(); ++v) {
        const Vec3d& sum = sums[first[v]];
        const double size = sum.norm();
        const bool usable = size > 1e-12;  // else unreferenced, or two faces back to back
        for (size_t k = 0; k < 3; ++k)
            mesh.normals[3 * v + k] = usable ? float(sum[k] / size) : (k == 2 ? 1.0f : 0.0f);
    }
}

void loopSubdivide(MeshData& mesh, int levels) {
    if (levels <= 0) return;
    using Mesh = OpenMesh::TriMesh_ArrayKernelT<>;
    Mesh topology;
    for (size_t v = 0; v < mesh.vertexCount(); ++v) {
        topology.add_vertex({mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]});
    }
    const QuietOpenMesh quiet;
    for (size_t t = 0; t < mesh.triangleCount(); ++t) {
        const uint32_t* corner = &mesh.triangles[3 * t];
        const bool repeated = corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0];
        OpenMesh::FaceHandle face;
        if (!repeated)
            face = topology.add_face(OpenMesh::VertexHandle(int(corner[0])),
                                     OpenMesh::VertexHandle(int(corner[1])),
                                     OpenMesh::VertexHandle(int(corner[2])));
        if (face.is_valid()) continue;
        throw FileError(
            mesh.source,
            concat("cannot be subdivided: triangle ", t, " (counted from 0) ",
                   (repeated ? "has a vertex twice"
                             : "makes an edge of more than two triangles, or of two that face opposite ways"),
                   "; mend the mesh, or do without subdivision"));
    }

    for (int level = 0; level < levels; ++level) {
        if (!mesh.uvs.empty()) {
            // LoopT adds one vertex per edge, in the order of the edges.
            for (auto edge : topology.edges()) {
                const auto a = size_t(edge.v0().idx()), b = size_t(edge.v1().idx());
                for (size_t k = 0; k < 2; ++k)
                    mesh.uvs.push_back((mesh.uvs[2 * a + k] + mesh.uvs[2 * b + k]) / 2);
            }
        }
        size_t valence = 6;
        for (auto v : topology.vertices()) valence = std::max<size_t>(valence, v.valence());
        OpenMesh::Subdivider::Uniform::LoopT<Mesh> loop;
        loop.init_weights(valence + 1);  // its table covers 49 neighbours, and is not checked
        loop.attach(topology);
        loop(1);
        loop.detach();
    }

    mesh.positions.clear();
    for (auto v : topology.vertices()) {
        const Mesh::Point& p = topology.point(v);
        mesh.positions.insert(mesh.positions.end(), {p[0], p[1], p[2]});
    }
    mesh.triangles.clear();
    for (auto f : topology.faces()) {
        for (auto v : f.vertices()) mesh.triangles.push_back(uint32_t(v.idx()));
    }
    mesh.normals.clear();
    mesh.splitFrom.clear();
}

float scaleToHeight(MeshData& mesh, float height, int axis) {
    Imath::Box3f box;
    for (size_t i = 0; i < mesh.positions.size(); i += 3)
        box.extendBy({mesh.positions[i], mesh.positions[i + 1], mesh.positions[i + 2]});
    const float extent = box.size()[axis];
    if (!(extent > 0)) throw FileError(mesh.source, "is flat along the axis it should be scaled to");
    const float factor = height / extent;
    for (size_t i = 0; i < mesh.positions.size(); ++i)
        mesh.positions[i] = (mesh.positions[i] - box.center()[int(i % 3)]) * factor;
    return factor;
}

static_assert(std::endian::native == std::endian::little, "the PLY below is written as the memory lies");

void writePly(const std::string& path, const MeshData& mesh, std::span<const float> quality, float low,
              float high) {
    if (quality.size() != mesh.vertexCount())
        throw std::invalid_argument(concat("writePly: ", quality.size(), " values for ", mesh.vertexCount(),
                                           " vertices; one each is needed"));
    const bool normals = !mesh.normals.empty();
    std::string out = concat("ply\nformat binary_little_endian 1.0\nelement vertex ", mesh.vertexCount(),
                             "\nproperty float x\nproperty float y\nproperty float z\n");
    if (normals) out += "property float nx\nproperty float ny\nproperty float nz\n";
    out += concat(
        "property float quality\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement "
        "face ",
        mesh.triangleCount(), "\nproperty list uchar int vertex_indices\nend_header\n");
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
