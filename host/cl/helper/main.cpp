// pellucid-build DEVICE NAME: compiles OpenCL programs for another process, whose library starts it
// (cl/build_helpers.h). DEVICE is a number among all devices, NAME what that one is called.
//
// Standard input: jobs, each two sizes (64 bits) and so many bytes: options and source. Standard output: for
// each its binary, a size and bytes; 0: it did not build.
#include <CL/cl.h>

#include <cstdint>
#include <cstring>

#include "system/process.h"

namespace {

// Of all platforms in turn; nullptr if there are fewer.
cl_device_id deviceAt(size_t index) {
    cl_platform_id platforms[64];
    cl_uint count = 0;
    if (clGetPlatformIDs(64, platforms, &count) != CL_SUCCESS) return nullptr;
    for (cl_uint i = 0; i < count && i < 64; ++i) {
        cl_device_id devices[64];
        cl_uint found = 0;
        if (clGetDeviceIDs(platforms[i], CL_DEVICE_TYPE_ALL, 64, devices, &found) != CL_SUCCESS) continue;
        if (index < found) return devices[index];
        index -= found;
    }
    return nullptr;
}

// A binary of PoCL holds the program's intermediate code as a file to be unpacked. From it PoCL would compile
// each kernel once more, for the size of its launch, and read it in each process. Under another name PoCL
// does not find it, and runs the compiled kernels.
void hideIntermediateCode(std::string& binary) {
    const std::string name = "/program.bc";
    if (const size_t at = binary.find(name); at != std::string::npos)
        binary.replace(at, name.size(), "/program.no");
}

// Empty if it does not build.
std::string binaryOf(cl_context context, cl_device_id device, const char* options, const char* source) {
    cl_program program = clCreateProgramWithSource(context, 1, &source, nullptr, nullptr);
    std::string binary;
    size_t size = 0;
    if (program && clBuildProgram(program, 1, &device, options, nullptr, nullptr) == CL_SUCCESS &&
        clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof size, &size, nullptr) == CL_SUCCESS) {
        binary.resize(size);
        char* to = binary.data();
        if (clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof to, &to, nullptr) != CL_SUCCESS)
            binary.clear();
        hideIntermediateCode(binary);
    }
    if (program) clReleaseProgram(program);
    return binary;
}

int serve(std::FILE* replies, int argc, char** argv) {
    const cl_device_id device = argc == 3 ? deviceAt(std::strtoull(argv[1], nullptr, 10)) : nullptr;
    char name[1024] = "";
    if (!replies || !device ||
        clGetDeviceInfo(device, CL_DEVICE_NAME, sizeof name, name, nullptr) != CL_SUCCESS ||
        std::strcmp(name, argv[2]) != 0)
        return 1;
    const cl_context context = clCreateContext(nullptr, 1, &device, nullptr, nullptr, nullptr);
    if (!context) return 1;
    for (uint64_t sizes[2]; std::fread(sizes, sizeof sizes, 1, stdin) == 1;) {
        std::string texts[2];
        for (int i = 0; i < 2; ++i) {
            texts[i].resize(sizes[i]);
            if (std::fread(texts[i].data(), 1, sizes[i], stdin) != sizes[i]) return 1;
        }
        const std::string binary = binaryOf(context, device, texts[0].c_str(), texts[1].c_str());
        const uint64_t size = binary.size();
        std::fwrite(&size, sizeof size, 1, replies);
        std::fwrite(binary.data(), 1, size, replies);
        if (std::fflush(replies) != 0) return 1;
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    std::FILE* const replies = pel::system::keepOutput();  // drivers may print
    std::error_code error;
    const std::string folder = pel::system::makeTemporaryFolder(
        std::filesystem::temp_directory_path(error).string(), "pellucid-build-");
    if (folder.empty()) return 1;
    // Separate from folders where other builds may have left intermediate code.
    pel::system::setVariable("POCL_CACHE_DIR", folder.c_str());
    const int status = serve(replies, argc, argv);
    std::filesystem::remove_all(folder, error);
    std::_Exit(status);  // PoCL would look for its folder
}
