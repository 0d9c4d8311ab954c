// Curvature by a local polynomial through the two-ring of each slot (mathematics, section 5): heights over the tangent
// plane of the given normal, fitted by least squares with slope, quadratic and cubic terms. The slope
// corrects the normal. The cubic terms absorb what would otherwise disturb the quadratic ones on irregular
// meshes, and are not used further. Only positions are measured: the normal says which direction is up. A
// normal that is far off the normals of its ring, as where noise folded a sliver over, is replaced by their
// mean.
//
// Heights are bent first: q becomes q r^2 / (r^2 + q^2), r being the distance along the plane. A circle
// through the slot that touches the plane, q = k (r^2 + q^2) / 2, then becomes exactly the parabola k r^2 /
// 2. So spheres and cylinders leave no terms of fourth order, which a fit of third order would take for
// quadratic ones, the more, the longer the cells are. The plane must touch the surface for that: the slope of
// the ring, unless it is small, is taken off first, and the bending fades out where the ring is still steep.
//
// The two-ring is walked as the rings of the ring. Where those are closed, their walks begin after the slot's
// own neighbours and leave out the last vertex, with which the next walk begins, so each vertex of the
// two-ring counts once. Some count several times: at borders; where triangles are not consistently oriented;
// and the one vertex behind a neighbour with four neighbours, which is kept although the next walk begins
// with it (on meshes of four and eight neighbours that takes up to a sixth off the error).
//
// Where a ring is small among larger triangles, or thinner than the two-ring, most of that lies outside of what the ring says
// is near, and what is left does not tell nine numbers. Such slots are fitted once more, to all of the two-ring in
// coordinates that its own moments give. Positions are known to float rounding only, and where points stand so that H would
// be off by more than that allows, the fit is done again too; if that does not help, to the rings of all these points.
//
// Of a ring with many neighbours (the hub of a fan, seen from its rim) only the nearest on either side are
// walked.
//
// What the points leave open (fewer than nine, all on a line) a ridge decides, towards a quadric and then a plane; a
// term whose pivot is lost to rounding is dropped. The result is always finite. Such slots are counted.
//
// Inputs: position (length) and unit normal of each slot, one-rings (shared/mesh.h), links and rounds (mesh_links.cl).
// Output: lib/mesh/principal.clh; counts->lowDegreeFits, where counts is not NULL.
//
// One work-item: PEL_WIDTH slots.
//
// Variants: PEL_MESH_STRIDE, PEL_MESH_RUNS (lib/mesh/mesh_slots.clh), PEL_MESH_PLANES (lib/mesh/principal.clh).

#include "lib/mesh/mesh_frame.clh"

#define TERMS 9  // u, v, u^2/2, u v, v^2/2, u^3/6, u^2 v/2, u v^2/2, v^3/6
#define PRODUCTS (TERMS * (TERMS + 1) / 2)
#define PRODUCT(row, column) ((row) * ((row) + 1) / 2 + (column))  // column <= row

// A point at distance r, in units of twice the ring's reach, weighs 1 / (this + r^2): near points tell about
// the slot, far ones about its surroundings. Measured on tori against equal weights: 10 to 25 % less error.
// It is multiplied by the roundness of the ring (1: as wide as long): across slivers, near points must tell
// about the bending across, otherwise terms of fourth order along them count as that. On tori with cells of 1
// : 125 that takes the error from 40 % to below 0.1.
#define WEIGHT_SOFTENING 0.05f

// Added to the diagonal, relative to the total weight. It decides where there are too few points, towards a
// plane and then towards a quadric, and stays below the noise of float positions elsewhere.
#define RIDGE_QUADRATIC 1e-7f
#define RIDGE_CUBIC 1e-5f

// The same on a border, where a two-ring has only three rows of vertices, which do not determine a cubic
// across the border. On smooth surfaces ten times more or less is better on some meshes and worse on others;
// with RIDGE_CUBIC, noise of 2 % of an edge is two to four times as large.
#define RIDGE_CUBIC_BORDER 1e-3f

// Root mean square of a coordinate over a round ring, in units of its reach, so that such a ring keeps its
// shape.
#define CHART_SIZE 0.70710678f

// Square of the chart's radius beyond which a point is ignored; a round two-ring has radius 1. Next to a
// vertex with many neighbours (the pole of a sphere) the two-ring is a wide circle, of which only the near
// part is useful.
#define FARTHEST2 4.0f

