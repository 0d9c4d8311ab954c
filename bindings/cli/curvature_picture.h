// A mesh coloured by a value at its vertices, as a picture.
#pragma once
#include <string>
#include <vector>

#include "io/mesh/mesh_file.h"

namespace pellucid::cli {

// Writes a PNG of the mesh seen from the front and from a side, with a colour bar from `low` to `high`. `up`
// is 'y' or 'z'. Throws FileError when the file cannot be written.
void writeCurvaturePicture(const std::string& path, const io::MeshData& mesh,
                           const std::vector<float>& values, float low, float high, char up,
                           const std::string& unit);

}  // namespace pellucid::cli
