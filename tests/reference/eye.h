// An eye, traced in double precision (section 13 of the mathematics). Space: mm, the sclera's centre at 0,
// the gaze along z, y up.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "reference/vec.h"

namespace reference {

struct Eye {
    double sclera = 12, cornea = 7.8, conic = -0.26, limbus = 6, limbusWidth = 1, limbusDarkening = 0.6;
    double chamber = 3.05, nCornea = 1.376, nAqueous = 1.336, iris = 6, concavity = 0, pupil = 2;
    double texturePupil = 0.3, tearRoughness = 0.03, wetLineRoughness = 0.2, nTear = 1.336;

    double limbusZ() const;
    double sag(double r) const;
    double apexZ() const;
    double irisZ() const;            // of the rim
    double corneaZ(double r) const;  // height of the cornea at a distance from the axis
    Vec3 corneaNormal(double x, double y) const;
    double irisHeight(double r) const;
};

// The light's angle to the gaze beyond which none enters: where the rim's own horizon, or the sclera's, hides
// it.
double largestAngle(const Eye& eye);
// Share of light that an interface from index `from` to index `to` reflects; 1 beyond the critical angle.
// Fresnel's equations, the mean of both polarisations.
double fresnel(double cosine, double from, double to);

// The hit of a ray from the camera.
struct EyeHit {
    bool cornea = false;
    double share = 0;       // of the cornea against the sclera, 0 to 1: a soft border
    Vec3 point, normal;     // on the outer surface
    double px = 0, py = 0;  // on the iris, mm; the rim where the ray misses it
    double radius = 0;      // of that
    double cosine = 0;      // between the refracted ray and the axis
    double transmittance = 0;
};
EyeHit traceEye(const Eye& eye, Vec3 origin, Vec3 direction);

// The factor on the iris' reflected light besides albedo: 0 in the pupil, lower at the limbus.
double irisVisible(const Eye& eye, const EyeHit& hit);
// Where its albedo is in the square texture, in [0, 1].
Vec2 irisTexture(const Eye& eye, const EyeHit& hit);

// Irradiance on the iris of a beam of irradiance 1, whose light comes from angle `angle` to the gaze at the
// side of +x. One slice: width x height texels over x from -iris to iris and |y| from 0 to iris; per area of
// the iris' surface. By photons: they start at jittered places of a grid on the cornea, are refracted, and
// reflected inside until nothing is left.
struct Caustic {
    int width = 0, height = 0;
    std::vector<double> texels;
    double flux = 0;     // mm^2 times irradiance: all photons that end on the texels
    double bounced = 0;  // of it: after a reflection inside
    double at(double x, double y, double iris) const;  // bilinear
};
Caustic tracePhotons(const Eye& eye, double angle, int width, int height, uint64_t photons, uint64_t seed);
// The same from starting points all over the cornea: the flux that ends within the iris' rim.
double fluxOnIris(const Eye& eye, double angle, int steps);

// Irradiance on the iris at a distance from its axis under light that is the same from everywhere, against
// that of the open air.
double ambientOnIris(const Eye& eye, double r, int steps);

// pi N.L times the BRDF of the tear film's single GGX lobe with Fresnel's equations.
double tearGloss(Vec3 normal, Vec3 toLight, Vec3 toCamera, double roughness, double index);

}  // namespace reference
