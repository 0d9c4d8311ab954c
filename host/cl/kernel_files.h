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

// The files one after another. An #include "..." line becomes the file that it names in kernels/, once.
std::string kernelSource(std::span<const std::string> names);

}  // namespace pel::cl
