// The caustic of a cornea on the iris (section 13 of the mathematics): the wavefront of each slice's light is carried
// through the refracting surface, cell by cell, and each cell's flux is spread over the texels that it lands on, in proportion
// to the area that it covers there. Nothing is lost between texels.
//
// Inputs: PelEyeShape in units of the iris' radius, PelEyeLutGrid. Cells lie in rows of equal angles, y = limbus sin a, x = limbus u cos a,
// u from -1 to 1, so that they end exactly at the limbus. Sums are whole numbers, whose order does not matter: same
// input, same bits.
//
// eye_lut: one work-item is PEL_WIDTH cells of a row. finish_eye_lut: one work-item is one texel of lut->layout, with its
// copied column and row. scatter_eye_lut: the same, for an iris that scatters. Variants: PEL_WIDTH, PEL_GROUP.
#include "lib/eye/eye_shape.clh"
#include "shared/lut.h"

#define HALF_PI 1.57079632679489662f
#define MOST_TEXELS 8.0f  // that a cell covers along an axis

typedef struct Landing {
    floatw x, y;   // on the iris' plane
    floatw share;  // of the flux through the cell, from all losses
    floatw slope;  // flux per area of the limbus' plane, of a beam of irradiance 1
} Landing;

// From the cornea's point above (x, y). Light comes from (sine, 0, cosine).
static inline Landing carry(const PelEyeShape s, floatw x, floatw y, float sine, float cosine) {
    Landing landing;
    Vec3w n;
    Vec3w p = corneaAt(s, x, y, &n);
    const floatw facing = fma(n.x, (floatw)(sine), n.z * cosine);
    // The sclera's horizon.
    const floatw ahead = fma(p.x, (floatw)(sine), p.z * cosine), above = dot3(p, p) - s.sclera2;
    const maskw blocked = (facing <= 0.0f) | ((ahead < 0.0f) & (ahead * ahead > above));
    landing.slope = selectw(facing / n.z, (floatw)(0.0f), blocked);
    const floatw c = max0w(facing);
    const floatw behind = cosineBehind(c, 1.0f / s.aqueousIndex);
    landing.share = corneaTransmittance(c, behind, s.corneaIndex, s.aqueousIndex);
    Vec3w d = refracted(vec3((floatw)(-sine), (floatw)(0.0f), (floatw)(-cosine)), n, c, behind,
                        1.0f / s.aqueousIndex);
    floatw length = toIris(s, p, d);
    // Light that runs so level that it meets the cornea again, from inside. Both ends lie on the conic.
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
    // What runs into the wall behind the limbus is lost.
    const floatw z = fma(length, d.z, p.z);
    const maskw lost = fma(landing.x, landing.x, fma(landing.y, landing.y, z * z)) > s.sclera2;
    landing.share = selectw(landing.share, (floatw)(0.0f), lost);
    return landing;
}

