// A head for the renderer, from an OBJ file, made finer.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

using Float3 = std::array<float, 3>;

enum Id : uint32_t { Skin = 1, Eyes = 2, Mouth = 3, Wall = 4 };

struct Mesh {
    std::vector<Float3> positions;    // mm
    std::vector<uint32_t> ids;        // per vertex
    std::vector<uint32_t> triangles;  // three vertices each
};

// Groups whose names begin with "eye" are eyes, with "teeth" or "tongue" the mouth; all else is skin. Throws
// std::runtime_error.
Mesh readObj(const std::string& path);

// Each triangle as four, their new corners towards the smooth surface that the normals describe [Boubekeur
// and Alexa, Phong Tessellation, 2008].
Mesh subdivided(const Mesh& mesh, const std::vector<Float3>& normals);
