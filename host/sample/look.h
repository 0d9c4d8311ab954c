// What the surfaces of the sample renderer look like: skin with zones of its own, eyes, teeth.
#pragma once

#include "sample/vector.h"

namespace pellucid::sample {

using LinearColor = std::array<double, 3>;

// A place where skin differs: lips, cheeks, a forehead with more oil. An ellipsoid along the axes.
struct SkinZone {
    Vec3 centre, radii;           // mm
    LinearColor color{1, 1, 1};   // factor of the albedo, in the middle, as are the next three
    double edge = 1;              // share of the radii over which factors fade to 1: 1 soft, 0.2 a line
    double specular = 1;          // of the material's
    double roughness = 1;         // of the material's: below 1 is oil, or a wet film
    double relief = 1;            // of the slope of pores
    double weight(Vec3 p) const;  // 1 in the middle, 0 outside
    LinearColor colorAt(Vec3 p) const;
};

// An eyeball whose iris and pupil are painted on.
struct EyeLook {
    Vec3 centre;            // mm
    Vec3 gaze{0, 0, 1};     // unit
    double radius = 12;     // mm
    double irisRadius = 6;  // mm, of an adult
    double pupilRadius = 2;
    LinearColor sclera{0.72, 0.66, 0.61}, iris{0.17, 0.11, 0.06};
    LinearColor at(Vec3 p) const;  // the albedo
};

// What a material id looks like.
struct Look {
    enum class Kind { Skin, Eye, Plain } kind = Kind::Skin;
    std::array<float, 3> albedo{0.72f, 0.49f, 0.39f};  // linear; of skin the mean, of eyes unused
};

}  // namespace pellucid::sample
