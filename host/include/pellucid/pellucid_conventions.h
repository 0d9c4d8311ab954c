/* Converts the matrices of OpenGL, Vulkan and Direct3D renderers to PelCamera and PelLight.
 *
 * A separate header for C and C++: none of its functions is in the library. It computes in double.
 * pellucid_conventions.hpp has the same with exceptions, pellucid.conventions is the same in Python.
 * docs/guide/hosts.md shows what to pass for which renderer. */
#ifndef PELLUCID_CONVENTIONS_H
#define PELLUCID_CONVENTIONS_H

#include <math.h>
#include <pellucid/pellucid.h>

/* Depth in clip space, from the near to the far plane. */
typedef enum PelClipDepth {
    PEL_CLIP_DEPTH_MINUS_ONE_TO_ONE = 0, /* OpenGL */
    PEL_CLIP_DEPTH_ZERO_TO_ONE =
        1, /* Vulkan, Direct3D, OpenGL with glClipControl; the far plane may be infinitely far */
    PEL_CLIP_DEPTH_ONE_TO_ZERO = 2 /* reversed; the far plane may be infinitely far */
} PelClipDepth;

typedef struct PelConvention {
    PelClipDepth depth;
    int yDown; /* 1: clip space has y downwards, as Vulkan's; 0: upwards, as OpenGL's and Direct3D's */
    /* 1: the first row of the image in memory is its lowest, as glReadPixels gives it; 0: its highest */
    int bottomFirst;
    /* 1: the 16 numbers are columns one after another (glm, OpenGL, Godot, bgfx), or rows of a matrix that
     * multiplies row vectors (DirectXMath); 0: rows of one that multiplies column vectors, as in this
     * library */
    int columnMajor;
} PelConvention;

static inline double pelConventionEntry_(const float* m, const PelConvention* c, int row, int column) {
    return c->columnMajor ? m[4 * column + row] : m[4 * row + column];
}

/* The matrix row by row; 0 if a number is not finite. */
static inline int pelConventionRead_(const float* m, const PelConvention* c, double rows[4][4]) {
    int i, k;
    for (i = 0; i < 4; ++i)
        for (k = 0; k < 4; ++k) {
            rows[i][k] = pelConventionEntry_(m, c, i, k);
            if (!isfinite(rows[i][k])) return 0;
        }
    return 1;
}

/* The vector that the three rows map to 0, from the minors of their matrix. */
static inline void pelConventionNull_(const double* a, const double* b, const double* c, double out[4]) {
    int i;
    for (i = 0; i < 4; ++i) {
        const int p = (i + 1) % 4, q = (i + 2) % 4, r = (i + 3) % 4;
        const double minor = a[p] * (b[q] * c[r] - b[r] * c[q]) - a[q] * (b[p] * c[r] - b[r] * c[p]) +
                             a[r] * (b[p] * c[q] - b[q] * c[p]);
        out[i] = i % 2 ? -minor : minor;
    }
}

/* By Gauss and Jordan with the largest pivot; 0 if there is none. */
static inline int pelConventionInvert_(double m[4][4], double inverse[4][4]) {
    int i, k, n;
    for (i = 0; i < 4; ++i)
        for (k = 0; k < 4; ++k) inverse[i][k] = i == k;
    for (i = 0; i < 4; ++i) {
        int pivot = i;
        for (k = i + 1; k < 4; ++k)
            if (fabs(m[k][i]) > fabs(m[pivot][i])) pivot = k;
        if (!(fabs(m[pivot][i]) > 1e-300)) return 0;
        for (k = 0; k < 4; ++k) {
            const double x = m[i][k], y = inverse[i][k];
            m[i][k] = m[pivot][k], m[pivot][k] = x;
            inverse[i][k] = inverse[pivot][k], inverse[pivot][k] = y;
        }
        for (n = 0; n < 4; ++n) {
            const double f = n == i ? 0 : m[n][i] / m[i][i];
            for (k = 0; k < 4; ++k) m[n][k] -= f * m[i][k], inverse[n][k] -= f * inverse[i][k];
        }
        {
            const double f = 1 / m[i][i];
            for (k = 0; k < 4; ++k) m[i][k] *= f, inverse[i][k] *= f;
        }
    }
    return 1;
}

/* Sets position and inverseViewProjection of `camera`, for a depth image with the values of the depth buffer,
 * whose first row is the highest. The position of a parallel projection is far away, in front of the middle
 * of the picture. Errors: PEL_ERROR_INVALID_ARGUMENT: numbers that are not finite, no inverse; nothing is
 * written. */
