// Kernels with one mistake each, which Oclgrind or the plugin must report in the words above it, and one
// without any. run.py runs them first: a check that finds nothing there would find nothing anywhere. `out`
// holds 16 uints; a work-group has 4 work-items, a launch 16.

typedef struct Pair {
    uint first, second;
} Pair;

uint sum_of(Pair pair) {
    return pair.first + pair.second;
}

// What looks open for a while and is not: whole vectors made of lanes, lanes that nobody takes, structures
// by value.
__kernel void sound(__global uint* out, __local uint* shared) {
    const uint i = get_global_id(0), l = get_local_id(0);
    float16 a, b;
    a.lo = (float8)(i), a.hi = (float8)((float4)(1.0f), (float4)((float3)((float2)(2.0f, 3.0f), i), 4.0f));
    b = shuffle2(a, a, (uint16)(11, 12, 13, 14, 15, 16, 27, 28, 29, 30, 31, 0, 1, 2, 3, 4));
    a = __builtin_shufflevector(a, b, 11, 12, 13, 14, 15, 16, 27, 28, 29, 30, 31, 0, 1, 2, 3, 4);
    float4 part;
    part.x = a.s0;
    part = select(part, a.lo.lo, (int4)(0, -1, -1, -1));
    float3 three = vload3(0, (const float*)&part);
    Pair pair;
    pair.first = i;
    pair.second = part.w > three.z ? 1 : 2;
    int exponent;
    const float mantissa = frexp(part.y + dot(three, three), &exponent);
    shared[l] = sum_of(pair);
    barrier(CLK_LOCAL_MEM_FENCE);
    out[i] = shared[3 - l] + exponent + (mantissa > 0.5f);
}

// expect: Invalid read of size 4 at global memory
__kernel void reads_out_of_bounds(__global uint* out, __local uint* shared) {
    out[get_global_id(0)] = out[get_global_id(0) + 1] * 0 + 1;
}

// expect: Invalid write of size 4 at global memory
__kernel void writes_out_of_bounds(__global uint* out, __local uint* shared) {
    out[get_global_id(0) * 2] = 1;
}

// expect: Invalid read of size 4 at private memory
__kernel void private_out_of_bounds(__global uint* out, __local uint* shared) {
    uint four[4] = {1, 2, 3, 4};
    out[get_global_id(0)] = four[get_global_id(0)];
}

// expect: Invalid write of size 4 at local memory
__kernel void local_out_of_bounds(__global uint* out, __local uint* shared) {
    shared[get_local_id(0) + 1] = 1;
    out[get_global_id(0)] = 1;
}

// expect: data race at local memory
__kernel void races_in_local_memory(__global uint* out, __local uint* shared) {
    const uint l = get_local_id(0);
    shared[l] = l;
    out[get_global_id(0)] = shared[3 - l];
}

// expect: Write-write data race at global memory
__kernel void races_in_global_memory(__global uint* out, __local uint* shared) {
    out[get_global_id(0) / 2] = get_global_id(0);
}

// expect: a branch depends on a value that nothing has set
__kernel void branches_on_unset(__global uint* out, __local uint* shared) {
    uint value;
    out[get_global_id(0)] = 0;
    if (value > 3) out[get_global_id(0)] = 1;
}

// expect: a value that nothing has set is stored in global memory
__kernel void chooses_by_unset_local(__global uint* out, __local uint* shared) {
    if (get_local_id(0) > 0) shared[get_local_id(0)] = 1;
    barrier(CLK_LOCAL_MEM_FENCE);
    out[get_global_id(0)] = shared[0] > 1 ? 1 : 2;
}

// expect: a value that nothing has set is stored in global memory
__kernel void stores_an_unset_lane(__global uint* out, __local uint* shared) {
    uint4 v;
    v.xyz = (uint3)(get_global_id(0));
    if (get_global_id(0) < 4) vstore4(v, get_global_id(0), out);
}

// expect: a value that nothing has set is stored in global memory
__kernel void stores_half_a_structure(__global uint* out, __local uint* shared) {
    Pair pair;
    pair.first = get_global_id(0);
    out[get_global_id(0)] = sum_of(pair);
}

// expect: an address that is read depends on a value that nothing has set
__kernel void addresses_by_unset(__global uint* out, __local uint* shared) {
    uint number;
    out[get_global_id(0)] = shared[number & 3] * 0;
}
