// For LD_PRELOAD: a driver that hangs or crashes when one kernel is created.
//   BAD_KERNEL   the name of that kernel
//   BAD_ENDING   hang, or crash
#include <CL/cl.h>
#include <dlfcn.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

extern "C" __attribute__((visibility("default"))) cl_kernel clCreateKernel(cl_program program,
                                                                           const char* name, cl_int* code) {
    const char *bad = std::getenv("BAD_KERNEL"), *ending = std::getenv("BAD_ENDING");
    if (bad && ending && std::strcmp(bad, name) == 0) {
        while (std::strcmp(ending, "hang") == 0) ::pause();
        std::abort();
    }
    return reinterpret_cast<decltype(clCreateKernel)*>(dlsym(RTLD_NEXT, "clCreateKernel"))(program, name,
                                                                                           code);
}
