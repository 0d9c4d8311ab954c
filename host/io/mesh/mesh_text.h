// Strict readers of mesh files: each number must be present and finite, each index in range. Every vertex
// and face is kept, whether or not they make a manifold. Lenient readers take "nan" for the end of the
// file, skip a broken vertex and so shift all later indices, and take trailing face colours for faces.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pellucid::io {

struct RawMesh {
    std::vector<float> positions;           // xyz
    std::vector<float> normals;             // xyz per vertex, or empty
    std::vector<float> uvs;                 // per vertex, or empty
    std::vector<uint32_t> faceStart = {0};  // face f has corners [faceStart[f], faceStart[f + 1])
    std::vector<int64_t> corners;           // vertex index per corner
    std::vector<float> cornerUvs;           // u, v per corner, or empty
    size_t leftOut = 0;                     // faces of OBJ and STL files with coinciding corners

    size_t faces() const { return faceStart.size() - 1; }
};

// Each throws FileError with the line of the first number that is missing, not finite, or an index out of
// range. No other file is opened, not even files that the text names (an OBJ's materials).
RawMesh readOff(const std::string& path, const std::string& text);  // ASCII: not "OFF BINARY"
RawMesh readObj(const std::string& path, const std::string& text);
RawMesh readStl(const std::string& path, const std::string& text);  // ASCII and binary
RawMesh readPly(const std::string& path, const std::string& text);  // ASCII and binary

}  // namespace pellucid::io
