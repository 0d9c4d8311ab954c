#include "eye/check_eye.h"

#include <cmath>

#include "core/check_range.h"
#include "eye/eye_lut.h"
#include "eye/eye_shape.h"

namespace pel {
namespace {

// Returns false for a vector of length 0.
bool normalize(double (&v)[3]) {
    const double length = std::hypot(v[0], v[1], v[2]);
    if (!(length > 0)) return false;
    for (double& c : v) c /= length;
    return true;
}

void checkFinite(const char* field, const float (&v)[3]) {
    for (int i = 0; i < 3; ++i)
        if (!std::isfinite(v[i]))
            invalidArgument("PelEye.", field, "[", i, "] is ", v[i], "; it must be finite");
}

}  // namespace

PelEye resolvedEye(const PelEye& given) {
    const char* structure = "PelEye";
    const PelEye& fields = given;
    PEL_EACH_EYE_FIELD(PEL_CHECK_RANGE)
    PelEye eye = given;
    if (eye.irisRadius == 0) eye.irisRadius = eye.limbusRadius;
    checkEyeLutWork(pelEyeLutDescOf(&eye), structure);
    if (eye.pupilRadius >= eye.irisRadius)
        invalidArgument("PelEye.pupilRadius is ", eye.pupilRadius,
                        "; it must be less than the radius of the iris, ", eye.irisRadius);
    checkFinite("center", eye.center);
    checkFinite("gaze", eye.gaze);
    checkFinite("up", eye.up);
    double g[3] = {eye.gaze[0], eye.gaze[1], eye.gaze[2]}, u[3] = {eye.up[0], eye.up[1], eye.up[2]};
    if (!normalize(g)) invalidArgument("PelEye.gaze is (0, 0, 0); a direction is needed");
    if (!normalize(u)) invalidArgument("PelEye.up is (0, 0, 0); a direction is needed");
    const double along = u[0] * g[0] + u[1] * g[1] + u[2] * g[2];
    for (int i = 0; i < 3; ++i) u[i] -= along * g[i];
    if (std::abs(along) > 0.99999 || !normalize(u))
        invalidArgument("PelEye.up is parallel to PelEye.gaze; a direction that is not would be right");
    for (int i = 0; i < 3; ++i) {
        eye.gaze[i] = float(g[i]);
        eye.up[i] = float(u[i]);
    }
    return eye;
}

void checkEyeLutDesc(const PelEyeLutDesc& fields) {
    const char* structure = "PelEyeLutDesc";
    PEL_EACH_EYE_LUT_FIELD(PEL_CHECK_RANGE)
    checkEyeLutWork(fields, structure);
}

}  // namespace pel
