// The surfaces that estimators are compared with, and areas of the oracle. The oracle's curvature is checked
// with the library's, which must equal it (test_curvature_oracle): by FaceWorks' values and these surfaces.
#include <gtest/gtest.h>

#include <random>

#include "reference/surfaces.h"
#include "tolerances.h"

using namespace reference;

TEST(ReferenceSurfaces, NormalsAndCurvaturesAgreeWithDifferencesOfPositions) {
    const std::pair<const char*, Surface> surfaces[] = {
        {"plane", planeSurface(2)},          {"sphere", sphereSurface(2)},
        {"cylinder", cylinderSurface(2, 5)}, {"cone", coneSurface(0.4, 1, 3)},
        {"torus", torusSurface(3, 1)},       {"ellipsoid", ellipsoidSurface(3, 2, 1.5)},
        {"monkey saddle", monkeySaddle(1)}};
    std::mt19937 random(3);
    for (const auto& [name, s] : surfaces)
        for (int i = 0; i < 20; ++i) {
            const double u = std::uniform_real_distribution<>(s.uBegin, s.uEnd)(random);
            const double v = std::uniform_real_distribution<>(s.vBegin, s.vEnd)(random), h = 1e-4;
            auto p = [&](double du, double dv) { return s.at(u + du, v + dv).position; };
            const Vec3 pu = (p(h, 0) - p(-h, 0)) / (2 * h), pv = (p(0, h) - p(0, -h)) / (2 * h);
            const Vec3 puu = (p(h, 0) - 2 * p(0, 0) + p(-h, 0)) / (h * h);
            const Vec3 pvv = (p(0, h) - 2 * p(0, 0) + p(0, -h)) / (h * h);
            const Vec3 puv = (p(h, h) - p(h, -h) - p(-h, h) + p(-h, -h)) / (4 * h * h);
            const SurfacePoint at = s.at(u, v);
            EXPECT_NEAR(length(at.normal), 1, tolerance::oracleExact) << name;
            EXPECT_NEAR(std::abs(dot(normalized(cross(pu, pv)), at.normal)), 1, tolerance::finiteDifference)
                << name;
            // First and second fundamental forms; minus, since positive means away from the normal.
            const double E = dot(pu, pu), F = dot(pu, pv), G = dot(pv, pv);
            const double L = -dot(puu, at.normal), M = -dot(puv, at.normal), N = -dot(pvv, at.normal);
            const double gaussian = (L * N - M * M) / (E * G - F * F);
            const double mean = (E * N - 2 * F * M + G * L) / (2 * (E * G - F * F));
            EXPECT_NEAR(at.curvature.gaussian(), gaussian, tolerance::finiteDifference) << name;
            EXPECT_NEAR(at.curvature.mean(), mean, tolerance::finiteDifference) << name;
            EXPECT_GE(at.curvature.first, at.curvature.second) << name;
        }
}

TEST(ReferenceCurvature, VoronoiAreasArePointsNearestToACorner) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int shape = 0; shape < 6; ++shape) {
        Vec3 p[3];
        for (Vec3& corner : p) corner = {2 * uniform(random), 0.4 * uniform(random), uniform(random)};
        const auto areas = voronoiAreas(p[0], p[1], p[2]);
        const double area = 0.5 * length(cross(p[1] - p[0], p[2] - p[0]));
        EXPECT_NEAR(areas[0] + areas[1] + areas[2], area, tolerance::oracleExact);
        const int n = 400;  // centroids of n² equal cells of barycentric coordinates
        double nearest[3] = {};
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                double a = (i + 0.5) / n, b = (j + 0.5) / n;
                if (a + b > 1) a = 1 - a, b = 1 - b;
                const Vec3 x = (1 - a - b) * p[0] + a * p[1] + b * p[2];
                int best = 0;
                for (int k = 1; k < 3; ++k)
                    if (length(x - p[k]) < length(x - p[best])) best = k;
                nearest[best] += area / (double(n) * n);
            }
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(areas[k] / area, nearest[k] / area, tolerance::countedArea);
    }
}
