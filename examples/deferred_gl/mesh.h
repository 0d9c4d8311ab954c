// A head for the renderer: control polygons from an OBJ file, subdivided.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

using Float3 = std::array<float, 3>;

enum Id : uint32_t { Skin = 1, Eyes = 2, Mouth = 3, Wall = 4 };

struct Mesh {
    std::vector<Float3> positions;  // mm
    std::vector<uint32_t> ids;      // per vertex
    std::vector<std::vector<uint32_t>> polygons;
    std::vector<uint32_t> triangles() const;
};

// Groups whose names begin with "eye" are eyes, with "teeth" or "tongue" the mouth; all else is skin. Throws
// std::runtime_error.
Mesh readObj(const std::string& path);

// One level of Catmull-Clark; open borders become smooth curves.
Mesh subdivided(const Mesh& mesh);
