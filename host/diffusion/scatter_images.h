// The images of a picture that scatters.
#pragma once
#include "core/image_view.h"

namespace pel {

// Images of one size. Images that are not set are empty; either positions or depth is set.
struct ScatterImages {
    ImageView irradiance, positions, depth, ids, out;
    ImageView curvature{};  // mean, 1/length: for materials with a gain
    ImageView radii{};      // times the profile's radius
    ImageView thickness{};  // length, of the body: for light from texels, if the irradiance follows it
    int radiusComponent = 0;

    // The second component of an image of weights, if there is one.
    void takeRadii(const ImageView& weight) {
        if (weight && weight.info().components > 1) radii = weight, radiusComponent = 1;
    }
};

}  // namespace pel
