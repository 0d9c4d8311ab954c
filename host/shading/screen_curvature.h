// Curvature per pixel of a G-buffer: kernels/shading/screen_curvature.cl.
#pragma once
#include "core/image_view.h"

namespace pel {

// Views that are not there are empty; either positions or depth is.
struct ScreenCurvatureImages {
    ImageView normals, positions, depth, ids, curvature;
};

// Throws where parameters or images are wrong or do not fit together.
void checkScreenCurvature(const PelScreenCurvatureParams& params, const ScreenCurvatureImages& images);
// Enqueues everything.
void screenCurvature(Device& device, const PelScreenCurvatureParams& params, const ScreenCurvatureImages& images);

}  // namespace pel
