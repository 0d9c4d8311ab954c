// Curvature LUT of a sum of Gaussians, forms arc, ring, half-ring, sphere and penner-ring (section 2 of the
// mathematics).
//
// Every form is a convolution on the circle of max0(cos) with an even kernel K(t), |t| <= X:
//   arc        K = r P(r t), X = min(pi, cut/r), not normalised
//   ring       K = R(2r sin|t/2|) / N, X = pi; half-ring: X = pi/2; penner-ring: P in place of R
//   sphere     K = int cos^2(h) R(chord) dh / N over the half circle across: with latitudes h from the great
//   circle through
//              normal and light, w.L = cos h cos(theta - t) and w.n = cos h cos t, so that the latitudes
//              integrate first; for a Gaussian, with k = (r/sigma)^2: exp(-k) int cos^2(h) exp(k cos h cos t)
//              dh, a function of k cos t.
// At the angle phi = theta - pi/2 behind the terminator (u = -sin phi) such a convolution obeys D'' + D =
// K(phi) + K(pi - phi). So a row is one sweep from phi = pi/2 to 0 over E with E(pi/2) = E'(pi/2) = 0; all
// terms are positive:
//   unlit side   D(-u) = E + back u        back  = 2 int_0^{pi/2} K(pi - t) cos t dt
//   lit side     D(+u) = E + front u       front = 2 int_0^{pi/2} K(t) cos t dt
// front is close to the integral of K, which has a closed form (or is 1), minus 2 int K (1 - cos t): no
// cancellation. For the sphere front - back is the mean of cos t, coth k - 1/k for a Gaussian. E and its
// slope are kept at N + 1 nodes (pi/2) (j/N)^4, and E is cubic between them. The error of such an
// interpolation, about 1e-3 sigma (h/sigma)^4, is about the same for every width sigma of K, so one mesh
// serves all rows and profiles.
//
// Variants: PEL_WIDTH; PEL_FORM, one of PEL_FORM_ARC ... (PelCurvatureForm); PEL_GROUP, work-items in a
// group; PEL_NODES, N; PEL_COLUMNS (curvature_texels.clh).
#include "lib/lut/normal.clh"
#include "lib/lut/stack.clh"
#include "lut/curvature_texels.clh"

// Gauss points of a mesh interval.
#define POINTS 2
__constant float gaussAt[POINTS] = {-0.577350269f, 0.577350269f};

// Beyond this many sigmas a Gaussian adds less than 1e-8 of its weight. A chord is at least 2/pi of its arc.
#if PEL_FORM == PEL_FORM_ARC
#define REACH 5.8f
#else
#define REACH 9.1f
#endif

typedef struct Rgb {
    floatw r, g, b;
} Rgb;

static inline Rgb rgbFma(const Rgb a, const floatw s, const Rgb b) {
    return (Rgb){fma(a.r, s, b.r), fma(a.g, s, b.g), fma(a.b, s, b.b)};
}

// Writes value of PEL_WIDTH rows to slot `slot` of each row's record.
static inline void storeRows(__global float4* rows, const uint firstRow, const uint height, const uint slot,
                             const Rgb value) {
#if PEL_WIDTH == 1
    rows[(size_t)firstRow * ROW_STRIDE + slot] = (float4)(value.r, value.g, value.b, 0.0f);
#else
    float r[PEL_WIDTH], g[PEL_WIDTH], b[PEL_WIDTH];
    storew(value.r, 0, r);
    storew(value.g, 0, g);
    storew(value.b, 0, b);
    for (uint lane = 0; lane < PEL_WIDTH && firstRow + lane < height; ++lane)
        rows[(size_t)(firstRow + lane) * ROW_STRIDE + slot] = (float4)(r[lane], g[lane], b[lane], 0.0f);
#endif
}