// The product of one minus the squared canonical correlations [Hotelling 1936] of cubic terms with lower
// ones, or of quadratic with linear ones, over the points. Below this limit the points cannot distinguish the
// terms, and the fit is done again; also where the ring is less round than LEAST_ROUND. The second fit takes
// all of the two-ring, as wide as long, with a root mean square of WIDE_SIZE per coordinate, and near points
// weigh more. Measured on random Delaunay, poked and red-green meshes: from 3 to 120 % RMS down to 0.1;
// regular meshes have 0.02.
#define POOR_TERMS 1e-3f
#define LEAST_ROUND 0.1f
#define WIDE_SIZE 0.5f
#define WIDE_FARTHEST2 16.0f
#define WIDE_SPREAD2 0.72f  // mean square of a point's distance, in units of the wide chart

// Heights are taken for known to ROUNDING of the position's part along the normal: a float's root mean square error. Where that
// moves H by more than NOISE_SHARE of the fit's curvedness, by more than NOISE_LEAST over the reach (planes need no more), and by
// more than NOISE_REGULAR heights over the square of the reach (regular rings: 1 to 2, and nothing else helps them), the points are
// too few. Measured on red-green refined random Delaunay meshes of 15,000 vertices: the worst vertex from 23 % to below 10.
#define ROUNDING 2.98e-8f
#define NOISE_SHARE 0.01f
#define NOISE_LEAST 3e-5f
#define NOISE_REGULAR 3.0f

// Rings of the two-ring's points that are longer than this are not walked.
#define LONGEST_FURTHER 36

// Of longer rings than twice this and four, so many neighbours of neighbours are walked to either side.
#define NEAR_STEPS 16

// The ring's slope is fitted with this share of the squared reach on the diagonal, so that across slivers the
// curvature along them does not count as slope. Slopes well below MIN_SLOPE are the surface's own and are
// kept.
#define SLOPE_RIDGE 0.03f
#define MIN_SLOPE 0.05f

// Squared height over squared width of a ring at which the bending is halved: 16 degrees of tilt, or a cap of
// edge / radius 0.4.
#define STEEP 0.04f

// If a ring is steeper than this, or its squared slope is above that, the normal is compared with its
// neighbours'. If the cosine is below WRONG_NORMAL (8 degrees) it is replaced. Measured with normals from
// meshes whose jitter folds triangles: half the error on tori, a tenth on cones.
#define STEEP_DOUBTFUL 0.05f
#define SLOPE2_DOUBTFUL 0.01f
#define WRONG_NORMAL 0.99f

// Squared width over squared length below which a ring counts as a line: slivers of 1 : 1000.
#define MOST_UNEVEN 1e-6f

// The products of two terms are the monomials of degree 2 to 6: 25 sums instead of 45.
#define DEGREES 7
#define MONOMIAL(a, b) (((a) + (b)) * ((a) + (b) + 1) / 2 - 3 + (b))  // of x^a y^b, a + b >= 2
#define MONOMIALS 25

// From offsets to the coordinates of the fit: x = xx X, y = xy X + yy Y, z = scale * bent height, with X and
// Y along the tangent vectors. The ring is as long as wide in them, so that slivers fit as well as other
// triangles. In coordinates of one unit the sixth powers of a short direction would be lost in the rounding
// of a long one's.
typedef struct Chart {
    Vec3w origin, u, v, n;
    Vec3w height;         // n without the ring's slope: dot3 with it gives q
    floatw su, sv, bend;  // that slope; share of the bending, 0 to 1
    maskw doubtful;       // the normal may be wrong
    floatw ridge;         // of the cubic terms
    floatw scale, xx, xy, yy;
    floatw round, farthest2;
    floatw reach;    // of the ring
    maskw replaced;  // the normal is the ring's mean
    uint last;       // slot of the mesh
} Chart;

typedef struct Fit {
    floatw moments[MONOMIALS];  // sum of weight x^a y^b
    floatw right[TERMS];        // sum of weight z term; in the end the solution
    floatw products[PRODUCTS];  // lower triangle of the normal equations, row by row
    floatw weight, weight2;  // sums of weight, of single ones no more than a regular one's, and of weight^2
    floatw ones[2];          // sums of weight x and weight y
    floatw noise;            // in the end: error of H for an error 1 of every height, in the fit's units
    maskw low;  // of a quadratic or cubic term the points tell less than the ridge inside of a mesh does
} Fit;

