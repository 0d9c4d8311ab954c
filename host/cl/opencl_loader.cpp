// Stands in for libOpenCL: the functions of OpenCL that Pellucid calls. Only clGetPlatformIDs needs a
// library, which is the system's loader or a driver. Every OpenCL object begins with a pointer to its
// driver's table of functions (cl_khr_icd), and all other calls use that table, as loaders do. So objects of
// a host's own loader work, too.
#include "cl/opencl_loader.h"

#define CL_USE_DEPRECATED_OPENCL_1_0_APIS  // the tables list them
#define CL_USE_DEPRECATED_OPENCL_1_1_APIS
#include <CL/cl.h>
#include <CL/cl_icd.h>

#include <algorithm>

#include "system/process.h"

namespace pel::cl {
namespace {

#ifdef _WIN32
constexpr char separator = ';';
constexpr const char* usual = "OpenCL.dll";
constexpr const char* advice = "install the driver of your GPU's or CPU's vendor, which includes it";
#elif defined(__APPLE__)
constexpr char separator = ':';
constexpr const char* usual =
    "libOpenCL.1.dylib:libOpenCL.dylib:/opt/homebrew/lib/libOpenCL.dylib:/System/Library/Frameworks/"
    "OpenCL.framework/OpenCL";
constexpr const char* advice = "install it and a driver for the CPU (brew install opencl-icd-loader pocl)";
#else
constexpr char separator = ':';
constexpr const char* usual = "libOpenCL.so.1:libOpenCL.so";
constexpr const char* advice =
    "install it (Debian and Ubuntu: apt-get install ocl-icd-libopencl1, Fedora: dnf install ocl-icd) and a "
    "driver, for example PoCL for the CPU (pocl-opencl-icd, pocl); in Python, pip install 'pellucid[cpu]' "
    "installs both";
#endif

using GetPlatforms = cl_int(CL_API_CALL*)(cl_uint, cl_platform_id*, cl_uint*);

struct Library {
    void* handle = nullptr;
    GetPlatforms getPlatforms = nullptr;
    std::string why;  // the reason if none was found
};

std::vector<std::string> namesOf(const std::string& list) {
    std::vector<std::string> names;
    for (size_t from = 0, to; from < list.size(); from = to + 1) {
        to = std::min(list.find(separator, from), list.size());
        if (to > from) names.push_back(list.substr(from, to - from));
    }
    return names;
}

GetPlatforms entryOf(void* library) {
    if (void* const entry = system::symbolIn(library, "clGetPlatformIDs"))
        return reinterpret_cast<GetPlatforms>(entry);
    // A driver without a loader's functions.
    using Extension = void*(CL_API_CALL*)(const char*);
    const auto extension =
        reinterpret_cast<Extension>(system::symbolIn(library, "clGetExtensionFunctionAddress"));
    return extension ? reinterpret_cast<GetPlatforms>(extension("clIcdGetPlatformIDsKHR")) : nullptr;
}

// The first library with a platform, else the first one.
Library find() {
    const char* const named = std::getenv("PELLUCID_OPENCL");
    const std::string list = named && *named ? named : usual;
    Library found;
    for (const std::string& name : namesOf(list)) {
        std::string why;
        void* const library = system::openLibrary(name, why);
        const GetPlatforms entry = library ? entryOf(library) : nullptr;
        if (!entry) {
            found.why +=
                (found.why.empty() ? "" : "; ") + (library ? name + " is not an OpenCL library" : why);
            continue;
        }
        cl_uint count = 0;
        const bool some = entry(0, nullptr, &count) == CL_SUCCESS && count > 0;
        if (some || !found.getPlatforms) {
            found.handle = library;
            found.getPlatforms = entry;
        }
        if (some) break;
    }
    if (found.getPlatforms)
        found.why.clear();
    else
        found.why = "the OpenCL library cannot be loaded (" + found.why + "): " + advice +
                    (named && *named ? "; PELLUCID_OPENCL lists the libraries to try" : "");
    return found;
}

const Library& library() {
    // Never destroyed: devices may be used while the process ends.
    static const Library& found = *new Library(find());
    return found;
}

#if defined(_WIN32) || defined(__APPLE__)
// By name: objects of Wine's OpenCL.dll belong to the Linux driver, whose calling convention differs, and
// objects of Apple's framework have no table.
template <class Function>
Function* named(const char* name) {
    return reinterpret_cast<Function*>(system::symbolIn(library().handle, name));
}
#else
// The table of functions of an object's driver.
template <class Object>
const cl_icd_dispatch& of(Object object) {
    return **reinterpret_cast<const cl_icd_dispatch* const*>(object);
}
#endif

}  // namespace

std::string whyNoLoader() {
    return library().why;
}

}  // namespace pel::cl

