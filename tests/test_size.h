// Smaller meshes, tables and images where every instruction is interpreted: ./run check oclgrind sets
// PELLUCID_TEST_SMALL.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstdlib>

inline bool testsAreSmall() {
    static const bool small = std::getenv("PELLUCID_TEST_SMALL") != nullptr;
    return small;
}

// A size or a count.
template <class T>
T sized(T usual, T small) {
    return testsAreSmall() ? small : usual;
}

// The description of a table with no more texels than small tests make.
template <class Desc>
Desc sizedTable(Desc desc) {
    if (!testsAreSmall()) return desc;
    desc.width = std::min(desc.width, decltype(desc.width)(24));
    desc.height = std::min(desc.height, decltype(desc.height)(6));
    return desc;
}

// The rows of a frame: fewer where there are many pixels.
inline uint32_t sizedRows(uint32_t width, uint32_t height) {
    return width * height > 3700 ? sized(height, std::max(1500 / width, 2u)) : height;
}
