// Curvature per pixel of a G-buffer: kernels/shading/screen_curvature.cl.
#pragma once
#include "core/image_view.h"

namespace pel {

// Missing views are empty; either positions or depth is given.
struct ScreenCurvatureImages {
    ImageView normals, positions, depth, ids, curvature;
};

// Throws if parameters or images are wrong or do not match.
void checkScreenCurvature(const PelScreenCurvatureParams& params, const ScreenCurvatureImages& images);
// Enqueues everything.
void screenCurvature(Device& device, const PelScreenCurvatureParams& params,
                     const ScreenCurvatureImages& images);

}  // namespace pel