inline void addPoint(Fit* fit, uintw slot, maskw counts, const Chart* chart, __global const float* positions) {
    Vec3w p;
    gather3(positions, chart->last, slotsAnywhere(slot), &p.x, &p.y, &p.z);
    p = scale3(sub3(p, chart->origin), chart->scale);
    const floatw zero = 0.0f;
    const floatw along = dot3(p, chart->u), across = dot3(p, chart->v), q = dot3(p, chart->height);
    const floatw flat2 = fma(along, along, across * across),
                 softened = fma(chart->round, (floatw)(WEIGHT_SOFTENING), dot3(p, p));
    const floatw bent = fma(chart->bend * q, q, flat2) + 1e-30f;
    counts &= finitew(softened * bent);
    const floatw inverse = 1.0f / (softened * bent);  // of both in one division
    floatw x = chart->xx * along, y = fma(chart->xy, along, chart->yy * across);
    counts &= fma(x, x, y * y) <= chart->farthest2;
    x = selectw(zero, x, counts), y = selectw(zero, y, counts);
    const floatw z = selectw(zero, q * flat2 * (softened * inverse), counts);
    const floatw weight = selectw(zero, bent * inverse, counts);
    fit->weight += fmin(weight, (floatw)(1.0f / WEIGHT_SOFTENING));
    fit->weight2 = fma(weight, weight, fit->weight2);
    fit->ones[0] = fma(weight, x, fit->ones[0]), fit->ones[1] = fma(weight, y, fit->ones[1]);
    // weight x^a, then times y as often as the degree allows.
    floatw column = weight;
#pragma unroll
    for (int a = 0; a < DEGREES; ++a) {
        floatw monomial = column;
#pragma unroll
        for (int b = 0; a + b < DEGREES; ++b) {
            if (a + b >= 2) fit->moments[MONOMIAL(a, b)] += monomial;
            if (a + b >= 1 && a + b <= 3) {
                const int term = a + b == 1 ? b : a + b == 2 ? 2 + b : 5 + b;
                fit->right[term] = fma(monomial, z, fit->right[term]);
            }
            monomial *= y;
        }
        column *= x;
    }
}

// Powers of x and y in a term, and what it divides them by.
#define TERM_X(i) ((i) < 2 ? 1 - (i) : (i) < 5 ? 4 - (i) : 8 - (i))
#define TERM_Y(i) ((i) < 2 ? (i) : (i) < 5 ? (i)-2 : (i)-5)
__constant float factor[TERMS] = {1.0f, 1.0f, 0.5f, 1.0f, 0.5f, 1.0f / 6.0f, 0.5f, 0.5f, 1.0f / 6.0f};

inline void assemble(Fit* fit) {
#pragma unroll
    for (int i = 0; i < TERMS; ++i) {
#pragma unroll
        for (int j = 0; j <= i; ++j)
            fit->products[PRODUCT(i, j)] =
                factor[i] * factor[j] * fit->moments[MONOMIAL(TERM_X(i) + TERM_X(j), TERM_Y(i) + TERM_Y(j))];
        fit->right[i] *= factor[i];
    }
}

// How many partial derivatives of an order equal this one (uv and vu, ...). The ridge's sum of squares is
// over all of them, so it does not change when the chart is rotated.
__constant int ridgeShares[TERMS] = {1, 1, 1, 2, 1, 1, 3, 3, 1};

// Determinant of the products of `count` terms from `first` on. At most four.
inline floatw blockDeterminant(const Fit* fit, const int first, const int count) {
    floatw a[4][4], determinant = 1.0f;
#pragma unroll
    for (int i = 0; i < count; ++i) {
#pragma unroll
        for (int j = 0; j <= i; ++j) {
            floatw sum = fit->products[PRODUCT(first + i, first + j)];
#pragma unroll
            for (int k = 0; k < j; ++k) sum = fma(-a[i][k] / a[k][k], a[j][k], sum);
            a[i][j] = sum;
        }
        determinant *= a[i][i];
    }
    return determinant;
}

