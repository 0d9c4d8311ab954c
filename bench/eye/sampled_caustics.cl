// A table of caustics by random paths, the way in which HDRP makes its own [Unity Technologies, High Definition Render Pipeline,
// EyeCausticLUT]: photons start at random places of a light, are reflected or refracted at random by Fresnel's share, and add 1 to
// the texel of the iris where they end. The baseline of bench/eye/sweep_eye.cpp; written for this library's eye.
//
// One work-item: `photons` of one slice. Scalars.
#include "shared/eye.h"

static inline float draw(uint* state) {
    *state = *state * 747796405u + 2891336453u;
    const uint word = ((*state >> ((*state >> 28) + 4u)) ^ *state) * 277803737u;
    return (float)(((word >> 22) ^ word) >> 8) * (1.0f / 16777216.0f);
}

static inline float reflected(float cosine, float from, float to) {
    const float sine2 = (1.0f - cosine * cosine) * from * from / (to * to);
    if (sine2 >= 1.0f) return 1.0f;
    const float behind = sqrt(1.0f - sine2);
    const float s = (from * cosine - to * behind) / (from * cosine + to * behind);
    const float p = (from * behind - to * cosine) / (from * behind + to * cosine);
    return 0.5f * (s * s + p * p);
}

static inline float3 normalOf(const PelEyeShape e, float3 p) {
    return normalize((float3)(p.x, p.y, e.cornea - e.conic1 * (e.apexZ - p.z)));
}

__kernel void sampled_caustics(const PelEyeShape e, uint width, uint height, float anglePerSlice,
                               uint photons, __global uint* sums) {
    const uint slice = get_global_id(1);
    uint state = (get_global_id(0) * 2654435761u) ^ (slice * 40503u + 17u);
    sums += slice * width * height;
    const float angle = (float)slice * anglePerSlice;
    const float3 l = (float3)(sin(angle), 0.0f, cos(angle)), side = (float3)(l.z, 0.0f, -l.x);
    const float3 middle = (float3)(0.0f, 0.0f, 0.5f * (e.limbusZ + e.apexZ));
    for (uint i = 0; i < photons; ++i) {
        // A rectangle of light, just wider than the limbus.
        const float u = (2.0f * draw(&state) - 1.0f) * e.limbus * 1.1f,
                    v = (2.0f * draw(&state) - 1.0f) * e.limbus;
        const float3 o = middle + side * u + (float3)(0.0f, v, 0.0f) + l * (4.0f * e.limbus);
        float3 d = -l;
        const float w = e.apexZ - o.z;
        float a = d.x * d.x + d.y * d.y + e.conic1 * d.z * d.z;
        float b = o.x * d.x + o.y * d.y + d.z * (e.cornea - e.conic1 * w);
        const float c = o.x * o.x + o.y * o.y + w * (e.conic1 * w - 2.0f * e.cornea), inside2 = b * b - a * c;
        if (inside2 <= 0.0f) continue;
        float3 p = o + d * (c / (sqrt(inside2) - b));
        if (p.z < e.limbusZ || p.x * p.x + p.y * p.y > e.limbus * e.limbus) continue;
        const float ahead = dot(p, l), above = dot(p, p) - e.sclera2;
        if (ahead < 0.0f && ahead * ahead > above) continue;
        float3 n = normalOf(e, p);
        float cosine = -dot(d, n);
        if (cosine <= 0.0f || draw(&state) < reflected(cosine, 1.0f, e.corneaIndex)) continue;
        const float between = sqrt(1.0f - (1.0f - cosine * cosine) / (e.corneaIndex * e.corneaIndex));
        if (draw(&state) < reflected(between, e.corneaIndex, e.aqueousIndex)) continue;
        const float eta = 1.0f / e.aqueousIndex;
        d = d * eta + n * (eta * cosine - sqrt(1.0f - eta * eta * (1.0f - cosine * cosine)));
        for (uint bounce = 0; bounce < 8; ++bounce) {
            const float t = d.z < 0.0f ? (e.irisZ - p.z) / d.z : 1e9f;
            a = d.x * d.x + d.y * d.y + e.conic1 * d.z * d.z;
            b = p.x * d.x + p.y * d.y + d.z * (e.cornea - e.conic1 * (e.apexZ - p.z));
            const float chord = -2.0f * b / a;
            const float3 q = p + d * chord;
            if (chord > 1e-4f && chord < t && q.z >= e.limbusZ) {
                n = normalOf(e, q);
                cosine = dot(d, n);
                const float behind = sqrt(fmax(1.0f - (1.0f - cosine * cosine) * e.aqueousIndex *
                                                          e.aqueousIndex / (e.corneaIndex * e.corneaIndex),
                                               0.0f));
                if (draw(&state) > reflected(cosine, e.aqueousIndex, e.corneaIndex) &&
                    draw(&state) > reflected(behind, e.corneaIndex, 1.0f))
                    break;
                d -= n * (2.0f * cosine);
                p = q;
                continue;
            }
            const float3 end = p + d * t;
            if (t > 1e8f || dot(end, end) > e.sclera2) break;
            const float x = (end.x / e.iris + 1.0f) * 0.5f * (float)width,
                        y = fabs(end.y) / e.iris * (float)height;
            if (x >= 0.0f && x < (float)width && y < (float)height)
                atomic_inc(&sums[(uint)y * width + (uint)x]);
            break;
        }
    }
}
