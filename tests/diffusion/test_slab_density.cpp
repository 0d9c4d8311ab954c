// Light through a slab (kernels/lib/diffusion/profile_table.clh) against double precision: other terms and
// another spread in each channel.
#include "own_kernel.h"
#include "shared/diffusion.h"

TEST(SlabDensity, EqualsItsFormulaInEachChannel) {
    constexpr cl_uint count = 256;
    constexpr float widest = 0.3f, spread[] = {0.4f, 0.9f, 1.6f};
    std::vector<float> terms, squared, cosine;
    for (int k = 0; k < PEL_SLAB_TERMS; ++k)
        for (int c = 0; c < 4; ++c) terms.push_back(1 / float(1 + k + 2 * c));
    for (size_t i = 0; i < count; ++i) {
        squared.push_back(0.01f + 0.05f * float(i % 32));
        cosine.push_back(float(i / 32) / 7);
    }
    // Red of all places, then green, then blue.
    const std::string file = "diffusion/profile_table.clh", source = "#include \"lib/" + file + R"("
__kernel void evaluate(__global const float* terms, __global const float* squared,
                       __global const float* cosine, uint count, float widest, float red, float green,
                       float blue, __global float* out) {
    const size_t item = get_global_id(0) * PEL_WIDTH, channel = item / count, at = item % count;
    PelProfileTable table;
    table.widest = widest, table.perRadius2 = 1.0f;
    table.spread[0] = red, table.spread[1] = green, table.spread[2] = blue;
    const Vec3w v = slabDensity(terms, PEL_SLAB_TERMS, table, loadw(at, squared), loadw(at, cosine));
    storew(channel == 0 ? v.x : channel == 1 ? v.y : v.z, item, out);
})";
    for (const int lanes : {1, 16}) {
        const std::vector<float> made = runOwnKernel(device(), source, lanes, 3 * count, terms, squared,
                                                     cosine, count, widest, spread[0], spread[1], spread[2]);
        for (size_t k = 0; k < made.size(); ++k) {
            const size_t c = k / count, i = k % count;
            const double cosines = std::max(double(cosine[i]), 0.05), depth = std::sqrt(squared[i]) * cosines;
            double sum = 0;
            for (size_t term = 0; term < PEL_SLAB_TERMS; ++term)
                sum += terms[4 * term + c] * std::exp2(-depth * depth * widest * std::pow(2.0, term));
            const double steps = (1 - 1 / cosines) / std::log(2.0);
            const double truth = sum * std::exp2(steps * (spread[c] * std::sqrt(depth) + PEL_SLAB_FIRST));
            EXPECT_NEAR(made[k], truth, tolerance::slabDensity * truth) << i << ", channel " << c;
        }
    }
}
