#include "lut/lut_check.h"

#include <cmath>

namespace pel {
namespace {

constexpr uint32_t maxSide = 16384;

void checkSide(uint32_t texels, const char* field) {
    if (texels < 1 || texels > maxSide)
        invalidArgument(field, " is ", texels, " texels; 1 to ", maxSide, " are possible");
}

void checkLength(float value, const char* field) {
    if (!std::isfinite(value) || value <= 0)
        invalidArgument(field, " is ", value, "; a finite length above 0 is needed");
}

void checkDiffusionRadius(float value, const char* field) {
    if (value != 0) checkLength(value, field);  // 0 is the profile's own
}

void checkOrder(float min, float max, const char* minField, const char* maxField) {
    checkLength(min, minField);
    checkLength(max, maxField);
    if (min > max)
        invalidArgument(minField, " (", min, ") is greater than ", maxField, " (", max, "); exchange them");
}

}  // namespace

void checkCurvatureDesc(const PelCurvatureLutDesc& desc) {
    checkSide(desc.width, "PelCurvatureLutDesc.width");
    checkSide(desc.height, "PelCurvatureLutDesc.height");
    if (desc.form < PEL_FORM_ARC || desc.form > PEL_FORM_PENNER_RING)
        invalidArgument(
            "PelCurvatureLutDesc.form is ", int(desc.form),
            "; PEL_FORM_ARC (0), _RING (1), _HALF_RING (2), _SPHERE (3) or _PENNER_RING (4) is needed");
    if (desc.axis != PEL_AXIS_LINEAR && desc.axis != PEL_AXIS_ROOT)
        invalidArgument("PelCurvatureLutDesc.axis is ", int(desc.axis),
                        "; PEL_AXIS_LINEAR (0) or PEL_AXIS_ROOT (1) is needed");
    checkDiffusionRadius(desc.diffusionRadius, "PelCurvatureLutDesc.diffusionRadius");
    checkOrder(desc.radiusMin, desc.radiusMax, "PelCurvatureLutDesc.radiusMin",
               "PelCurvatureLutDesc.radiusMax");
}

void checkShadowDesc(const PelShadowLutDesc& desc) {
    if (desc.closedEnds > 1)
        invalidArgument("PelShadowLutDesc.closedEnds is ", desc.closedEnds, "; 0 or 1 is needed");
    if (desc.axis != PEL_AXIS_LINEAR && desc.axis != PEL_AXIS_ROOT)
        invalidArgument("PelShadowLutDesc.axis is ", int(desc.axis),
                        "; PEL_AXIS_LINEAR (0) or PEL_AXIS_ROOT (1) is needed");
    checkSide(desc.width, "PelShadowLutDesc.width");
    checkSide(desc.height, "PelShadowLutDesc.height");
    checkDiffusionRadius(desc.diffusionRadius, "PelShadowLutDesc.diffusionRadius");
    checkOrder(desc.widthMin, desc.widthMax, "PelShadowLutDesc.widthMin", "PelShadowLutDesc.widthMax");
    if (!std::isfinite(desc.sharpening) || desc.sharpening < 1)
        invalidArgument("PelShadowLutDesc.sharpening is ", desc.sharpening,
                        "; 1 (no sharpening) or more, finite, is needed");
}

void checkSpecularDesc(const PelSpecularLutDesc& desc) {
    checkSide(desc.width, "PelSpecularLutDesc.width");
    checkSide(desc.height, "PelSpecularLutDesc.height");
}

void checkInfo(const PelLutInfo& info) {
    if (info.kind == PEL_LUT_CURVATURE)
        checkCurvatureDesc(info.curvature);
    else if (info.kind == PEL_LUT_SHADOW)
        checkShadowDesc(info.shadow);
    else if (info.kind == PEL_LUT_SPECULAR)
        checkSpecularDesc(info.specular);
    else
        invalidArgument("PelLutInfo.kind is ", int(info.kind),
                        "; PEL_LUT_CURVATURE (0), PEL_LUT_SHADOW (1) or PEL_LUT_SPECULAR (2) is needed");
}

}  // namespace pel
