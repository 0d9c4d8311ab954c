// Runs the cases of a test program, or of one source where it is started by that one's name. Ends with 77
// where none failed and some were skipped, so that CTest says so, and with 1 where handles or OpenCL objects
// are left (host/core/handle_table.cpp, tests/cl/cl_spy.cpp).
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "cl/cl_spy.h"

namespace {

// Leaves out the tests of other sources if the program is called test_NAME. Returns whether any is left.
bool chooseSource(const std::string& name) {
    if (!name.starts_with("test_")) return true;
    const auto& all = *testing::UnitTest::GetInstance();
    std::string others;
    bool some = false;
    for (int s = 0; s < all.total_test_suite_count(); ++s) {
        const testing::TestSuite& suite = *all.GetTestSuite(s);
        for (int t = 0; t < suite.total_test_count(); ++t) {
            const testing::TestInfo& test = *suite.GetTestInfo(t);
            if (std::filesystem::path(test.file()).stem() == name)
                some = true;
            else
                others += std::string(others.empty() ? "" : ":") + suite.name() + "." + test.name();
        }
    }
    std::string& filter = testing::FLAGS_gtest_filter;
    if (!others.empty()) filter += (filter.find('-') == std::string::npos ? "-" : ":") + others;
    return some || others.empty();
}

}  // namespace

int main(int argc, char** argv) {
#ifdef __GLIBC__
    mallopt(M_PERTURB, 0x80);  // new memory holds large numbers (3.4e38), so that one that nobody set is seen
#endif
    const std::string name = std::filesystem::path(argc > 0 ? argv[0] : "").filename();
    testing::InitGoogleTest(&argc, argv);
    if (!chooseSource(name)) {
        std::fprintf(stderr, "no test is of %s.cpp\n", name.c_str());
        return 1;
    }
    spy::counts();  // a program that names nothing of the spy would not load it
    const int failed = RUN_ALL_TESTS();
    ::setenv("PELLUCID_CHECK_LEFT", "1", 0);  // of this program, not of those that it has started
    if (failed) return failed;
    return testing::UnitTest::GetInstance()->skipped_test_count() > 0 ? 77 : 0;
}
