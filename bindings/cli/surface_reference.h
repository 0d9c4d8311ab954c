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
    std::vector<uint32_t> materials;  // per triangle: 1 scatters, 2 only casts shadows; empty: all scatter
};

// `subdivide` levels: Catmull-Clark of OBJ files, Loop of others. `part`: the only group of an OBJ file that
// scatters; "": all.
ReferenceMesh loadReferenceMesh(const std::string& path, int subdivide, const std::string& part);

}  // namespace pellucid::cli
