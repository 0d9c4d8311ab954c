#include "cl/cl_spy.h"

#include <CL/cl.h>
#include <dlfcn.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory_resource>
#include <mutex>
#include <string>
#include <vector>

namespace {

enum Type { contexts, queues, memory, programs, kernels, events, types };
constexpr const char* names[types] = {"contexts", "queues",  "memory objects",
                                      "programs", "kernels", "events"};
std::atomic<int64_t> live[types];
std::atomic<int64_t> memoryBytes;
std::atomic<uint64_t> buffersMade, bytesCopied, transfers, launches, bytesFilled, fills, waits, builds;
std::atomic<spy::Call> failing{spy::Call::none};
std::atomic<int> untilFailure{0};
std::atomic<bool> failsOn{false};
std::atomic<bool> warned;  // the compiler, about a kernel

// Memory of a buffer at the begin or the end of its pages, between pages that end a program which reads them.
struct Fence {
    static constexpr size_t around = size_t(1) << 20;
    size_t bytes;
    char *map, *at;
    Fence(size_t size, const void* from, bool atEnd)
        : bytes((size + 4095) / 4096 * 4096 + 2 * around),
          map(static_cast<char*>(mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0))),
          at(map + (atEnd ? bytes - around - (size + 15) / 16 * 16 : around)) {
        if (map == MAP_FAILED || mprotect(map + around, bytes - 2 * around, PROT_READ | PROT_WRITE))
            std::abort();
        if (from) std::memcpy(at, from, size);
    }
    static void CL_CALLBACK end(cl_mem, void* fence) {
        munmap(static_cast<Fence*>(fence)->map, static_cast<Fence*>(fence)->bytes);
        delete static_cast<Fence*>(fence);
    }
};

// Never destroyed: the library may launch until the very end.
struct Seen {
    std::mutex mutex;
    std::map<std::string, uint64_t> launches;
    std::vector<std::string> sources;
};
Seen& seen() {
    static Seen* const all = new Seen;
    return *all;
}

void remember(cl_uint count, const char* const* texts, const size_t* sizes) {
    std::string source;
    for (cl_uint i = 0; i < count; ++i)
        source += sizes && sizes[i] ? std::string(texts[i], sizes[i]) : std::string(texts[i]);
    const std::lock_guard lock(seen().mutex);
    seen().sources.push_back(std::move(source));
}

template <class F>
F* next(const char* name) {
    return reinterpret_cast<F*>(dlsym(RTLD_NEXT, name));
}

// Writes the program to a file that its content names, the build options first, for tests/gpu/check.py.
void dumpProgram(const char* folder, cl_program program, const char* options) {
    size_t size = 0;
    const auto info = next<decltype(clGetProgramInfo)>("clGetProgramInfo");
    if (info(program, CL_PROGRAM_SOURCE, 0, nullptr, &size) != CL_SUCCESS || size < 2) return;
    std::string source(size, '\0');
    if (info(program, CL_PROGRAM_SOURCE, size, source.data(), nullptr) != CL_SUCCESS) return;
    source.resize(size - 1);
    source = "// " + std::string(options ? options : "") + "\n" + source;
    const std::string path =
        std::string(folder) + "/" + std::to_string(std::hash<std::string>()(source)) + ".cl";
    if (std::FILE* file = std::fopen(path.c_str(), "w")) {
        std::fwrite(source.data(), 1, source.size(), file);
        std::fclose(file);
    }
}

void remember(cl_kernel kernel) {
    char name[256] = {};
    const auto info = next<decltype(clGetKernelInfo)>("clGetKernelInfo");
    if (info(kernel, CL_KERNEL_FUNCTION_NAME, sizeof name - 1, name, nullptr) != CL_SUCCESS) return;
    const std::lock_guard lock(seen().mutex);
    ++seen().launches[name];
}

template <class T>
T* refused(cl_int why, cl_int* code) {
    if (code) *code = why;
    return nullptr;
}

template <class T>
T* made(Type type, T* object) {
    if (object) ++live[type];
    return object;
}

cl_int counted(Type type, int by, cl_int code) {
    if (code == CL_SUCCESS) live[type] += by;
    return code;
}