// Cholesky without roots, in place; the solution replaces the right side. A pivot that is lost to rounding
// drops its term. Set where the points do not tell terms apart.
inline maskw solve(Fit* fit, const Chart* chart) {
    floatw inverse[TERMS], quadratic = 1.0f, cubic = 1.0f;
    const floatw ridge = chart->ridge;
    // H as a sum over terms, and what heights of 1 everywhere would be fitted to (the slot's own error moves all of them).
    floatw trace[TERMS], ones[TERMS], own = 0.0f, square = 0.0f;
#pragma unroll
    for (int i = 0; i < TERMS; ++i) {
        trace[i] = 0.0f;
        ones[i] = i < 2 ? fit->ones[i] : factor[i] * fit->moments[MONOMIAL(TERM_X(i), TERM_Y(i))];
    }
    trace[2] = 0.5f * chart->xx * chart->xx, trace[3] = chart->xx * chart->xy;
    trace[4] = 0.5f * fma(chart->xy, chart->xy, chart->yy * chart->yy);
    fit->low = 0;
#pragma unroll
    for (int i = 0; i < TERMS; ++i)
        fit->products[PRODUCT(i, i)] +=
            fit->weight * (float)ridgeShares[i] * (i < 5 ? (floatw)(RIDGE_QUADRATIC) : ridge);
    const floatw quadraticAlone = blockDeterminant(fit, 2, 3), cubicAlone = blockDeterminant(fit, 5, 4);
#pragma unroll
    for (int i = 0; i < TERMS; ++i) {
        floatw pivot = fit->products[PRODUCT(i, i)];
        const floatw whole = pivot;
#pragma unroll
        for (int j = 0; j < i; ++j) {
            // products[i][j] holds L_ij D_j until here.
            floatw sum = fit->products[PRODUCT(i, j)];
#pragma unroll
            for (int k = 0; k < j; ++k)
                sum = fma(-fit->products[PRODUCT(i, k)] * inverse[k], fit->products[PRODUCT(j, k)], sum);
            fit->products[PRODUCT(i, j)] = sum;
            pivot = fma(-sum * inverse[j], sum, pivot);
            const floatw part = -sum * inverse[j];
            fit->right[i] = fma(part, fit->right[j], fit->right[i]);
            trace[i] = fma(part, trace[j], trace[i]), ones[i] = fma(part, ones[j], ones[i]);
        }
        if (i >= 2) {
            const floatw added =
                (float)ridgeShares[i] * (i < 5 ? (floatw)(2.0f * RIDGE_QUADRATIC) : ridge + RIDGE_CUBIC);
            fit->low |= !(pivot > fit->weight * added);
        }
        if (i >= 5)
            cubic *= pivot;
        else if (i >= 2)
            quadratic *= pivot;
        inverse[i] = selectw((floatw)(0.0f), 1.0f / pivot, pivot > 1e-7f * whole);
        own = fma(trace[i] * inverse[i], ones[i], own), square = fma(trace[i] * inverse[i], trace[i], square);
    }
    fit->noise = sqrt(fma(own, own, square * fit->weight2 / fmax(fit->weight, 1e-20f)));
#pragma unroll
    for (int i = TERMS - 1; i >= 0; --i) {
        floatw sum = fit->right[i];
#pragma unroll
        for (int k = i + 1; k < TERMS; ++k) sum = fma(-fit->products[PRODUCT(k, i)], fit->right[k], sum);
        fit->right[i] = sum * inverse[i];
    }
    return !(quadratic >= POOR_TERMS * quadraticAlone) | !(cubic >= POOR_TERMS * cubicAlone);
}

// Coordinates in which second moments suu, suv, svv become size^2: their inverse root (Cholesky). `thick`:
// the smallest moment that is trusted.
inline void shapeChart(Chart* chart, floatw suu, floatw suv, floatw svv, floatw thick, float size) {
    const floatw total = suu + svv, least = fmax(MOST_UNEVEN * total, thick) + 1e-20f;
    suu = fmax(suu, least);
    const floatw slope = suv / suu;
    const floatw rest = fmax(fma(-slope, suv, svv), least);
    chart->xx = size / sqrt(suu);
    chart->yy = size / sqrt(rest);
    chart->xy = -slope * chart->yy;
    chart->round = fmin((floatw)(1.0f), 4.0f * suu * rest / (total * total));
}

