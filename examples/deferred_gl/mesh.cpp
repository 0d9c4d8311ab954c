#include "mesh.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

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
            id = word.starts_with("eye")                                   ? Eyes
                 : word.starts_with("teeth") || word.starts_with("tongue") ? Mouth
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
            for (size_t i = 2; i < polygon.size(); ++i)
                mesh.triangles.insert(mesh.triangles.end(), {polygon[0], polygon[i - 1], polygon[i]});
        }
    }
    if (mesh.triangles.empty()) throw std::runtime_error(path + ": no faces; an OBJ file is needed");
    return mesh;
}

Mesh subdivided(const Mesh& mesh, const std::vector<Float3>& normals) {
    Mesh out{mesh.positions, mesh.ids, {}};
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;  // of edges
    const auto middle = [&](uint32_t a, uint32_t b) {
        const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), uint32_t(out.positions.size()));
        if (fresh) {
            const Float3 &from = mesh.positions[a], &to = mesh.positions[b];
            float rise = 0, fall = 0;  // of the edge, from the tangent planes at its ends
            for (size_t i = 0; i < 3; ++i)
                rise += (to[i] - from[i]) * normals[a][i], fall += (to[i] - from[i]) * normals[b][i];
            Float3 p;
            for (size_t i = 0; i < 3; ++i)
                p[i] = 0.5f * (from[i] + to[i]) + 0.1875f * (fall * normals[b][i] - rise * normals[a][i]);
            out.positions.push_back(p);
            out.ids.push_back(mesh.ids[a]);
        }
        return at->second;
    };
    for (size_t i = 0; i < mesh.triangles.size(); i += 3) {
        const uint32_t a = mesh.triangles[i], b = mesh.triangles[i + 1], c = mesh.triangles[i + 2],
                       ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        out.triangles.insert(out.triangles.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
    }
    return out;
}
