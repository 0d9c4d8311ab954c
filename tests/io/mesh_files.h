// What the tests of mesh files share.
#pragma once
#include <string>
#include <vector>

#include "io/file_error.h"
#include "io/mesh/mesh_file.h"
#include "io_files.h"

// A regular tetrahedron, faces outwards.
inline const std::vector<float> corners = {1, 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1};
inline const std::vector<uint32_t> tetrahedron = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
inline const char* const offTetrahedron =
    "OFF\n4 4 6\n1 1 1\n-1 -1 1\n-1 1 -1\n1 -1 -1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

class MeshFile : public FolderTest {
  protected:
    std::string loadError(const std::string& name, const std::string& text) const {
        const std::string file = write(name, text);
        return messageOf<pellucid::io::FileError>([&] { pellucid::io::loadMesh(file); });
    }
};
