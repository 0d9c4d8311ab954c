// Every allocation of a shader fails, alone or with all that come after it: an error each time, or less
// memory at a time, and nothing broken after it.
//
// This program defines operator new and OpenCL calls itself, which are linked before the others: they count
// calls of the library, and let one of them fail.
#include <CL/cl.h>
#include <dlfcn.h>
#include "test.h"

#include "pass_scene.h"

using namespace shade_test;

namespace {

enum class Fault { none, hostMemory, deviceMemory, launch, kernel };
std::atomic<Fault> fault{Fault::none};
std::atomic<int> countdown{0}, calls{0};
std::atomic<bool> lasting{false};
std::atomic<void*> libraryBase{nullptr};

bool inLibrary(void* address) {
    Dl_info info{};
    return dladdr(address, &info) && info.dli_fbase == libraryBase.load();
}

// Whether this call is the one to fail.
bool strikes(Fault kind) {
    if (fault.load() != kind) return false;
    ++calls;
    const int left = --countdown;
    return left == 0 || (left < 0 && lasting);
}

template <class F>
F* next(const char* name) {
    return reinterpret_cast<F*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

// Not inlined: the compiler would see free() of what it takes for another allocator's memory.
[[gnu::noinline]] void* operator new(size_t bytes) {
    if (fault.load() == Fault::hostMemory && inLibrary(__builtin_return_address(0)) &&
        strikes(Fault::hostMemory))
        throw std::bad_alloc();
    if (void* memory = std::malloc(bytes ? bytes : 1)) return memory;
    throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(size_t bytes, const std::nothrow_t&) noexcept {
    try {
        return operator new(bytes);
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, size_t) noexcept {
    std::free(memory);
}

extern "C" {
#pragma GCC visibility push(default)
cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, size_t bytes, void* host, cl_int* code) {
    if (strikes(Fault::deviceMemory)) {
        if (code) *code = CL_MEM_OBJECT_ALLOCATION_FAILURE;
        return nullptr;
    }
    return next<decltype(clCreateBuffer)>("clCreateBuffer")(context, flags, bytes, host, code);
}
cl_kernel clCreateKernel(cl_program program, const char* name, cl_int* code) {
    if (strikes(Fault::kernel)) {
        if (code) *code = CL_OUT_OF_HOST_MEMORY;
        return nullptr;
    }
    return next<decltype(clCreateKernel)>("clCreateKernel")(program, name, code);
}
cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                              const size_t* offset, const size_t* global, const size_t* local, cl_uint waits,
                              const cl_event* list, cl_event* event) {
    if (strikes(Fault::launch)) return CL_MEM_OBJECT_ALLOCATION_FAILURE;
    return next<decltype(clEnqueueNDRangeKernel)>("clEnqueueNDRangeKernel")(
        queue, kernel, dimensions, offset, global, local, waits, list, event);
}
#pragma GCC visibility pop
}

namespace {

using Case = std::pair<Fault, bool>;  // the second: all calls after it fail, too
class ShadeFaults : public testing::TestWithParam<Case> {};

TEST_P(ShadeFaults, EachAllocationInTurn) {
    const auto [kind, lasts] = GetParam();
    lasting = lasts;
    Dl_info info{};
    ASSERT_TRUE(dladdr(reinterpret_cast<void*>(&pelShaderCommit), &info));
    libraryBase = info.dli_fbase;
    MapLight from = mapLight(3, false, false, {0.5, 0.2, 0.9}, {24, 10, 5}, 70, 61);
    Frame f = reliefFrame(1, 70, 20, 0.4f);
    f.lights = {from.light};
    f.options.blurNormals = 1;
    f.curvatureLut = f.shadowLut = true;
    f.slots[PEL_SLOT_CURVATURE] = f.slots[PEL_SLOT_MATERIAL];
    f.cube = {2, std::vector<Rgb>(24, Rgb{0.25, 0.5, 0.125})};
    const auto right = shade(f);  // the programs are built by now

    Shader shader(device());
    const Buffer target(device(), f.pixels() * 12), curvature(device(), f.slots[PEL_SLOT_CURVATURE].values);
    setFrame(shader, f, target);
    shader.commit();
    int failures = 0, recovered = 0;
    for (int n = 1; n < 2000; ++n) {
        // A new shader, so that everything is allocated anew.
        Shader fresh;
        calls = 0;
        countdown = n;
        fault = kind;
        PelError code = PEL_SUCCESS;
        std::string message;
        try {
            fresh = Shader(device());
            setFrame(fresh, f, target);
            fresh.commit().execute();
        } catch (const pellucid::Error& e) {
            fault = Fault::none;
            code = e.code();
            message = e.what();
        }
        fault = Fault::none;
        if (countdown > 0) {  // there are no more calls than that
            EXPECT_EQ(code, PEL_SUCCESS) << message;
            break;
        }
        ++failures;
        if (code == PEL_SUCCESS) {  // the passes' images were made in bands instead
            ++recovered;
            EXPECT_EQ(target.readAll<float>(), right) << "call " << n;
        } else {
            EXPECT_EQ(code, PEL_ERROR_OUT_OF_MEMORY) << "call " << n << ": " << message;
            EXPECT_FALSE(message.empty());
        }
        // After a failure another shader works, and so does the same one when it is executed again.
        if (n % 7 == 0) {
            shader.execute();
            EXPECT_EQ(target.readAll<float>(), right) << "after call " << n;
        }
        if (!fresh.get()) continue;
        setFrame(fresh, f, target);
        fresh.commit().execute();
        EXPECT_EQ(target.readAll<float>(), right) << "after call " << n;
    }
    std::printf("%d calls failed, each in its turn; %d times it went on with less memory\n", failures,
                recovered);
    if (lasting) {
        EXPECT_EQ(recovered, 0);
    } else if (kind != Fault::hostMemory) {
        EXPECT_GT(recovered, 2);
    }
    lasting = false;
    EXPECT_GT(failures, 3);
}

std::string nameOf(const testing::TestParamInfo<Case>& info) {
    constexpr const char* names[] = {"None", "HostMemory", "DeviceMemory", "Launch", "Kernel"};
    return names[int(info.param.first)] + std::string(info.param.second ? "FromThenOn" : "");
}

INSTANTIATE_TEST_SUITE_P(Kinds, ShadeFaults,
                         testing::Values(Case{Fault::hostMemory, false}, Case{Fault::deviceMemory, false},
                                         Case{Fault::launch, false}, Case{Fault::kernel, false},
                                         Case{Fault::deviceMemory, true}, Case{Fault::launch, true},
                                         Case{Fault::kernel, true}),
                         nameOf);

}  // namespace