// The chart's scales from the ring's second moments in the tangent plane. False for a ring without extent.
inline maskw scaleChart(Chart* chart, const RingCursor start, __global const uint* rings,
                        __global const uint* runs, __global const float* positions) {
    RingCursor ring = start;
    const floatw zero = 0.0f, one = 1.0f;
    floatw reach2 = zero, suu = zero, suv = zero, svv = zero, sun = zero, svn = zero, snn = zero, count = zero;
    maskw border = count > zero;
    for (; ring.row < ring.end; ++ring.row) {
        const RingEntry entry = ringEntry(&ring, rings, runs);
        border |= (entry.bits & (uintw)(PEL_MESH_SINGLE)) != 0;
        Vec3w p;
        gather3(positions, ring.last, entry.slots, &p.x, &p.y, &p.z);
        p = sub3(p, chart->origin);
        const floatw length2 = dot3(p, p);
        const maskw counts = finitew(length2);
        reach2 = selectw(reach2, fmax(reach2, length2), counts);
        const floatw along = selectw(zero, dot3(p, chart->u), counts),
                     across = selectw(zero, dot3(p, chart->v), counts);
        const floatw height = selectw(zero, dot3(p, chart->n), counts);
        suu = fma(along, along, suu), suv = fma(along, across, suv), svv = fma(across, across, svv);
        sun = fma(along, height, sun), svn = fma(across, height, svn), snn = fma(height, height, snn);
        count += selectw(zero, one, entry.slots.each != ring.self.each);
    }
    const maskw spread = reach2 >= PEL_MESH_MIN_LENGTH2;
    // In units of the ring's reach: powers up to the sixth must neither overflow nor underflow.
    reach2 = selectw(one, reach2, spread);
    chart->reach = sqrt(reach2);
    chart->scale = 0.5f / chart->reach;
    // The moments' inverse square root (Cholesky): with it the ring is as wide as long.
    const floatw inverse = 1.0f / (reach2 * fmax(count, one));
    suu *= inverse, suv *= inverse, svv *= inverse, sun *= inverse, svn *= inverse, snn *= inverse;
    const floatw a = suu + SLOPE_RIDGE, c = svv + SLOPE_RIDGE, determinant = fma(a, c, -suv * suv);
    const floatw su = fma(c, sun, -suv * svn) / determinant, sv = fma(a, svn, -suv * sun) / determinant;
    const floatw slope2 = fma(su, su, sv * sv), part = slope2 / (slope2 + MIN_SLOPE * MIN_SLOPE);
    chart->su = su * part, chart->sv = sv * part;
    chart->height = sub3(chart->n, add3(scale3(chart->u, chart->su), scale3(chart->v, chart->sv)));
    chart->ridge = selectw((floatw)(RIDGE_CUBIC), (floatw)(RIDGE_CUBIC_BORDER), border);
    const floatw steepness = snn / (suu + svv + 1e-20f), steep = steepness / STEEP;
    chart->doubtful = (steepness > STEEP_DOUBTFUL) | (slope2 > SLOPE2_DOUBTFUL);
    chart->bend = 1.0f / fma(steep, steep, one);
    // A ring that is thinner than high is a sliver, or its normal is wrong because a triangle is folded over.
    chart->doubtful |= (suu < snn) | (fma(-suv, suv, suu * svv) < snn * suu);
    chart->farthest2 = FARTHEST2;
    shapeChart(chart, suu, suv, svv, selectw(zero, snn, chart->replaced), CHART_SIZE);
    return spread;
}

inline void orientChart(Chart* chart, Vec3w normal) {
    chart->n = normal;
    tangentFrame(normal, &chart->u, &chart->v);
}

// Mean direction of the normals of the ring; NaN where they cancel out.
inline Vec3w ringNormal(const RingCursor start, __global const uint* rings, __global const uint* runs,
                        __global const float* normals) {
    RingCursor ring = start;
    Vec3w sum = vec3((floatw)(0.0f), (floatw)(0.0f), (floatw)(0.0f));
    for (; ring.row < ring.end; ++ring.row) {
        const Slots slots = ringEntry(&ring, rings, runs).slots;
        Vec3w n;
        gather3(normals, ring.last, slots, &n.x, &n.y, &n.z);
        usableNormals(&n.x, &n.y, &n.z);
        sum = select3(sum, add3(sum, n), finite3(n) & (slots.each != ring.self.each));
    }
    return scale3(sum, 1.0f / sqrt(dot3(sum, sum)));
}

typedef struct Moments {
    floatw uu, uv, vv, nn, weight;
} Moments;

inline void addMoments(Moments* m, uintw slot, maskw counts, const Chart* chart, int alike,
                       __global const float* positions) {
    Vec3w p;
    gather3(positions, chart->last, slotsAnywhere(slot), &p.x, &p.y, &p.z);
    p = scale3(sub3(p, chart->origin), chart->scale);
    const floatw length2 = dot3(p, p), zero = 0.0f;
    counts &= finitew(length2);
    const floatw weight = selectw(zero, alike ? (floatw)(1.0f) : 1.0f / (WEIGHT_SOFTENING + length2), counts);
    const floatw along = selectw(zero, dot3(p, chart->u), counts),
                 across = selectw(zero, dot3(p, chart->v), counts);
    const floatw height = selectw(zero, dot3(p, chart->height), counts);
    m->uu = fma(weight * along, along, m->uu), m->uv = fma(weight * along, across, m->uv);
    m->vv = fma(weight * across, across, m->vv), m->nn = fma(weight * height, height, m->nn);
    m->weight += weight;
}

