#include "core/lut.h"

namespace pel {
namespace {

LutLayout layoutOf(const PelLutInfo& info) {
    const bool curvature = info.kind == PEL_LUT_CURVATURE;
    LutLayout layout{};
    layout.width = curvature ? info.curvature.width : info.shadow.width;
    layout.height = curvature ? info.curvature.height : info.shadow.height;
    layout.rowTexels = layout.width + 1;
    layout.axis = LUT_AXIS_LINEAR;
    const double longest = curvature ? info.curvature.radiusMax : info.shadow.widthMax;
    const double shortest = curvature ? info.curvature.radiusMin : info.shadow.widthMin;
    layout.rowMin = float(1 / longest);
    layout.rowScale = longest > shortest ? float(layout.height / (1 / shortest - 1 / longest)) : 0.0f;
    layout.radius = curvature ? info.curvature.diffusionRadius : info.shadow.diffusionRadius;
    return layout;
}

}  // namespace

Lut::Lut(Ref<Device> device, const PelLutInfo& info)
    : Object(kind),
      device_(std::move(device)),
      info_(info),
      layout_(layoutOf(info)),
      texels_(device_->allocate(size_t(layout_.rowTexels) * (layout_.height + 1) * sizeof(cl_float4))) {}

}  // namespace pel
