#include "io/mesh/mesh_text.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <optional>

#include "io/text_scan.h"

namespace pellucid::io {
namespace {

constexpr size_t stlHeader = 84, stlFacet = 50;  // bytes of a binary STL
constexpr const char* axisNames[3] = {"x", "y", "z"};

void readPosition(const TextScan& scan, size_t firstWord, std::vector<float>& positions) {
    for (size_t a = 0; a < 3; ++a)
        positions.push_back(scan.number(firstWord + a, std::string("coordinate ") + axisNames[a]));
}

std::string outOfRange(long long index, long long first, size_t count, std::string_view what) {
    return concat(what, " index ", index, " is out of range: the file has ", count, ", so ", first, " to ",
                  static_cast<long long>(count) - 1 + first, " would be right");
}

// Ends a face of the corners since the last one. Drops it and returns false if a vertex occurs twice.
bool endFace(RawMesh& mesh) {
    const auto first = mesh.corners.begin() + mesh.faceStart.back();
    std::vector<int64_t> sorted(first, mesh.corners.end());
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) {
        mesh.corners.erase(first, mesh.corners.end());
        ++mesh.leftOut;
        return false;
    }
    mesh.faceStart.push_back(uint32_t(mesh.corners.size()));
    return true;
}

// The lists of an OBJ file: vertices, texture coordinates, normals. A face may refer to later elements.
enum { V, VT, VN };
constexpr const char* listNames[3] = {"vertex", "texture coordinate", "normal"};

struct ObjCorner {
    long long index[3] = {0, 0, 0};  // from 1; 0: none
    long long given[3] = {0, 0, 0};  // as the file has it, for messages
};

// One corner "v", "v/vt", "v//vn" or "v/vt/vn"; `counts` hold what was defined so far.
ObjCorner readCorner(const TextScan& scan, std::string_view word, const size_t (&counts)[3]) {
    ObjCorner corner;
    for (size_t k = 0; k < 3; ++k) {
        const size_t slash = word.find('/');
        const std::string_view part = word.substr(0, slash);
        if (k == 0 || !part.empty()) {
            corner.given[k] = scan.integer(part, listNames[k]);
            corner.index[k] = corner.given[k] < 0 ? static_cast<long long>(counts[k]) + corner.given[k] + 1
                                                  : corner.given[k];
            if (corner.index[k] < 1) corner.index[k] = -1;
        }
        if (slash == std::string_view::npos) return corner;
        word.remove_prefix(slash + 1);
    }
    scan.fail("a corner has more than the three parts vertex/texture/normal");
}

struct ObjFace {
    std::vector<ObjCorner> corners;
    int line;
};

// Resolves the faces of an OBJ file after all lists have been read.
void assemble(const std::string& path, const std::vector<ObjFace>& faces, const std::vector<float>& uvs,
              const std::vector<float>& normals, RawMesh& mesh) {
    const size_t counts[3] = {mesh.positions.size() / 3, uvs.size() / 2, normals.size() / 3};
    for (const ObjFace& face : faces) {
        bool allUvs = true;
        for (const ObjCorner& c : face.corners) {
            for (size_t k = 0; k < 3; ++k)
                if (c.index[k] < 0 || c.index[k] > static_cast<long long>(counts[k]))
                    throw FileError(path, outOfRange(c.given[k], 1, counts[k], listNames[k]), face.line);
            mesh.corners.push_back(c.index[V] - 1);
            allUvs &= c.index[VT] > 0;
        }
        const size_t first = mesh.faceStart.back();
        if (!endFace(mesh)) continue;
        if (allUvs) {
            mesh.cornerUvs.resize(2 * first, 0.0f);  // faces without UVs before this one
            for (const ObjCorner& c : face.corners)
                mesh.cornerUvs.insert(mesh.cornerUvs.end(),
                                      {uvs[2 * size_t(c.index[VT]) - 2], uvs[2 * size_t(c.index[VT]) - 1]});
        }
        for (const ObjCorner& c : face.corners) {
            if (c.index[VN] == 0) continue;
            mesh.normals.resize(mesh.positions.size(), 0.0f);
            std::copy_n(&normals[3 * size_t(c.index[VN] - 1)], 3, &mesh.normals[3 * size_t(c.index[V] - 1)]);
        }
    }
    if (!mesh.cornerUvs.empty()) mesh.cornerUvs.resize(2 * mesh.corners.size(), 0.0f);
}

// STL files repeat a vertex for every facet; equal positions become one vertex.
class StlVertices {
  public:
    explicit StlVertices(RawMesh& mesh) : mesh_(mesh) {}
    void corner(const float (&p)[3]) {
        const auto [entry, isNew] =
            known_.try_emplace({p[0], p[1], p[2]}, int64_t(mesh_.positions.size() / 3));
        if (isNew) mesh_.positions.insert(mesh_.positions.end(), p, p + 3);
        mesh_.corners.push_back(entry->second);
    }

