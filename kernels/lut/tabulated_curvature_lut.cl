// Curvature LUT of a tabulated profile, R linear between distances: every form of curvature_lut.cl (section 2
// of the mathematics). As there, each row becomes E and F = -E' at the nodes of one mesh of angles phi behind
// the terminator, with
//   unlit side D(-u) = E + back u,   lit side D(+u) = E + front u,   u = sin phi.
//
// tabulated_rows solves E'' + E = K(phi) + K(pi - phi), swept from pi/2 to 0. K is the density P or R of the
// profile at the distance: the arc r t, or the chord 2r sin(t/2). K may have corners and steps, but its
// integrals from 0 on are smooth. Each interval of the mesh takes the integral of K and the moment of that
// integral from two of these. The weights of an interval are nearly linear in the distance (TableInterval).
// One work-item: PEL_ROWS rows, each in four lanes (red, green, blue, one unused).
//
// tabulated_sphere_rows: the circle of points at chord d receives the mean m(phi, d), which has a closed
// form. A row is a sum over the points and weights that represent the profile. One work-item: PEL_WIDTH nodes
// of a row.
//
// Variants: PEL_WIDTH; PEL_GROUP, work-items in a group; PEL_NODES, intervals of the mesh; PEL_COLUMNS
// (curvature_texels.clh); PEL_HALF: the half ring, without angles beyond pi/2.
#include "lib/width.clh"
#include "lut/curvature_texels.clh"

// Row value to radius of the circle, in diffusion radii.
static inline float rowRadius(const TabulatedCurvatureLutParams params, const uint row) {
    const float value = fma((float)row + 0.5f, params.rowStep, params.rowMin);
    return 1.0f / (params.axis == PEL_LUT_AXIS_ROOT ? value * value : value);
}

// PEL_ROWS rows of (R, G, B, 0).
#if PEL_WIDTH == 16
#define PEL_ROWS 4
typedef float16 rowsw;
#define OF_ROWS(F) ((float16)(F(0, s0), F(1, s4), F(2, s8), F(3, sc)))
#define PUT_ROWS(F) F(0, s0123) F(1, s4567) F(2, s89ab) F(3, scdef)
#define LAST_ROW(v) ((v).sc)
#elif PEL_WIDTH == 8
#define PEL_ROWS 2
typedef float8 rowsw;
#define OF_ROWS(F) ((float8)(F(0, s0), F(1, s4)))
#define PUT_ROWS(F) F(0, s0123) F(1, s4567)
#define LAST_ROW(v) ((v).s4)
#else
#define PEL_ROWS 1
typedef float4 rowsw;
#define OF_ROWS(F) (F(0, s0))
#define PUT_ROWS(F) F(0, s0123)
#define LAST_ROW(v) ((v).s0)
#endif

static inline void storeRows(__global float4* rows, const uint firstRow, const uint height, const uint slot,
                             const rowsw value) {
#define PUT(k, s) \
    if (firstRow + k < height) rows[(size_t)(firstRow + k) * ROW_STRIDE + slot] = (float4)(value.s.xyz, 0.0f);
    PUT_ROWS(PUT)
#undef PUT
}

// Adds a term by Kahan's method: many terms have about the same size, and plain float would round each in the
// same direction.
typedef struct Sum {
    rowsw value, lost;
} Sum;

static inline void add(Sum* sum, const rowsw term) {
    const rowsw due = term - sum->lost, next = sum->value + due;
    sum->lost = (next - sum->value) - due;
    sum->value = next;
}

// The integrals of the density up to a distance.
typedef struct Integrals {
    rowsw distance, density, total, moment;
} Integrals;

