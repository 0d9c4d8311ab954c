// The text of every file under kernels/, embedded at build time (cmake/EmbedKernels.cmake).
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace pel::cl {

struct KernelFile {
    std::string_view name;  // relative to kernels/, such as "lib/vector.clh"
    std::string_view text;
};

std::span<const KernelFile> kernelFiles();
const char* kernelsHash();  // changes with any byte of any file

// The files, one after the other, with their #include "..." lines replaced by the files they name (relative to kernels/), each
// once.
std::string kernelSource(std::span<const std::string> names);

}  // namespace pel::cl