  private:
    RawMesh& mesh_;
    std::map<std::array<float, 3>, int64_t> known_;
};

// A binary STL has exactly the bytes that its header announces.
std::optional<RawMesh> readBinaryStl(const std::string& path, const std::string& text) {
    uint32_t facets = 0;
    if (text.size() >= stlHeader) std::memcpy(&facets, text.data() + 80, 4);
    if (text.size() < stlHeader || text.size() != stlHeader + stlFacet * size_t(facets)) return std::nullopt;
    RawMesh mesh;
    StlVertices vertices(mesh);
    for (uint32_t f = 0; f < facets; ++f) {
        for (size_t k = 0; k < 3; ++k) {
            float p[3];
            std::memcpy(p, text.data() + stlHeader + stlFacet * f + 12 * (k + 1), sizeof p);
            if (!(std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2])))
                throw FileError(
                    path, concat("facet ", f, " (counted from 0) has a coordinate that is NaN or infinite"));
            vertices.corner(p);
        }
        endFace(mesh);
    }
    return mesh;
}

}  // namespace

RawMesh readOff(const std::string& path, const std::string& text) {
    TextScan scan(path, text);
    if (!scan.nextLine()) scan.fail("is empty; an OFF file starts with a line 'OFF'");
    const std::string header(scan.words()[0]);
    const size_t prefix = header.find("OFF");
    if (prefix == std::string::npos || prefix + 3 != header.size())
        scan.fail("starts with '" + header.substr(0, 20) + "'; the first line of an OFF file is 'OFF'");
    const std::string flags = header.substr(0, prefix);
    constexpr std::string_view known[] = {"", "C", "N", "CN", "ST", "STC", "STN", "STCN"};
    if (std::ranges::find(known, flags) == std::end(known))
        scan.fail("has the header '" + header + "'; OFF, NOFF, COFF, STOFF and their combinations are known");
    const bool normals = flags.find('N') != std::string::npos, uvs = flags.find("ST") != std::string::npos;

    RawMesh mesh;
    size_t at = 1;
    if (scan.words().size() == 1) {
        if (!scan.nextLine())
            scan.fail("ends after its header; the numbers of vertices and faces must follow");
        at = 0;
    }
    if (scan.words().size() < at + 2) scan.fail("needs the numbers of vertices, faces and edges here");
    const long long vertices = scan.integer(scan.words()[at], "number of vertices");
    const long long faces = scan.integer(scan.words()[at + 1], "number of faces");
    if (vertices < 0 || faces < 0) scan.fail("the numbers of vertices and faces cannot be negative");

    for (long long v = 0; v < vertices; ++v) {
        if (!scan.nextLine())
            scan.fail(concat("ends early: ", vertices, " vertices announced, ", v, " found"));
        readPosition(scan, 0, mesh.positions);
        if (normals)
            for (size_t i = 3; i < 6; ++i) mesh.normals.push_back(scan.number(i, "normal"));
        if (uvs) {
            // Colours of varying length precede the texture coordinates.
            const size_t count = scan.words().size();
            if (count < (normals ? 6u : 3u) + 2) scan.fail("the texture coordinates are missing");
            for (size_t i = count - 2; i < count; ++i)
                mesh.uvs.push_back(scan.number(i, "texture coordinate"));
        }
    }
    for (long long f = 0; f < faces; ++f) {
        if (!scan.nextLine()) scan.fail(concat("ends early: ", faces, " faces announced, ", f, " found"));
        const long long corners = scan.integer(scan.words()[0], "number of corners");
        if (corners < 1 || size_t(corners) >= scan.words().size())
            scan.fail(concat("the face announces ", corners, " corners and lists ", scan.words().size() - 1));
        for (size_t i = 1; i <= size_t(corners); ++i) {
            const long long index = scan.integer(scan.words()[i], "vertex");
            if (index < 0 || index >= vertices) scan.fail(outOfRange(index, 0, size_t(vertices), "vertex"));
            mesh.corners.push_back(index);
        }
        mesh.faceStart.push_back(uint32_t(mesh.corners.size()));
    }
    return mesh;
}

