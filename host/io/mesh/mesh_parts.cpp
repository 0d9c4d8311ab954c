#include "io/mesh/mesh_parts.h"

#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/CatmullClarkT.hh>
#include <algorithm>
#include <array>
#include <map>

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
std::vector<uint32_t> groupsOf(const std::string& path, const std::string& text, const RawMesh& raw,
                               std::vector<std::string>& names) {
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
    if (raw.leftOut || groups.size() != raw.faces())
        throw FileError(
            path,
            "has faces with coinciding corners, so that its groups cannot be told apart; mend the mesh");
    if (groups.empty()) throw FileError(path, "has no face; a surface was expected");
    return groups;
}

using Uv = std::array<double, 2>;
struct FaceCorner {
    int vertex;
    Uv uv;
};
using FaceCorners = std::vector<FaceCorner>;

// The faces of one part with vertices of their own; `faces`: their corners.
PolyMesh polygonsOf(const RawMesh& raw, const std::vector<uint32_t>& groups, uint32_t part,
                    const std::string& path, std::vector<FaceCorners>& faces) {
    PolyMesh mesh;
    std::map<int64_t, PolyMesh::VertexHandle> vertices;
    const QuietOpenMesh quiet;
    for (size_t f = 0; f < groups.size(); ++f) {
        if (groups[f] != part) continue;
        std::vector<PolyMesh::VertexHandle> corners;
        FaceCorners face;
        for (size_t c = raw.faceStart[f]; c < raw.faceStart[f + 1]; ++c) {
            const int64_t v = raw.corners[c];
            const auto [entry, isNew] = vertices.try_emplace(v);
            const float* p = &raw.positions[3 * size_t(v)];
            if (isNew) entry->second = mesh.add_vertex({p[0], p[1], p[2]});
            corners.push_back(entry->second);
            const bool mapped = !raw.cornerUvs.empty();
            face.push_back({entry->second.idx(),
                            {mapped ? raw.cornerUvs[2 * c] : 0.0, mapped ? raw.cornerUvs[2 * c + 1] : 0.0}});
        }
        faces.push_back(std::move(face));
        if (!mesh.add_face(corners).is_valid())
            throw FileError(
                path,
                concat("cannot be subdivided: face ", f,
                       " (counted from 0) has a vertex twice, makes an edge of more than two faces, or "
                       "faces the other way than its neighbour; mend the mesh, or do without subdivision"));
    }
    return mesh;
}

Uv middle(const Uv& a, const Uv& b) {
    return {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])};
}

// The corners after one level of subdivision. Each corner of a face becomes a quad with the face's centre;
// the vertex of that corner keeps its number, which is below `before`.
std::vector<FaceCorners> subdividedCorners(const PolyMesh& mesh, const std::vector<FaceCorners>& faces,
                                           int before) {
    std::map<std::vector<int>, const FaceCorners*> known;  // by their vertices in order of number
    for (const FaceCorners& face : faces) {
        std::vector<int> vertices;
        for (const FaceCorner& corner : face) vertices.push_back(corner.vertex);
        std::ranges::sort(vertices);
        known[vertices] = &face;
    }
    std::vector<std::array<int, 4>> quads;  // from the old corner on
    std::map<int, std::vector<int>> round;  // old corners round a middle
    for (auto f : mesh.faces()) {
        std::vector<int> quad;
        for (auto v : f.vertices()) quad.push_back(v.idx());
        std::rotate(quad.begin(), std::ranges::find_if(quad, [&](int v) { return v < before; }), quad.end());
        quads.push_back({quad[0], quad[1], quad[2], quad[3]});
        round[quad[2]].push_back(quad[0]);
    }
    for (auto& [centre, corners] : round) std::ranges::sort(corners);
    std::vector<FaceCorners> out;
    for (const auto& [corner, after, centre, ahead] : quads) {
        const FaceCorners& face = *known.at(round.at(centre));
        const size_t n = face.size(),
                     k = size_t(std::ranges::find(face, corner, &FaceCorner::vertex) - face.begin());
        Uv mean{0, 0};
        for (const FaceCorner& c : face)
            for (size_t i = 0; i < 2; ++i) mean[i] += c.uv[i] / double(n);
        const Uv& own = face[k].uv;
        out.push_back({{corner, own},
                       {after, middle(own, face[(k + 1) % n].uv)},
                       {centre, mean},
                       {ahead, middle(own, face[(k + n - 1) % n].uv)}});
    }
    return out;
}

// Each polygon as a fan from the corner that makes the shortest diagonal of a quad.
void appendTriangles(const PolyMesh& polygons, const std::vector<FaceCorners>& faces, bool mapped,
                     uint32_t part, PartedMesh& out) {
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
            for (size_t k : {size_t(0), c, c + 1}) {
                mesh.triangles.push_back(base + uint32_t(corners[k].idx()));
                if (!mapped) continue;
                const FaceCorners& face = faces[size_t(f.idx())];
                const Uv& uv = std::ranges::find(face, corners[k].idx(), &FaceCorner::vertex)->uv;
                out.cornerUvs.insert(out.cornerUvs.end(), {float(uv[0]), float(uv[1])});
            }
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

PartedMesh loadGroups(const std::string& path) {
    requireExtension(path, {"obj"});
    const std::string text = readWholeFile(path);
    const RawMesh raw = readObj(path, text);
    PartedMesh out;
    const std::vector<uint32_t> groups = groupsOf(path, text, raw, out.parts);
    out.mesh = decodeMesh(path, text);
    for (size_t f = 0; f < groups.size(); ++f)
        out.partOf.insert(out.partOf.end(), raw.faceStart[f + 1] - raw.faceStart[f] - 2, groups[f]);
    return out;
}

PartedMesh decodeParts(const std::string& path, const std::string& text, int levels) {
    const RawMesh raw = readObj(path, text);
    PartedMesh out;
    out.mesh.source = path;
    const std::vector<uint32_t> groups = groupsOf(path, text, raw, out.parts);
    const bool mapped = !raw.cornerUvs.empty();
    for (uint32_t part = 0; part < out.parts.size(); ++part) {
        std::vector<FaceCorners> faces;
        PolyMesh polygons = polygonsOf(raw, groups, part, path, faces);
        for (int level = 0; level < levels; ++level) {
            const int before = int(polygons.n_vertices());
            OpenMesh::Subdivider::Uniform::CatmullClarkT<PolyMesh, double> subdivide;
            subdivide.attach(polygons);
            subdivide(1);
            subdivide.detach();
            if (mapped) faces = subdividedCorners(polygons, faces, before);
        }
        appendTriangles(polygons, faces, mapped, part, out);
    }
    computeNormals(out.mesh);
    return out;
}

}  // namespace pellucid::io
