// A strict check of a mesh file's text before OpenMesh's lenient readers see it; for OFF and PLY, where
// little is left to do then, in place of them. OpenMesh's readers take "nan" for the end of the file, skip a
// broken vertex and so shift all later indices, and take trailing face colours for faces.
#pragma once
#include <cstddef>
#include <optional>
#include <string>

#include "io/mesh/mesh_import.h"

namespace pellucid::io {

struct MeshText {
    size_t faces = 0;             // faces that the file lists
    bool binary = false;          // an STL that is not text
    std::optional<RawMesh> mesh;  // if the check has read it already
    std::optional<std::string> canonical;  // the same mesh without what OpenMesh cannot read, if there was such a thing
};

// Each throws FileError with the line of the first number that is missing, not finite, or an index out of
// range.
MeshText checkOff(const std::string& path, const std::string& text);  // ASCII: not "OFF BINARY"
MeshText checkObj(const std::string& path, const std::string& text);
MeshText checkStl(const std::string& path, const std::string& text);  // ASCII and binary
MeshText checkPly(const std::string& path, const std::string& text);  // ASCII and binary

}  // namespace pellucid::io
