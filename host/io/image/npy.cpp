// The .npy format, versions 1.0 and 2.0 (NumPy Enhancement Proposal 1).
#include <Imath/half.h>
#include <bit>
#include <cstring>
#include <numeric>

#include "io/atomic_file.h"
#include "io/image/image_file.h"

namespace pellucid::io {
namespace {

constexpr size_t mostValues = size_t(1) << 31;

// The text between `key` and the character that ends its value, or "".
std::string entryOf(const std::string& header, const std::string& key, const char* begin, const char* end) {
    const size_t at = header.find("'" + key + "'");
    if (at == std::string::npos) return "";
    const size_t from = header.find_first_of(begin, at + key.size() + 2);
    if (from == std::string::npos) return "";
    const size_t to = header.find_first_of(end, from + 1);
    return to == std::string::npos ? "" : header.substr(from + 1, to - from - 1);
}

template <class T>
void convert(const char* from, std::vector<float>& to) {
    for (size_t i = 0; i < to.size(); ++i) {
        T value;
        std::memcpy(&value, from + i * sizeof(T), sizeof(T));
        to[i] = float(value);
    }
}

}  // namespace

NpyArray readNpy(const std::string& path) {
    const std::string file = readWholeFile(path);
    if (file.size() < 12 || file.compare(0, 6, "\x93NUMPY") != 0)
        throw FileError(path, "is not an .npy file");
    const auto byte = [&](size_t i) { return size_t(static_cast<unsigned char>(file[i])); };
    const size_t version = byte(6), preamble = version == 1 ? 10 : 12;
    if (version < 1 || version > 2)
        throw FileError(path, concat("is a .npy file of version ", version, "; 1 and 2 are known"));
    size_t length = byte(8) | byte(9) << 8;
    if (version == 2) length |= byte(10) << 16 | byte(11) << 24;
    if (length > file.size() - preamble) throw FileError(path, "is cut off in its header");
    const std::string header = file.substr(preamble, length);
    const std::string type = entryOf(header, "descr", "'", "'"),
                      order = entryOf(header, "fortran_order", ":", ","),
                      shape = entryOf(header, "shape", "(", ")");
    if (order.find("False") == std::string::npos)
        throw FileError(path, "is not in C order; save numpy.ascontiguousarray(array)");
    const size_t bytes = type == "<f2" ? 2 : type == "<f4" ? 4 : type == "<f8" ? 8 : type == "|u1" ? 1 : 0;
    if (bytes == 0)
        throw FileError(path, "holds values of type '" + type +
                                  "'; float16, float32, float64 (little-endian) and uint8 are read");
    NpyArray array;
    size_t count = 1;
    for (const char *at = shape.data(), *end = at + shape.size(); at != end;) {
        if (*at == ' ' || *at == ',') {
            ++at;
            continue;
        }
        size_t extent = 0;
        const auto read = std::from_chars(at, end, extent);
        if (read.ec != std::errc() || extent > mostValues || (extent > 0 && count > mostValues / extent))
            throw FileError(path, "has the shape (" + shape + "), which is invalid or too large");
        array.shape.push_back(extent);
        count *= extent;
        at = read.ptr;
    }
    const size_t there = file.size() - preamble - length;
    if (there != count * bytes)
        throw FileError(path, concat("holds ", there, " bytes of values; its shape needs ", count * bytes));
    if (count > inputLimit() / sizeof(float))
        throw FileError(path, tooLarge(double(count) * sizeof(float), inputLimit()));
    array.values.resize(count);
    const char* values = file.data() + preamble + length;
    if (bytes == 2) convert<half>(values, array.values);
    if (bytes == 4) convert<float>(values, array.values);
    if (bytes == 8) convert<double>(values, array.values);
    if (bytes == 1) convert<uint8_t>(values, array.values);
    return array;
}

static_assert(std::endian::native == std::endian::little, "arrays are written as the memory lies");

static void write(const std::string& path, const char* descr, std::span<const size_t> shape, size_t count,
                  const void* bytes, size_t elementBytes) {
    if (std::accumulate(shape.begin(), shape.end(), size_t{1}, std::multiplies<>()) != count)
        throw std::invalid_argument(concat("writeNpy: the shape does not hold ", count, " values"));
    std::string header = std::string("{'descr': '") + descr + "', 'fortran_order': False, 'shape': (";
    for (size_t extent : shape) header += concat(extent, ", ");
    header += "), }";
    constexpr size_t preamble = 10, alignment = 64;
    header.append(alignment - 1 - (preamble + header.size()) % alignment, ' ');
    header += '\n';
    std::string out("\x93NUMPY\x01\x00", 8);
    out += char(header.size() & 0xff);
    out += char(header.size() >> 8);
    out += header;
    out.append(static_cast<const char*>(bytes), count * elementBytes);
    writeWholeFile(path, out);
}

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
