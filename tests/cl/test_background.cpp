// Programs that are built while the caller goes on (PelShaderOptions.buildInBackground), by other processes
// if the driver is PoCL: the stand-in, the switch to the materials' own methods, and errors.
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>
#include "shading/pass_scene.h"
#include "variable.h"

using namespace shade_test;
using pellucid::Device;
using pellucid::Shader;
namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;
constexpr auto patience = std::chrono::minutes(5);

// New folders for PoCL and the library, without programs of other processes. Set before OpenCL is used.
struct NewCaches {
    char folder[32] = "/tmp/pellucid-new-XXXXXX";
    NewCaches() {
        if (::mkdtemp(folder)) ::setenv("XDG_CACHE_HOME", folder, 1);
        ::unsetenv("POCL_CACHE_DIR");
        ::unsetenv("PELLUCID_CACHE_DIR");
    }
    ~NewCaches() { fs::remove_all(folder); }
} caches;

bool onPocl(const Device& on) {
    return on.info().platform == std::string("Portable Computing Language");
}

// With tables that follow from the profile, and specular light: the stand-in has neither.
Frame tableFrame() {
    Frame f = reliefFrame(1, 90, 40, 0.4f);
    f.lights.resize(1);
    f.lights[0].params.toLight[0] = 0.6f, f.lights[0].params.toLight[2] = 0.8f;
    f.slots[PEL_SLOT_CURVATURE] = f.slots[PEL_SLOT_MATERIAL];
    f.camera.position[2] = 300;
    static const pellucid::Profile skin = pellucid::Profile::skin();
    for (auto& [id, m] : f.materials) {
        m = pelMaterialDefaults();
        m.scattering = PEL_SCATTERING_PREINTEGRATED;
        m.profile = skin.get();
        m.specular = 0.3f * float(id);
    }
    f.options = pelShaderOptionsDefaults();
    f.options.buildInBackground = 1;
    return f;
}

Frame plain(Frame f) {
    f.options.buildInBackground = 0;
    for (auto& [id, m] : f.materials) {
        m.scattering = PEL_SCATTERING_NONE;
        m.specular = 0;
    }
    return f;
}

struct Running {
    Shader shader;
    Buffer target;
    Running(const Device& on, const Frame& f) : shader(on) {
        setFrame(on, shader, f, {});
        target = setTarget(on, shader, f);
    }
    std::vector<float> picture() {
        shader.execute();
        return target.readAll<float>();
    }
    // Frame after frame until the method itself has shaded one.
    std::vector<float> last(bool committing = false) {
        const auto begin = Clock::now();
        for (std::vector<float> seen;; std::this_thread::sleep_for(std::chrono::milliseconds(20))) {
            if (committing) shader.commit();
            seen = picture();
            if (!shader.stats().standsIn) return seen;
            if (Clock::now() - begin > patience) return {};
        }
    }
};

std::vector<float> waitedFor(const Device& on, Frame f) {
    f.options.buildInBackground = 0;
    return shade(on, f, {});
}

// Whether this process has children left.
bool hasChildren() {
    return ::waitpid(-1, nullptr, WNOHANG) >= 0 || errno != ECHILD;
}

TEST(Background, NoneStandsInUntilTheMethodTakesOver) {
    const Device own("");
    const Frame f = tableFrame();
    Running running(own, f);
    running.shader.commit();
    PelShaderStats stats = running.shader.stats();
    ASSERT_EQ(stats.standsIn, 1u);
    EXPECT_FALSE(stats.features & (PEL_FEATURE_SPECULAR | PEL_FEATURE_DIRECT_SCATTER));
    EXPECT_NE(running.shader.warnings().find("\"none\""), std::string::npos) << running.shader.warnings();
    const auto first = running.picture();
    const bool stood = running.shader.stats().standsIn;
    const auto last = running.last();
    stats = running.shader.stats();
    EXPECT_EQ(stats.standsIn, 0u);
    EXPECT_TRUE(stats.features & PEL_FEATURE_SPECULAR && stats.features & PEL_FEATURE_DIRECT_SCATTER);
    EXPECT_EQ(running.shader.warnings().find("\"none\""), std::string::npos);
    const auto truth = waitedFor(own, f), lambert = shade(own, plain(f), {});
    EXPECT_EQ(last, truth);
    EXPECT_TRUE(stood);
    EXPECT_EQ(first, lambert);
    EXPECT_NE(first, last);
    // With all programs in memory, or on disk for other devices, there is no stand-in.
    Running again(own, f);
    again.shader.commit();
    EXPECT_EQ(again.shader.stats().standsIn, 0u);
    EXPECT_EQ(again.picture(), truth);
    const Device other("");
    if (!onPocl(other)) return;
    Running there(other, f);
    there.shader.commit();
    EXPECT_EQ(there.shader.stats().standsIn, 0u);
    EXPECT_EQ(there.picture(), truth);
}

// Host memory whose use after its release is a fault.
class FaultingMemory {
  public:
    explicit FaultingMemory(const std::vector<float>& values) : bytes_(values.size() * sizeof(float)) {
        void* const pages =
            ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (pages == MAP_FAILED) throw std::bad_alloc();
        values_ = static_cast<float*>(pages);
        std::ranges::copy(values, values_);
    }
    FaultingMemory(FaultingMemory&& other) noexcept
        : bytes_(other.bytes_), values_(std::exchange(other.values_, nullptr)) {}
    ~FaultingMemory() {
        if (values_) ::munmap(values_, bytes_);
    }
    void go() const { ::mprotect(values_, bytes_, PROT_NONE); }
    pellucid::OwnedImage image(const Device& on, PelFormat format, uint32_t width, uint32_t height) const {
        return imageDesc(Buffer::fromHost(on, values_, bytes_), format, width, height);
    }

