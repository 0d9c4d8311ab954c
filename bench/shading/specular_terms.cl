// One specular term over and over on pixels that stay in the cache (bench_specular.cpp).
// PEL_TERM: 0 nothing but reading the pixels, 1 evaluated directly, 2 from the table.
#include "lib/shading/specular.clh"
#include "lib/shading/specular_table.clh"

static inline Vec3w loadVec(__global const float* p, uint pixels, uint at) {
    return vec3(loadw(at, p), loadw(at, p + pixels), loadw(at, p + 2 * pixels));
}

static inline floatw term(__global const float* pixel, uint pixels, uint at, __global const float* table,
                          uint width, uint height) {
    const Vec3w n = loadVec(pixel, pixels, at), l = loadVec(pixel + 3 * pixels, pixels, at),
                v = loadVec(pixel + 6 * pixels, pixels, at);
    const floatw m = loadw(at, pixel + 9 * pixels), nl = dot3(n, l);
    if (PEL_TERM == 0) return nl + v.x + v.y + v.z + m;
    if (PEL_TERM == 1) return specularKsk(n, l, v, nl, m, 0.028f);
    return specularKskTable(table, width, height, n, l, v, nl, m, 0.028f);
}

// One work-item: `rounds` times PEL_WIDTH pixels, one block after another. pixels: a multiple of PEL_WIDTH.
__kernel void repeat_term(__global const float* pixel, uint pixels, __global const float* table, uint width,
                          uint height, uint rounds, __global float* out) {
    const uint blocks = pixels / PEL_WIDTH, item = get_global_id(0);
    floatw sum = 0.0f;
    for (uint r = 0; r < rounds; ++r)
        sum += term(pixel, pixels, (item + r) % blocks * PEL_WIDTH, table, width, height);
    storew(sum, item * PEL_WIDTH, out);
}

__kernel void each_term(__global const float* pixel, uint pixels, __global const float* table, uint width,
                        uint height, __global float* out) {
    const uint at = get_global_id(0) * PEL_WIDTH;
    storew(term(pixel, pixels, at, table, width, height), at, out);
}
