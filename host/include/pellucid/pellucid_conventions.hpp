// pellucid_conventions.h with exceptions.
#ifndef PELLUCID_CONVENTIONS_HPP
#define PELLUCID_CONVENTIONS_HPP
#include <pellucid/pellucid_conventions.h>

#include <pellucid/pellucid.hpp>
#include <type_traits>

namespace pellucid {
namespace detail {

template <class Matrix>
const float* floatsOf(const Matrix& matrix, std::true_type /* an array or a pointer */) {
    return matrix;
}
template <class Matrix>
const float* floatsOf(const Matrix& matrix, std::false_type) {
    static_assert(std::is_standard_layout<Matrix>::value && sizeof(Matrix) == 16 * sizeof(float),
                  "a matrix of 16 floats is needed");
    return reinterpret_cast<const float*>(&matrix);
}
template <class Matrix>
const float* floatsOf(const Matrix& matrix) {
    return floatsOf(matrix, std::is_convertible<const Matrix&, const float*>());
}

}  // namespace detail

// The camera of a G-buffer, from the matrix that it was drawn with: a float[16], a pointer to 16 floats, or a
// type that holds 16 floats and nothing else, as glm::mat4 and XMFLOAT4X4.
template <class Matrix>
PelCamera cameraFromViewProjection(const Matrix& viewProjection, const PelConvention& convention) {
    PelCamera camera = pelCameraDefaults();
    if (pelCameraFromViewProjection(detail::floatsOf(viewProjection), convention, &camera) != PEL_SUCCESS)
        throw Error(PEL_ERROR_INVALID_ARGUMENT,
                    "the camera's viewProjection has no inverse, or holds NaN or Inf");
    return camera;
}

// `light` with the fields that follow from its shadow map's matrix, of the same types.
template <class Matrix>
PelLight lightFromViewProjection(const Matrix& viewProjection, const PelConvention& convention,
                                 PelLight light = pelLightDefaults()) {
    if (pelLightFromViewProjection(detail::floatsOf(viewProjection), convention, &light) != PEL_SUCCESS)
        throw Error(PEL_ERROR_INVALID_ARGUMENT,
                    "the light's viewProjection makes no depth, or holds NaN or Inf");
    return light;
}

}  // namespace pellucid

#endif  // PELLUCID_CONVENTIONS_HPP