#if defined(_WIN32) || defined(__APPLE__)
#define PEL_FUNCTION(object, name) pel::cl::named<decltype(::name)>(#name)
#else
#define PEL_FUNCTION(object, name) pel::cl::of(object).name
#endif

extern "C" {

cl_int CL_API_CALL clGetPlatformIDs(cl_uint count, cl_platform_id* platforms, cl_uint* all) {
    const auto entry = pel::cl::library().getPlatforms;
    return entry ? entry(count, platforms, all) : CL_PLATFORM_NOT_FOUND_KHR;
}

cl_context CL_API_CALL clCreateContext(const cl_context_properties* a, cl_uint b, const cl_device_id* c,
                                       void(CL_CALLBACK* d)(const char*, const void*, size_t, void*), void* e,
                                       cl_int* f) {
    return PEL_FUNCTION(c[0], clCreateContext)(a, b, c, d, e, f);
}

cl_int CL_API_CALL clWaitForEvents(cl_uint a, const cl_event* b) {
    return PEL_FUNCTION(b[0], clWaitForEvents)(a, b);
}

// The first parameter is the object. The compiler compares the others with the declarations of CL/cl.h.
#define PEL_CALL(Result, name, parameters, arguments) \
    Result CL_API_CALL name parameters {              \
        return PEL_FUNCTION(a, name) arguments;       \
    }
#define PEL_REFERENCES(Type, Object)                  \
    PEL_CALL(cl_int, clRetain##Type, (Object a), (a)) \
    PEL_CALL(cl_int, clRelease##Type, (Object a), (a))
#define PEL_INFO(name, Object, What) \
    PEL_CALL(cl_int, name, (Object a, What b, size_t c, void* d, size_t* e), (a, b, c, d, e))
#define PEL_WAITS cl_uint waits, const cl_event *list, cl_event *event
// clang-format off
PEL_REFERENCES(Context, cl_context)
PEL_REFERENCES(CommandQueue, cl_command_queue)
PEL_REFERENCES(MemObject, cl_mem)
PEL_REFERENCES(Program, cl_program)
PEL_REFERENCES(Kernel, cl_kernel)
PEL_REFERENCES(Event, cl_event)
PEL_INFO(clGetPlatformInfo, cl_platform_id, cl_platform_info)
PEL_INFO(clGetDeviceInfo, cl_device_id, cl_device_info)
PEL_INFO(clGetCommandQueueInfo, cl_command_queue, cl_command_queue_info)
PEL_INFO(clGetMemObjectInfo, cl_mem, cl_mem_info)
PEL_INFO(clGetImageInfo, cl_mem, cl_image_info)
PEL_INFO(clGetProgramInfo, cl_program, cl_program_info)
PEL_INFO(clGetEventInfo, cl_event, cl_event_info)
PEL_INFO(clGetEventProfilingInfo, cl_event, cl_profiling_info)
PEL_CALL(cl_int, clGetDeviceIDs, (cl_platform_id a, cl_device_type b, cl_uint c, cl_device_id* d, cl_uint* e),
         (a, b, c, d, e))
PEL_CALL(cl_command_queue, clCreateCommandQueue,
         (cl_context a, cl_device_id b, cl_command_queue_properties c, cl_int* d), (a, b, c, d))
PEL_CALL(cl_mem, clCreateBuffer, (cl_context a, cl_mem_flags b, size_t c, void* d, cl_int* e),
         (a, b, c, d, e))
PEL_CALL(cl_int, clSetMemObjectDestructorCallback,
         (cl_mem a, void (CL_CALLBACK* b)(cl_mem, void*), void* c), (a, b, c))
PEL_CALL(cl_program, clCreateProgramWithSource,
         (cl_context a, cl_uint b, const char** c, const size_t* d, cl_int* e), (a, b, c, d, e))
PEL_CALL(cl_program, clCreateProgramWithBinary,
         (cl_context a, cl_uint b, const cl_device_id* c, const size_t* d, const unsigned char** e, cl_int* f,
          cl_int* g), (a, b, c, d, e, f, g))
PEL_CALL(cl_int, clBuildProgram,
         (cl_program a, cl_uint b, const cl_device_id* c, const char* d,
          void (CL_CALLBACK* e)(cl_program, void*), void* f), (a, b, c, d, e, f))
PEL_CALL(cl_int, clGetProgramBuildInfo,
         (cl_program a, cl_device_id b, cl_program_build_info c, size_t d, void* e, size_t* f),
         (a, b, c, d, e, f))
PEL_CALL(cl_kernel, clCreateKernel, (cl_program a, const char* b, cl_int* c), (a, b, c))
PEL_CALL(cl_int, clSetKernelArg, (cl_kernel a, cl_uint b, size_t c, const void* d), (a, b, c, d))
PEL_CALL(cl_int, clFlush, (cl_command_queue a), (a))
PEL_CALL(cl_int, clFinish, (cl_command_queue a), (a))
PEL_CALL(cl_int, clEnqueueReadBuffer,
         (cl_command_queue a, cl_mem b, cl_bool c, size_t d, size_t e, void* f, PEL_WAITS),
         (a, b, c, d, e, f, waits, list, event))
PEL_CALL(cl_int, clEnqueueWriteBuffer,
         (cl_command_queue a, cl_mem b, cl_bool c, size_t d, size_t e, const void* f, PEL_WAITS),
         (a, b, c, d, e, f, waits, list, event))
PEL_CALL(cl_int, clEnqueueFillBuffer,
         (cl_command_queue a, cl_mem b, const void* c, size_t d, size_t e, size_t f, PEL_WAITS),
         (a, b, c, d, e, f, waits, list, event))
PEL_CALL(cl_int, clEnqueueCopyBuffer,
         (cl_command_queue a, cl_mem b, cl_mem c, size_t d, size_t e, size_t f, PEL_WAITS),
         (a, b, c, d, e, f, waits, list, event))
PEL_CALL(cl_int, clEnqueueCopyImageToBuffer,
         (cl_command_queue a, cl_mem b, cl_mem c, const size_t* d, const size_t* e, size_t f, PEL_WAITS),
         (a, b, c, d, e, f, waits, list, event))
PEL_CALL(cl_int, clEnqueueCopyBufferToImage,
         (cl_command_queue a, cl_mem b, cl_mem c, size_t d, const size_t* e, const size_t* f, PEL_WAITS),
         (a, b, c, d, e, f, waits, list, event))
PEL_CALL(void*, clEnqueueMapBuffer,
         (cl_command_queue a, cl_mem b, cl_bool c, cl_map_flags d, size_t e, size_t f, PEL_WAITS, cl_int* g),
         (a, b, c, d, e, f, waits, list, event, g))
PEL_CALL(cl_int, clEnqueueUnmapMemObject, (cl_command_queue a, cl_mem b, void* c, PEL_WAITS),
         (a, b, c, waits, list, event))
PEL_CALL(cl_int, clEnqueueNDRangeKernel,
         (cl_command_queue a, cl_kernel b, cl_uint c, const size_t* d, const size_t* e, const size_t* f,
          PEL_WAITS), (a, b, c, d, e, f, waits, list, event))
PEL_CALL(cl_int, clEnqueueMarkerWithWaitList, (cl_command_queue a, PEL_WAITS), (a, waits, list, event))
PEL_CALL(cl_int, clEnqueueBarrierWithWaitList, (cl_command_queue a, PEL_WAITS), (a, waits, list, event))
// clang-format on

}  // extern "C"
