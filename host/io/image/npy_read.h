// Reads NumPy arrays.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace pellucid::io {

struct NpyArray {
    std::vector<size_t> shape;
    std::vector<float> values;  // C order
};

// Little-endian float16, float32, float64 or uint8 (values 0 to 255 unchanged), C order. Throws FileError:
// missing, damaged or truncated file, another type or order.
NpyArray readNpy(const std::string& path);

}  // namespace pellucid::io
