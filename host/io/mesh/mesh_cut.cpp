#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "io/mesh/mesh_parts.h"

namespace pellucid::io {
namespace {

// New vertices on cut edges; the same for both triangles of an edge.
class Cutter {
  public:
    Cutter(MeshData& mesh, const float (&normal)[3], float offset)
        : mesh_(mesh), normal_{normal[0], normal[1], normal[2]}, offset_(offset) {}

    double above(uint32_t v) const {
        const float* p = &mesh_.positions[3 * size_t(v)];
        return normal_[0] * p[0] + normal_[1] * p[1] + normal_[2] * p[2] - offset_;
    }
    uint32_t crossing(uint32_t a, uint32_t b) {
        if (a > b) std::swap(a, b);
        const auto [entry, isNew] = cuts_.try_emplace({a, b}, uint32_t(mesh_.vertexCount()));
        if (isNew) {
            const double t = above(a) / (above(a) - above(b));
            for (std::vector<float>* array : {&mesh_.positions, &mesh_.normals})
                for (size_t k = 0; k < 3; ++k) {
                    const float x = (*array)[3 * size_t(a) + k], y = (*array)[3 * size_t(b) + k];
                    array->push_back(float(x + t * (y - x)));
                }
            float* n = &mesh_.normals[mesh_.normals.size() - 3];
            const double length = std::hypot(n[0], n[1], n[2]);
            for (size_t k = 0; k < 3 && length > 0; ++k) n[k] = float(n[k] / length);
        }
        return entry->second;
    }

    // UVs of the new vertex: equal in both triangles of an edge if the UVs of the edge's ends are.
    std::array<float, 2> uvAt(uint32_t a, uint32_t b, std::array<float, 2> uvA,
                              std::array<float, 2> uvB) const {
        if (a > b) std::swap(a, b), std::swap(uvA, uvB);
        const double t = above(a) / (above(a) - above(b));
        return {float(uvA[0] + t * (uvB[0] - uvA[0])), float(uvA[1] + t * (uvB[1] - uvA[1]))};
    }

