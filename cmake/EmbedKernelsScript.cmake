# Run by EmbedKernels.cmake at build time: writes OUT, a C++ file with the text of FILES (relative to ROOT).
set(body "")
foreach(f ${FILES})
  file(READ ${ROOT}/${f} hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  string(MAKE_C_IDENTIFIER ${f} id)
  string(APPEND body "static const unsigned char ${id}[] = {${bytes}0};\n")
  string(APPEND table "    {\"${f}\", {reinterpret_cast<const char*>(${id}), sizeof(${id}) - 1}},\n")
endforeach()
file(WRITE ${OUT}.tmp "// Written by cmake/EmbedKernelsScript.cmake from kernels/: do not edit.
#include \"cl/kernel_files.h\"
${body}
namespace pel::cl {
static const KernelFile files[] = {
${table}};
std::span<const KernelFile> kernelFiles() { return files; }
}  // namespace pel::cl
")
file(RENAME ${OUT}.tmp ${OUT})
