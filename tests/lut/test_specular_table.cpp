// kernels/lib/shading/specular_table.clh as a renderer includes it: against the oracle, and against the same
// texels in double precision.
#include "own_kernel.h"
#include "reference/lut.h"
#include "reference/shade.h"

using reference::Vec3;

namespace {

constexpr size_t count = 4096;
constexpr uint32_t width = 300, height = 200;

// n, l, v, m per evaluation: ten floats each.
std::vector<float> evaluate(const std::vector<float>& table, const std::vector<float>& inputs, int lanes) {
    return runOwnKernel(device(), R"(#include "lib/shading/specular_table.clh"
#define V(i) vec3(loadw(at, in + (i) * n), loadw(at, in + (i + 1) * n), loadw(at, in + (i + 2) * n))
__kernel void evaluate(__global const float* in, __global const float* table, uint width, uint height,
                       __global float* out) {
    const size_t at = get_global_id(0) * PEL_WIDTH, n = get_global_size(0) * PEL_WIDTH;
    const Vec3w normal = V(0), light = V(3), view = V(6);
    storew(specularKskTable(table, width, height, normal, light, view, dot3(normal, light),
                            loadw(at, in + 9 * n), 0.028f),
           at, out);
})",
                        lanes, count, inputs, table, width, height);
}

TEST(SpecularTable, ReadsWhatTheTableHolds) {
    PelSpecularLutDesc desc = pelSpecularLutDescDefaults();
    desc.width = width, desc.height = height;
    const auto rgb = pellucid::Lut(device(), desc).read<float>(PEL_LUT_FLOAT);
    std::vector<float> table;
    reference::Table truth{int(width), int(height), {}};
    for (size_t i = 0; i < rgb.size(); i += 3) {
        table.push_back(rgb[i]);
        truth.texels.push_back({rgb[i], rgb[i + 1], rgb[i + 2]});
    }
    std::mt19937 engine(5);
    std::normal_distribution<float> normal;
    std::vector<float> inputs(10 * count);
    const auto vec = [&](size_t i, size_t first) {
        return Vec3{inputs[first * count + i], inputs[(first + 1) * count + i],
                    inputs[(first + 2) * count + i]};
    };
    for (size_t i = 0; i < count; ++i) {
        for (size_t first : {0, 3, 6}) {
            const Vec3 v = reference::normalized(Vec3{normal(engine), normal(engine), normal(engine)});
            for (size_t c = 0; c < 3; ++c) inputs[(first + c) * count + i] = float(v[int(c)]);
        }
        inputs[9 * count + i] = 0.2f + 0.3f * float(i) / count;
    }
    inputs[9 * count + 7] = 0;  // the ends of the table, and beyond them
    inputs[9 * count + 8] = 1.5f;
    inputs[9 * count + 9] = -1;
    // must not read elsewhere, nor disturb others
    inputs[count + 10] = std::numeric_limits<float>::quiet_NaN();
    for (int lanes : {1, 8, 16}) {
        const auto result = evaluate(table, inputs, lanes);
        size_t lit = 0;
        for (size_t i = 0; i < count; ++i) {
            const Vec3 n = vec(i, 0), l = vec(i, 3), v = vec(i, 6), h = l + v;
            const double m = inputs[9 * count + i];
            if (i == 10) continue;
            double expected = 0;
            if (dot(n, l) > 0 && dot(n, h) > 0) {
                const double nh = dot(n, reference::normalized(h));
                const double p = std::pow(2 * bilinear(truth, nh, m).x, 10);
                expected =
                    dot(n, l) * p * reference::schlick(dot(v, reference::normalized(h)), 0.028) / dot(h, h);
                ++lit;
            }
            EXPECT_NEAR(result[i], expected, tolerance::specularTable * std::max(1.0, expected)) << i;
            // Also against the exact function that the table of 300 x 200 texels approximates.
            if (m > 0.25 && m < 0.6) {
                EXPECT_NEAR(result[i], reference::specular(n, l, v, m, 1), 0.05 * std::max(0.1, expected))
                    << i;
            }
        }
        EXPECT_GT(lit, count / 8);
    }
}

}  // namespace