  private:
    MeshData& mesh_;
    std::array<double, 3> normal_;
    double offset_;
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> cuts_;
};

// A fan from the middle of the rim, with vertices of its own.
void closeRim(PartedMesh& mesh, const std::vector<std::array<uint32_t, 2>>& rim, const float (&normal)[3],
              uint32_t part) {
    const double length = std::hypot(normal[0], normal[1], normal[2]);
    MeshData& data = mesh.mesh;
    const auto copy = [&](const double(&p)[3]) {
        for (size_t k = 0; k < 3; ++k) {
            data.positions.push_back(float(p[k]));
            data.normals.push_back(float(-normal[k] / length));
        }
        return uint32_t(data.vertexCount() - 1);
    };
    double middle[3] = {0, 0, 0};
    for (const auto& edge : rim)
        for (size_t k = 0; k < 3; ++k)
            middle[k] += data.positions[3 * size_t(edge[0]) + k] / double(rim.size());
    const uint32_t centre = copy(middle);
    std::map<uint32_t, uint32_t> copies;
    const auto own = [&](uint32_t v) {
        const auto [entry, isNew] = copies.try_emplace(v);
        if (isNew)
            entry->second = copy({data.positions[3 * size_t(v)], data.positions[3 * size_t(v) + 1],
                                  data.positions[3 * size_t(v) + 2]});
        return entry->second;
    };
    for (const auto& edge : rim) {
        const uint32_t corners[3] = {own(edge[1]), own(edge[0]), centre};
        data.triangles.insert(data.triangles.end(), corners, corners + 3);
        mesh.partOf.push_back(part);
        if (!mesh.cornerUvs.empty()) mesh.cornerUvs.insert(mesh.cornerUvs.end(), 6, 0.0f);
    }
}

// Removes vertices that no triangle uses any more.
void dropUnused(MeshData& mesh) {
    std::vector<uint32_t> place(mesh.vertexCount(), UINT32_MAX);
    std::vector<float> positions, normals;
    for (uint32_t& v : mesh.triangles) {
        if (place[v] == UINT32_MAX) {
            place[v] = uint32_t(positions.size() / 3);
            positions.insert(positions.end(), &mesh.positions[3 * size_t(v)],
                             &mesh.positions[3 * size_t(v)] + 3);
            normals.insert(normals.end(), &mesh.normals[3 * size_t(v)], &mesh.normals[3 * size_t(v)] + 3);
        }
        v = place[v];
    }
    mesh.positions = std::move(positions);
    mesh.normals = std::move(normals);
}

}  // namespace

void cutAndClose(PartedMesh& mesh, const std::string& part, const float (&normal)[3], float offset,
                 const std::string& cap) {
    MeshData& data = mesh.mesh;
    Cutter cutter(data, normal, offset);
    const int wanted = mesh.part(part);
    std::vector<uint32_t> triangles, partOf;
    std::vector<float> uvs;
    std::vector<std::array<uint32_t, 2>> rim;  // edges of the cut, in the direction of the kept triangles
    const bool mapped = !mesh.cornerUvs.empty();
    struct Corner {
        uint32_t v;
        std::array<float, 2> uv;
    };
    const auto add = [&](const Corner& a, const Corner& b, const Corner& c, uint32_t of) {
        triangles.insert(triangles.end(), {a.v, b.v, c.v});
        for (const Corner* corner : {&a, &b, &c})
            if (mapped) uvs.insert(uvs.end(), corner->uv.begin(), corner->uv.end());
        partOf.push_back(of);
    };
    const auto crossing = [&](const Corner& a, const Corner& b) {
        return Corner{cutter.crossing(a.v, b.v), cutter.uvAt(a.v, b.v, a.uv, b.uv)};
    };
    const std::vector<uint32_t> before = std::move(data.triangles);
    for (size_t t = 0; t < mesh.partOf.size(); ++t) {
        std::array<Corner, 3> v{};
        for (size_t k = 0; k < 3; ++k) {
            v[k].v = before[3 * t + k];
            if (mapped) v[k].uv = {mesh.cornerUvs[6 * t + 2 * k], mesh.cornerUvs[6 * t + 2 * k + 1]};
        }
        const uint32_t of = mesh.partOf[t];
        const auto isKept = [&](const Corner& c) { return cutter.above(c.v) >= 0; };
        const auto kept = std::count_if(v.begin(), v.end(), isKept);
        if (kept == 0) continue;
        if (kept == 3) {
            add(v[0], v[1], v[2], of);
            continue;
        }
        // The corner that is alone on its side comes first.
        while (isKept(v[0]) != (kept == 1) || isKept(v[1]) == (kept == 1))
            std::rotate(v.begin(), v.begin() + 1, v.end());
        const Corner p = crossing(v[0], v[1]), q = crossing(v[0], v[2]);
        if (kept == 1) {
            add(v[0], p, q, of);
            if (int(of) == wanted) rim.push_back({p.v, q.v});
        } else {
            add(p, v[1], v[2], of);
            add(p, v[2], q, of);
            if (int(of) == wanted) rim.push_back({q.v, p.v});
        }
    }
    mesh.cornerUvs = std::move(uvs);
    data.triangles = std::move(triangles);
    mesh.partOf = std::move(partOf);
    std::map<uint32_t, int> ends;
    for (const auto& edge : rim) ++ends[edge[0]], --ends[edge[1]];
    const bool closed =
        std::all_of(ends.begin(), ends.end(), [](const auto& end) { return end.second == 0; });
    if (!rim.empty() && closed) {
        mesh.parts.push_back(cap);
        closeRim(mesh, rim, normal, uint32_t(mesh.parts.size() - 1));
    }
    dropUnused(data);
}

}  // namespace pellucid::io
