// Light on a mesh and the surface integral over it, for `pellucid reference` and the programs that measure
// methods.
#pragma once
#include <string>
#include <vector>

#include "io/mesh/mesh_file.h"
#include "io/scene/scene_file.h"
#include "sample/lit_mesh.h"

namespace pellucid::cli {

// A scene's lights, which all cast shadows, and its ambient light, which does not.
sample::Lighting lightingOf(const io::SceneFile& scene);

struct ReferenceMesh {
    io::MeshData mesh;
    std::vector<uint32_t> materials;  // id per triangle; empty: no parts, all triangles scatter
    // The id of the triangles that enclose a material of the scene; 0: all triangles.
    uint32_t bodyOf(uint32_t material) const { return materials.empty() ? 0 : byMaterial ? material : 1; }
    bool byMaterial = false;
};

// `subdivide` levels: Catmull-Clark of OBJ files, Loop of others. `parts`: groups of an OBJ file that
// scatter, all others just cast shadows; none: all scatter. Either one GROUP, for all materials, or ID=GROUP
// for each material that has a body of its own.
ReferenceMesh loadReferenceMesh(const std::string& path, int subdivide,
                                const std::vector<std::string>& parts);

}  // namespace pellucid::cli
