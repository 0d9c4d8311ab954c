// Triangle meshes from OFF, OBJ, PLY and STL files, as plain arrays in the file's vertex order.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace pellucid::io {

struct MeshData {
    std::vector<float> positions;     // xyz per vertex, in the file's unit of length
    std::vector<float> normals;       // unit xyz per vertex, or empty
    std::vector<float> uvs;           // u, v per vertex, or empty
    std::vector<uint32_t> triangles;  // three indices each; polygons become fans round their first corner
    // For each vertex added at UV seams, after the file's own: the vertex that it copies
    std::vector<uint32_t> splitFrom;
    size_t trianglesTurned = 0;         // by MeshLoadOptions.orient
    std::vector<std::string> warnings;  // what was left out or repaired, one sentence each
    std::string source;                 // the file, for messages

    size_t vertexCount() const { return positions.size() / 3; }
    size_t triangleCount() const { return triangles.size() / 3; }
};

struct MeshLoadOptions {
    // OBJ files give UVs per corner. True: a vertex whose corners differ is copied, and copies come after all
    // of the file's own vertices (see splitFrom), so that a renderer can use them. False: UVs that differ are
    // not loaded, since their average is useless, and the vertices are exactly the file's.
    bool splitUvSeams = false;
    // Turns triangles that face another way than their neighbours (pelMeshOrient, by the file's normals if
    // it has some). False: they stay, with a warning.
    bool orient = false;
};

// Keeps every face, even those with non-manifold edges, which an OpenMesh mesh refuses. Throws FileError:
// file missing or damaged (with its line in text files), unknown extension, a position that is not finite, an
// index out of range, no face.
MeshData loadMesh(const std::string& path, const MeshLoadOptions& options = {});
// The same from the bytes of a file; `path` is for messages and names the format.
MeshData decodeMesh(const std::string& path, const std::string& text, const MeshLoadOptions& options = {});

// Gives each vertex texture coordinates, from u, v of each corner of `triangles`: one whose corners differ
// is copied, as by MeshLoadOptions.splitUvSeams.
void splitAtSeams(MeshData& mesh, std::span<const float> cornerUvs);

// Unit normals: face normals weighted with the corner's angle, summed over all vertices at one position, so
// that seams do not show; opposite ones cancel out. Vertices of no triangle get (0, 0, 1).
void computeNormals(MeshData& mesh);

// Splits each triangle into four, `levels` times, by OpenMesh's Loop scheme; UVs are interpolated linearly,
// normals dropped, indices of vertices kept. Throws FileError, naming the triangle, if it is not manifold.
void loopSubdivide(MeshData& mesh, int levels);

// Scales and moves so that the largest extent along `axis` (0 x, 1 y, 2 z) is `height` and the bounding box
// is centred on the origin. Returns the factor. Throws FileError when the mesh has no extent there.
float scaleToHeight(MeshData& mesh, float height, int axis);

// Writes a binary PLY: positions, normals if present, `quality` per vertex (vertexCount() values) and colours
// that show quality from `low` to `high` (scaleColor). Complete or not at all; throws
// FileError.
void writePly(const std::string& path, const MeshData& mesh, std::span<const float> quality, float low,
              float high);

}  // namespace pellucid::io