// Cubic between the distances of the list, which holds values and slopes. Distances beyond the end count as
// at it. Inlined: a call would pass everything in memory.
static inline __attribute__((always_inline)) Integrals integralsTo(__global const float* sums,
                                                                   const TabulatedCurvatureLutParams params,
                                                                   rowsw distance) {
    const float end = params.end, cells = (float)params.cells;
    Integrals found;
    found.distance = distance = fmin(distance, (rowsw)(end));
    const rowsw cell = trunc(fmin(sqrt(distance * (1.0f / end)) * cells, (rowsw)(cells - 1.0f)));
    const rowsw unit = end / (cells * cells), h = unit * (2.0f * cell + 1.0f), perLength = 1.0f / h;
    const rowsw t = clamp((distance - unit * cell * cell) * perLength, (rowsw)(0.0f), (rowsw)(1.0f)),
                u = 1.0f - t;
    const rowsw value0 = u * u * (1.0f + 2.0f * t), value1 = t * t * (3.0f - 2.0f * t);
    const rowsw slope0 = u * u * t * h, slope1 = t * t * u * h;
#define CELL(k, s) vload4(0, sums + ((int)cell.s * PEL_SUM_VALUES + VALUE) * 4)
#define VALUE PEL_SUM_DENSITY
    const rowsw density0 = OF_ROWS(CELL);
#undef VALUE
#define VALUE PEL_SUM_TOTAL
    const rowsw total0 = OF_ROWS(CELL);
#undef VALUE
#define VALUE PEL_SUM_MOMENT
    const rowsw moment0 = OF_ROWS(CELL);
#undef VALUE
#define VALUE (PEL_SUM_VALUES + PEL_SUM_DENSITY)
    const rowsw density1 = OF_ROWS(CELL);
#undef VALUE
#define VALUE (PEL_SUM_VALUES + PEL_SUM_TOTAL)
    const rowsw total1 = OF_ROWS(CELL);
#undef VALUE
#define VALUE (PEL_SUM_VALUES + PEL_SUM_MOMENT)
    const rowsw moment1 = OF_ROWS(CELL);
#undef VALUE
#undef CELL
    found.density = (6.0f * t * u * perLength) * (total1 - total0) + density0 * u * (1.0f - 3.0f * t) +
                    density1 * t * (1.0f - 3.0f * u);
    found.total = total0 * value0 + density0 * slope0 + total1 * value1 - density1 * slope1;
    found.moment = moment0 * value0 + total0 * slope0 + moment1 * value1 - total1 * slope1;
    return found;
}

// Contribution of the density between two distances to E, F, the light and the total.
typedef struct Gain {
    rowsw toE, toF, light, total;
} Gain;