// What a mesh is walked by, and into what: the fit or, without one, the moments.
typedef struct Walk {
    __global const uint *slices, *rings, *runs, *links, *rounds;
    __global const float* positions;
    const Chart* chart;
    Fit* fit;
    Moments* moments;
    int alike;  // moments: whether all points weigh alike
} Walk;

__attribute__((always_inline)) inline void take(const Walk* walk, uintw slot, maskw counts) {
    if (walk->fit)
        addPoint(walk->fit, slot, counts, walk->chart, walk->positions);
    else
        addMoments(walk->moments, slot, counts, walk->chart, walk->alike, walk->positions);
}

// Each lane walks the ring of its own neighbour `around`, in that one's slice, in which this slot stands `here`.
typedef struct Steps {
    uintw around, begin, length, from, middle, count;
} Steps;

inline Steps stepsRound(const Walk* walk, uintw around, uintw here, maskw real) {
    const uintw none = (uintw)(0), one = (uintw)(1), near_steps = (uintw)(NEAR_STEPS);
    Steps s;
    s.around = around;
    s.begin = gatherUint(walk->slices, around / PEL_MESH_LANES);
    const uintw round = gatherUint(walk->rounds, around);
    s.length = selectw(none, round & ~(uintw)(PEL_MESH_ROUND), real);
    const maskw closed = real & ((round & (uintw)(PEL_MESH_ROUND)) != 0);
    // Closed: all but this slot, its two neighbours and the last one; with four in the ring just one is left.
    const uintw rest = selectw(selectw(none, one, s.length == 4), s.length - 4, s.length > 4);
    s.count = selectw(s.length, rest, closed);
    s.from = selectw(none, here + 2, closed);
    // Past the part that is left out in the middle of a long one: this slot and its two neighbours.
    const maskw long_ = s.length > 2 * NEAR_STEPS + 4;
    s.middle = s.count;
    if (anyw(long_)) {
        const uintw before = here - min(here, near_steps);
        const uintw wrapped = selectw(none, s.length, here < NEAR_STEPS + 1);
        s.from = selectw(s.from, selectw(before, here + wrapped - 1 - NEAR_STEPS, closed), long_);
        s.count = selectw(s.count,
                          selectw(min(2 * near_steps + 1, s.length - before), 2 * near_steps, closed), long_);
        s.middle = selectw(s.count, near_steps, long_ & closed);
    }
    return s;
}

inline uintw entryOf(const Walk* walk, uintw slot, uintw begin, uintw row) {
    return PEL_RING_SLOT(gatherUint(walk->rings, (begin + row) * PEL_MESH_LANES + slot % PEL_MESH_LANES));
}

// `inside`: the lanes that take this step.
inline uintw stepTo(const Walk* walk, const Steps* s, uint step, maskw inside) {
    const uintw none = (uintw)(0);
    uintw row = selectw(none, s->from + step + selectw((uintw)(3), none, step < s->middle), inside);
    row -= selectw(none, s->length, row >= s->length);
    return entryOf(walk, s->around, s->begin, selectw(none, row, inside));
}

// All points of the two-ring, of the lanes in `wanted`.
__attribute__((always_inline)) inline void walkPoints(const Walk* walk, const RingCursor first, maskw wanted) {
    RingCursor ring = first;
    for (; ring.row < ring.end; ++ring.row) {
        const uintw near_ = ringEntry(&ring, walk->rings, walk->runs).slots.each;
        const maskw real = (near_ != ring.self.each) & wanted;
        take(walk, near_, real);
        const uintw here = loadw((size_t)ring.row * PEL_MESH_LANES + ring.lane, walk->links);
        const Steps s = stepsRound(walk, near_, here, real);
        const uint longest = largestLane(s.count);
        for (uint step = 0; step < longest; ++step) {
            const maskw inside = step < s.count;
            const uintw far_ = selectw(ring.self.each, stepTo(walk, &s, step, inside), inside);
            take(walk, far_, inside & (far_ != ring.self.each));
        }
    }
}

