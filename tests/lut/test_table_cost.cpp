// The overhead of a table besides arithmetic: buffers, launches, transfers, waits, and pages that the system
// maps anew.
#include <sys/resource.h>
#include "test.h"

#include "cl/cl_spy.h"

using namespace pellucid;

namespace {

constexpr uint32_t side = 512;
constexpr uint64_t tableBytes = 16ull * (side + 1) * (side + 1);

struct Kind {
    const char* name;
    std::function<Lut(const PelSubmit*)> make;
    uint64_t buffers, launches, maxBytes;  // of device memory
};

std::vector<Kind> kinds() {
    static const Profile table = Profile::table({0, 1, 2, 4}, {9, 8, 7, 4, 3, 2, 1, .5f, .2f, 0, 0, 0});
    const auto of = [](auto desc, const Profile& profile, PelCurvatureForm form = PEL_FORM_ARC) {
        desc.width = desc.height = side;
        desc.profile = profile.get();
        if constexpr (std::is_same_v<decltype(desc), PelCurvatureLutDesc>) desc.form = form;
        return [=](const PelSubmit* submit) { return Lut(device(), desc, submit); };
    };
    const PelCurvatureLutDesc curvature = pelCurvatureLutDescDefaults();
    const PelShadowLutDesc shadow = pelShadowLutDescDefaults();
    PelSpecularLutDesc specular = pelSpecularLutDescDefaults();
    specular.width = specular.height = side;
    PelEyeLutDesc eye = pelEyeLutDescDefaults();
    eye.width = 128, eye.height = 64, eye.depth = 32;
    static const Profile skin = Profile::skin();
    return {{"arc", of(curvature, skin), 3, 2, tableBytes * 3 / 2},
            {"sphere", of(curvature, skin, PEL_FORM_SPHERE), 3, 2, tableBytes * 3 / 2},
            {"shadow", of(shadow, skin), 2, 1, tableBytes + 4096},
            {"specular", [=](const PelSubmit* s) { return Lut(device(), specular, s); }, 1, 1, tableBytes},
            {"tabulated arc", of(curvature, table), 6, 2, tableBytes * 2},
            {"tabulated sphere", of(curvature, table, PEL_FORM_SPHERE), 6, 2, tableBytes * 2},
            {"tabulated shadow", of(shadow, table), 5, 2, tableBytes * 9 / 4},
            {"caustic", [=](const PelSubmit* s) { return Lut(device(), eye, s); }, 2, 2, tableBytes * 3 / 2}};
}

// Page faults of this process, in which the system hands out pages of zeros.
[[maybe_unused]] int64_t pageFaults() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_minflt;
}

}  // namespace

TEST(TableCost, Counters) {
    {
        const auto before = spy::counts().buffersMade;
        const Buffer probe(device(), 16);
        if (spy::counts().buffersMade == before)
            GTEST_SKIP() << "another library stands before the spy (Oclgrind)";
    }
    for (const Kind& kind : kinds()) {
        SCOPED_TRACE(kind.name);
        kind.make(nullptr);  // builds the program
        const PelDeviceStats stats = device().stats();
        const spy::Counts before = spy::counts();
        kind.make(nullptr);
        const spy::Counts blocking = spy::counts();
        EXPECT_EQ(blocking.buffersMade - before.buffersMade, kind.buffers);
        EXPECT_EQ(blocking.launches - before.launches, kind.launches);
        EXPECT_EQ(blocking.waits - before.waits, 1u);
        if (device().info().sharedMemory) {
            EXPECT_EQ(blocking.transfers, before.transfers);
        }
        EXPECT_EQ(blocking.programs, before.programs);
        const bool cleared = device().info().type != PEL_DEVICE_CPU && kind.name == std::string("caustic");
        EXPECT_EQ(blocking.bytesFilled - before.bytesFilled, cleared ? 4ull * 128 * 64 * 32 : 0);
        const PelDeviceStats after = device().stats();
        EXPECT_LE(after.bytesAllocated - stats.bytesAllocated, kind.maxBytes);
        EXPECT_LE(after.bytesToDevice - stats.bytesToDevice, 1200u << 10);
        EXPECT_EQ(after.bytesToHost, stats.bytesToHost);

        PelEvent made = nullptr;
        const PelSubmit submit{nullptr, 0, &made};
        const uint64_t waits = spy::counts().waits;
        const Lut lut = kind.make(&submit);
        EXPECT_EQ(spy::counts().waits, waits) << "a call that returns an event does not wait";
        Event(made).wait();
    }
}

// A stack takes the launches of one table as long as its texels fit a launch.
TEST(TableCost, AStackIsMadeTogether) {
    PelLutInfo info = pelLutInfoDefaults();
    info.curvature.width = info.curvature.height = info.shadow.width = info.shadow.height = 16;
    for (const auto& [kind, launches] : {std::pair(PEL_LUT_CURVATURE, 3u), {PEL_LUT_SHADOW, 2}}) {
        info.kind = kind;
        std::vector<uint16_t> texels(64 * 16 * 16 * 3);
        const spy::Counts before = spy::counts();
        Lut::readStack(device(), std::vector(64, info), PEL_LUT_HALF, texels.data(), 2 * texels.size());
        if (spy::counts().buffersMade == before.buffersMade)
            GTEST_SKIP() << "another library stands before the spy (Oclgrind)";
        EXPECT_EQ(spy::counts().launches - before.launches, launches);
    }
}

// Memory of tables is used again: mapped anew, its pages would take several times as long as the arithmetic.
TEST(TableCost, PagesAreUsedAgain) {
#if !defined(__linux__) || !defined(__GLIBC__)
    GTEST_SKIP() << "pages are counted on Linux, and by glibc's allocator only";
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "the sanitizer's allocator keeps what is freed";
#endif
    if (device().info().type != PEL_DEVICE_CPU || !device().info().sharedMemory || testsAreSmall())
        GTEST_SKIP() << "the library allocates tables itself on CPUs only";
    for (const Kind& kind : kinds()) {
        constexpr int tables = 8;
        // Memory that other threads free late, such as pages of earlier tables, settles within a few rounds.
        int64_t least = INT64_MAX;
        for (int round = 0; round < 4; ++round) {
            const int64_t before = pageFaults();
            for (int i = 0; i < tables; ++i) kind.make(nullptr);
            least = std::min(least, pageFaults() - before);
        }
        EXPECT_LT(least, int64_t(tables * kind.maxBytes / 4096 / 4)) << kind.name;
    }
}
