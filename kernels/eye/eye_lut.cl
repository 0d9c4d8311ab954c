// Caustic table: irradiance on the iris behind a refracting cornea, for light from several angles (section 13
// of the mathematics). The disk of the limbus is divided into cells. Each cell's light is refracted to the
// iris, and its flux is distributed over the texels that the refracted cell covers, in proportion to area, so
// that no flux is lost between texels. Sums are integers, so that the result does not depend on the order of
// additions.
//
// Inputs: PelEyeShape in units of the iris radius; PelEyeLutGrid. The rows of cells are y = limbus sin a with
// even angles a; within a row x = limbus u cos a, u from -1 to 1, so that cells end at the limbus exactly.
//
// eye_lut: one work-item computes PEL_WIDTH cells of a row.
// finish_eye_lut: one work-item converts one texel of lut->layout, the copied column and row included.
// plain_eye_lut, scatter_eye_lut: for an iris that scatters light; see there.
// Variants: PEL_WIDTH, PEL_GROUP; PEL_EYE_SCATTERS: light scatters in the iris by a profile.
#include "lib/eye/eye_shape.clh"
#include "shared/lut.h"

#define HALF_PI 1.57079632679489662f
#define MAX_TEXELS 8.0f  // that a cell covers along an axis

typedef struct Landing {
    floatw x, y;   // on the plane of the iris
    floatw share;  // of the flux through the cell that arrives
    floatw slope;  // flux per area of the limbus plane, for a beam of irradiance 1
} Landing;

// Refracts light that meets the cornea above (x, y). Light comes from direction (sine, 0, cosine).
static inline Landing refractToIris(const PelEyeShape s, floatw x, floatw y, float sine, float cosine) {
    Landing landing;
    Vec3w n;
    Vec3w p = corneaAt(s, x, y, &n);
    const floatw facing = fma(n.x, (floatw)(sine), n.z * cosine);
    // The sclera blocks light from below its horizon.
    const floatw ahead = fma(p.x, (floatw)(sine), p.z * cosine), above = dot3(p, p) - s.sclera2;
    const maskw blocked = (facing <= 0.0f) | ((ahead < 0.0f) & (ahead * ahead > above));
    landing.slope = selectw(facing / n.z, (floatw)(0.0f), blocked);
    const floatw c = max0w(facing);
    const floatw behind = cosineBehind(c, 1.0f / s.aqueousIndex);
    landing.share = corneaTransmittance(c, behind, s.corneaIndex, s.aqueousIndex);
    Vec3w d = refracted(vec3((floatw)(-sine), (floatw)(0.0f), (floatw)(-cosine)), n, c, behind,
                        1.0f / s.aqueousIndex);
    floatw length = toIris(s, p, d);
    // Light at a grazing angle may meet the cornea a second time, from inside, and be reflected. The chord
    // between the two points follows from both lying on the conic.
    const floatw a = fma(d.x, d.x, fma(d.y, d.y, s.conic1 * d.z * d.z));
    const floatw b = fma(p.x, d.x, fma(p.y, d.y, corneaUpright(s, fma(p.x, p.x, p.y * p.y)) * d.z));
    const floatw chord = -2.0f * b / fmax(a, (floatw)(1e-6f));
    const Vec3w q = add3(p, scale3(d, chord));
    const maskw again = (chord > 0.0f) & (chord < length) & (q.z >= s.limbusZ) & (landing.slope > 0.0f);
    if (anyw(again)) {
        Vec3w m;
        const Vec3w on = corneaAt(s, q.x, q.y, &m);
        const floatw inside = dot3(d, m);
        const floatw between = cosineBehind(inside, s.aqueousIndex / s.corneaIndex);
        const floatw outside = cosineBehind(between, s.corneaIndex);
        const Interface inner = lightAt(inside, between, s.aqueousIndex / s.corneaIndex),
                        outer = lightAt(between, outside, s.corneaIndex);
        const floatw kept = 1.0f - inner.transmitted * outer.transmitted / (inner.whole * outer.whole);
        p = select3(p, on, again);
        d = select3(d, sub3(d, scale3(m, 2.0f * inside)), again);
        landing.share = selectw(landing.share, landing.share * kept, again);
        length = selectw(length, toIris(s, p, d), again);
    }
    landing.x = fma(length, d.x, p.x);
    landing.y = fma(length, d.y, p.y);
    // Light that hits the wall behind the limbus is lost.
    const floatw z = fma(length, d.z, p.z);
    const maskw lost = fma(landing.x, landing.x, fma(landing.y, landing.y, z * z)) > s.sclera2;
    landing.share = selectw(landing.share, (floatw)(0.0f), lost);
    return landing;
}