  private:
    size_t bytes_;
    float* values_;
};

// Light space, which marks what the shadow map sees in launches over the whole frame; and a choice by the
// pixels of the material image.
TEST(Background, TheCallersImagesMayGoWhileProgramsAreBuilt) {
    const Device own("");
    if (!onPocl(own)) GTEST_SKIP() << "other drivers may copy host memory back when they release it";
    Frame f = tableFrame();
    f.lights[0].params.toLight[0] = 0, f.lights[0].params.toLight[2] = 1;
    f.lights[0].mapSize = 32;
    f.lights[0].map.values.assign(32 * 32, 0.2f);
    f.lights[0].map.components = 1;
    const float toMap[16] = {1 / 40.f, 0, 0, 0, 0, 1 / 20.f, 0, 0, 0, 0, -0.02f, 1, 0, 0, 0, 1};
    std::copy_n(toMap, 16, f.lights[0].params.worldToShadow);
    f.lights[0].params.shadowDepthRange = 50;
    for (const bool chosen : {false, true}) {
        SCOPED_TRACE(chosen);
        for (auto& [id, m] : f.materials) m.scattering = chosen ? PEL_SCATTERING_AUTO : PEL_SCATTERING_LIGHT;
        f.options.timeBudget = chosen ? 1e3f : 0.0f;
        Running running(own, f);
        std::vector<FaultingMemory> given;
        for (const PelImageSlot slot : {PEL_SLOT_POSITION, PEL_SLOT_NORMAL_SHADING, PEL_SLOT_MATERIAL}) {
            const auto& values = f.slots[slot].values;
            const uint32_t components = f.slots[slot].components;
            given.emplace_back(values);
            running.shader.set(slot, given.back().image(own, floatFormats[components], f.width, f.height));
        }
        running.shader.commit();
        EXPECT_EQ(running.shader.stats().standsIn, 1u);
        setFrame(own, running.shader, f, {});
        for (const FaultingMemory& memory : given) memory.go();
        running.shader.commit();
        EXPECT_EQ(running.last(true), waitedFor(own, f));
    }
}

// In these, PoCL has compiled the programs before, but this library kept none.
class BackgroundAgain : public testing::Test {
  protected:
    const Variable cache_{"PELLUCID_CACHE", "off"}, folder_{"PELLUCID_CACHE_DIR"},
        helper_{"PELLUCID_BUILD_HELPER"};
    void expectTakeover() const {
        const Device own("");
        const Frame f = tableFrame();
        Running running(own, f);
        running.shader.commit();
        EXPECT_EQ(running.shader.stats().standsIn, 1u);
        EXPECT_EQ(running.last(), waitedFor(own, f));
    }
};

TEST_F(BackgroundAgain, WithoutHelpersThisProcessBuilds) {
    for (const char* program : {"off", "/no/such/program", "/bin/false"}) {
        SCOPED_TRACE(program);
        helper_.set(program);
        expectTakeover();
    }
}

TEST_F(BackgroundAgain, AFolderThatCannotBeWrittenIsNoError) {
    cache_.set(nullptr);
    folder_.set("/proc/no-folder");
    expectTakeover();
}

TEST_F(BackgroundAgain, SettingsMayChangeMeanwhile) {
    const Device own("");
    Frame f = tableFrame();
    Running running(own, f);
    running.shader.commit();
    for (auto& [id, m] : f.materials) m.albedo[0] = 0.2f;
    f.lights[0].params.color[1] = 0.3f;
    setFrame(own, running.shader, f, {});
    EXPECT_THROW(running.picture(), pellucid::Error) << "not committed";
    running.shader.commit();
    EXPECT_EQ(running.last(true), waitedFor(own, f));
    // Other programs: built in turn.
    f.options.blurNormals = 1;
    setFrame(own, running.shader, f, {});
    running.shader.commit();
    EXPECT_EQ(running.shader.stats().standsIn, 1u);
    EXPECT_EQ(running.last(), waitedFor(own, f));
}

TEST_F(BackgroundAgain, EndsWithItsShader) {
    const Frame f = tableFrame();
    {
        const Device own("");
        Running running(own, f);
        running.shader.commit();
    }
    EXPECT_FALSE(hasChildren());
    const Device own("");
    Running running(own, f);
    running.shader.commit();
    PelShaderOptions options = f.options;
    options.buildInBackground = 0;  // from now on it waits
    running.shader.set(options).commit();
    EXPECT_EQ(running.shader.stats().standsIn, 0u);
    EXPECT_EQ(running.picture(), waitedFor(own, f));
    EXPECT_FALSE(hasChildren());
}

TEST_F(BackgroundAgain, RefusesWhatACommitRefuses) {
    const Device own("");
    Frame f = tableFrame();
    Running running(own, f);
    running.shader.clear(PEL_SLOT_NORMAL_SHADING);
    expectRefused("shading normal image is needed", [&] { running.shader.commit(); });
}

}  // namespace