#if PEL_FORM == PEL_FORM_SPHERE
// exp(-z) int cos^2(h) exp(z cos h) dh over the half circle, z >= 0. Minimax fits made for this file, 7e-8
// and 2e-8 relative.
static inline floatw latitudeFront(const floatw z) {
    floatw low = fma(z, (floatw)(1.33625866e-8f), (floatw)(-4.85755379e-7f));
    low = fma(z, low, (floatw)(8.44782153e-6f));
    low = fma(z, low, (floatw)(-9.71177501e-5f));
    low = fma(z, low, (floatw)(8.60452068e-4f));
    low = fma(z, low, (floatw)(-6.38133334e-3f));
    low = fma(z, low, (floatw)(4.11006995e-2f));
    low = fma(z, low, (floatw)(-0.237460122f));
    low = fma(z, low, (floatw)(1.57079625f));
    const floatw t = 1.0f / fmax(z, 6.0f);
    floatw high = fma(t, (floatw)(-32.7124710f), (floatw)(9.91074276f));
    high = fma(t, high, (floatw)(-0.225557968f));
    high = fma(t, high, (floatw)(0.498109281f));
    high = fma(t, high, (floatw)(1.11645734f));
    high = fma(t, high, (floatw)(-2.19331264f));
    high = fma(t, high, (floatw)(2.50662827f));
    return selectw(high * sqrt(t), low, z < 6.0f);
}

// int cos^2(h) exp(-z cos h) dh over the half circle, 0 <= z <= 18, to 1e-6 of exp(z)/z, because it is
// multiplied by k exp(-k), k >= z.
static inline floatw latitudeBack(const floatw z) {
    const floatw x = fmin(z, 18.0f);
    floatw sum = fma(x, (floatw)(-1.38030712e-10f), (floatw)(1.08690017e-8f));
    sum = fma(x, sum, (floatw)(-3.76110108e-7f));
    sum = fma(x, sum, (floatw)(7.62933678e-6f));
    sum = fma(x, sum, (floatw)(-1.02584600e-4f));
    sum = fma(x, sum, (floatw)(9.85347200e-4f));
    sum = fma(x, sum, (floatw)(-7.13011669e-3f));
    sum = fma(x, sum, (floatw)(4.01858836e-2f));
    sum = fma(x, sum, (floatw)(-0.177170083f));
    sum = fma(x, sum, (floatw)(0.588795900f));
    sum = fma(x, sum, (floatw)(-1.33329487f));
    return fma(x, sum, (floatw)(1.57079542f));
}
#endif

// K of the Gaussians first <= g < end at angle t, versine 1 - cos t, on a circle of that radius: for arc and
// sphere as above, for the rings up to the factor that normalises them.
static inline Rgb kernelAt(__global const LutGaussian* gaussians, const uint first, const uint end,
                           const floatw radius, const floatw t, const floatw versine, const int behind) {
    Rgb sum = {0.0f, 0.0f, 0.0f};
    for (uint g = first; g < end; ++g) {
        const LutGaussian G = gaussians[g];
#if PEL_FORM == PEL_FORM_SPHERE
        // In sigmas. At 1e-6 light is already uniform; the normalisation uses the same limit.
        const floatw x = clamp(radius / G.sigma, 1e-6f, 1e8f);
#else
        const floatw x = fmin(radius / G.sigma, 1e8f);
#endif
#if PEL_FORM == PEL_FORM_ARC
        const floatw e = exp(-0.5f * (x * t) * (x * t)) * (0.39894228f * x);
#elif PEL_FORM == PEL_FORM_SPHERE
        const floatw latitude =
            behind ? exp(-x * x) * latitudeBack(x * (versine - 1.0f) * x)
                   : exp(-(x * versine) * x) * latitudeFront(fmax(x * (1.0f - versine) * x, 0.0f));
        const floatw e = x * latitude * (x * 0.159154943f);
#elif PEL_FORM == PEL_FORM_PENNER_RING
        const floatw e = x * exp(-(x * versine) * x);
#else
        const floatw e = x * exp(-(x * versine) * x) * x;
#endif
        sum.r = fma(e, (floatw)(G.red), sum.r);
        sum.g = fma(e, (floatw)(G.green), sum.g);
        sum.b = fma(e, (floatw)(G.blue), sum.b);
    }
    return sum;
}

