// What OpenMesh's readers hand over, kept raw: every vertex and every face, whether or not they make a
// manifold.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace pellucid::io {

struct RawMesh {
    std::vector<float> positions;     // xyz
    std::vector<float> normals;       // xyz per vertex, or empty
    std::vector<float> uvs;           // per vertex, or empty
    std::vector<uint32_t> faceStart;  // face f has corners [faceStart[f], faceStart[f + 1])
    std::vector<int64_t> corners;     // vertex index per corner, as the file has it
    std::vector<float> cornerUvs;     // u, v per corner, or empty
};

// Reads `path` with the OpenMesh reader for `extension` ("off", "obj", "ply", "stl"). Throws FileError.
RawMesh importWithOpenMesh(const std::string& path, const std::string& extension);

}  // namespace pellucid::io
