#include "io/mesh/mesh_import.h"

#include <OpenMesh/Core/IO/MeshIO.hh>

#include <cmath>
#include <sstream>

#include "io/file_error.h"
#include "io/mesh/quiet_open_mesh.h"

namespace pellucid::io {
namespace {

using namespace OpenMesh;

class RawImporter final : public OpenMesh::IO::BaseImporter {
  public:
    explicit RawImporter(RawMesh& mesh) : mesh_(mesh) { mesh_.faceStart.push_back(0); }

    VertexHandle add_vertex(const Vec3f& p) override {
        mesh_.positions.insert(mesh_.positions.end(), {p[0], p[1], p[2]});
        return VertexHandle(static_cast<int>(n_vertices()) - 1);
    }
    VertexHandle add_vertex() override { return add_vertex(Vec3f(0, 0, 0)); }
    void set_point(VertexHandle v, const Vec3f& p) override { set(mesh_.positions, v, p, 3); }
    void set_normal(VertexHandle v, const Vec3f& n) override { set(mesh_.normals, v, n, 3); }
    void set_normal(VertexHandle v, const Vec3d& n) override { set_normal(v, Vec3f(n)); }
    void set_texcoord(VertexHandle v, const Vec2f& t) override { set(mesh_.uvs, v, t, 2); }

    FaceHandle add_face(const VHandles& vertices) override {
        for (VertexHandle v : vertices) mesh_.corners.push_back(v.idx());
        mesh_.faceStart.push_back(static_cast<uint32_t>(mesh_.corners.size()));
        return FaceHandle(static_cast<int>(n_faces()) - 1);
    }
    void add_face_texcoords(FaceHandle f, VertexHandle, const std::vector<Vec2f>& uvs) override {
        const size_t first = mesh_.faceStart[static_cast<size_t>(f.idx())];
        const size_t last = mesh_.faceStart[static_cast<size_t>(f.idx()) + 1];
        if (uvs.size() != last - first) return;
        mesh_.cornerUvs.resize(2 * first, 0.0f);  // faces without UVs before this one
        for (const Vec2f& uv : uvs) mesh_.cornerUvs.insert(mesh_.cornerUvs.end(), {uv[0], uv[1]});
    }

    size_t n_vertices() const override { return mesh_.positions.size() / 3; }
    size_t n_faces() const override { return mesh_.faceStart.size() - 1; }
    size_t n_edges() const override { return 0; }

    // The rest is not needed: half-edges (OM files), colours, status, textures.
    HalfedgeHandle add_edge(VertexHandle, VertexHandle) override { return HalfedgeHandle(); }
    FaceHandle add_face(HalfedgeHandle) override { return FaceHandle(); }
    void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec3f>&) override {}
    void set_face_texindex(FaceHandle, int) override {}
    void set_halfedge(VertexHandle, HalfedgeHandle) override {}
    void set_color(VertexHandle, const Vec3uc&) override {}
    void set_color(VertexHandle, const Vec4uc&) override {}
    void set_color(VertexHandle, const Vec3f&) override {}
    void set_color(VertexHandle, const Vec4f&) override {}
    void set_status(VertexHandle, const Attributes::StatusInfo&) override {}
    void set_next(HalfedgeHandle, HalfedgeHandle) override {}
    void set_face(HalfedgeHandle, FaceHandle) override {}
    void request_face_texcoords2D() override {}
    void set_texcoord(HalfedgeHandle, const Vec2f&) override {}
    void set_texcoord(VertexHandle, const Vec3f&) override {}
    void set_texcoord(HalfedgeHandle, const Vec3f&) override {}
    void set_status(HalfedgeHandle, const Attributes::StatusInfo&) override {}
    void set_color(EdgeHandle, const Vec3uc&) override {}
    void set_color(EdgeHandle, const Vec4uc&) override {}
    void set_color(EdgeHandle, const Vec3f&) override {}
    void set_color(EdgeHandle, const Vec4f&) override {}
    void set_status(EdgeHandle, const Attributes::StatusInfo&) override {}
    void set_normal(FaceHandle, const Vec3f&) override {}
    void set_normal(FaceHandle, const Vec3d&) override {}
    void set_color(FaceHandle, const Vec3uc&) override {}
    void set_color(FaceHandle, const Vec4uc&) override {}
    void set_color(FaceHandle, const Vec3f&) override {}
    void set_color(FaceHandle, const Vec4f&) override {}
    void set_status(FaceHandle, const Attributes::StatusInfo&) override {}
    void add_texture_information(int, std::string) override {}

  private:
    // Vertices that never get a value keep 0. If the file sets none, the array stays empty.
    template <class Vector>
    void set(std::vector<float>& array, VertexHandle v, const Vector& value, size_t size) {
        if (v.idx() < 0 || static_cast<size_t>(v.idx()) >= n_vertices()) return;
        const size_t needed = (static_cast<size_t>(v.idx()) + 1) * size;
        if (array.size() < needed) array.resize(needed, 0.0f);
        for (size_t i = 0; i < size; ++i) array[needed - size + i] = value[i];
    }

    RawMesh& mesh_;
};

void checkVertices(const std::string& path, const RawMesh& raw) {
    for (size_t i = 0; i < raw.positions.size(); ++i) {
        if (!std::isfinite(raw.positions[i])) {
            throw FileError(
                path,
                "vertex " + std::to_string(i / 3) +
                    " (counted from 0) has a position that is NaN or infinite; positions must be finite");
        }
    }
}

void checkCorners(const std::string& path, const RawMesh& raw) {
    const auto vertices = static_cast<int64_t>(raw.positions.size() / 3);
    for (size_t f = 0; f + 1 < raw.faceStart.size(); ++f) {
        for (size_t c = raw.faceStart[f]; c < raw.faceStart[f + 1]; ++c) {
            if (raw.corners[c] >= 0 && raw.corners[c] < vertices) continue;
            throw FileError(path, "face " + std::to_string(f) + " (counted from 0) refers to vertex " +
                                      std::to_string(raw.corners[c]) + ", but the file has " +
                                      std::to_string(vertices) + (vertices == 1 ? " vertex" : " vertices") +
                                      "; 0 to " + std::to_string(vertices - 1) + " would be right");
        }
    }
}

}  // namespace

void checkRawMesh(const std::string& path, const RawMesh& raw) {
    checkVertices(path, raw);
    checkCorners(path, raw);
}

RawMesh importWithOpenMesh(const std::string& path, const std::string& text, const std::string& extension,
                           bool binaryStl) {
    QuietOpenMesh quiet;
    RawMesh mesh;
    RawImporter importer(mesh);
    OpenMesh::IO::Options options = OpenMesh::IO::Options::VertexNormal;
    options += OpenMesh::IO::Options::VertexTexCoord;
    options += OpenMesh::IO::Options::FaceTexCoord;
    std::istringstream stream(text, std::ios::binary);
    if (binaryStl) options += OpenMesh::IO::Options::Binary;
    const bool read = OpenMesh::IO::IOManager().read(stream, extension, importer, options);
    if (!read) throw FileError(path, "is not a ." + extension + " file that OpenMesh can read");
    const size_t vertices = importer.n_vertices();
    if (!mesh.normals.empty()) mesh.normals.resize(3 * vertices, 0.0f);
    if (!mesh.uvs.empty()) mesh.uvs.resize(2 * vertices, 0.0f);
    if (!mesh.cornerUvs.empty()) mesh.cornerUvs.resize(2 * mesh.corners.size(), 0.0f);
    return mesh;
}

}  // namespace pellucid::io
