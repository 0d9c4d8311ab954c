#include "mesh.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace {

Float3& operator+=(Float3& a, const Float3& b) {
    for (size_t i = 0; i < 3; ++i) a[i] += b[i];
    return a;
}

Float3 scaled(const Float3& a, float s) {
    return {a[0] * s, a[1] * s, a[2] * s};
}

struct Edge {
    Float3 ends{}, faces{};  // sums
    int count = 0;           // of faces; 1 on a border
    uint32_t point = 0;      // the vertex that divides it
};

}  // namespace

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
    const size_t count = mesh.positions.size();
    Mesh out{mesh.positions, mesh.ids, {}};
    std::map<std::pair<uint32_t, uint32_t>, Edge> edges;
    std::vector<Float3> faceSums(count), edgeSums(count), borderSums(count);
    std::vector<int> faces(count), borders(count);
    const auto edgeOf = [&](const std::vector<uint32_t>& polygon, size_t i) -> auto& {
        const uint32_t a = polygon[i], b = polygon[(i + 1) % polygon.size()];
        return edges[{std::min(a, b), std::max(a, b)}];
    };

    std::vector<Float3> centers;
    for (const auto& polygon : mesh.polygons) {
        Float3 center{};
        for (const uint32_t v : polygon) center += scaled(mesh.positions[v], 1.0f / float(polygon.size()));
        centers.push_back(center);
        for (size_t i = 0; i < polygon.size(); ++i) {
            edgeOf(polygon, i).faces += center;
            ++edgeOf(polygon, i).count;
            faceSums[polygon[i]] += center;
            ++faces[polygon[i]];
        }
    }
    for (auto& [ends, edge] : edges) {
        edge.ends = mesh.positions[ends.first];
        edge.ends += mesh.positions[ends.second];
        const Float3 middle = scaled(edge.ends, 0.5f);
        Float3 point = middle;
        if (edge.count == 2) point = scaled(edge.faces, 0.25f), point += scaled(edge.ends, 0.25f);
        edge.point = uint32_t(out.positions.size());
        out.positions.push_back(point);
        out.ids.push_back(mesh.ids[ends.first]);
        for (const uint32_t v : {ends.first, ends.second}) {
            edgeSums[v] += middle;
            if (edge.count == 1) borderSums[v] += middle, ++borders[v];
        }
    }
    for (size_t v = 0; v < count; ++v) {
        const auto n = float(faces[v]);
        Float3& p = out.positions[v];
        if (borders[v] == 2) {
            p = scaled(p, 0.5f);
            p += scaled(borderSums[v], 0.25f);
        } else if (n > 0 && borders[v] == 0) {
            p = scaled(p, (n - 3) / n);
            p += scaled(faceSums[v], 1 / (n * n));
            p += scaled(edgeSums[v], 2 / (n * n));
        }
    }
    for (size_t f = 0; f < mesh.polygons.size(); ++f) {
        const auto& polygon = mesh.polygons[f];
        const auto center = uint32_t(out.positions.size());
        out.positions.push_back(centers[f]);
        out.ids.push_back(mesh.ids[polygon[0]]);
        for (size_t i = 0; i < polygon.size(); ++i) {
            const size_t before = (i + polygon.size() - 1) % polygon.size();
            out.polygons.push_back(
                {polygon[i], edgeOf(polygon, i).point, center, edgeOf(polygon, before).point});
        }
    }
    return out;
}
