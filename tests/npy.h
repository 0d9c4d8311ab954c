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
#include <regex>
#include <sstream>
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

// Throws std::runtime_error that names the file when it is missing, is no .npy of version 1, or holds another
// type.
template <class T>
Array<T> read(const std::filesystem::path& path) {
    const std::string type = (std::is_floating_point_v<T> ? "<f"
                              : sizeof(T) == 1            ? "|u"
                                                          : "<i") +
                             std::to_string(sizeof(T));
    std::ifstream file(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    const std::string header = bytes.substr(0, bytes.find('\n') + 1);
    std::smatch found;
    static const std::regex form(
        R"(\x93NUMPY\x01[^]*'descr': '(.*)', 'fortran_order': False, 'shape': \((.*)\))");
    if (!std::regex_search(header, found, form) || found[1] != type)
        throw std::runtime_error(path.string() + ": is no .npy file of type " + type);
    Array<T> array;
    size_t count = 1;
    std::istringstream shape(found[2]);
    for (std::string number; std::getline(shape, number, ',');)
        if (number != " " && !number.empty()) count *= array.shape.emplace_back(std::stoull(number));
    if (bytes.size() - header.size() != count * sizeof(T))
        throw std::runtime_error(path.string() + ": its size does not match its shape");
    array.data.resize(count);
    std::memcpy(array.data.data(), bytes.data() + header.size(), count * sizeof(T));
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
