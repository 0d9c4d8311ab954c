#include "io/mesh/mesh_file.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <pellucid/pellucid.hpp>

#include "io/input_file.h"
#include "io/mesh/mesh_text.h"

namespace pellucid::io {
namespace {

std::string counted(size_t count, const std::string& one, const std::string& several) {
    return concat(count, " ", (count == 1 ? one : several));
}

void checkVertices(const std::string& path, const RawMesh& raw) {
    for (size_t i = 0; i < raw.positions.size(); ++i) {
        if (!std::isfinite(raw.positions[i]))
            throw FileError(
                path,
                concat("vertex ", i / 3,
                       " (counted from 0) has a position that is NaN or infinite; positions must be finite"));
    }
}

void checkCorners(const std::string& path, const RawMesh& raw) {
    const auto vertices = int64_t(raw.positions.size() / 3);
    for (size_t f = 0; f + 1 < raw.faceStart.size(); ++f)
        for (size_t c = raw.faceStart[f]; c < raw.faceStart[f + 1]; ++c) {
            if (raw.corners[c] >= 0 && raw.corners[c] < vertices) continue;
            throw FileError(path,
                            concat("face ", f, " (counted from 0) refers to vertex ", raw.corners[c],
                                   ", but the file has ", vertices, (vertices == 1 ? " vertex" : " vertices"),
                                   "; 0 to ", vertices - 1, " would be right"));
        }
}

// Corner UVs become vertex UVs. Where corners differ, the vertex is copied, or all UVs are left out.
void assignCornerUvs(MeshData& mesh, std::vector<uint32_t>& corners, std::span<const float> cornerUvs,
                     bool split) {
    const size_t fileVertices = mesh.vertexCount();
    std::vector<uint32_t> own = corners;
    std::vector<float> uvs(2 * fileVertices, 0.0f);
    std::vector<bool> seen(fileVertices, false);
    std::map<std::pair<uint32_t, std::pair<float, float>>, uint32_t> copies;
    for (size_t c = 0; c < own.size(); ++c) {
        const uint32_t v = own[c];
        const float* uv = &cornerUvs[2 * c];
        if (!seen[v]) {
            seen[v] = true;
            std::copy_n(uv, 2, &uvs[2 * v]);
        } else if (std::memcmp(&uvs[2 * v], uv, 2 * sizeof(float)) != 0) {
            if (!split) {
                mesh.warnings.push_back(
                    "texture coordinates left out: they differ between faces at a vertex");
                return;
            }
            const auto next = uint32_t(uvs.size() / 2);
            const auto [entry, isNew] = copies.try_emplace({v, {uv[0], uv[1]}}, next);
            own[c] = entry->second;
            if (isNew) {
                mesh.splitFrom.push_back(v);
                uvs.insert(uvs.end(), {uv[0], uv[1]});
            }
        }
    }
    for (uint32_t v : mesh.splitFrom) {
        for (std::vector<float>* array : {&mesh.positions, &mesh.normals}) {
            if (array->empty()) continue;
            for (size_t a = 0; a < 3; ++a) array->push_back((*array)[3 * v + a]);
        }
    }
    corners = std::move(own);
    mesh.uvs = std::move(uvs);
}

void triangulate(MeshData& mesh, const RawMesh& raw) {
    size_t tooSmall = 0;
    for (size_t f = 0; f + 1 < raw.faceStart.size(); ++f) {
        const size_t first = raw.faceStart[f], last = raw.faceStart[f + 1];
        tooSmall += last - first < 3;
        for (size_t c = first + 1; c + 1 < last; ++c) {
            for (size_t corner : {first, c, c + 1}) mesh.triangles.push_back(uint32_t(raw.corners[corner]));
        }
    }
    if (tooSmall)
        mesh.warnings.push_back(counted(tooSmall, "face", "faces") +
                                " with fewer than three corners left out");
}

// Loaded normals are used only if all of them are usable.
void checkNormals(MeshData& mesh) {
    size_t bad = 0;
    for (size_t v = 0; v + 2 < mesh.normals.size(); v += 3) {
        float* n = &mesh.normals[v];
        const float length = std::hypot(n[0], n[1], n[2]);
        if (!(std::isfinite(length) && length > 1e-6f)) {
            ++bad;
            continue;
        }
        for (size_t a = 0; a < 3; ++a) n[a] /= length;
    }
    if (!bad) return;
    mesh.normals.clear();
    mesh.warnings.push_back("normals left out: " + counted(bad, "vertex normal", "vertex normals") +
                            " missing, zero or not finite");
}

// Reorients triangles that face another way than their neighbours, or adds a warning.
void checkOrder(MeshData& mesh, bool orient) {
    PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
    desc.numVertices = uint32_t(mesh.vertexCount());
    desc.indices = mesh.triangles.data();
    desc.numIndices = mesh.triangles.size();
    desc.weld = PEL_WELD_EXACT;
    desc.positions = mesh.positions.data();
    std::vector<uint32_t> turned(mesh.triangles.size());
    const PelMeshOrientation found =
        orientMesh(desc, turned.data(), mesh.normals.empty() ? nullptr : mesh.normals.data());
    const std::string triangles = counted(found.trianglesTurned, "triangle faces", "triangles face");
    if (orient) {
        mesh.triangles = std::move(turned);
        mesh.trianglesTurned = found.trianglesTurned;
    } else if (found.trianglesTurned > 0)
        mesh.warnings.push_back(
            triangles + " the other way than the neighbours, so normals computed from them cancel out");
    if (found.inconsistentEdges > 0)
        mesh.warnings.push_back("the surface cannot be oriented (like a Moebius strip): at " +
                                counted(found.inconsistentEdges, "edge", "edges") +
                                " the two triangles face opposite ways, whichever is flipped");
}

}  // namespace

void splitAtSeams(MeshData& mesh, std::span<const float> cornerUvs) {
    assignCornerUvs(mesh, mesh.triangles, cornerUvs, true);
}

MeshData loadMesh(const std::string& path, const MeshLoadOptions& options) {
    return decodeMesh(path, readWholeFile(path), options);
}

MeshData decodeMesh(const std::string& path, const std::string& text, const MeshLoadOptions& options) {
    const std::string extension = requireExtension(path, {"off", "obj", "ply", "stl"});
    if (text.empty()) throw FileError(path, "is empty; a mesh was expected");
    RawMesh raw = extension == "off"   ? readOff(path, text)
                  : extension == "obj" ? readObj(path, text)
                  : extension == "stl" ? readStl(path, text)
                                       : readPly(path, text);
    checkVertices(path, raw);
    checkCorners(path, raw);

    MeshData mesh;
    mesh.source = path;
    mesh.positions = std::move(raw.positions);
    mesh.normals = std::move(raw.normals);
    checkNormals(mesh);
    if (raw.leftOut)
        mesh.warnings.push_back(counted(raw.leftOut, "face", "faces") + " with coinciding corners left out");
    if (!raw.cornerUvs.empty()) {
        std::vector<uint32_t> corners(raw.corners.begin(), raw.corners.end());
        assignCornerUvs(mesh, corners, raw.cornerUvs, options.splitUvSeams);
        raw.corners.assign(corners.begin(), corners.end());
    } else {
        mesh.uvs = std::move(raw.uvs);
    }
    triangulate(mesh, raw);
    if (mesh.triangles.empty())
        throw FileError(path, "has " + counted(mesh.vertexCount(), "vertex", "vertices") +
                                  " but no face with three corners; a surface was expected");
    checkOrder(mesh, options.orient);
    return mesh;
}

}  // namespace pellucid::io
