// The images of a picture that scatters.
#pragma once
#include "core/image_view.h"

namespace pel {

// Images of one size. Views that are not there are empty; either positions or depth is.
struct ScatterImages {
    ImageView irradiance, positions, depth, ids, out;
};

}  // namespace pel
