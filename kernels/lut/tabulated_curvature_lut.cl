// Curvature LUT of a tabulated profile, R linear between distances: every form of curvature_lut.cl (section 2
// of the mathematics). As in curvature_lut.cl each row becomes nodes at angles phi behind the terminator with
// E and F = -E',
//   unlit side D(-u) = E + back u,   lit side D(+u) = E + front u,   u = sin phi,
// and texels are cubics between nodes. Here each row stores the angles of its nodes, which may differ from
// row to row.
//   tabulated_arc_rows     E'' + E = K(phi) + K(pi - phi), K = r P(r t), swept from pi/2 to 0. P has corners, but its
//                          tail is smoother: an interval adds its mass, a difference of tails, and the moment of that mass,
//                          from K at both ends. PEL_CHORD is penner-ring, K = P(2r sin(t/2)): masses over chords, divided by
//                          dchord/dt; where the chord hardly changes, from K alone.
//   tabulated_ring_rows    the same with K = R(2r sin(t/2)), which is smooth between the angles where R bends: these
//                          become nodes of their row.
//   tabulated_sphere_rows  the circle of points at chord d receives the mean m(phi, d), a closed form: a sum over the
//                          points and weights that represent the profile.
//
// One work-item: tabulated_arc_rows, tabulated_ring_rows a row; tabulated_sphere_rows PEL_WIDTH nodes of a row; tabulated_texels PEL_COLUMNS
// columns of the unlit half of a row, and their mirror images.
// Variants: PEL_WIDTH; PEL_GROUP, work-items in a group; PEL_COLUMNS; PEL_HALF: the half ring; PEL_CHORD.
#include "lib/lut/profile_tails.clh"
#include "lib/width.clh"
#include "shared/lut.h"

// A row's record: E (angle in w) and F of `slots` nodes, angles rising, of which the first may be unused;
// back (first used node in w), front, scale of E.
#define RECORD(params) PEL_TABLE_RECORD((size_t)(params).slots)

// In diffusion radii.
inline float rowRadius(const TabulatedCurvatureLutParams params, const uint row) {
    const float value = fma((float)row + 0.5f, params.rowStep, params.rowMin);
    return 1.0f / (params.axis == PEL_LUT_AXIS_ROOT ? value * value : value);
}

inline void storeNode(__global float4* record, const uint slot, const float angle, const float4 E,
                      const float4 F) {
    record[2 * slot] = (float4)(E.xyz, angle);
    record[2 * slot + 1] = (float4)(F.xyz, 0.0f);
}

// Kahan's sum: thousands of terms of about the same size, which plain float would round in the same direction
// each time.
typedef struct Sum {
    float4 value, lost;
} Sum;

inline void add(Sum* sum, const float4 term) {
    const float4 due = term - sum->lost, next = sum->value + due;
    sum->lost = (next - sum->value) - due;
    sum->value = next;
}

// E and F at the next node, h further down, including what K adds between. Computed as differences, so that
// short steps do not lose 1 - cos h.
inline void turn(Sum* E, Sum* F, const float h, const float4 addE, const float4 addF) {
    const float half_ = sin(0.5f * h), versine = 2.0f * half_ * half_, s = sin(h);
    const float4 e = E->value, f = F->value;
    add(E, f * s - e * versine + addE);
    add(F, addF - e * s - f * versine);
}

