#include "io/mesh/mesh_text.h"

#include <cstdint>
#include <cstring>

#include "io/text_scan.h"

namespace pellucid::io {
namespace {

constexpr const char* axisNames[3] = {"x", "y", "z"};

void checkPosition(const TextScan& scan, size_t firstWord) {
    for (size_t a = 0; a < 3; ++a) scan.number(firstWord + a, std::string("coordinate ") + axisNames[a]);
}

void appendWords(std::string& out, const TextScan& scan, size_t count) {
    for (size_t i = 0; i < count; ++i) out.append(i ? " " : "").append(scan.words()[i]);
    out += '\n';
}

std::string outOfRange(long long index, long long first, size_t count, std::string_view what) {
    return std::string(what) + " index " + std::to_string(index) + " is out of range: the file has " +
           std::to_string(count) + ", so " + std::to_string(first) + " to " +
           std::to_string(static_cast<long long>(count) - 1 + first) + " would be right";
}

// One corner "v", "v/vt", "v//vn" or "v/vt/vn" of an OBJ face. The counts are those of what was defined so
// far, and in all.
void checkObjCorner(const TextScan& scan, std::string_view corner, const size_t (&soFar)[3],
                    const size_t (&total)[3]) {
    constexpr const char* what[3] = {"vertex", "texture coordinate", "normal"};
    for (size_t k = 0; k < 3; ++k) {
        const size_t slash = corner.find('/');
        const std::string_view word = corner.substr(0, slash);
        if (k == 0 || !word.empty()) {
            const long long given = scan.integer(word, what[k]);
            const long long index = given < 0 ? static_cast<long long>(soFar[k]) + given + 1 : given;
            if (index < 1 || index > static_cast<long long>(total[k]))
                scan.fail(outOfRange(given, 1, total[k], what[k]));
        }
        if (slash == std::string_view::npos) return;
        corner.remove_prefix(slash + 1);
    }
    scan.fail("a corner has more than the three parts vertex/texture/normal");
}

}  // namespace

MeshText checkOff(const std::string& path, const std::string& text) {
    TextScan scan(path, text);
    if (!scan.nextLine()) scan.fail("is empty; an OFF file starts with a line 'OFF'");
    const std::string header(scan.words()[0]);
    const size_t prefix = header.find("OFF");
    if (prefix == std::string::npos || prefix + 3 != header.size()) {
        scan.fail("starts with '" + header.substr(0, 20) + "'; the first line of an OFF file is 'OFF'");
    }
    bool normals = false, uvs = false;
    const std::string flags = header.substr(0, prefix);
    if (flags != "" && flags != "C" && flags != "N" && flags != "CN" && flags != "ST" && flags != "STC" &&
        flags != "STN" && flags != "STCN")
        scan.fail("has the header '" + header + "'; OFF, NOFF, COFF, STOFF and their combinations are known");
    normals = flags.find('N') != std::string::npos;
    uvs = flags.find("ST") != std::string::npos;

    MeshText result;
    RawMesh& mesh = result.mesh.emplace();
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
        if (!scan.nextLine()) {
            scan.fail("ends early: " + std::to_string(vertices) + " vertices announced, " +
                      std::to_string(v) + " found");
        }
        checkPosition(scan, 0);
        for (size_t i = 0; i < 3; ++i) mesh.positions.push_back(scan.number(i, "coordinate"));
        if (normals)
            for (size_t i = 3; i < 6; ++i) mesh.normals.push_back(scan.number(i, "normal"));
        if (uvs) {
            // Colours come before them, in several ways.
            const size_t count = scan.words().size();
            if (count < (normals ? 6u : 3u) + 2) scan.fail("the texture coordinates are missing");
            for (size_t i = count - 2; i < count; ++i)
                mesh.uvs.push_back(scan.number(i, "texture coordinate"));
        }
    }
    mesh.faceStart.push_back(0);
    for (long long f = 0; f < faces; ++f) {
        if (!scan.nextLine()) {
            scan.fail("ends early: " + std::to_string(faces) + " faces announced, " + std::to_string(f) +
                      " found");
        }
        const long long corners = scan.integer(scan.words()[0], "number of corners");
        if (corners < 1 || static_cast<size_t>(corners) >= scan.words().size()) {
            scan.fail("the face announces " + std::to_string(corners) + " corners and lists " +
                      std::to_string(scan.words().size() - 1));
        }
        for (size_t i = 1; i <= static_cast<size_t>(corners); ++i) {
            const long long index = scan.integer(scan.words()[i], "vertex");
            if (index < 0 || index >= vertices)
                scan.fail(outOfRange(index, 0, static_cast<size_t>(vertices), "vertex"));
            mesh.corners.push_back(index);
        }
        mesh.faceStart.push_back(static_cast<uint32_t>(mesh.corners.size()));
    }
    result.faces = static_cast<size_t>(faces);
    return result;
}

