// For LD_PRELOAD: a driver that hangs or crashes when one kernel is created, or never runs it.
//   BAD_KERNEL      the name of that kernel
//   BAD_ENDING      hang, crash, or skip
//   BAD_EXTENSIONS  all that devices say they have
#include <CL/cl.h>
#include <dlfcn.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

#define REAL(function) reinterpret_cast<decltype(function)*>(dlsym(RTLD_NEXT, #function))
#define EXPORTED extern "C" __attribute__((visibility("default")))

static bool isBad(const char* name) {
    const char* const bad = std::getenv("BAD_KERNEL");
    return bad && std::strcmp(bad, name) == 0;
}
static bool endsBy(const char* what) {
    const char* const ending = std::getenv("BAD_ENDING");
    return ending && std::strcmp(ending, what) == 0;
}

EXPORTED cl_int clGetDeviceInfo(cl_device_id device, cl_device_info what, size_t size, void* value,
                                size_t* needed) {
    const char* const said = std::getenv("BAD_EXTENSIONS");
    if (what != CL_DEVICE_EXTENSIONS || !said)
        return REAL(clGetDeviceInfo)(device, what, size, value, needed);
    if (needed) *needed = std::strlen(said) + 1;
    if (value) std::strncpy(static_cast<char*>(value), said, size);
    return CL_SUCCESS;
}

EXPORTED cl_kernel clCreateKernel(cl_program program, const char* name, cl_int* code) {
    while (isBad(name) && endsBy("hang")) ::pause();
    if (isBad(name) && endsBy("crash")) std::abort();
    return REAL(clCreateKernel)(program, name, code);
}

EXPORTED cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                                       const size_t* offset, const size_t* items, const size_t* group,
                                       cl_uint numWaits, const cl_event* waits, cl_event* done) {
    char name[64] = "";
    clGetKernelInfo(kernel, CL_KERNEL_FUNCTION_NAME, sizeof name, name, nullptr);
    if (isBad(name) && endsBy("skip")) return clEnqueueMarkerWithWaitList(queue, numWaits, waits, done);
    return REAL(clEnqueueNDRangeKernel)(queue, kernel, dimensions, offset, items, group, numWaits, waits,
                                        done);
}