// Adds a cell's flux to the texels that a box covers; the edges of the box are in texels. Rows below 0 are
// mirror images of those above.
static inline void spread(__global uint* sums, const PelEyeLutGrid grid, float x0, float x1, float y0,
                          float y1, float amount) {
    const float perX = 1.0f / (x1 - x0), perY = 1.0f / (y1 - y0);
    const int left = max((int)floor(x0), 0), right = min((int)floor(x1), (int)grid.width - 1);
    const int top = (int)floor(y0), bottom = min((int)floor(y1), (int)grid.height - 1);
    for (int j = top; j <= bottom; ++j) {
        const float share = (fmin(y1, (float)(j + 1)) - fmax(y0, (float)j)) * perY * amount;
        const int row = j < 0 ? -1 - j : j;
        if (row >= (int)grid.height) continue;
        for (int i = left; i <= right; ++i) {
            const float part = (fmin(x1, (float)(i + 1)) - fmax(x0, (float)i)) * perX;
            atomic_add(&sums[row * grid.width + i], (uint)fma(share, part, 0.5f));
        }
    }
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void eye_lut(const PelEyeShape shape,
                                                                             const PelEyeLutGrid grid,
                                                                             __global uint* restrict sums) {
    const uint first = get_global_id(0) * PEL_WIDTH, row = get_global_id(1),
               slice = grid.firstSlice + get_global_id(2);
    const float turn = HALF_PI / (float)grid.rows, a = ((float)row + 0.5f) * turn;
    const float across = shape.limbus * cos(a), y = shape.limbus * sin(a);
    // All rows have cells of the same length.
    const uint columns = (uint)ceil((float)grid.columns * cos(a));
    if (first >= columns) return;
    sums += (size_t)slice * grid.width * grid.height;
    const float angle = (float)slice * grid.anglePerSlice, sine = sin(angle), cosine = cos(angle);
    const float step = 2.0f / (float)columns;
    const floatw u = fma(convert_floatw(lanesw() + (int)first) + 0.5f, (floatw)(step), (floatw)(-1.0f));
    const Landing here = refractToIris(shape, u * across, (floatw)(y), sine, cosine);
    const float texelsX = 0.5f * (float)grid.width, texelsY = (float)grid.height;
    const float area = across * across * step * turn * texelsX * texelsY;
    const maskw inside = lanesw() + (int)first < (int)columns;
    const floatw flux = selectw((floatw)(0.0f), here.slope * here.share * (area * grid.perTexel), inside);
    if (!anyw(flux > 0.0f)) return;
    // The area that the cell covers follows from where its neighbours land.
    const Landing next = refractToIris(shape, (u + step) * across, (floatw)(y), sine, cosine);
    const Landing below = refractToIris(shape, u * (shape.limbus * cos(a + turn)),
                                        (floatw)(shape.limbus * sin(a + turn)), sine, cosine);
    const floatw ax = (next.x - here.x) * texelsX, ay = (next.y - here.y) * texelsY;
    const floatw bx = (below.x - here.x) * texelsX, by = (below.y - here.y) * texelsY;
    // A box with the height and the area of the refracted cell, and at least its width.
    floatw high = fmax(fabs(by), fabs(ay)),
           wide = fmax(fabs(ax), fabs(ax * by - ay * bx) / fmax(high, (floatw)(1e-3f)));
    high = clamp(high, (floatw)(1e-3f), (floatw)(MAX_TEXELS));
    wide = clamp(wide, (floatw)(1e-3f), (floatw)(MAX_TEXELS));
    const floatw x = fma(here.x, (floatw)(texelsX), (floatw)(texelsX)), yy = here.y * texelsY;
    float x0[PEL_WIDTH], x1[PEL_WIDTH], y0[PEL_WIDTH], y1[PEL_WIDTH], amount[PEL_WIDTH];
    storew(x - 0.5f * wide, 0, x0);
    storew(x + 0.5f * wide, 0, x1);
    storew(yy - 0.5f * high, 0, y0);
    storew(yy + 0.5f * high, 0, y1);
    storew(flux, 0, amount);
    for (uint i = 0; i < PEL_WIDTH; ++i)
        if (amount[i] > 0.0f && x1[i] > 0.0f && x0[i] < (float)grid.width && y0[i] < texelsY)
            spread(sums, grid, x0[i], x1[i], y0[i], y1[i], amount[i]);
}

// Mean irradiance of a texel; `texel` counts through the slices without copied columns.
static inline float irradianceOf(const PelEyeShape shape, const PelEyeLutGrid grid, __global const uint* sums,
                                 uint texel) {
    const uint column = texel % grid.width, row = texel / grid.width % grid.height;
    const float x = fma((float)column + 0.5f, 2.0f / (float)grid.width, -1.0f),
                y = ((float)row + 0.5f) / (float)grid.height;
    const float slope2 = 4.0f * shape.irisBend * shape.irisBend * fma(x, x, y * y);
    return (float)sums[texel] / (grid.perTexel * sqrt(1.0f + slope2));
}

#if !PEL_EYE_SCATTERS
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void finish_eye_lut(
    const PelEyeShape shape, const PelEyeLutGrid grid, const LutLayout lut,
    __global const uint* restrict sums, __global float4* restrict texels) {
    const uint i = get_global_id(0), j = get_global_id(1);
    if (i >= lut.rowTexels) return;
    const uint texel = min(j, lut.height - 1) * lut.width + min(i, lut.width - 1);
    const float value = irradianceOf(shape, grid, sums, texel);
    texels[(size_t)j * lut.rowTexels + i] = (float4)(value, value, value, 0.0f);
}

#else
// Texels of all slices as single floats in rows of `stride`, with `border` texels of 0 before each row and at
// least as many behind it. Light beyond the rim of the iris does not scatter: it is 0 too. One work-item: one
// float.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void plain_eye_lut(
    const PelEyeShape shape, const PelEyeLutGrid grid, uint stride, uint border,
    __global const uint* restrict sums, __global float* restrict plain) {
    const uint i = get_global_id(0), row = get_global_id(1);
    if (i >= stride) return;
    const int column = (int)i - (int)border;
    const float y = ((float)(row % grid.height) + 0.5f) / (float)grid.height,
                chord = sqrt(max(1.0f - y * y, 0.0f));
    const int left = max((int)ceil((1.0f - chord) * 0.5f * (float)grid.width - 0.5f), 0),
              right = min((int)floor((1.0f + chord) * 0.5f * (float)grid.width - 0.5f), (int)grid.width - 1);
    const int lit = column >= left && column <= right;
    plain[(size_t)row * stride + i] =
        lit ? irradianceOf(shape, grid, sums, row * grid.width + (uint)column) : 0.0f;
}

