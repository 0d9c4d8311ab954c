// UV scale of a mesh (mathematics, section 5): the geometric mean over triangles of longest edge / longest UV
// edge, without the triangles where either is below 1e-6 of the largest of its kind.
//
// Inputs: triangles as the caller's vertex numbers, positions (length), UV coordinates (1).
// One work-item: a fixed share of the triangles, every PEL_UV_SCALE_ITEMS-th. The shares and the order within
// them are the same on every device, and so is the result. The host adds the shares in order.
// uv_scale_largest must run first: its maxima decide what uv_scale_sum skips.

#include "lib/mesh/mesh_vertex.clh"

static inline float edgeLongest2(float3 a, float3 b, float3 c) {
    return fmax(dot(b - a, b - a), fmax(dot(c - b, c - b), dot(a - c, a - c)));
}

// Squared longest edge and squared longest UV edge of a triangle; NaN or Inf if it has such vertices.
static inline float2 triangleLongest2(uint triangle, __global const uint* indices,
                                      __global const float* positions, VertexLayout positionLayout,
                                      __global const float* uvs, VertexLayout uvLayout) {
    const uint3 v = vload3(triangle, indices);
    const float2 length2 = (float2)(edgeLongest2(vertexLoad3(positions, positionLayout, v.x),
                                                 vertexLoad3(positions, positionLayout, v.y),
                                                 vertexLoad3(positions, positionLayout, v.z)),
                                    0.0f);
    __global const float* uv = uvs + uvLayout.offset;
    const float2 a = vload2(0, uv + (size_t)v.x * uvLayout.stride);
    const float2 b = vload2(0, uv + (size_t)v.y * uvLayout.stride);
    const float2 c = vload2(0, uv + (size_t)v.z * uvLayout.stride);
    // A sum over all corners is NaN or Inf if one of them is; fmax would hide that.
    const float3 total = vertexLoad3(positions, positionLayout, v.x) +
                         vertexLoad3(positions, positionLayout, v.y) +
                         vertexLoad3(positions, positionLayout, v.z);
    if (!isfinite(total.x + total.y + total.z + a.x + a.y + b.x + b.y + c.x + c.y))
        return (float2)(meshNan3().x);
    return (float2)(length2.x, edgeLongest2((float3)(a, 0.0f), (float3)(b, 0.0f), (float3)(c, 0.0f)));
}

__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void uv_scale_largest(
    uint triangles, __global const uint* restrict indices, __global const float* restrict positions,
    VertexLayout positionLayout, __global const float* restrict uvs, VertexLayout uvLayout,
    __global float* largest) {
    const uint item = get_global_id(0);
    float2 high = (float2)(0.0f);
    for (uint t = item; t < triangles; t += PEL_UV_SCALE_ITEMS) {
        const float2 length2 = triangleLongest2(t, indices, positions, positionLayout, uvs, uvLayout);
        if (all(isfinite(length2))) high = fmax(high, length2);
    }
    vstore2(high, item, largest);
}

__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void uv_scale_sum(
    uint triangles, __global const uint* restrict indices, __global const float* restrict positions,
    VertexLayout positionLayout, __global const float* restrict uvs, VertexLayout uvLayout,
    float smallestLength2, float smallestUv2, __global UvScaleShare* shares) {
    const uint item = get_global_id(0);
    // The binary logarithm of each squared ratio: exponents add up exactly as whole numbers, the logarithms
    // of the mantissas lie within [-1, 1] and add up with Kahan's correction. This is as accurate as double
    // precision.
    float sum = 0.0f, lost = 0.0f;
    int exponents = 0;
    uint count = 0;
    for (uint t = item; t < triangles; t += PEL_UV_SCALE_ITEMS) {
        const float2 length2 = triangleLongest2(t, indices, positions, positionLayout, uvs, uvLayout);
        if (!all(isfinite(length2)) || length2.x < smallestLength2 || length2.y < smallestUv2) continue;
        int e, uvE;
        const float term = log2(frexp(length2.x, &e) / frexp(length2.y, &uvE)) - lost;
        exponents += e - uvE;
        const float next = sum + term;
        lost = (next - sum) - term;
        sum = next;
        ++count;
    }
    shares[item].mantissas = sum;
    shares[item].exponents = exponents;
    shares[item].triangles = count;
}
