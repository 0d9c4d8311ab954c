// Runs the cases of a test program. Ends with 77 where none failed and some were skipped, so that CTest says
// so, and with 1 where handles or OpenCL objects are left (host/core/handle_table.cpp, tests/cl/cl_spy.cpp).
#include <gtest/gtest.h>

#include <cstdlib>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "cl/cl_spy.h"

int main(int argc, char** argv) {
#ifdef __GLIBC__
    mallopt(M_PERTURB, 0x80);  // new memory holds large numbers (3.4e38), so that one that nobody set is seen
#endif
    testing::InitGoogleTest(&argc, argv);
    spy::counts();  // a program that names nothing of the spy would not load it
    const int failed = RUN_ALL_TESTS();
    ::setenv("PELLUCID_CHECK_LEFT", "1", 0);  // of this program, not of those that it has started
    if (failed) return failed;
    return testing::UnitTest::GetInstance()->skipped_test_count() > 0 ? 77 : 0;
}
