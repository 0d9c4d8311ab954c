// Every allocation of a shader fails, alone or with all that come after it: an error each time, or less
// memory at a time, and nothing broken after it.
//
// This program defines operator new itself, which is linked before the others: it lets one call of the
// library fail, as the spy does of OpenCL's.
#include <dlfcn.h>
#include "test.h"

#include "cl/refused_buffer.h"
#include "scattering_frame.h"

using namespace shade_test;
using pellucid::Profile;

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

// Each buffer in turn cannot be made while `change` is committed; then `before` gives its picture again, and
// so it does after a failure of a shader's first commit.
void expectTakenBack(const Frame& f, const std::function<void(Shader&)>& before,
                     const std::function<void(Shader&)>& change) {
    libraryBase = nullptr;
    const Buffer target(device(), f.pixels() * 12);
    const auto shade = [&](Shader& shader, const std::function<void(Shader&)>& set) {
        set(shader);
        shader.commit().execute();
        return target.readAll<float>();
    };
    const auto made = [&] {
        Shader shader(device());
        setFrame(shader, f, target);
        return shader;
    };
    Shader first = made();
    const std::vector<float> right = shade(first, before), other = shade(first, change);
    EXPECT_NE(right, other);
    for (const bool anew : {false, true})
        for (int n = 1; n < 100; ++n) {
            Shader shader = made();
            if (!anew) shade(shader, before);
            const auto [struck, code] = refuseBuffer(n, [&] {
                (anew ? before : change)(shader);
                shader.commit();
            });
            EXPECT_TRUE(code == PEL_SUCCESS || code == PEL_ERROR_OUT_OF_MEMORY) << code;
            EXPECT_EQ(shade(shader, before), right) << "call " << n << (anew ? " of the first commit" : "");
            if (!struck) break;
        }
}

TEST(ShadeChanges, FailAndAreTakenBack) {
    PelSkin thick = pelSkinDefaults();
    thick.epidermis *= 3;
    const Profile skin = Profile::skinLayers(pelSkinDefaults()), other = Profile::skinLayers(thick);
    for (const auto& [scattering, taps] : {std::pair{PEL_SCATTERING_SCREEN, 0u},
                                           {PEL_SCATTERING_SCREEN, 16u},
                                           {PEL_SCATTERING_SEPARABLE, 0u},
                                           {PEL_SCATTERING_LIGHT, 0u},
                                           {PEL_SCATTERING_AUTO, 0u}}) {
        SCOPED_TRACE(testing::Message() << scattering << ", taps " << taps);
        Frame f = scatteringFrame(scattering, 96, 40);
        if (scattering == PEL_SCATTERING_SCREEN && !taps)  // whose tables take long
            f.slots[PEL_SLOT_SKIN] = {2, std::vector<float>(2 * f.pixels(), 0.05f)};
        const auto set = [&f, taps = taps](const Profile& profile) {
            return [&, taps](Shader& shader) {
                for (auto [id, m] : f.materials) {
                    m.profile = profile.get(), m.scatterTaps = taps;
                    shader.setMaterial(id, m);
                }
            };
        };
        expectTakenBack(f, set(skin), set(other));
    }
}

TEST(ShadeChanges, AnotherUnitFailsForAllMaterials) {
    Frame f = scatteringFrame(PEL_SCATTERING_SCREEN, 96, 40);
    const Profile skin = Profile::skin();
    for (auto& [id, m] : f.materials) m.profile = skin.get(), m.shadowFilterWidth = float(id);
    f.curvatureLut = f.shadowLut = false;
    const auto unit = [&f](float unit) {
        return [&f, unit](Shader& shader) {
            PelShaderOptions options = f.options;
            options.millimetresPerUnit = unit;
            shader.set(options);
        };
    };
    expectTakenBack(f, unit(1), unit(3));
    // Tables of former units are released.
    FrameShader made = shaderOf(f);
    int64_t first = 0;
    for (int i = 1; i < 20; ++i) {
        unit(float(i))(made.shader);
        made.shader.commit().execute();
        if (i == 2) first = spy::counts().memory;
    }
    EXPECT_EQ(spy::counts().memory, first);
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