// The same, and behind each point its whole ring: points of the three-ring, some several times.
__attribute__((always_inline)) inline void walkFurther(const Walk* walk, const RingCursor first, maskw wanted) {
    const uintw none = (uintw)(0);
    RingCursor ring = first;
    for (; ring.row < ring.end; ++ring.row) {
        const uintw near_ = ringEntry(&ring, walk->rings, walk->runs).slots.each;
        const maskw real = (near_ != ring.self.each) & wanted;
        const uintw here = loadw((size_t)ring.row * PEL_MESH_LANES + ring.lane, walk->links);
        const Steps s = stepsRound(walk, near_, here, real);
        const uint longest = largestLane(s.count);
        for (uint step = 0; step <= longest; ++step) {
            const maskw inside = step == 0 ? real : real & (step - 1 < s.count);
            const uintw there = step == 0 ? near_ : stepTo(walk, &s, step - 1, inside);
            const uintw point = selectw(ring.self.each, there, inside);
            const maskw counts = inside & (point != ring.self.each);
            const uintw begin = gatherUint(walk->slices, point / PEL_MESH_LANES);
            uintw length = selectw(none, gatherUint(walk->rounds, point) & ~(uintw)(PEL_MESH_ROUND), counts);
            length = selectw(length, none, length > LONGEST_FURTHER);
            const uint rows = largestLane(length);
            for (uint row = 0; row <= rows; ++row) {
                const maskw behind = row == 0 ? counts : counts & (row - 1 < length);
                const uintw at =
                    row == 0 ? point : entryOf(walk, point, begin, selectw(none, (uintw)(row - 1), behind));
                take(walk, at, behind & (at != ring.self.each));
            }
        }
    }
}

// From the moments of points to coordinates in which these are WIDE_SPREAD2 away in the mean, of the lanes in `wanted`; those that
// have such.
inline maskw widenChart(Chart* chart, const Moments* m, maskw wanted) {
    const floatw spread2 = (m->uu + m->vv) / m->weight;
    wanted &= finitew(spread2) & (spread2 > 0.0f);
    const floatw unit2 = WIDE_SPREAD2 / selectw((floatw)(1.0f), spread2, wanted), part = unit2 / m->weight;
    Chart other = *chart;
    shapeChart(&other, m->uu * part, m->uv * part, m->vv * part,
               selectw((floatw)(0.0f), m->nn * part, chart->replaced), WIDE_SIZE);
    chart->xx = selectw(chart->xx, other.xx, wanted), chart->xy = selectw(chart->xy, other.xy, wanted);
    chart->yy = selectw(chart->yy, other.yy, wanted), chart->round = selectw(chart->round, other.round, wanted);
    chart->scale = selectw(chart->scale, chart->scale * sqrt(unit2), wanted);
    chart->farthest2 = WIDE_FARTHEST2;
    return wanted;
}

// Whether rounding of positions moves H by too much.
inline maskw isNoisy(const Fit* fit, const Chart* chart) {
    const floatw x = chart->n.x * chart->origin.x, y = chart->n.y * chart->origin.y,
                 z = chart->n.z * chart->origin.z;
    const floatw unit = chart->reach * chart->scale, amplified = fit->noise * unit * unit;
    const floatw noise = amplified * ROUNDING * sqrt(fma(x, x, fma(y, y, z * z))) / chart->reach;
    const floatw fxx = fit->right[2], fxy = fit->right[3], fyy = fit->right[4];
    const floatw uu = chart->xx * fma(chart->xx, fxx, 2.0f * chart->xy * fxy) + chart->xy * chart->xy * fyy;
    const floatw uv = chart->yy * fma(chart->xx, fxy, chart->xy * fyy), vv = chart->yy * chart->yy * fyy;
    const floatw bent = unit * sqrt(0.5f * fma(uu, uu, fma(2.0f * uv, uv, vv * vv)));
    return (noise > NOISE_LEAST) & (noise > NOISE_SHARE * bent) & (amplified > NOISE_REGULAR);
}

// How many lanes of the `slots` that begin at `first` are set.
inline uint countLanes(maskw mask, uint first, uint slots) {
    const uintw one = selectw((uintw)(0), (uintw)(1), mask & ((uintw)(first) + as_uintw(lanesw()) < slots));
#if PEL_WIDTH == 1
    return one;
#else
    const uint4 four = one.lo + one.hi;
    const uint2 two = four.lo + four.hi;
    return two.x + two.y;
#endif
}