// Distance from the point to another one at the angle, and its derivative.
#ifdef PEL_CHORD
#define DISTANCE(r, angle) (2.0f * (r)*sin(0.5f * (angle)))
#define BEHIND(r, angle) (2.0f * (r)*cos(0.5f * (angle)))  // at pi - angle
#else
#define DISTANCE(r, angle) ((r) * (angle))
#define BEHIND(r, angle) ((r) * (M_PI_F - (angle)))
#endif

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void tabulated_arc_rows(
    const TabulatedCurvatureLutParams params, __global const LutNode* nodes, __global const float4* tails,
    __global float4* rows) {
    if (get_global_id(0) >= params.rows) return;
    const float r = rowRadius(params, params.firstRow + (uint)get_global_id(0));
    const float end = params.end;
    __global float4* record = rows + get_global_id(0) * RECORD(params);
    Sum E = {0.0f, 0.0f}, F = E;
    float4 front = 0.0f, back = 0.0f;
    float4 frontTail = tailAt(tails, PEL_TAIL_MASS, DISTANCE(r, M_PI_2_F), end), backTail = frontTail;
    float4 frontK = r * spreadAt(tails, DISTANCE(r, M_PI_2_F), end), backK = frontK;
#ifdef PEL_CHORD
    Sum mass = {0.0f, 0.0f};
#endif
    for (int j = (int)params.nodes - 1; j >= 0; --j) {
        const float angle = nodes[j].angle;
        if (j + 1 < (int)params.nodes) {
            const float h = nodes[j + 1].angle - angle;
            const float4 frontNext = tailAt(tails, PEL_TAIL_MASS, DISTANCE(r, angle), end),
                         backNext = tailAt(tails, PEL_TAIL_MASS, BEHIND(r, angle), end);
            const float4 frontNextK = r * spreadAt(tails, DISTANCE(r, angle), end),
                         backNextK = r * spreadAt(tails, BEHIND(r, angle), end);
            float4 frontMass = fmax(frontNext - frontTail, 0.0f), backMass = fmax(backTail - backNext, 0.0f);
#ifdef PEL_CHORD
            const float middle = angle + 0.5f * h;
            frontMass /= cos(0.5f * middle);
            if (middle > 0.2f)
                backMass /= sin(0.5f * middle);
            else
                backMass = 0.5f * h * r *
                           (spreadAt(tails, BEHIND(r, angle + 0.211324865f * h), end) +
                            spreadAt(tails, BEHIND(r, angle + 0.788675135f * h), end));
            add(&mass, frontMass + backMass);
#endif
            // About this node: the middle, and to which side K leans.
            const float third = h * h * (1.0f / 12.0f);
            const float4 frontMoment =
                clamp(0.5f * h * frontMass + third * (frontK - frontNextK), 0.0f, h * frontMass);
            const float4 backMoment =
                clamp(0.5f * h * backMass + third * (backK - backNextK), 0.0f, h * backMass);
            const float4 all = frontMass + backMass, moment = frontMoment + backMoment;
            turn(&E, &F, h, moment * (1.0f - third), all - moment * (h * (1.0f / 3.0f)));
            const float sine = nodes[j].sine, cosine = nodes[j].cosine;
            front += frontMass * cosine - frontMoment * (sine + cosine * (h * (1.0f / 3.0f)));
            back += backMass * cosine - backMoment * (sine + cosine * (h * (1.0f / 3.0f)));
            frontTail = frontNext, backTail = backNext, frontK = frontNextK, backK = backNextK;
        }
        storeNode(record, (uint)j, angle, E.value, F.value);
    }
    float4 scale = 1.0f;
#ifdef PEL_CHORD
    scale = 0.5f / mass.value;
#endif
    __global float4* last = record + 2 * params.slots;
    last[0] = (float4)((2.0f * back * scale).xyz, 0.0f);
    last[1] = 2.0f * front * scale;
    last[2] = scale;
}

// R at a chord on the piece that begins at knot `piece`.
inline float4 radialOn(__global const float4* knots, const uint piece, const float chord) {
    const float4 low = knots[piece], high = knots[piece + 1];
    return fmax(low + ((chord - low.w) / (high.w - low.w)) * (high - low), 0.0f);
}