// Convolves the plain texels with a profile. `weights`: the profile over (2 reachY + 1) x (2 reachX + 1)
// texels. `plain` has a border of reachX. One work-item: PEL_WIDTH texels of a row of the padded image, from
// `firstRow` on.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void scatter_eye_lut(
    const PelEyeLutGrid grid, const LutLayout lut, __global const float* restrict plain, uint stride,
    __global const float4* restrict weights, int reachX, int reachY, uint firstRow,
    __global float4* restrict texels) {
    const uint column = get_global_id(0) * PEL_WIDTH, j = firstRow + get_global_id(1);
    if (column >= lut.width) return;
    const uint from = min(j, lut.height - 1);
    const int row = (int)(from % grid.height);
    __global const float* slice = plain + (size_t)(from - (uint)row) * stride + column;
    floatw red = 0.0f, green = 0.0f, blue = 0.0f;
    for (int dy = -reachY; dy <= reachY; ++dy) {
        const int other = row + dy < 0 ? -1 - row - dy : row + dy;
        if (other >= (int)grid.height) continue;
        __global const float* line = slice + (size_t)other * stride;
        __global const float4* of = weights + (dy + reachY) * (2 * reachX + 1);
        for (int k = 0; k <= 2 * reachX; ++k) {
            const floatw value = loadw(k, line);
            const float4 weight = of[k];
            red = fma((floatw)(weight.x), value, red);
            green = fma((floatw)(weight.y), value, green);
            blue = fma((floatw)(weight.z), value, blue);
        }
    }
    float r[PEL_WIDTH], g[PEL_WIDTH], b[PEL_WIDTH];
    storew(red, 0, r);
    storew(green, 0, g);
    storew(blue, 0, b);
    __global float4* to = texels + (size_t)j * lut.rowTexels;
    for (uint lane = 0; lane < PEL_WIDTH && column + lane < lut.width; ++lane) {
        to[column + lane] = (float4)(r[lane], g[lane], b[lane], 0.0f);
        if (column + lane == lut.width - 1) to[lut.width] = to[column + lane];
    }
}
#endif