RawMesh readObj(const std::string& path, const std::string& text) {
    RawMesh mesh;
    std::vector<float> uvs, normals;
    std::vector<ObjFace> faces;
    for (TextScan scan(path, text); scan.nextLine();) {
        const std::string_view word = scan.words()[0];
        if (scan.words().back().back() == '\\')
            scan.fail("lines continued with '\\' are not supported; join them");
        if (word == "v") readPosition(scan, 1, mesh.positions);
        if (word == "vt")
            for (size_t i = 1; i < 3; ++i) uvs.push_back(scan.number(i, "texture coordinate"));
        if (word == "vn")
            for (size_t i = 1; i < 4; ++i) normals.push_back(scan.number(i, "normal"));
        if (word != "f") {
            if (std::ranges::any_of(word, [](char c) { return c >= 0 && c < ' '; }))
                scan.fail("begins with a control character; the file is damaged");
            continue;
        }
        if (scan.words().size() < 4) scan.fail("a face needs at least three corners");
        const size_t counts[3] = {mesh.positions.size() / 3, uvs.size() / 2, normals.size() / 3};
        faces.push_back({{}, scan.line()});
        for (size_t i = 1; i < scan.words().size(); ++i)
            faces.back().corners.push_back(readCorner(scan, scan.words()[i], counts));
    }
    assemble(path, faces, uvs, normals, mesh);
    return mesh;
}

RawMesh readStl(const std::string& path, const std::string& text) {
    if (std::optional<RawMesh> binary = readBinaryStl(path, text)) return std::move(*binary);
    RawMesh mesh;
    StlVertices vertices(mesh);
    TextScan scan(path, text);
    if (!scan.nextLine() || scan.words()[0] != "solid")
        throw FileError(path,
                        concat("is not an STL file: it neither starts with 'solid' nor has the ", stlHeader,
                               " + 50 x facets bytes of a binary one (", text.size(), " bytes: cut off?)"));
    size_t inFacet = 0;
    bool ended = false;
    while (scan.nextLine()) {
        const std::string_view word = scan.words()[0];
        if (word == "vertex") {
            std::vector<float> p;
            readPosition(scan, 1, p);
            vertices.corner({p[0], p[1], p[2]});
            ++inFacet;
        }
        if (word == "endfacet") {
            if (inFacet != 3) scan.fail(concat("a facet has ", inFacet, " vertices; 3 would be right"));
            endFace(mesh);
            inFacet = 0;
        }
        ended = word == "endsolid";
    }
    if (!ended) scan.fail("ends without 'endsolid': the file was cut off");
    return mesh;
}

}  // namespace pellucid::io
