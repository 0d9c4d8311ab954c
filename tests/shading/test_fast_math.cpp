// Functions that are quicker than OpenCL's, at each number of lanes, against double precision.
#include "own_kernel.h"

TEST(FastMath, PowersOfTwo) {
    const pellucid::Device device("");
    constexpr size_t count = 4096;
    std::vector<float> x;
    for (size_t i = 0; i < count; ++i) x.push_back(float(130 * (double(i) / (count - 1) - 1)));  // -130 to 0
    for (const int lanes : {1, 8, 16}) {
        const auto powers = [&](const std::string& file, const std::string& function) {
            return runOwnKernel(
                device,
                "#include \"lib/" + file + "\"\n__kernel void evaluate(__global const float* in, " +
                    "__global float* out) {\n    const size_t at = get_global_id(0) * PEL_WIDTH;\n" +
                    "    storew(" + function + "(loadw(at, in)), at, out);\n}",
                lanes, count, x);
        };
        const auto falling = powers("vector.clh", "exp2Fallingw"),
                   whole = powers("shading/wide_filter.clh", "fastExp2");
        for (size_t i = 0; i < count; ++i) {
            const double truth = std::exp2(double(x[i]));
            EXPECT_NEAR(falling[i] / std::exp2(std::max(double(x[i]), -62.0)), 1, tolerance::fastMath)
                << x[i];
            EXPECT_NEAR(whole[i], truth, x[i] > -126 ? tolerance::fastMath * truth : 1.2e-38) << x[i];
        }
    }
}
