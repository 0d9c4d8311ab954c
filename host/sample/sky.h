// A studio sky, as an image of the light from all directions.
#pragma once
#include <vector>

#include "sample/vector.h"

namespace pellucid::sample {

using Rgb = std::array<double, 3>;

// A gradient from horizon to zenith, a soft lamp in it and a floor that returns some light.
struct Sky {
    Vec3 up{0, 0, 1};              // unit
    Rgb zenith{0.30, 0.38, 0.52};  // radiance
    Rgb horizon{0.46, 0.45, 0.44};
    Rgb floor{0.16, 0.12, 0.09};
    Vec3 lamp{0.5, -0.7, 0.5};  // towards the lamp; need not be unit
    Rgb lampRadiance{0.9, 0.82, 0.7};
    double lampSharpness = 8;  // exponent of the cosine to the lamp
    double scale = 1;          // of all of the above

    // A soft box: a bright rectangle upright before the sky.
    struct Panel {
        Vec3 direction;                // towards its middle, not along `up`; need not be unit
        double halfWidth, halfHeight;  // at a distance of 1
        Rgb radiance;
    };
    std::vector<Panel> panels;

    Rgb radiance(Vec3 direction) const;
};

// The sky as PelEnvironment wants it: equirectangular, 2 `height` x `height` pixels of RGB. `front`: a unit
// vector across `up`, in the middle of the image.
std::vector<float> equirectangular(const Sky& sky, Vec3 front, int height);

}  // namespace pellucid::sample