cl_int withEvent(cl_int code, const cl_event* event) {
    if (code == CL_SUCCESS && event) ++live[events];
    return code;
}

cl_int copied(cl_int code, const cl_event* event, size_t bytes) {
    if (code == CL_SUCCESS) ++transfers, bytesCopied += bytes;
    return withEvent(code, event);
}

// References of the library to buffers; drivers may hold further references for a while.
struct Held {
    size_t bytes;
    int64_t references;
};
// Outlives every static object. Not on the heap, where it would keep the library's blocks.
std::pmr::map<cl_mem, Held>& heldBuffers() {
    static std::byte first[1 << 20];
    static auto* room = new std::pmr::monotonic_buffer_resource(first, sizeof first);
    static auto* nodes = new std::pmr::unsynchronized_pool_resource(room);
    static auto* held = new std::pmr::map<cl_mem, Held>(nodes);
    return *held;
}
std::recursive_mutex heldMutex;  // drivers may call back from a release

// The lock spans the call: another thread may be given the same address as soon as it is free.
template <class Call>
cl_int countedMemory(cl_mem h, int by, Call&& call) {
    const std::lock_guard lock(heldMutex);
    const cl_int code = call(h);
    const auto found = heldBuffers().find(h);
    if (code == CL_SUCCESS && found != heldBuffers().end() && (found->second.references += by) == 0) {
        memoryBytes -= int64_t(found->second.bytes);
        heldBuffers().erase(found);
    }
    return counted(memory, by, code);
}

// Users see a compiler's warnings on their terminal.
void lookForWarnings(cl_program program, cl_device_id device) {
    const auto info = next<decltype(clGetProgramBuildInfo)>("clGetProgramBuildInfo");
    size_t bytes = 0;
    if (info(program, device, CL_PROGRAM_BUILD_LOG, 0, nullptr, &bytes) != CL_SUCCESS) return;
    std::string log(bytes, '\0');
    info(program, device, CL_PROGRAM_BUILD_LOG, bytes, log.data(), nullptr);
    if (log.find("warning:") == std::string::npos) return;
    warned = true;
    std::fprintf(stderr, "\n%s\n", log.c_str());
}

pid_t watched = 0;

void check() {
    if (::getpid() != watched) return;  // a fork has counts of objects that are its parent's
    bool left = false;
    for (int i = 0; i < types; ++i) left |= live[i] != 0;
    if (!left && !warned) return;
    if (left) std::fprintf(stderr, "\nOpenCL objects that nobody released at the end of the program:");
    for (int i = 0; i < types; ++i)
        if (live[i] != 0) std::fprintf(stderr, " %lld %s;", static_cast<long long>(live[i]), names[i]);
    if (warned) std::fprintf(stderr, "\nkernels that compile with warnings: see above");
    std::fprintf(stderr, "\n");
    std::fflush(nullptr);
    ::_exit(1);
}

// Registered before any static object is made, and so called after the last of them is gone.
[[gnu::constructor(101)]] void watch() {
    watched = ::getpid();
    std::atexit(check);
}

}  // namespace

namespace spy {

Counts counts() {
    return {live[contexts], live[queues], live[memory], live[programs], live[kernels],
            live[events],   memoryBytes,  buffersMade,  bytesCopied,    transfers,
            launches,       bytesFilled,  fills,        waits,          builds};
}

void failAt(Call call, int nth, bool lasting) {
    failing = Call::none;
    untilFailure = nth, failsOn = lasting;
    failing = call;
}

bool strikes(Call call) {
    if (failing != call) return false;
    const int left = --untilFailure;
    return left == 0 || (left < 0 && failsOn);
}

int callsUntilFailure() {
    return untilFailure;
}

uint64_t launchesOf(const char* kernel) {
    const std::lock_guard lock(seen().mutex);
    const auto found = seen().launches.find(kernel);
    return found == seen().launches.end() ? 0 : found->second;
}

uint64_t programsWith(const char* kernel) {
    const std::lock_guard lock(seen().mutex);
    uint64_t count = 0;
    for (const std::string& source : seen().sources) count += source.find(kernel) != std::string::npos;
    return count;
}

}  // namespace spy

