// What a device can do at best, for the figures of the benchmarks. One work-item: PEL_WIDTH values. Variants: PEL_WIDTH.
#include "lib/width.clh"

// 8 chains of 64 exponentials each, none waiting for another.
__kernel void exponentials(__global float* out) {
    floatw x[8];
    for (int i = 0; i < 8; ++i)
        x[i] = convert_floatw((intw)((int)get_global_id(0) & 1023) + lanesw()) * 1e-3f + 0.1f * (float)i;
    for (int n = 0; n < 64; ++n) {
#pragma unroll
        for (int i = 0; i < 8; ++i) x[i] = exp(-x[i]);
    }
    floatw sum = 0.0f;
    for (int i = 0; i < 8; ++i) sum += x[i];
    storew(sum, 0, out + get_global_id(0) * PEL_WIDTH);
}

__kernel void copy(__global const float16* from, __global float16* to) {
    const size_t i = get_global_id(0);
    to[i] = from[i];
}