static inline PelError pelCameraFromViewProjection(const float viewProjection[16], PelConvention convention,
                                                   PelCamera* camera) {
    double m[4][4], inverse[4][4], eye[4], middle[3], largest = 0, nearer = 0, length2, along = 0, away;
    int i, k;
    if (!viewProjection || !camera || !pelConventionRead_(viewProjection, &convention, m))
        return PEL_ERROR_INVALID_ARGUMENT;
    pelConventionNull_(m[0], m[1], m[3], eye);
    for (k = 0; k < 4; ++k) {
        if (convention.yDown) m[1][k] = -m[1][k];
        if (convention.depth == PEL_CLIP_DEPTH_MINUS_ONE_TO_ONE) m[2][k] = 0.5 * (m[2][k] + m[3][k]);
    }
    /* parallel: depth says which way along the line leads to the camera */
    for (k = 0; k < 3; ++k) nearer -= m[2][k] * eye[k] * m[3][3];
    if (convention.depth == PEL_CLIP_DEPTH_ONE_TO_ZERO) nearer = -nearer;
    if (!pelConventionInvert_(m, inverse)) return PEL_ERROR_INVALID_ARGUMENT;
    for (k = 0; k < 3; ++k) {
        largest = fabs(eye[k]) > largest ? fabs(eye[k]) : largest;
        middle[k] = (0.5 * inverse[k][2] + inverse[k][3]) / (0.5 * inverse[3][2] + inverse[3][3]);
    }
    length2 = eye[0] * eye[0] + eye[1] * eye[1] + eye[2] * eye[2];
    for (k = 0; k < 3; ++k) along += middle[k] * eye[k] / length2;
    /* a million times half of the width that is seen, whatever the unit */
    away =
        1e6 *
        sqrt(inverse[0][0] * inverse[0][0] + inverse[1][0] * inverse[1][0] + inverse[2][0] * inverse[2][0]) /
        fabs(inverse[3][3]);
    for (k = 0; k < 3; ++k)
        camera->position[k] =
            (float)(fabs(eye[3]) > 1e-12 * largest
                        ? eye[k] / eye[3]
                        : middle[k] + ((nearer > 0 ? away : -away) / sqrt(length2) - along) * eye[k]);
    for (i = 0; i < 4; ++i)
        for (k = 0; k < 4; ++k) camera->inverseViewProjection[4 * i + k] = (float)inverse[i][k];
    return PEL_SUCCESS;
}

/* Sets the fields of PelLight that describe a shadow map drawn with this matrix: directional for a parallel
 * projection, a spot for a perspective one (its position and direction too). Colour, cone and filter are not
 * changed. Errors: as above, and a matrix that makes no depth. */
static inline PelError pelLightFromViewProjection(const float viewProjection[16], PelConvention convention,
                                                  PelLight* light) {
    double m[4][4], image[4][4], largest = 0, across = 0;
    int i, k;
    if (!viewProjection || !light || !pelConventionRead_(viewProjection, &convention, m))
        return PEL_ERROR_INVALID_ARGUMENT;
    for (k = 0; k < 4; ++k) {
        const double down =
            !convention.yDown == !convention.bottomFirst ? -0.5 : 0.5; /* v grows against y, or with it */
        image[0][k] = 0.5 * (m[0][k] + m[3][k]);
        image[1][k] = down * m[1][k] + 0.5 * m[3][k];
        image[2][k] =
            convention.depth == PEL_CLIP_DEPTH_MINUS_ONE_TO_ONE ? 0.5 * (m[2][k] + m[3][k]) : m[2][k];
        image[3][k] = m[3][k];
    }
    for (k = 0; k < 3; ++k) {
        across = fabs(m[3][k]) > across ? fabs(m[3][k]) : across;
        for (i = 0; i < 3; ++i) largest = fabs(m[i][k]) > largest ? fabs(m[i][k]) : largest;
    }
    /* parallel: z grows along its row, or against it, by 1 over depthRange */
    if (across <= 1e-12 * largest) {
        const double sign = convention.depth == PEL_CLIP_DEPTH_ONE_TO_ZERO ? -1 : 1;
        double length;
        if (image[3][3] == 0) return PEL_ERROR_INVALID_ARGUMENT;
        for (i = 0; i < 3; ++i)
            for (k = 0; k < 4; ++k) image[i][k] /= image[3][3];
        image[3][3] = 1;
        length = sqrt(image[2][0] * image[2][0] + image[2][1] * image[2][1] + image[2][2] * image[2][2]);
        if (!(length > 0)) return PEL_ERROR_INVALID_ARGUMENT;
        light->type = PEL_LIGHT_DIRECTIONAL;
        light->shadowProjection = PEL_SHADOW_PARALLEL;
        light->shadowDepthRange = (float)(sign / length);
        for (k = 0; k < 3; ++k) light->toLight[k] = (float)(-sign * image[2][k] / length);
    } else { /* along the axis the distance is w, its gradient scaled to 1, and z w = slope w + offset */
        const double* axis = image[3];
        const double scale2 = axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2], scale = sqrt(scale2);
        const double slope = (image[2][0] * axis[0] + image[2][1] * axis[1] + image[2][2] * axis[2]) / scale2,
                     offset = image[2][3] - slope * axis[3];
        double eye[4];
        pelConventionNull_(m[0], m[1], m[3], eye);
        if (offset == 0 || eye[3] == 0) return PEL_ERROR_INVALID_ARGUMENT;
        light->type = PEL_LIGHT_SPOT;
        light->shadowProjection = PEL_SHADOW_PERSPECTIVE;
        for (k = 0; k < 3; ++k) {
            light->position[k] = (float)(eye[k] / eye[3]);
            light->spotDirection[k] = (float)(axis[k] / scale);
        }
        light->shadowDepthA = (float)(scale / offset);
        light->shadowDepthB = (float)(-scale * slope / offset);
    }
    for (i = 0; i < 4; ++i)
        for (k = 0; k < 4; ++k) light->worldToShadow[4 * i + k] = (float)image[i][k];
    return PEL_SUCCESS;
}

#endif