// One work-item: PEL_WIDTH rows, one per lane, of one table of the stack.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void curvature_rows(
    const StackParams params, __global const StackedLut* restrict stack, __constant LutNode* restrict nodes,
    __global float4* restrict records) {
    const uint firstRow = get_global_id(0) * PEL_WIDTH;
    if (firstRow >= params.height) return;
    const StackedLut table = stack[get_global_id(2)];
    __global const LutGaussian* gaussians = gaussiansOf(stack, table);
    __global float4* rows = records + get_global_id(2) * params.height * ROW_STRIDE;
    const floatw row = convert_floatw((intw)((int)firstRow) + lanesw());
    const floatw rowValue = fma(row + 0.5f, (floatw)(table.rowStep), (floatw)(table.rowMin));
    const floatw curvature = params.axis == PEL_LUT_AXIS_ROOT ? rowValue * rowValue : rowValue;
    const floatw radius = 1.0f / curvature;
#if PEL_FORM == PEL_FORM_ARC
    const floatw end = fmin(params.cut * curvature, (floatw)(M_PI_F));
#elif PEL_FORM == PEL_FORM_HALF_RING
    const floatw end = M_PI_2_F;
#else
    const floatw end = M_PI_F;
#endif
    const floatw frontEnd = fmin(end, (floatw)(M_PI_2_F));
    const int hasBack = anyw(end > M_PI_2_F);

    Rgb E = {0.0f, 0.0f, 0.0f}, F = E, missing = E, back = E, total = E;
    storeRows(rows, firstRow, params.height, 2 * PEL_NODES, E);
    storeRows(rows, firstRow, params.height, 2 * PEL_NODES + 1, F);
    uint front = table.gaussians, behind = 0;
    for (int j = PEL_NODES - 1; j >= 0; --j) {
        const LutNode node = nodes[j];
        const float step = nodes[j + 1].angle - node.angle;
        // Narrow Gaussians come first in the list. Going down in phi, Gaussians join in front and leave
        // behind.
        while (front > 0 && anyw(REACH * gaussians[front - 1].sigma * curvature > node.angle)) --front;
        while (behind < table.gaussians &&
               !anyw(REACH * gaussians[behind].sigma * curvature > M_PI_F - nodes[j + 1].angle))
            ++behind;

        // Over one step: a rotation by its angle, plus the contribution of the kernel.
        const float step2 = step * step;
        const float s = step * (1.0f - step2 * (1.0f / 6.0f) * (1.0f - step2 * (1.0f / 20.0f)));
        const float c = 1.0f - step2 * 0.5f * (1.0f - step2 * (1.0f / 12.0f));
        const Rgb turned = {fma(F.r, (floatw)(s), E.r * c), fma(F.g, (floatw)(s), E.g * c),
                            fma(F.b, (floatw)(s), E.b * c)};
        F = (Rgb){fma(E.r, (floatw)(-s), F.r * c), fma(E.g, (floatw)(-s), F.g * c),
                  fma(E.b, (floatw)(-s), F.b * c)};
        E = turned;

        const floatw frontHalf = 0.5f * fmax(fmin((floatw)(step), frontEnd - node.angle), 0.0f);
        const floatw backStart = fmax(M_PI_F - end - node.angle, 0.0f);
        const floatw backHalf = 0.5f * fmax(step - backStart, 0.0f);
        for (int q = 0; q < POINTS; ++q) {
            if (front < table.gaussians) {
                const floatw d = fma(frontHalf, (floatw)(gaussAt[q]), frontHalf);
                const floatw d2 = d * d;
                const floatw sd = d * (1.0f - d2 * (1.0f / 6.0f) * (1.0f - d2 * (1.0f / 20.0f)));
                const floatw vd = d2 * 0.5f * (1.0f - d2 * (1.0f / 12.0f));
                const floatw weight = frontHalf;
                // versine of the sum of two angles
                const floatw versine = node.versine + node.cosine * vd + node.sine * sd;
                const floatw t = node.angle + d;
                const Rgb k = kernelAt(gaussians, front, table.gaussians, radius, t, versine, 0);
                E = rgbFma(k, weight * sd, E);
                F = rgbFma(k, weight * (1.0f - vd), F);
                missing = rgbFma(k, weight * versine, missing);
                total = rgbFma(k, weight, total);
            }
            if (hasBack && behind < table.gaussians) {
                const floatw d = backStart + fma(backHalf, (floatw)(gaussAt[q]), backHalf);
                const floatw d2 = d * d;
                const floatw sd = d * (1.0f - d2 * (1.0f / 6.0f) * (1.0f - d2 * (1.0f / 20.0f)));
                const floatw cd = 1.0f - d2 * 0.5f * (1.0f - d2 * (1.0f / 12.0f));
                const floatw weight = backHalf;
                const floatw cosine = node.cosine * cd - node.sine * sd;
                const Rgb k = kernelAt(gaussians, behind, table.gaussians, radius, M_PI_F - node.angle - d,
                                       1.0f + cosine, 1);
                E = rgbFma(k, weight * sd, E);
                F = rgbFma(k, weight * cd, F);
                back = rgbFma(k, weight * cosine, back);
                total = rgbFma(k, weight, total);
#if PEL_FORM != PEL_FORM_ARC
                // front is 1 minus the light that does not arrive there, which includes all of back
                missing = rgbFma(k, weight, missing);
#endif
            }
        }
        storeRows(rows, firstRow, params.height, 2 * j, E);
        storeRows(rows, firstRow, params.height, 2 * j + 1, F);
    }

    const Rgb none = {0.0f, 0.0f, 0.0f};
    Rgb frontTotal, scale = {1.0f, 1.0f, 1.0f};
#if PEL_FORM == PEL_FORM_ARC
    // Integral of K within the cut and the half circle.
    frontTotal = none;
    for (uint g = 0; g < table.gaussians; ++g) {
        const LutGaussian G = gaussians[g];
        const floatw inside =
            1.0f - 2.0f * normalTailOnly(fmin((floatw)(params.cut), M_PI_2_F * radius) / G.sigma);
        frontTotal = rgbFma((Rgb){G.red, G.green, G.blue}, inside, frontTotal);
    }
    frontTotal = rgbFma(missing, -2.0f, frontTotal);
    back = rgbFma(back, 2.0f, none);
#elif PEL_FORM == PEL_FORM_SPHERE
    Rgb all = none, mean = none;
    for (uint g = 0; g < table.gaussians; ++g) {
        const LutGaussian G = gaussians[g];
        const floatw x = clamp(radius / G.sigma, 1e-6f, 1e8f);
        const floatw k = x * x;
        // 1 - exp(-2k), and its product with the mean of cos t: both 2 exp(-k) times hyperbolic functions, as
        // series near 0.
        const floatw e2 = exp(-2.0f * k), e1 = 2.0f * exp(-k);
        const floatw share =
            selectw(1.0f - e2, e1 * k * (1.0f + k * k * (1.0f / 6.0f + k * k * (1.0f / 120.0f))), k < 0.3f);
        const floatw series = e1 * k * k * (1.0f / 3.0f + k * k * (1.0f / 30.0f + k * k * (1.0f / 840.0f)));
        const floatw turned = selectw(1.0f + e2 - (1.0f - e2) / k, series, k < 0.3f);
        all = rgbFma((Rgb){G.red, G.green, G.blue}, share, all);
        mean = rgbFma((Rgb){G.red, G.green, G.blue}, turned, mean);
    }
    scale = (Rgb){1.0f / all.r, 1.0f / all.g, 1.0f / all.b};
    back = (Rgb){2.0f * back.r * scale.r, 2.0f * back.g * scale.g, 2.0f * back.b * scale.b};
    frontTotal.r = fma(mean.r, scale.r, back.r);
    frontTotal.g = fma(mean.g, scale.g, back.g);
    frontTotal.b = fma(mean.b, scale.b, back.b);
#else
    // A kernel narrower than the mesh adds nothing to the sum: it is a point, and E is 0.
    scale = (Rgb){0.5f / fmax(total.r, 1e-30f), 0.5f / fmax(total.g, 1e-30f), 0.5f / fmax(total.b, 1e-30f)};
    back = (Rgb){2.0f * back.r * scale.r, 2.0f * back.g * scale.g, 2.0f * back.b * scale.b};
    frontTotal = (Rgb){1.0f - 2.0f * missing.r * scale.r, 1.0f - 2.0f * missing.g * scale.g,
                       1.0f - 2.0f * missing.b * scale.b};
#endif
    // Values that are nearly 0 may come out negative by rounding. No texel may be negative.
    back = (Rgb){fmax(back.r, 0.0f), fmax(back.g, 0.0f), fmax(back.b, 0.0f)};
    storeRows(rows, firstRow, params.height, 2 * PEL_NODES + 2, back);
    storeRows(rows, firstRow, params.height, 2 * PEL_NODES + 3, frontTotal);
    storeRows(rows, firstRow, params.height, 2 * PEL_NODES + 4, scale);
}