__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void curvature_quadric(
    uint slots, uint listed, __global const uint* list, __global const uint* slices,
    __global const uint* rings, __global const uint* runs, __global const float* positions, uint positionOffset,
    __global const float* normals, uint normalOffset, uint planeStride, __global float* planes,
    __global const uint* links, __global const uint* rounds, __global MeshCounts* counts) {
    const uint first = meshSlot(get_global_id(0) * PEL_WIDTH, slots, listed, list);
    if (first >= slots) return;
    RingCursor ring = ringBegin(first, slots, slices);
    positions += positionOffset;
    normals += normalOffset;
    Chart chart;
    chart.last = ring.last;
    chart.replaced = 0;
    const SlotFrame frame = slotFrame(&ring, positions, normals);
    chart.origin = frame.origin, chart.n = frame.n, chart.u = frame.u, chart.v = frame.v;
    maskw spread = scaleChart(&chart, ring, rings, runs, positions) & frame.sound;
    const maskw doubtful = spread & chart.doubtful;
    if (anyw(doubtful)) {
        const Vec3w mean = ringNormal(ring, rings, runs, normals);
        const maskw wrong = doubtful & (dot3(mean, chart.n) < WRONG_NORMAL);
        if (anyw(wrong)) {
            chart.replaced = wrong;
            orientChart(&chart, select3(chart.n, mean, wrong));
            spread = scaleChart(&chart, ring, rings, runs, positions) & frame.sound;
        }
    }

    Fit fit;
    Moments moments;
    const Walk intoFit = {slices, rings, runs, links, rounds, positions, &chart, &fit, 0, 0};
    floatw best[5];
    maskw poor = spread, low = spread, moved = spread;
    for (int attempt = 0; attempt < 3; ++attempt) {
#pragma unroll
        for (int i = 0; i < MONOMIALS; ++i) fit.moments[i] = 0.0f;
#pragma unroll
        for (int i = 0; i < TERMS; ++i) fit.right[i] = 0.0f;
        fit.weight = fit.weight2 = fit.ones[0] = fit.ones[1] = 0.0f;
        if (attempt < 2)
            walkPoints(&intoFit, ring, poor);
        else
            walkFurther(&intoFit, ring, poor);
        assemble(&fit);
        const maskw unsure = solve(&fit, &chart);
#pragma unroll
        for (int i = 0; i < 5; ++i) best[i] = attempt ? selectw(best[i], fit.right[i], poor) : fit.right[i];
        low = selectw(low, fit.low, poor) & spread;
        const maskw noisy = isNoisy(&fit, &chart);
        // What a ridge decides is not moved by noise, and not right for that.
        poor &= attempt ? noisy | (unsure & moved) : noisy | unsure | (chart.round < LEAST_ROUND);
        moved = noisy;
        if (attempt == 2 || !anyw(poor)) break;
        moments.uu = moments.uv = moments.vv = moments.nn = 0.0f, moments.weight = 1e-20f;
        const Walk intoMoments = {slices,    rings,  runs, links,    rounds,
                                  positions, &chart, 0,    &moments, attempt};
        if (attempt)
            walkFurther(&intoMoments, ring, poor);
        else
            walkPoints(&intoMoments, ring, poor);
        poor = widenChart(&chart, &moments, poor);
    }
    if (counts && anyw(low)) atomic_add(&counts->lowDegreeFits, countLanes(low, first, slots));

    // Back to derivatives of the height, in units of the reach, by the tangent vectors.
    const floatw fx = best[0], fxx = best[2], fxy = best[3];
    const floatw fy = best[1], fyy = best[4];
    const floatw du = chart.su + fma(chart.xx, fx, chart.xy * fy), dv = fma(chart.yy, fy, chart.sv);
    const floatw duu = chart.xx * fma(chart.xx, fxx, 2.0f * chart.xy * fxy) + chart.xy * chart.xy * fyy;
    const floatw duv = chart.yy * fma(chart.xx, fxy, chart.xy * fyy), dvv = chart.yy * chart.yy * fyy;
    // The second fundamental form of the graph, in an orthonormal frame of its tangent plane at the slot.
    const Vec3w n = chart.n, u = chart.u, v = chart.v;
    const floatw slope2 = fma(du, du, dv * dv), w = sqrt(1.0f + slope2);
    const Vec3w normal = scale3(sub3(n, add3(scale3(u, du), scale3(v, dv))), 1.0f / w);
    const Vec3w tu = scale3(add3(u, scale3(n, du)), inverseRootw(fma(du, du, (floatw)(1.0f))));
    const Vec3w tv = cross3(normal, tu);
    const floatw ux = dot3(tu, u), uy = dot3(tu, v), vx = dot3(tv, u), vy = dot3(tv, v);
    const floatw part = -chart.scale / w;  // heights along the normal: bending away from it is negative
    const floatw xx = duu * part, xy = duv * part, yy = dvv * part;
    const floatw uu = ux * fma(xx, ux, 2.0f * xy * uy) + yy * uy * uy;
    const floatw vv = vx * fma(xx, vx, 2.0f * xy * vy) + yy * vy * vy;
    const floatw uv = xx * ux * vx + xy * fma(ux, vy, uy * vx) + yy * uy * vy;
    const maskw measured = spread & finitew(uu) & finitew(uv) & finitew(vv);
    storePrincipal(uu, uv, vv, tu, tv, measured, first, planeStride, planes);
}