MeshText checkObj(const std::string& path, const std::string& text) {
    size_t total[3] = {0, 0, 0};
    const auto kindOf = [](std::string_view word) {
        return word == "v" ? 0 : word == "vt" ? 1 : word == "vn" ? 2 : -1;
    };
    for (TextScan scan(path, text); scan.nextLine();) {
        const int kind = kindOf(scan.words()[0]);
        if (kind < 0) continue;
        ++total[kind];
        if (kind == 0) checkPosition(scan, 1);
        if (kind == 1) {
            for (size_t i = 1; i < 3; ++i) scan.number(i, "texture coordinate");
        }
        if (kind == 2) {
            for (size_t i = 1; i < 4; ++i) scan.number(i, "normal");
        }
    }
    MeshText result;
    size_t soFar[3] = {0, 0, 0};
    bool materials = false;
    const auto isMaterial = [](std::string_view word) { return word == "mtllib" || word == "usemtl"; };
    for (TextScan scan(path, text); scan.nextLine();) {
        const int kind = kindOf(scan.words()[0]);
        materials |= isMaterial(scan.words()[0]);
        if (kind >= 0) ++soFar[kind];
        if (scan.words().back().back() == '\\')
            scan.fail("lines continued with '\\' are not supported; join them");
        if (scan.words()[0] != "f") continue;
        ++result.faces;
        if (scan.words().size() < 4) scan.fail("a face needs at least three corners");
        for (size_t i = 1; i < scan.words().size(); ++i) checkObjCorner(scan, scan.words()[i], soFar, total);
    }
    if (materials) {  // OpenMesh would open the files that they name
        result.canonical.emplace();
        for (TextScan scan(path, text); scan.nextLine();)
            if (!isMaterial(scan.words()[0])) appendWords(*result.canonical, scan, scan.words().size());
    }
    return result;
}

MeshText checkStl(const std::string& path, const std::string& text) {
    MeshText result;
    constexpr size_t headerBytes = 84, facetBytes = 50;  // of a binary STL
    if (text.size() >= headerBytes) {
        uint32_t facets;
        std::memcpy(&facets, text.data() + 80, 4);
        if (text.size() == headerBytes + facetBytes * static_cast<size_t>(facets)) {
            for (uint32_t f = 0; f < facets; ++f) {
                float corners[9];
                std::memcpy(corners, text.data() + headerBytes + facetBytes * f + 12, sizeof corners);
                for (float c : corners) {
                    if (!std::isfinite(c)) {
                        throw FileError(path,
                                        "facet " + std::to_string(f) +
                                            " (counted from 0) has a coordinate that is NaN or infinite");
                    }
                }
            }
            result.faces = facets;
            result.binary = true;
            return result;
        }
    }
    TextScan scan(path, text);
    if (!scan.nextLine() || scan.words()[0] != "solid") {
        throw FileError(path, "is not an STL file: it neither starts with 'solid' nor has the " +
                                  std::to_string(headerBytes) + " + 50 x facets bytes of a binary one (" +
                                  std::to_string(text.size()) + " bytes: cut off?)");
    }
    size_t inFacet = 0;
    bool ended = false;
    while (scan.nextLine()) {
        const std::string_view word = scan.words()[0];
        if (word == "facet") inFacet = 0;
        if (word == "vertex") {
            checkPosition(scan, 1);
            ++inFacet;
        }
        if (word == "endfacet") {
            if (inFacet != 3)
                scan.fail("a facet has " + std::to_string(inFacet) + " vertices; 3 would be right");
            ++result.faces;
        }
        ended = word == "endsolid";
    }
    if (!ended) scan.fail("ends without 'endsolid': the file was cut off");
    return result;
}

}  // namespace pellucid::io