static inline void gain(Gain* sum, const TableSide side, const Integrals* nearer, const Integrals* further,
                        const rowsw perRadius) {
    const rowsw length = further->distance - nearer->distance;
    const rowsw total =
        further->total - nearer->total;  // rounding may make it negative, and the next interval's greater
    rowsw moment = length * further->total - (further->moment - nearer->moment);
    if (side.antipodal)
        moment = length * (0.5f * total + (further->density - nearer->density) * length * (1.0f / 12.0f));
    const rowsw max = length * total;
    moment = clamp(moment, fmin(max, (rowsw)(0.0f)), fmax(max, (rowsw)(0.0f))) * perRadius;
    sum->toE += total * side.toE.at + moment * side.toE.slope;
    sum->toF += total * side.toF.at + moment * side.toF.slope;
    sum->light += total * side.light.at + moment * side.light.slope;
    sum->total += total * side.total.at + moment * side.total.slope;
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void tabulated_rows(
    const TabulatedCurvatureLutParams params, __global const TableInterval* restrict mesh,
    __global const float* restrict sums, __global const float4* restrict antipodes,
    __global float4* restrict rows) {
    const uint firstRow = get_global_id(0) * PEL_ROWS;
    if (firstRow >= params.height) return;
#define RADIUS(k, s) (float4)(rowRadius(params, min(firstRow + k, params.height - 1)))
    const rowsw r = OF_ROWS(RADIUS), perRadius = 1.0f / r;
#undef RADIUS
#define ANTIPODE(k, s) antipodes[min(firstRow + k, params.height - 1)]
    const rowsw antipode = OF_ROWS(ANTIPODE) * r;
#undef ANTIPODE
    const rowsw zero = 0.0f;
    Sum E = {zero, zero}, F = E;
    rowsw front = zero, back = zero, total = zero;
    storeRows(rows, firstRow, params.height, 2 * PEL_NODES, zero);
    storeRows(rows, firstRow, params.height, 2 * PEL_NODES + 1, zero);
    Integrals ahead = integralsTo(sums, params, r * params.frontReach), behind = ahead;
    for (int j = PEL_NODES - 1; j >= 0; --j) {
        const TableInterval interval = mesh[j];
        Gain inFront = {zero, zero, zero, zero}, inBack = inFront;
        // The last row is the smallest circle, where distances are shortest. In most rows the profile ends
        // early.
        if (LAST_ROW(r) * interval.front.distance < params.end) {
            const Integrals nearer = integralsTo(sums, params, r * interval.front.distance);
            gain(&inFront, interval.front, &nearer, &ahead, perRadius);
            ahead = nearer;
        }
#ifndef PEL_HALF
        if (interval.back.antipodal > 1.0f) {
            inBack.toE = antipode * interval.back.toE.at, inBack.toF = antipode * interval.back.toF.at;
            inBack.light = antipode * interval.back.light.at;
            inBack.total = antipode * interval.back.total.at;
        } else if (LAST_ROW(behind.distance) < params.end) {
            const Integrals further = integralsTo(sums, params, r * interval.back.distance);
            gain(&inBack, interval.back, &behind, &further, perRadius);
            behind = further;
        }
#endif
        // Computed as differences, so that short steps do not lose 1 - cos h.
        const rowsw e = E.value, f = F.value;
        add(&E, f * interval.sine - e * interval.versine + (inFront.toE + inBack.toE));
        add(&F, (inFront.toF + inBack.toF) - e * interval.sine - f * interval.versine);
        front += inFront.light, back += inBack.light;
        total += inFront.total + inBack.total;
        storeRows(rows, firstRow, params.height, 2 * j, E.value);
        storeRows(rows, firstRow, params.height, 2 * j + 1, F.value);
    }
    rowsw scale = 1.0f;
    front *= 2.0f, back *= 2.0f;
    if (params.normalised) {
        // If a channel has no energy within the circle, nothing scatters: E is 0 and front 1.
        scale = 0.5f / fmax(total, (rowsw)(1e-30f));
        front = select((rowsw)(1.0f), front * scale, total > 0.0f);
        back *= scale;
    }
    // Values that are nearly 0 may come out negative by rounding.
    storeRows(rows, firstRow, params.height, 2 * PEL_NODES + 2, fmax(back, zero));
    storeRows(rows, firstRow, params.height, 2 * PEL_NODES + 3, front);
    storeRows(rows, firstRow, params.height, 2 * PEL_NODES + 4, scale);
}

// acos to 2e-8 (Abramowitz and Stegun, Handbook of Mathematical Functions, 4.4.46), over pi.
static inline floatw acosOverPi(const floatw x) {
    const floatw a = fabs(x);
    floatw sum = fma(a, (floatw)(-0.0012624911f), (floatw)(0.0066700901f));
    sum = fma(a, sum, (floatw)(-0.0170881256f));
    sum = fma(a, sum, (floatw)(0.0308918810f));
    sum = fma(a, sum, (floatw)(-0.0501743046f));
    sum = fma(a, sum, (floatw)(0.0889789874f));
    sum = fma(a, sum, (floatw)(-0.2145988016f));
    sum = fma(a, sum, (floatw)(1.5707963050f));
    const floatw angle = sqrt(1.0f - a) * sum * M_1_PI_F;
    return selectw(angle, 1.0f - angle, x < 0.0f);
}

// With a = cos theta cos psi, b = sin theta sin psi and theta = pi/2 + phi, the mean over the circle at
// colatitude psi is (a acos(-a/b) + sqrt(b^2 - a^2)) / pi, 0 from a = -b and a from b on; its derivatives by
// a and b are acos(-a/b) / pi and sqrt(1 - a^2/b^2) / pi.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void tabulated_sphere_rows(
    const TabulatedCurvatureLutParams params, __global const LutNode* restrict nodes,
    __global const TablePoints* restrict pointsOfRow, __global const float4* restrict points,
    __global float4* restrict rows) {
    const uint firstNode = get_global_id(0) * PEL_WIDTH;
    if (firstNode > PEL_NODES) return;
    const uint row = get_global_id(1);
    const float perDiameter = 0.5f / rowRadius(params, row);
    const TablePoints range = pointsOfRow[row];
    __global float4* record = rows + (size_t)row * ROW_STRIDE;
    float sines[PEL_WIDTH], cosines[PEL_WIDTH];
    for (uint lane = 0; lane < PEL_WIDTH; ++lane) {
        const LutNode node = nodes[min(firstNode + lane, (uint)PEL_NODES)];
        sines[lane] = node.sine, cosines[lane] = node.cosine;
    }
    const floatw sinPhi = loadw(0, sines), cosPhi = loadw(0, cosines);
    const floatw tanPhi = sinPhi / fmax(cosPhi, (floatw)(1e-30f));
    const float nearest = sines[0];  // circles with a smaller sin(psi) are all dark
    floatw Er = 0.0f, Eg = 0.0f, Eb = 0.0f, Fr = 0.0f, Fg = 0.0f, Fb = 0.0f;
    float4 cosineMean = 0.0f;
    for (uint i = range.first; i < range.first + range.count; ++i) {
        const float4 point = points[i];
        const float x = fmin(point.w * perDiameter, 1.0f);  // sin(psi/2)
        const float cosPsi = 1.0f - 2.0f * x * x, sinPsi = 2.0f * x * sqrt((1.0f - x) * (1.0f + x));
        cosineMean += point * cosPsi;
        if (cosPsi > 0.0f && sinPsi <= nearest) continue;
        const float cotPsi = cosPsi / fmax(sinPsi, 1e-30f);
        const floatw q = clamp(tanPhi * cotPsi, -1.0f, 1.0f);  // -a / b
        const floatw byA = acosOverPi(q), byB = sqrt(fma(-q, q, (floatw)(1.0f))) * M_1_PI_F;
        const floatw alongA = byA * cosPsi, alongB = byB * sinPsi;
        const floatw m = fma(cosPhi, alongB, -sinPhi * alongA);
        const floatw slope = fma(cosPhi, alongA, sinPhi * alongB);  // -dm/dphi
        Er = fma(m, (floatw)(point.x), Er);
        Eg = fma(m, (floatw)(point.y), Eg);
        Eb = fma(m, (floatw)(point.z), Eb);
        Fr = fma(slope, (floatw)(point.x), Fr);
        Fg = fma(slope, (floatw)(point.y), Fg);
        Fb = fma(slope, (floatw)(point.z), Fb);
    }
    float values[6][PEL_WIDTH];
    storew(Er, 0, values[0]);
    storew(Eg, 0, values[1]);
    storew(Eb, 0, values[2]);
    storew(Fr, 0, values[3]);
    storew(Fg, 0, values[4]);
    storew(Fb, 0, values[5]);
    for (uint lane = 0; lane < PEL_WIDTH && firstNode + lane <= PEL_NODES; ++lane) {
        __global float4* node = record + 2 * (firstNode + lane);
        node[0] = (float4)(values[0][lane], values[1][lane], values[2][lane], 0.0f);
        node[1] = (float4)(values[3][lane], values[4][lane], values[5][lane], 0.0f);
    }
    if (firstNode == 0) {
        // max0(x) - max0(-x) is x, whose mean is that of cos psi.
        __global float4* last = record + 2 * PEL_NODES + 2;
        last[0] = 0.0f;
        last[1] = (float4)(cosineMean.xyz, 0.0f);
        last[2] = 1.0f;
    }
}
