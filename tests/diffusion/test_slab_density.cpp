// Light through a slab (kernels/lib/diffusion/profile_table.clh) against double precision: other terms and
// another spread in each channel.
#include "own_kernel.h"
#include "shared/diffusion.h"

TEST(SlabDensity, EqualsItsFormulaInEachChannel) {
    const pellucid::Device device("");
    constexpr size_t count = 256;
    constexpr float widest = 0.3f, spread[] = {0.4f, 0.9f, 1.6f};
    std::vector<float> terms, squared, cosine;
    for (int k = 0; k < PEL_SLAB_TERMS; ++k)
        for (int c = 0; c < 4; ++c) terms.push_back(1 / float(1 + k + 2 * c));
    for (size_t i = 0; i < count; ++i) {
        squared.push_back(0.01f + 0.05f * float(i % 32));
        cosine.push_back(float(i / 32) / 7);
    }
    const std::string file = "diffusion/profile_table.clh", source = "#include \"lib/" + file + R"("
__kernel void evaluate(__global const float* terms, __global const float* squared,
                       __global const float* cosine, float widest, float red, float green, float blue,
                       __global float* out) {
    const size_t at = get_global_id(0) * PEL_WIDTH;
    PelProfileTable table;
    table.widest = widest, table.perRadius2 = 1.0f;
    table.spread[0] = red, table.spread[1] = green, table.spread[2] = blue;
    const Vec3w v = slabDensity(terms, PEL_SLAB_TERMS, table, loadw(at, squared), loadw(at, cosine));
    storew(v.x, at, out);
})";
    for (const int lanes : {1, 16})
        for (int c = 0; c < 3; ++c) {
            std::string one = source;
            one.replace(one.find("v.x"), 3, c == 0 ? "v.x" : c == 1 ? "v.y" : "v.z");
            const std::vector<float> made = runOwnKernel(device, one, lanes, count, terms, squared, cosine,
                                                         widest, spread[0], spread[1], spread[2]);
            for (size_t i = 0; i < count; ++i) {
                const double cosines = std::max(double(cosine[i]), 0.05),
                             depth = std::sqrt(squared[i]) * cosines;
                double sum = 0;
                for (int k = 0; k < PEL_SLAB_TERMS; ++k)
                    sum += terms[size_t(4 * k + c)] * std::exp2(-depth * depth * widest * std::pow(2.0, k));
                const double steps = (1 - 1 / cosines) / std::log(2.0);
                const double truth = sum * std::exp2(steps * (spread[c] * std::sqrt(depth) + PEL_SLAB_FIRST));
                EXPECT_NEAR(made[i], truth, tolerance::slabDensity * truth) << i << ", channel " << c;
            }
        }
}
