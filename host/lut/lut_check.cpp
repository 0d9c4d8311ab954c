#include "lut/lut_check.h"

#include "core/check_range.h"
#include "lut/eye_shape.h"

namespace pel {
namespace {

void checkOrder(float min, float max, const char* minField, const char* maxField) {
    if (min > max)
        invalidArgument(minField, " (", min, ") is greater than ", maxField, " (", max, "); exchange them");
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
    const PelCurvatureLutDesc& desc = fields;
    const char* structure = "PelCurvatureLutDesc";
    PEL_EACH_CURVATURE_LUT_RANGE(PEL_CHECK_RANGE)
    if (desc.form < PEL_FORM_ARC || desc.form > PEL_FORM_PENNER_RING)
        invalidArgument(
            "PelCurvatureLutDesc.form is ", int(desc.form),
            "; PEL_FORM_ARC (0), _RING (1), _HALF_RING (2), _SPHERE (3) or _PENNER_RING (4) is needed");
    if (desc.axis != PEL_AXIS_LINEAR && desc.axis != PEL_AXIS_ROOT)
        invalidArgument("PelCurvatureLutDesc.axis is ", int(desc.axis),
                        "; PEL_AXIS_LINEAR (0) or PEL_AXIS_ROOT (1) is needed");
}

void checkShadowDesc(const PelShadowLutDesc& fields) {
    const PelShadowLutDesc& desc = fields;
    const char* structure = "PelShadowLutDesc";
    PEL_EACH_SHADOW_LUT_RANGE(PEL_CHECK_RANGE)
    if (desc.axis != PEL_AXIS_LINEAR && desc.axis != PEL_AXIS_ROOT)
        invalidArgument("PelShadowLutDesc.axis is ", int(desc.axis),
                        "; PEL_AXIS_LINEAR (0) or PEL_AXIS_ROOT (1) is needed");
}

void checkSpecularDesc(const PelSpecularLutDesc& fields) {
    const char* structure = "PelSpecularLutDesc";
    PEL_EACH_SPECULAR_LUT_RANGE(PEL_CHECK_RANGE)
}

void checkEyeDesc(const PelEyeLutDesc& fields) {
    const char* structure = "PelEyeLutDesc";
    PEL_EACH_EYE_LUT_RANGE(PEL_CHECK_RANGE)
    EyeShape(fields, structure);
}

void checkInfo(const PelLutInfo& info) {
    if (info.kind == PEL_LUT_CURVATURE)
        checkCurvatureDesc(info.curvature);
    else if (info.kind == PEL_LUT_SHADOW)
        checkShadowDesc(info.shadow);
    else if (info.kind == PEL_LUT_SPECULAR)
        checkSpecularDesc(info.specular);
    else if (info.kind == PEL_LUT_EYE)
        checkEyeDesc(info.eye);
    else
        invalidArgument(
            "PelLutInfo.kind is ", int(info.kind),
            "; PEL_LUT_CURVATURE (0), PEL_LUT_SHADOW (1), PEL_LUT_SPECULAR (2) or PEL_LUT_EYE (3) is needed");
}

}  // namespace pel
