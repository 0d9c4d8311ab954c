// The lengths of an eye that follow from its description (section 13 of the mathematics), in double precision. z runs along the gaze, 0 is the
// sclera's centre.
#pragma once
#include <pellucid/pellucid.h>

namespace pel {

struct EyeShape {
    double sclera, cornea, conic, limbus, iris, concavity;  // as described; the iris' default filled in
    double limbusZ, apexZ, irisZ;  // planes: where cornea and sclera meet, apex, the iris' rim
    double largestAngle;           // radians, between gaze and light, at which some still enters

    // Throws PEL_ERROR_INVALID_ARGUMENT, with names of fields of `structure`, if the parts do not fit together.
    EyeShape(const PelEyeLutDesc& desc, const char* structure);

    // How far the cornea lies below its apex at a distance from the axis, and its slope there.
    double sag(double r) const;
    double slope(double r) const;
};

}  // namespace pel
