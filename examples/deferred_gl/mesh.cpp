#include "mesh.h"

#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/CatmullClarkT.hh>
#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

std::vector<uint32_t> Mesh::triangles() const {
    std::vector<uint32_t> indices;
    for (const auto& polygon : polygons)
        for (size_t i = 2; i < polygon.size(); ++i)
            indices.insert(indices.end(), {polygon[0], polygon[i - 1], polygon[i]});
    return indices;
}

Mesh readObj(const std::string& path) {
    std::ifstream file(path);
    Mesh mesh;
    Id id = Skin;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string key, word;
        words >> key;
        if (key == "v") {
            Float3 p{};
            words >> p[0] >> p[1] >> p[2];
            mesh.positions.push_back(p);
            mesh.ids.push_back(Skin);
        } else if (key == "g") {
            words >> word;
            id = word.rfind("eye", 0) == 0                                     ? Eyes
                 : word.rfind("teeth", 0) == 0 || word.rfind("tongue", 0) == 0 ? Mouth
                                                                               : Skin;
        } else if (key == "f") {
            std::vector<uint32_t> polygon;
            while (words >> word) {
                const unsigned long vertex = std::strtoul(word.c_str(), nullptr, 10);  // "12/7": 12
                if (vertex < 1 || vertex > mesh.positions.size())
                    throw std::runtime_error(path + ": a face names vertex " + word + ", which is not there");
                polygon.push_back(uint32_t(vertex - 1));
                mesh.ids[vertex - 1] = id;
            }
            mesh.polygons.push_back(std::move(polygon));
        }
    }
    if (mesh.polygons.empty()) throw std::runtime_error(path + ": no faces; an OBJ file is needed");
    return mesh;
}

Mesh subdivided(const Mesh& mesh) {
    using Polygons = OpenMesh::PolyMesh_ArrayKernelT<>;
    Polygons polygons;
    for (const Float3& p : mesh.positions) polygons.add_vertex({p[0], p[1], p[2]});
    for (const auto& polygon : mesh.polygons) {
        std::vector<OpenMesh::VertexHandle> corners;
        for (const uint32_t v : polygon) corners.emplace_back(int(v));
        if (!polygons.add_face(corners).is_valid())
            throw std::runtime_error("the mesh has an edge of more than two faces, or faces that are turned");
    }
    OpenMesh::Subdivider::Uniform::CatmullClarkT<Polygons> subdivide;
    subdivide.attach(polygons);
    subdivide(1);
    subdivide.detach();
    Mesh out{{}, mesh.ids, {}};
    for (const auto v : polygons.vertices()) {
        const auto& p = polygons.point(v);
        out.positions.push_back({p[0], p[1], p[2]});
    }
    out.ids.resize(out.positions.size());
    for (const auto face : polygons.faces()) {
        std::vector<uint32_t>& quad = out.polygons.emplace_back();
        for (const auto v : face.vertices()) quad.push_back(uint32_t(v.idx()));
        // From the corner of before on, which has kept its number.
        std::rotate(quad.begin(), std::min_element(quad.begin(), quad.end()), quad.end());
        for (const uint32_t v : quad) out.ids[v] = mesh.ids[quad[0]];
    }
    return out;
}
