// The images of a picture that scatters.
#pragma once
#include "core/image_view.h"

namespace pel {

// Images of one size. Images that are not set are empty; either positions or depth is set.
struct ScatterImages {
    ImageView irradiance, positions, depth, ids, out;
};

}  // namespace pel
