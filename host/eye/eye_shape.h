// Dimensions of an eye that follow from its description (section 13 of the mathematics), in double precision.
// The z axis points along the gaze; the origin is the centre of the sclera.
#pragma once
#include <pellucid/pellucid.h>

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

}  // namespace pel
