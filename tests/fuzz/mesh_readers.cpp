#include <cstring>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "fuzz/readers.h"
#include "io/file_error.h"
#include "io/mesh/mesh_parts.h"

namespace fuzz {

using namespace pellucid;

static Reader mesh(const std::string& extension, std::vector<std::string> seeds,
                   std::vector<std::string> words) {
    return {extension,
            std::move(seeds),
            [file = "m." + extension](const std::string& bytes) {
                io::MeshData mesh = io::decodeMesh(file, bytes, {true});
                if (!mesh.uvs.empty() && mesh.uvs.size() != 2 * mesh.vertexCount())
                    throw std::logic_error("texture coordinates of another number of vertices");
                if (mesh.normals.empty()) io::computeNormals(mesh);
                for (const std::vector<float>* values : {&mesh.positions, &mesh.normals})
                    for (float x : *values)
                        if (!std::isfinite(x))
                            throw std::logic_error("a position or normal that is not finite");
                for (uint32_t t : mesh.triangles)
                    if (t >= mesh.vertexCount())
                        throw std::logic_error("a triangle of a vertex that there is not");
                io::decodeMesh(file, bytes, {false});
                try {
                    io::loopSubdivide(mesh, 1);
                } catch (const io::FileError&) {  // not manifold
                }
            },
            {},
            std::move(words)};
}

// XXH32, behind 8 + 4 + 24 bytes of header, as host/mesh/mesh_topology_file.cpp has it.
static std::string mendTopology(std::string b) {
    constexpr size_t sumAt = 36, start = sumAt + 4 + sizeof(PelMeshReport);
    if (b.size() < start) return b;
    const uint32_t hash = XXH32(b.data() + start, (b.size() - start) / 4 * 4, 0);
    std::memcpy(b.data() + sumAt, &hash, 4);
    return b;
}

void addMeshes(std::vector<Reader>& all, const Folder& folder) {
    all.push_back(
        mesh("off",
             {"OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n4 0 1 2 3\n",
              "STNOFF\n# c\n3 1 0\n0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n0 1 0 0 0 1 0 1\n3 0 1 2 255 0 0\n",
              "COFF 3 1 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2\n"},
             {"STOFF", "NOFF", "COFF", "STCNOFF", "BINARY", "4OFF", "nan", "-1", "99999999999", "#"}));
    all.push_back(mesh("obj",
                       {"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 "
                        "1\nusemtl x\nf 1/1/1 2/2/1 3/3/1\nf -4//1 -3//1 -1//1\nf 1 2 3 4\n",
                        "o a\ng b\ns off\nv 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nvt 0 0 0\nf 1/1 2/1 "
                        "3/1\nl 1 2\np 1\n"},
                       {"vt", "vn", "vp", "f ", "v ", "/", "//", "\\\n", "curv", "call x", "mtllib", "usemtl",
                        "-1", "nan", "1e39"}));
    all.push_back(
        {"parts",
         {"g a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nf 1 2 3 4\ng b\nf 1 2 5\nf -5 -1 -2\n"},
         [](const std::string& t) { io::decodeParts("m.obj", t, 1); },
         {},
         {"g ", "g", "f ", "v ", "-1", "99", "\n"}});
    io::MeshData data;
    data.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    data.triangles = {0, 1, 2};
    io::writePly(folder / "m.ply", data, std::vector<float>{0, 1, 2}, 0, 1);
    const std::string head =
        " 1.0\ncomment c\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty "
        "list uchar short extra\nelement face 1\nproperty list uchar int vertex_indices\nproperty double "
        "q\nelement edge 1\nproperty int a\nend_header\n";
    std::string big = "ply\nformat binary_big_endian" + head;
    for (int v = 0; v < 3; ++v) big += std::string(12, '\0') + "\x01" + std::string("\0\7", 2);
    big += std::string("\3\0\0\0\0\0\0\0\1\0\0\0\2", 13) + std::string(8, '\0') + std::string(4, '\1');
    all.push_back(
        mesh("ply",
             {bytesOf(folder / "m.ply"),
              "ply\nformat ascii" + head + "0 0 0 1 7\n1 0 0 0\n0 1 0 2 7 7\n3 0 1 2 1.5\n9\n", big},
             {"element", "property", "list", "uchar", "double", "int", "vertex", "face", "vertex_indices",
              "binary_big_endian", "4294967295", "-1", "s", "t", "nx"}));
    std::string binaryStl(80, 'x');
    binaryStl += std::string("\1\0\0\0", 4);
    const float facet[12] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
    binaryStl.append(reinterpret_cast<const char*>(facet), sizeof facet).append(2, '\0');
    all.push_back(mesh("stl",
                       {"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
                        "0\nendloop\nendfacet\nendsolid a\n",
                        binaryStl},
                       {"solid", "facet", "vertex", "endfacet", "endsolid", "outer loop", "nan"}));
}

Reader topology(const Device& device) {
    // A tetrahedron and a square whose corners are met twice.
    const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 2, 0, 0,
                                          3, 0, 0, 3, 1, 0, 2, 0, 0, 3, 1, 0, 2, 1, 0};
    const std::vector<uint32_t> triangles = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 4, 5, 6, 7, 8, 9};
    std::vector<std::string> seeds;
    for (PelWeld weld : {PEL_WELD_NONE, PEL_WELD_EXACT}) {
        PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
        desc.indices = triangles.data();
        desc.numIndices = triangles.size();
        desc.numVertices = uint32_t(positions.size() / 3);
        desc.weld = weld;
        desc.positions = positions.data();
        const std::vector<char> bytes = MeshTopology(device, desc).save();
        seeds.emplace_back(bytes.begin(), bytes.end());
    }
    return {"topology",
            std::move(seeds),
            [device, positions](const std::string& bytes) {
                PelMeshReport report = pelMeshReportDefaults();
                const MeshTopology t = MeshTopology::load(device, bytes.data(), bytes.size(), &report);
                if (report.vertices > 100000) return;
                std::vector<float> all(3 * size_t(report.vertices));
                for (size_t i = 0; i < all.size(); ++i) all[i] = positions[i % positions.size()];
                if (all.empty()) return;
                const Buffer p(device, all), result(device, std::vector<float>(report.vertices));
                t.curvature(pelCurvatureParamsDefaults(), vertexView(p, report.vertices),
                            vertexView(result, report.vertices));
            },
            mendTopology,
            {}};
}

}  // namespace fuzz
