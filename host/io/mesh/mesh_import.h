// The raw output of OpenMesh's readers: every vertex and every face, whether or not they make a manifold.
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

// Throws FileError if a position is not finite, or a corner refers to a vertex that does not exist.
void checkRawMesh(const std::string& path, const RawMesh& raw);

// Reads the text of `path` with the OpenMesh reader for `extension` ("obj", "stl"). Opens no files, also not
// those that the text names (an OBJ's materials). Throws FileError.
RawMesh importWithOpenMesh(const std::string& path, const std::string& text, const std::string& extension,
                           bool binaryStl);

}  // namespace pellucid::io
