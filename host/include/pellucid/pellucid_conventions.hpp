// pellucid_conventions.h with exceptions.
#pragma once
#include <pellucid/pellucid_conventions.h>

#include <pellucid/pellucid.hpp>

namespace pellucid {

// The camera of a G-buffer, from the matrix that it was drawn with.
inline PelCamera cameraFromViewProjection(const float (&viewProjection)[16], const PelConvention& convention) {
    PelCamera camera = pelCameraDefaults();
    if (pelCameraFromViewProjection(viewProjection, convention, &camera) != PEL_SUCCESS)
        throw Error(PEL_ERROR_INVALID_ARGUMENT,
                    "the camera's viewProjection has no inverse, or holds NaN or Inf");
    return camera;
}

// `light` with what its shadow map's matrix says.
inline PelLight lightFromViewProjection(const float (&viewProjection)[16], const PelConvention& convention,
                                        PelLight light = pelLightDefaults()) {
    if (pelLightFromViewProjection(viewProjection, convention, &light) != PEL_SUCCESS)
        throw Error(PEL_ERROR_INVALID_ARGUMENT,
                    "the light's viewProjection makes no depth, or holds NaN or Inf");
    return light;
}

}  // namespace pellucid