// Adds one cell's flux to the texels that a box covers, whose edges are in texels. Rows below 0 are mirror images of those above.
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
                                                                             __global uint* sums) {
    const uint first = get_global_id(0) * PEL_WIDTH, row = get_global_id(1), slice = get_global_id(2);
    const float turn = HALF_PI / (float)grid.rows, a = ((float)row + 0.5f) * turn;
    const float across = shape.limbus * cos(a), y = shape.limbus * sin(a);
    // Cells of one length in all rows.
    const uint columns = (uint)ceil((float)grid.columns * cos(a));
    if (first >= columns) return;
    sums += (size_t)slice * grid.width * grid.height;
    const float angle = (float)slice * grid.anglePerSlice, sine = sin(angle), cosine = cos(angle);
    const float step = 2.0f / (float)columns;
    const floatw u = fma(convert_floatw(lanesw() + (int)first) + 0.5f, (floatw)(step), (floatw)(-1.0f));
    const Landing here = carry(shape, u * across, (floatw)(y), sine, cosine);
    const float texelsX = 0.5f * (float)grid.width, texelsY = (float)grid.height;
    const float area = across * across * step * turn * texelsX * texelsY;
    const maskw inside = lanesw() + (int)first < (int)columns;
    const floatw flux = selectw((floatw)(0.0f), here.slope * here.share * (area * grid.perTexel), inside);
    if (!anyw(flux > 0.0f)) return;
    // What the cell covers, from where its neighbours land.
    const Landing next = carry(shape, (u + step) * across, (floatw)(y), sine, cosine);
    const Landing below =
        carry(shape, u * (shape.limbus * cos(a + turn)), (floatw)(shape.limbus * sin(a + turn)), sine, cosine);
    const floatw ax = (next.x - here.x) * texelsX, ay = (next.y - here.y) * texelsY;
    const floatw bx = (below.x - here.x) * texelsX, by = (below.y - here.y) * texelsY;
    // A box of the same extent in y, and in x of the same area; a cell that lands on edge is as wide as it is.
    floatw high = fmax(fabs(by), fabs(ay)),
           wide = fmax(fabs(ax), fabs(ax * by - ay * bx) / fmax(high, (floatw)(1e-3f)));
    high = clamp(high, (floatw)(1e-3f), (floatw)(MOST_TEXELS));
    wide = clamp(wide, (floatw)(1e-3f), (floatw)(MOST_TEXELS));
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

// The texel that (i, j) of the padded image stands for.
static inline uint texelOf(const LutLayout lut, uint i, uint j) {
    return min(j, lut.height - 1) * lut.width + min(i, lut.width - 1);
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void finish_eye_lut(const PelEyeShape shape,
                                                                                    const PelEyeLutGrid grid,
                                                                                    const LutLayout lut,
                                                                                    __global const uint* sums,
                                                                                    __global float4* texels) {
    const uint i = get_global_id(0), j = get_global_id(1);
    if (i >= lut.rowTexels) return;
    const uint texel = texelOf(lut, i, j), column = texel % lut.width, row = texel / lut.width % grid.height;
    const float x = fma((float)column + 0.5f, 2.0f / (float)grid.width, -1.0f),
                y = ((float)row + 0.5f) / (float)grid.height;
    const float slope2 = 4.0f * shape.irisBend * shape.irisBend * fma(x, x, y * y);
    const float value = (float)sums[texel] / (grid.perTexel * sqrt(1.0f + slope2));
    texels[(size_t)j * lut.rowTexels + i] = (float4)(value, value, value, 0.0f);
}

// `weights`: the profile over (2 reachY + 1) x (2 reachX + 1) texels. Light beside the iris' rim does not scatter.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void scatter_eye_lut(
    const PelEyeLutGrid grid, const LutLayout lut, __global const float4* plain,
    __global const float4* weights, int reachX, int reachY, __global float4* texels) {
    const uint i = get_global_id(0), j = get_global_id(1);
    if (i >= lut.rowTexels) return;
    const uint texel = texelOf(lut, i, j);
    const int column = (int)(texel % lut.width), row = (int)(texel / lut.width % grid.height),
              height = (int)grid.height;
    __global const float4* slice =
        plain + (size_t)(texel / lut.width / grid.height) * grid.height * lut.rowTexels;
    float4 sum = (float4)(0.0f);
    for (int dy = -reachY; dy <= reachY; ++dy) {
        const int other = row + dy < 0 ? -1 - row - dy : row + dy;
        if (other >= height) continue;
        const float y = ((float)other + 0.5f) / (float)height, chord = sqrt(max(1.0f - y * y, 0.0f));
        const int left = max((int)ceil((1.0f - chord) * 0.5f * (float)grid.width - 0.5f), column - reachX),
                  right = min((int)floor((1.0f + chord) * 0.5f * (float)grid.width - 0.5f), column + reachX);
        __global const float4* of = weights + (dy + reachY) * (2 * reachX + 1) + reachX - column;
        for (int k = left; k <= right; ++k) sum = fma(of[k], slice[other * (int)lut.rowTexels + k], sum);
    }
    texels[(size_t)j * lut.rowTexels + i] = sum;
}