// The angle whose chord on a circle of that diameter reaches a knot; pi where none does.
inline float knotAngle(const float distance, const float diameter) {
    return 2.0f * asin(fmin(distance / diameter, 1.0f));
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void tabulated_ring_rows(
    const TabulatedCurvatureLutParams params, __global const LutNode* nodes, __global const float4* knots,
    __global float4* rows) {
    if (get_global_id(0) >= params.rows) return;
    const float diameter = 2.0f * rowRadius(params, params.firstRow + (uint)get_global_id(0));
    __global float4* record = rows + get_global_id(0) * RECORD(params);
    // R scaled to about 1, so that no radius leaves the range of float.
    const float4 peak = fmax(knots[0], fmax(radialOn(knots, 0, diameter), 1e-30f));
    Sum E = {0.0f, 0.0f}, F = E, front = E, back = E, mass = E;
    // In front: the last knot not beyond pi/2, and the piece that begins there. Behind: the first knot beyond
    // it. Knot `knots` is the last; beyond it R is 0.
    int frontPiece = (int)params.knots, node = (int)params.nodes - 1;
    while (frontPiece > 0 && knotAngle(knots[frontPiece].w, diameter) >= M_PI_2_F) --frontPiece;
    int backPiece = frontPiece;
    uint slot = params.slots - 1;
    float angle = M_PI_2_F;
    storeNode(record, slot, angle, E.value, F.value);
    while (node > 0 && slot > 0) {
        // The next border downwards: a node, a knot in front, or one behind.
        const float lower = nodes[node - 1].angle;
        const float frontKnot = frontPiece > 0 ? knotAngle(knots[frontPiece].w, diameter) : 0.0f;
        float backKnot = 0.0f;
#ifndef PEL_HALF
        if (backPiece < (int)params.knots) backKnot = M_PI_F - knotAngle(knots[backPiece + 1].w, diameter);
#endif
        const float next = fmax(lower, fmax(frontKnot, backKnot));
        const float h = angle - next;
        if (h > 0.0f) {
            float4 addE = 0.0f, addF = 0.0f;
            for (int q = 0; q < 2; ++q) {
                const float d = h * (q ? 0.788675135f : 0.211324865f), t = next + d, weight = 0.5f * h;
                const float sd = sin(d), cd = cos(d), cosine = cos(t);
                if (frontPiece < (int)params.knots) {
                    const float4 k = weight * radialOn(knots, (uint)frontPiece, diameter * sin(0.5f * t)) / peak;
                    addE += k * sd;
                    addF += k * cd;
                    add(&front, k * cosine);
                    add(&mass, k);
                }
#ifndef PEL_HALF
                if (backPiece < (int)params.knots) {
                    const float4 k = weight * radialOn(knots, (uint)backPiece, diameter * cos(0.5f * t)) / peak;
                    addE += k * sd;
                    addF += k * cd;
                    add(&back, k * cosine);
                    add(&mass, k);
                }
#endif
            }
            turn(&E, &F, h, addE, addF);
            --slot;
            storeNode(record, slot, next, E.value, F.value);
            angle = next;
        }
        if (next == lower) --node;
        if (frontPiece > 0 && next == frontKnot) --frontPiece;
        if (backPiece < (int)params.knots && next == backKnot) ++backPiece;
    }
    // If a channel's table has no energy within the circle, nothing scatters: E is 0 and front 1.
    const int4 empty = mass.value <= 0.0f;
    const float4 scale = select(0.5f / mass.value, (float4)(0.0f), empty);
    __global float4* last = record + 2 * params.slots;
    last[0] = (float4)((2.0f * back.value * scale).xyz, (float)slot);
    last[1] = select(2.0f * front.value * scale, (float4)(1.0f), empty);
    last[2] = scale;
}

// acos to 2e-8 (Abramowitz and Stegun, Handbook of Mathematical Functions, 4.4.46), over pi.
inline floatw acosOverPi(const floatw x) {
    const floatw a = fmin(fabs(x), 1.0f);
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

// With a = cos theta cos psi, b = sin theta sin psi and theta = pi/2 + phi, the mean over the circle at colatitude psi is
// (a acos(-a/b) + sqrt(b^2 - a^2)) / pi, 0 from a = -b and a from b on; its derivatives by a and b are acos(-a/b) / pi
// and sqrt(1 - a^2/b^2) / pi.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void tabulated_sphere_rows(
    const TabulatedCurvatureLutParams params, __global const LutNode* nodes,
    __global const TablePoints* pointsOfRow, __global const float4* points, __global float4* rows) {
    const uint firstNode = get_global_id(0) * PEL_WIDTH;
    if (firstNode >= params.nodes) return;
    const uint row = get_global_id(1);
    const float diameter = 2.0f * rowRadius(params, params.firstRow + row);
    const TablePoints range = pointsOfRow[params.firstRow + row];
    __global float4* record = rows + row * RECORD(params);
    float sines[PEL_WIDTH], cosines[PEL_WIDTH], angles[PEL_WIDTH];
    for (uint lane = 0; lane < PEL_WIDTH; ++lane) {
        const LutNode node = nodes[min(firstNode + lane, params.nodes - 1)];
        sines[lane] = node.sine, cosines[lane] = node.cosine, angles[lane] = node.angle;
    }
    const floatw sinPhi = loadw(0, sines), cosPhi = loadw(0, cosines);
    const float nearest = angles[0];  // nothing nearer than this reaches the light
    floatw Er = 0.0f, Eg = 0.0f, Eb = 0.0f, Fr = 0.0f, Fg = 0.0f, Fb = 0.0f;
    float4 cosineMean = 0.0f;
    for (uint i = range.first; i < range.first + range.count; ++i) {
        const float4 point = points[i];
        const float x = fmin(point.w / diameter, 1.0f);  // sin(psi/2)
        const float cosPsi = 1.0f - 2.0f * x * x, sinPsi = 2.0f * x * sqrt((1.0f - x) * (1.0f + x));
        cosineMean += point * cosPsi;
        if (x < 0.5f && 2.2f * x < nearest) continue;  // psi < 2.2 x there
        const floatw a = -sinPhi * cosPsi, b = cosPhi * sinPsi;
        const floatw q = clamp(-a / fmax(b, 1e-30f), -1.0f, 1.0f);
        const floatw byA = acosOverPi(q), byB = sqrt((1.0f - q) * (1.0f + q)) * M_1_PI_F;
        const floatw m = fma(a, byA, b * byB);
        const floatw slope = fma(cosPhi * cosPsi, byA, sinPhi * sinPsi * byB);  // -dm/dphi
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
    for (uint lane = 0; lane < PEL_WIDTH && firstNode + lane < params.nodes; ++lane)
        storeNode(record, firstNode + lane, angles[lane],
                  (float4)(values[0][lane], values[1][lane], values[2][lane], 0.0f),
                  (float4)(values[3][lane], values[4][lane], values[5][lane], 0.0f));
    if (firstNode == 0) {
        // max0(x) - max0(-x) is x, whose mean is that of cos psi.
        __global float4* last = record + 2 * params.slots;
        last[0] = 0.0f;
        last[1] = (float4)(cosineMean.xyz, 0.0f);
        last[2] = 1.0f;
    }
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void tabulated_texels(
    const TabulatedCurvatureLutParams params, __global const float4* rows,
    __global const TableColumn* columns, __global float4* texels) {
    const uint unlit = (params.width + 1) / 2;
    const uint begin = get_global_id(0) * PEL_COLUMNS;
    if (begin >= unlit) return;
    const uint y = params.firstRow + get_global_id(1);
    const uint row = min((uint)get_global_id(1), params.rows - 1);
    __global const float4* record = rows + row * RECORD(params);
    __global float4* line = texels + (size_t)y * (params.width + 1);
    const float4 back = record[2 * params.slots], front = record[2 * params.slots + 1],
                 scale = record[2 * params.slots + 2];
    const uint firstNode = (uint)back.w;
    for (uint x = begin; x < min(begin + PEL_COLUMNS, unlit); ++x) {
        const TableColumn column = columns[x];
        uint low = firstNode, high = params.slots - 1;
        while (high - low > 1) {
            const uint middle = (low + high) / 2;
            if (record[2 * middle].w > column.angle)
                high = middle;
            else
                low = middle;
        }
        const float4 E0 = record[2 * low], E1 = record[2 * low + 2];
        const float h = E1.w - E0.w, t = clamp((column.angle - E0.w) / h, 0.0f, 1.0f), u = 1.0f - t;
        float4 E = u * u * ((1.0f + 2.0f * t) * E0 - h * t * record[2 * low + 1]) +
                   t * t * ((3.0f - 2.0f * t) * E1 + h * u * record[2 * low + 3]);
        E = fmax(E, 0.0f) * scale;
        float4 dark = fma((float4)(column.elevation), back, E), lit = fma((float4)(column.elevation), front, E);
        dark.w = lit.w = 0.0f;
        line[x] = dark;
        line[params.width - 1 - x] = lit;
    }
    if (begin == 0) line[params.width] = line[params.width - 1];
}
