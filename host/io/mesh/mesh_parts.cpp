#include "io/mesh/mesh_parts.h"

#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/CatmullClarkT.hh>
#include <algorithm>
#include <map>

#include "io/file_error.h"
#include "io/input_file.h"
#include "io/mesh/mesh_text.h"
#include "io/mesh/quiet_open_mesh.h"
#include "io/text_scan.h"

namespace pellucid::io {
namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
};
using PolyMesh = OpenMesh::PolyMesh_ArrayKernelT<DoubleTraits>;

// The group of each face, in the order of the file.
std::vector<uint32_t> groupsOf(const std::string& path, const std::string& text, std::vector<std::string>& names) {
    std::map<std::string, uint32_t> known;
    std::vector<uint32_t> groups;
    std::string current;
    for (TextScan scan(path, text); scan.nextLine();) {
        if (scan.words()[0] == "g") current = scan.words().size() > 1 ? std::string(scan.words()[1]) : "";
        if (scan.words()[0] != "f") continue;
        const auto [entry, isNew] = known.try_emplace(current, uint32_t(names.size()));
        if (isNew) names.push_back(current);
        groups.push_back(entry->second);
    }
    return groups;
}

// The faces of one part with vertices of their own.
PolyMesh polygonsOf(const RawMesh& raw, const std::vector<uint32_t>& groups, uint32_t part,
                    const std::string& path) {
    PolyMesh mesh;
    std::map<int64_t, PolyMesh::VertexHandle> vertices;
    const QuietOpenMesh quiet;
    for (size_t f = 0; f < groups.size(); ++f) {
        if (groups[f] != part) continue;
        std::vector<PolyMesh::VertexHandle> corners;
        for (size_t c = raw.faceStart[f]; c < raw.faceStart[f + 1]; ++c) {
            const int64_t v = raw.corners[c];
            const auto [entry, isNew] = vertices.try_emplace(v);
            const float* p = &raw.positions[3 * size_t(v)];
            if (isNew) entry->second = mesh.add_vertex({p[0], p[1], p[2]});
            corners.push_back(entry->second);
        }
        if (!mesh.add_face(corners).is_valid())
            throw FileError(
                path,
                "cannot be subdivided: face " + std::to_string(f) +
                    " (counted from 0) has a vertex twice, makes an edge of more than two faces, or faces "
                    "the other way than its neighbour; mend the mesh, or do without subdivision");
    }
    return mesh;
}

// Each polygon as a fan from the corner that makes the shortest diagonal of a quad.
void appendTriangles(const PolyMesh& polygons, uint32_t part, PartedMesh& out) {
    MeshData& mesh = out.mesh;
    const auto base = uint32_t(mesh.vertexCount());
    for (auto v : polygons.vertices())
        for (int a = 0; a < 3; ++a) mesh.positions.push_back(float(polygons.point(v)[a]));
    for (auto f : polygons.faces()) {
        std::vector<PolyMesh::VertexHandle> corners;
        for (auto v : f.vertices()) corners.push_back(v);
        const auto span = [&](size_t a, size_t b) {
            return (polygons.point(corners[a]) - polygons.point(corners[b])).sqrnorm();
        };
        if (corners.size() == 4 && span(1, 3) < span(0, 2))
            std::rotate(corners.begin(), corners.begin() + 1, corners.end());
        for (size_t c = 1; c + 1 < corners.size(); ++c) {
            for (size_t k : {size_t(0), c, c + 1})
                mesh.triangles.push_back(base + uint32_t(corners[k].idx()));
            out.partOf.push_back(part);
        }
    }
}

}  // namespace

int PartedMesh::part(const std::string& name) const {
    const auto found = std::find(parts.begin(), parts.end(), name);
    return found == parts.end() ? -1 : int(found - parts.begin());
}

PartedMesh loadParts(const std::string& path, int levels) {
    requireExtension(path, {"obj"});
    return decodeParts(path, readWholeFile(path), levels);
}

PartedMesh decodeParts(const std::string& path, const std::string& text, int levels) {
    const RawMesh raw = readObj(path, text);
    PartedMesh out;
    out.mesh.source = path;
    const std::vector<uint32_t> groups = groupsOf(path, text, out.parts);
    if (raw.leftOut || groups.size() != raw.faces())
        throw FileError(
            path,
            "has faces with coinciding corners, so that its groups cannot be told apart; mend the mesh");
    if (groups.empty()) throw FileError(path, "has no face; a surface was expected");
    for (uint32_t part = 0; part < out.parts.size(); ++part) {
        PolyMesh polygons = polygonsOf(raw, groups, part, path);
        if (levels > 0) {
            OpenMesh::Subdivider::Uniform::CatmullClarkT<PolyMesh, double> subdivide;
            subdivide.attach(polygons);
            subdivide(size_t(levels));
            subdivide.detach();
        }
        appendTriangles(polygons, part, out);
    }
    computeNormals(out.mesh);
    return out;
}

}  // namespace pellucid::io
