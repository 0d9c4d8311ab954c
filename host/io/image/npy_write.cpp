// The .npy format, version 1.0 (NumPy Enhancement Proposal 1).
#include <Imath/half.h>

#include <bit>
#include <functional>
#include <numeric>
#include <stdexcept>

#include "io/atomic_file.h"
#include "io/image/image_file.h"

namespace pellucid::io {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as the memory lies");

void write(const std::string& path, const char* descr, std::span<const size_t> shape, size_t count,
           const void* bytes, size_t elementBytes) {
    if (std::accumulate(shape.begin(), shape.end(), size_t{1}, std::multiplies<>()) != count) {
        throw std::invalid_argument("writeNpy: the shape does not hold " + std::to_string(count) + " values");
    }
    std::string header = std::string("{'descr': '") + descr + "', 'fortran_order': False, 'shape': (";
    for (size_t extent : shape) header += std::to_string(extent) + ", ";
    header += "), }";
    constexpr size_t preamble = 10, alignment = 64;
    header.append(alignment - 1 - (preamble + header.size()) % alignment, ' ');
    header += '\n';
    std::string out("\x93NUMPY\x01\x00", 8);
    out += static_cast<char>(header.size() & 0xff);
    out += static_cast<char>(header.size() >> 8);
    out += header;
    out.append(static_cast<const char*>(bytes), count * elementBytes);
    writeWholeFile(path, out);
}

}  // namespace

void writeNpy(const std::string& path, std::span<const size_t> shape, std::span<const float> values,
              ChannelType type) {
    if (type == ChannelType::Half) {
        const std::vector<half> halves(values.begin(), values.end());
        write(path, "<f2", shape, values.size(), halves.data(), sizeof(half));
    } else {
        write(path, "<f4", shape, values.size(), values.data(), sizeof(float));
    }
}

void writeNpy(const std::string& path, std::span<const size_t> shape, std::span<const uint8_t> values) {
    write(path, "|u1", shape, values.size(), values.data(), 1);
}

}  // namespace pellucid::io
