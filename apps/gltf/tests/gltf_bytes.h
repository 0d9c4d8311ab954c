// Small glTF files in memory.
#pragma once
#include "test.h"

namespace gltf {

inline std::string word(uint32_t value) {
    std::string out;
    for (int i = 0; i < 4; ++i) out += char(value >> (8 * i) & 255);
    return out;
}

template <class T>
std::string bytesOf(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

inline std::string base64(const std::string& bytes) {
    const char* letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t bits = 0;
        for (size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k)
            out += i + k <= bytes.size() ? letters[bits >> (18 - 6 * k) & 63] : '=';
    }
    return out;
}

inline std::string glb(std::string json, std::string binary) {
    while (json.size() % 4) json += ' ';
    while (binary.size() % 4) binary += '\0';
    const size_t total = 12 + 8 + json.size() + (binary.empty() ? 0 : 8 + binary.size());
    return word(0x46546C67) + word(2) + word(uint32_t(total)) + word(uint32_t(json.size())) +
           word(0x4E4F534A) + json +
           (binary.empty() ? "" : word(uint32_t(binary.size())) + word(0x004E4942) + binary);
}

// A square of four corners and six indices: positions at byte 0, texture coordinates at 48, 16-bit indices
// at 80. `more`: members of the root.
inline std::string squareBuffer() {
    return bytesOf<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) + bytesOf<float>({0, 0, 1, 0, 1, 1, 0, 1}) +
           bytesOf<uint16_t>({0, 1, 2, 0, 2, 3});
}

inline std::string squareJson(const std::string& primitive = "", const std::string& nodes = R"([{"mesh":0}])",
                              const std::string& more = "", const std::string& uri = "") {
    return R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
           R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2)" +
           primitive + R"(}]}],"buffers":[{"byteLength":92)" + uri +
           R"(}],"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,)"
           R"("byteLength":32},{"buffer":0,"byteOffset":80,"byteLength":12}],)" +
           R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
           R"({"bufferView":1,"componentType":5126,"count":4,"type":"VEC2"},)" +
           R"({"bufferView":2,"componentType":5123,"count":6,"type":"SCALAR"}])" + more + "}";
}

inline std::string square(const std::string& primitive = "", const std::string& nodes = R"([{"mesh":0}])",
                          const std::string& more = "") {
    return glb(squareJson(primitive, nodes, more), squareBuffer());
}

}  // namespace gltf
