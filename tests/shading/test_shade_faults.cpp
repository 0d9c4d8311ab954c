// Every allocation of a shader fails, alone or with all that come after it: an error each time, or less
// memory at a time, and nothing broken after it.
//
// This program defines operator new itself, which is linked before the others: it lets one call of the
// library fail, as the spy does of OpenCL's.
#include <dlfcn.h>
#include "test.h"

#include "cl/cl_spy.h"
#include "pass_scene.h"

using namespace shade_test;

namespace {

std::atomic<void*> libraryBase{nullptr};  // where its allocations may fail

bool inLibrary(void* address) {
    Dl_info info{};
    return dladdr(address, &info) && info.dli_fbase == libraryBase.load();
}

}  // namespace

// Not inlined: the compiler would see free() of what it takes for another allocator's memory.
[[gnu::noinline]] void* operator new(size_t bytes) {
    if (libraryBase && inLibrary(__builtin_return_address(0)) && spy::strikes(spy::Call::host))
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

namespace {

using Case = std::pair<spy::Call, bool>;  // the second: all calls after it fail, too
class ShadeFaults : public testing::TestWithParam<Case> {};

TEST_P(ShadeFaults, EachAllocationInTurn) {
    const auto [kind, lasts] = GetParam();
    Dl_info info{};
    ASSERT_TRUE(dladdr(reinterpret_cast<void*>(&pelShaderCommit), &info));
    libraryBase = nullptr;  // the compiler allocates much, and a look at each caller takes it minutes
    MapLight from = mapLight(3);
    Frame f = reliefFrame(1, 70, 20, 0.4f);
    f.lights = {from.light};
    f.options.blurNormals = 1;
    f.curvatureLut = f.shadowLut = true;
    f.slots[PEL_SLOT_CURVATURE] = f.slots[PEL_SLOT_MATERIAL];
    f.cube = {2, std::vector<Rgb>(24, Rgb{0.25, 0.5, 0.125})};
    const auto right = shade(f);  // the programs are built by now
    if (kind == spy::Call::host) libraryBase = info.dli_fbase;

    Shader shader(device());
    const Buffer target(device(), f.pixels() * 12), curvature(device(), f.slots[PEL_SLOT_CURVATURE].values);
    setFrame(shader, f, target);
    shader.commit();
    const std::vector<float> none(3 * f.pixels());
    int failures = 0, recovered = 0;
    for (int n = 1; n < 2000; ++n) {
        // A new shader, so that everything is allocated anew.
        Shader fresh;
        spy::failAt(kind, n, lasts);
        PelError code = PEL_SUCCESS;
        std::string message;
        try {
            fresh = Shader(device());
            setFrame(fresh, f, target);
            fresh.commit().execute();
        } catch (const pellucid::Error& e) {
            spy::failAt(spy::Call::none, spy::callsUntilFailure());
            code = e.code();
            message = e.what();
        }
        spy::failAt(spy::Call::none, spy::callsUntilFailure());
        if (spy::callsUntilFailure() > 0) {  // there are no more calls than that
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
        // What failed to commit is not executed.
        target.write(none.data(), none.size() * sizeof none[0]);
        try {
            fresh.execute();
            EXPECT_EQ(target.readAll<float>(), right) << "after call " << n;
        } catch (const pellucid::Error& e) {
            EXPECT_EQ(e.code(), PEL_ERROR_INVALID_STATE) << e.what();
        }
        setFrame(fresh, f, target);
        fresh.commit().execute();
        EXPECT_EQ(target.readAll<float>(), right) << "after call " << n;
    }
    if (lasts) {
        EXPECT_EQ(recovered, 0);
    } else if (kind != spy::Call::host) {
        EXPECT_GT(recovered, 2);
    }
    EXPECT_GT(failures, 3);
}

std::string nameOf(const testing::TestParamInfo<Case>& info) {
    constexpr const char* names[] = {"None", "HostMemory", "DeviceMemory", "Kernel", "Launch"};
    return names[int(info.param.first)] + std::string(info.param.second ? "FromThenOn" : "");
}

INSTANTIATE_TEST_SUITE_P(Kinds, ShadeFaults,
                         testing::Values(Case{spy::Call::host, false}, Case{spy::Call::createBuffer, false},
                                         Case{spy::Call::launch, false}, Case{spy::Call::createKernel, false},
                                         Case{spy::Call::createBuffer, true}, Case{spy::Call::launch, true},
                                         Case{spy::Call::createKernel, true}),
                         nameOf);

}  // namespace
