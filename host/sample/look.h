// Appearance of surfaces in the sample renderer: skin with zones, eyes, teeth.
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
    double furrows = 0;           // root mean square of the slope of lines that run up and down, as on lips
    double weight(Vec3 p) const;  // 1 in the middle, 0 outside
    LinearColor colorAt(Vec3 p) const;
};

// The white of an eye, which is pink with fine veins towards the corners.
struct EyeLook {
    Vec3 centre;         // mm
    Vec3 gaze{0, 0, 1};  // unit
    double radius{};     // mm
    LinearColor sclera{0.84, 0.79, 0.74};
    LinearColor at(Vec3 p) const;  // the albedo
};

// Appearance of a material id.
struct Look {
    enum class Kind { Skin, Eye, Plain } kind = Kind::Skin;
    std::array<float, 3> albedo{0.72f, 0.49f, 0.39f};  // linear; of skin the mean, of eyes unused
};

}  // namespace pellucid::sample
