// Polygon meshes with named parts, subdivided: the heads of the demo.
#pragma once
#include "io/mesh/mesh_file.h"

namespace pellucid::io {

struct PartedMesh {
    MeshData mesh;                 // no UVs (splitAtSeams makes them of cornerUvs); normals over all vertices
    std::vector<float> cornerUvs;  // u, v per corner of mesh.triangles; empty where the file has none
    std::vector<std::string> parts;  // the OBJ file's groups, in the order of their first face
    std::vector<uint32_t> partOf;    // index into `parts`, per triangle

    int part(const std::string& name) const;  // -1: there is none
};

// Reads an OBJ file with its groups ("g NAME"; faces before the first are in a part ""). Each part is
// subdivided `levels` times by Catmull-Clark, so that its polygons become 4^levels quads or more, and cut
// into triangles. Texture coordinates are interpolated linearly in each face. Parts share no vertices
// afterwards. Throws FileError as loadMesh does, and for a part that is not manifold.
PartedMesh loadParts(const std::string& path, int levels);
// As loadMesh reads an OBJ file, with its normals and texture coordinates, and the group of each triangle.
PartedMesh loadGroups(const std::string& path);
// The same from the bytes of a file; `path` is for messages.
PartedMesh decodeParts(const std::string& path, const std::string& text, int levels);

// Removes the part below a plane, where dot(normal, p) < offset, cuts the triangles that cross it, and closes
// each hole of the cut part with triangles of a new part called `cap`, whose normals face down the plane and
// whose UVs are 0. The cut must be one closed, star-shaped curve, as that of a neck is; an open curve is not
// closed.
void cutAndClose(PartedMesh& mesh, const std::string& part, const float (&normal)[3], float offset,
                 const std::string& cap);

}  // namespace pellucid::io
