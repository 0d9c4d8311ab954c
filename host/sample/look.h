// What colour the surfaces of the sample renderer have: skin with redder places, eyes, teeth.
#pragma once

#include "sample/vector.h"

namespace pellucid::sample {

using LinearColor = std::array<double, 3>;

// A place where the colour differs: lips, cheeks, ears. An ellipsoid along the axes.
struct Tint {
    Vec3 centre, radii;  // mm
    LinearColor factor;  // of the albedo, in the middle
    double edge = 1;     // share of the radii over which the factor fades to 1: 1 soft, 0.2 a line
    LinearColor at(Vec3 p) const;
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
