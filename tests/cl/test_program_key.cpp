// Programs kept on disk are for one driver with its settings: another setting compiles anew.
#include "io/io_files.h"
#include "variable.h"

namespace {

class ProgramKey : public FolderTest {
  protected:
    struct Counts {
        uint32_t loaded, stored;
        bool operator==(const Counts&) const = default;
    };
    Counts first{};
    // A device of its own each time: it asks for the settings once.
    static Counts table() {
        const pellucid::Device device("");
        PelSpecularLutDesc desc = pelSpecularLutDescDefaults();
        desc.width = desc.height = 4;
        const pellucid::Lut lut(device, desc);
        const PelDeviceStats stats = device.stats();
        return {stats.programsLoaded, stats.programsStored};
    }
    void SetUp() override {
        FolderTest::SetUp();
        std::filesystem::permissions(folder_, std::filesystem::perms::owner_all);
        place_.set(path("cache").c_str());
        first = table();
        if (first.stored == 0) GTEST_SKIP() << "this driver gives no binaries";
    }
    const Variable cache_{"PELLUCID_CACHE", "on"}, place_{"PELLUCID_CACHE_DIR"};
};

TEST_F(ProgramKey, HasTheDriversSettings) {
    EXPECT_EQ(first.loaded, 0u);
    EXPECT_EQ(table(), (Counts{first.stored, 0})) << "the same settings";
    int value = 0;
    for (const char* name : {"CL_CONFIG_TEST", "POCL_TEST", "POCL_TEST", "RUSTICL_TEST", "LP_TEST",
                             "GALLIVM_TEST", "IGC_TEST"}) {
        const Variable setting(name, std::to_string(++value).c_str());
        EXPECT_EQ(table(), (Counts{0, first.stored})) << name << "=" << value << " was forgotten";
        EXPECT_EQ(table(), (Counts{first.stored, 0})) << name << "=" << value << " the second time";
    }
    // Variables that do not change the compiled program: others, and the one for the cache folder.
    for (const char* name : {"UNRELATED_TEST", "POCL_CACHE_TEST"}) {
        const Variable setting(name, "1");
        EXPECT_EQ(table(), (Counts{first.stored, 0})) << name;
    }
}

TEST_F(ProgramKey, HasTheWidth) {
    const uint32_t own = pellucid::Device("").info().mathWidth;
    const Variable width("PELLUCID_MATH_WIDTH");
    width.set(own == 8 ? "16" : "8");
    EXPECT_EQ(table(), (Counts{0, first.stored}));
    width.set(nullptr);
    EXPECT_EQ(table(), (Counts{first.stored, 0}));
}

TEST_F(ProgramKey, FoldersThatOthersMayWriteToAreNotUsed) {
    for (const char* which : {"cache", "."})
        for (const auto open : {std::filesystem::perms::others_write, std::filesystem::perms::group_write}) {
            std::filesystem::permissions(path(which), open, std::filesystem::perm_options::add);
            EXPECT_EQ(table(), (Counts{0, 0})) << which;
            std::filesystem::permissions(path(which), open, std::filesystem::perm_options::remove);
        }
    if (::geteuid() == 0) {
        ASSERT_EQ(::chown(path("cache").c_str(), 12345, 12345), 0);
        EXPECT_EQ(table(), (Counts{0, 0})) << "another user's";
        ASSERT_EQ(::chown(path("cache").c_str(), 0, 0), 0);
    }
    EXPECT_EQ(table(), (Counts{first.stored, 0}));
}

}  // namespace
