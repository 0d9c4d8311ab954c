// Eyes: their shape, their constants for kernels, and their caustic tables.
#pragma once
#include "lut/lut.h"
#include "shared/eye.h"

namespace pel {

struct EyeShape {
    double sclera, cornea, conic, limbus, iris, concavity;  // as described, with defaults
    double limbusZ;                                         // plane in which cornea and sclera meet
    double apexZ;                                           // apex of the cornea
    double irisZ;                                           // rim of the iris
    double largestAngle;  // between gaze and light, beyond which no light enters; radians

    // Throws PEL_ERROR_INVALID_ARGUMENT if the parts do not fit together; the message names fields of
    // `structure`.
    EyeShape(const PelEyeLutDesc& desc, const char* structure);

    // Depth of the cornea's surface below its apex at distance r from the axis, and its slope there.
    double sag(double r) const;
    double slope(double r) const;
};

// The shape with lengths multiplied by `scale`.
PelEyeShape describeShape(const EyeShape& shape, const PelEyeLutDesc& desc, double scale);

// Ambient light on the iris over that outside the eye, from the axis to the rim.
using AmbientNodes = std::array<float, PEL_AMBIENT_NODES>;
AmbientNodes ambientNodes(const PelEye& eye);

// Whether light takes the same paths in both eyes.
bool sameShape(const PelEye& a, const PelEye& b);

// The constants of an eye, except those of tables and textures. `eye` is resolved (resolvedEye()).
PelShadeEye describeEye(const PelEye& eye, const AmbientNodes& ambient, double millimetresPerUnit);

// Checks of PelEye and PelEyeLutDesc. They throw PEL_ERROR_INVALID_ARGUMENT with the field, its value and the
// valid range.
// Fills in all defaults except the colour of the iris, which depends on a texture. In the result `gaze` and
// `up` are perpendicular unit vectors.
PelEye resolvedEye(const PelEye& eye);

void checkEyeLutDesc(const PelEyeLutDesc& desc);

// Throws PEL_ERROR_INVALID_ARGUMENT if the parts of the eye do not fit together or if its table would take
// too long; the message names fields of `structure`.
void checkEyeLutWork(const PelEyeLutDesc& desc, const char* structure);

// Checks `desc` first. Work is enqueued; if `interruptible`, long work is split, and the progress callback
// may cancel it between two parts.
Ref<Lut> integrateEyeLut(Ref<Device> device, const PelEyeLutDesc& desc, bool interruptible = false);

}  // namespace pel