#pragma GCC visibility push(default)
extern "C" {

#define REAL(function) next<decltype(function)>(#function)
#define COUNT_REFERENCES(type, Type, handle)                \
    cl_int clRetain##Type(handle h) {                       \
        return counted(type, 1, REAL(clRetain##Type)(h));   \
    }                                                       \
    cl_int clRelease##Type(handle h) {                      \
        return counted(type, -1, REAL(clRelease##Type)(h)); \
    }
COUNT_REFERENCES(contexts, Context, cl_context)
COUNT_REFERENCES(queues, CommandQueue, cl_command_queue)
cl_int clRetainMemObject(cl_mem h) {
    return countedMemory(h, 1, REAL(clRetainMemObject));
}
cl_int clReleaseMemObject(cl_mem h) {
    return countedMemory(h, -1, REAL(clReleaseMemObject));
}
COUNT_REFERENCES(programs, Program, cl_program)
COUNT_REFERENCES(kernels, Kernel, cl_kernel)
COUNT_REFERENCES(events, Event, cl_event)

cl_context clCreateContext(const cl_context_properties* properties, cl_uint count,
                           const cl_device_id* devices,
                           void(CL_CALLBACK* notify)(const char*, const void*, size_t, void*), void* user,
                           cl_int* code) {
    return made(contexts, REAL(clCreateContext)(properties, count, devices, notify, user, code));
}
cl_command_queue clCreateCommandQueue(cl_context context, cl_device_id device,
                                      cl_command_queue_properties properties, cl_int* code) {
    return made(queues, REAL(clCreateCommandQueue)(context, device, properties, code));
}
cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, size_t bytes, void* host, cl_int* code) {
    if (spy::strikes(spy::Call::createBuffer))
        return refused<_cl_mem>(CL_MEM_OBJECT_ALLOCATION_FAILURE, code);
    const char* const side = std::getenv("PELLUCID_FENCE");
    Fence* const fence = side && bytes ? new Fence(bytes, host, side[0] == 'e') : nullptr;
    cl_mem buffer =
        fence ? REAL(clCreateBuffer)(context, CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes, fence->at, code)
              : REAL(clCreateBuffer)(context, flags, bytes, host, code);
    if (fence && buffer) REAL(clSetMemObjectDestructorCallback)(buffer, Fence::end, fence);
    if (buffer) {
        const std::lock_guard lock(heldMutex);
        heldBuffers()[buffer] = {bytes, 1};
        ++buffersMade, memoryBytes += int64_t(bytes);
    }
    if (buffer && (flags & CL_MEM_COPY_HOST_PTR)) ++transfers, bytesCopied += bytes;
    return made(memory, buffer);
}
cl_int clSetMemObjectDestructorCallback(cl_mem buffer, void(CL_CALLBACK* callback)(cl_mem, void*),
                                        void* user) {
    if (spy::strikes(spy::Call::destructorCallback)) return CL_INVALID_OPERATION;
    return REAL(clSetMemObjectDestructorCallback)(buffer, callback, user);
}
cl_mem clCreateImage(cl_context context, cl_mem_flags flags, const cl_image_format* format,
                     const cl_image_desc* desc, void* host, cl_int* code) {
    return made(memory, REAL(clCreateImage)(context, flags, format, desc, host, code));
}
cl_mem clCreateSubBuffer(cl_mem whole, cl_mem_flags flags, cl_buffer_create_type type, const void* info,
                         cl_int* code) {
    return made(memory, REAL(clCreateSubBuffer)(whole, flags, type, info, code));
}
cl_program clCreateProgramWithSource(cl_context context, cl_uint count, const char** texts,
                                     const size_t* sizes, cl_int* code) {
    if (texts) remember(count, texts, sizes);
    return made(programs, REAL(clCreateProgramWithSource)(context, count, texts, sizes, code));
}
cl_program clCreateProgramWithBinary(cl_context context, cl_uint count, const cl_device_id* devices,
                                     const size_t* sizes, const unsigned char** binaries, cl_int* status,
                                     cl_int* code) {
    return made(programs,
                REAL(clCreateProgramWithBinary)(context, count, devices, sizes, binaries, status, code));
}
cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id* devices, const char* options,
                      void(CL_CALLBACK* notify)(cl_program, void*), void* user) {
    ++::builds;
    if (const char* folder = std::getenv("PELLUCID_DUMP_PROGRAMS")) dumpProgram(folder, program, options);
    const cl_int code = REAL(clBuildProgram)(program, count, devices, options, notify, user);
    if (code == CL_SUCCESS && count == 1) lookForWarnings(program, devices[0]);
    return code;
}
cl_kernel clCreateKernel(cl_program program, const char* name, cl_int* code) {
    if (spy::strikes(spy::Call::createKernel)) return refused<_cl_kernel>(CL_OUT_OF_HOST_MEMORY, code);
    return made(kernels, REAL(clCreateKernel)(program, name, code));
}
cl_event clCreateUserEvent(cl_context context, cl_int* code) {
    return made(events, REAL(clCreateUserEvent)(context, code));
}
cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                              const size_t* offset, const size_t* global, const size_t* local, cl_uint waits,
                              const cl_event* list, cl_event* event) {
    if (spy::strikes(spy::Call::launch)) return CL_MEM_OBJECT_ALLOCATION_FAILURE;
    const cl_int code =
        REAL(clEnqueueNDRangeKernel)(queue, kernel, dimensions, offset, global, local, waits, list, event);
    if (code == CL_SUCCESS) ++launches, remember(kernel);
    return withEvent(code, event);
}
cl_int clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset,
                           size_t bytes, void* to, cl_uint waits, const cl_event* list, cl_event* event) {
    return copied(REAL(clEnqueueReadBuffer)(queue, buffer, blocking, offset, bytes, to, waits, list, event),
                  event, bytes);
}
cl_int clEnqueueWriteBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset,
                            size_t bytes, const void* from, cl_uint waits, const cl_event* list,
                            cl_event* event) {
    return copied(
        REAL(clEnqueueWriteBuffer)(queue, buffer, blocking, offset, bytes, from, waits, list, event), event,
        bytes);
}
cl_int clEnqueueCopyBuffer(cl_command_queue queue, cl_mem from, cl_mem to, size_t fromOffset, size_t toOffset,
                           size_t bytes, cl_uint waits, const cl_event* list, cl_event* event) {
    return copied(REAL(clEnqueueCopyBuffer)(queue, from, to, fromOffset, toOffset, bytes, waits, list, event),
                  event, bytes);
}
cl_int clEnqueueFillBuffer(cl_command_queue queue, cl_mem buffer, const void* pattern, size_t patternBytes,
                           size_t offset, size_t bytes, cl_uint waits, const cl_event* list,
                           cl_event* event) {
    ++::fills, ::bytesFilled += bytes;
    return withEvent(
        REAL(clEnqueueFillBuffer)(queue, buffer, pattern, patternBytes, offset, bytes, waits, list, event),
        event);
}
cl_int clFinish(cl_command_queue queue) {
    ++::waits;
    return REAL(clFinish)(queue);
}
cl_int clWaitForEvents(cl_uint count, const cl_event* list) {
    ++::waits;
    return REAL(clWaitForEvents)(count, list);
}
void* clEnqueueMapBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, cl_map_flags flags,
                         size_t offset, size_t bytes, cl_uint waits, const cl_event* list, cl_event* event,
                         cl_int* code) {
    void* const mapped =
        REAL(clEnqueueMapBuffer)(queue, buffer, blocking, flags, offset, bytes, waits, list, event, code);
    if (mapped && event) ++live[events];
    return mapped;
}
cl_int clEnqueueUnmapMemObject(cl_command_queue queue, cl_mem buffer, void* mapped, cl_uint waits,
                               const cl_event* list, cl_event* event) {
    return withEvent(REAL(clEnqueueUnmapMemObject)(queue, buffer, mapped, waits, list, event), event);
}
cl_int clEnqueueMarkerWithWaitList(cl_command_queue queue, cl_uint waits, const cl_event* list,
                                   cl_event* event) {
    return withEvent(REAL(clEnqueueMarkerWithWaitList)(queue, waits, list, event), event);
}
cl_int clEnqueueBarrierWithWaitList(cl_command_queue queue, cl_uint waits, const cl_event* list,
                                    cl_event* event) {
    return withEvent(REAL(clEnqueueBarrierWithWaitList)(queue, waits, list, event), event);
}

}  // extern "C"
