#include "lut/lut_check.h"

#include "core/check_range.h"

namespace pel {
namespace {

void checkOrder(float min, float max, const char* minField, const char* maxField) {
    if (min > max)
        invalidArgument(minField, " (", min, ") is greater than ", maxField, " (", max, "); exchange them");
}

// Bounds the time and the memory that a table takes.
void checkTexels(const char* structure, uint32_t width, uint32_t height) {
    constexpr uint64_t max = 1 << 26;
    if (uint64_t(width) * height > max)
        invalidArgument(structure, ".width and height are ", width, " and ", height, ": ",
                        uint64_t(width) * height, " texels, at most ", max);
}

void checkAxis(const char* structure, PelLutAxis axis) {
    if (axis != PEL_AXIS_LINEAR && axis != PEL_AXIS_ROOT)
        invalidArgument(structure, ".axis is ", int(axis),
                        "; PEL_AXIS_LINEAR (0) or PEL_AXIS_ROOT (1) is needed");
}

}  // namespace

void checkOrder(const PelLutInfo& info) {
    if (info.kind == PEL_LUT_CURVATURE)
        checkOrder(info.curvature.radiusMin, info.curvature.radiusMax, "PelCurvatureLutDesc.radiusMin",
                   "PelCurvatureLutDesc.radiusMax");
    if (info.kind == PEL_LUT_SHADOW)
        checkOrder(info.shadow.widthMin, info.shadow.widthMax, "PelShadowLutDesc.widthMin",
                   "PelShadowLutDesc.widthMax");
}

void checkCurvatureDesc(const PelCurvatureLutDesc& fields) {
    const char* structure = "PelCurvatureLutDesc";
    PEL_EACH_CURVATURE_LUT_FIELD(PEL_CHECK_RANGE)
    if (fields.form < PEL_FORM_ARC || fields.form > PEL_FORM_PENNER_RING)
        invalidArgument(
            "PelCurvatureLutDesc.form is ", int(fields.form),
            "; PEL_FORM_ARC (0), _RING (1), _HALF_RING (2), _SPHERE (3) or _PENNER_RING (4) is needed");
    checkAxis(structure, fields.axis);
    checkTexels(structure, fields.width, fields.height);
}

void checkShadowDesc(const PelShadowLutDesc& fields) {
    const char* structure = "PelShadowLutDesc";
    PEL_EACH_SHADOW_LUT_FIELD(PEL_CHECK_RANGE)
    checkAxis(structure, fields.axis);
    checkTexels(structure, fields.width, fields.height);
}

void checkSpecularDesc(const PelSpecularLutDesc& fields) {
    const char* structure = "PelSpecularLutDesc";
    PEL_EACH_SPECULAR_LUT_FIELD(PEL_CHECK_RANGE)
    checkTexels(structure, fields.width, fields.height);
}

}  // namespace pel
