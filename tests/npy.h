// Reads NumPy .npy files (C order; little-endian float32, float64, int32, uint8) and finds the reference data
// that other people's software made. Tests of such data are skipped where the environment does not name their
// directory.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace npy {

template <class T>
struct Array {
    std::vector<size_t> shape;
    std::vector<T> data;  // row-major
    const T* row(size_t i) const { return data.data() + i * (data.size() / shape[0]); }
};

template <class T>
constexpr const char* typeCode();
template <>
constexpr const char* typeCode<float>() {
    return "<f4";
}
template <>
constexpr const char* typeCode<double>() {
    return "<f8";
}
template <>
constexpr const char* typeCode<int32_t>() {
    return "<i4";
}
template <>
constexpr const char* typeCode<uint8_t>() {
    return "|u1";
}

// Throws std::runtime_error that names the file when it is missing, is no .npy, or holds another type.
template <class T>
Array<T> read(const std::filesystem::path& path) {
    auto fail = [&](const std::string& what) { throw std::runtime_error(path.string() + ": " + what); };
    std::ifstream file(path, std::ios::binary);
    if (!file) fail("cannot be opened");
    const std::vector<char> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    if (bytes.size() < 10 || std::memcmp(bytes.data(), "\x93NUMPY", 6) != 0) fail("is not a .npy file");
    auto byte = [&](size_t i) { return size_t(uint8_t(bytes.at(i))); };
    const bool longHeader = byte(6) > 1;  // version 2 and later: four bytes of header length instead of two
    const size_t headerBegin = longHeader ? 12 : 10;
    size_t headerSize = byte(8) + 256 * byte(9);
    if (longHeader) headerSize += 65536 * byte(10) + 16777216 * byte(11);
    if (bytes.size() < headerBegin + headerSize) fail("ends within its header");
    const std::string header(bytes.data() + headerBegin, headerSize);
    if (header.find(typeCode<T>()) == std::string::npos)
        fail(std::string("is not of type ") + typeCode<T>() + ": " + header);
    if (header.find("'fortran_order': False") == std::string::npos) fail("is not in C order");

    Array<T> array;
    size_t count = 1, at = header.find('(', header.find("'shape'"));
    while (header.at(++at) != ')') {
        if (!std::isdigit(uint8_t(header[at]))) continue;
        array.shape.push_back(std::stoull(header.substr(at)));
        count *= array.shape.back();
        while (std::isdigit(uint8_t(header.at(at + 1)))) ++at;
    }
    if (bytes.size() - headerBegin - headerSize != count * sizeof(T))
        fail("its size does not match its shape");
    array.data.resize(count);
    if (count > 0) std::memcpy(array.data.data(), bytes.data() + headerBegin + headerSize, count * sizeof(T));
    return array;
}

// The directory of the reference data, if PELLUCID_ORACLE_DIR names one.
inline std::optional<std::filesystem::path> oracleDirectory() {
    const char* name = std::getenv("PELLUCID_ORACLE_DIR");
    if (!name || !*name) return std::nullopt;
    return std::filesystem::path(name);
}

}  // namespace npy

// At the top of a test: skips it without reference data, else defines the path `directory`.
#define REQUIRE_ORACLE_DIRECTORY(directory)                                                  \
    if (!npy::oracleDirectory())                                                             \
        GTEST_SKIP() << "PELLUCID_ORACLE_DIR is not set: no reference data to compare with"; \
    const std::filesystem::path directory = *npy::oracleDirectory()
