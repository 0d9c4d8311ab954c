#include "lut/lut.h"

#include <cstring>

#include "core/handle_table.h"
#include "lut/lut_check.h"
#include "lut/lut_terms.h"

namespace pel {
namespace {

static_assert(int(PEL_AXIS_LINEAR) == PEL_LUT_AXIS_LINEAR && int(PEL_AXIS_ROOT) == PEL_LUT_AXIS_ROOT);

PelProfile profileHandle(const PelLutInfo& info) {
    return info.kind == PEL_LUT_CURVATURE ? info.curvature.profile
           : info.kind == PEL_LUT_SHADOW  ? info.shadow.profile
           : info.kind == PEL_LUT_EYE     ? info.eye.profile
                                          : nullptr;
}

// Fills in the defaults of a description: the profile, its name, the diffusion radius and lengths that follow
// from these.
PelLutInfo resolved(PelLutInfo info, const Profile& profile) {
    if (profileHandle(info)) {
        std::memset(info.profile, 0, sizeof info.profile);
        std::strncpy(info.profile, profile.name().c_str(), sizeof info.profile - 1);
    }
    const PelProfileInfo lengths = profile.info();
    info.curvature = pelCurvatureLutDescFilled(info.curvature, &lengths);
    info.shadow = pelShadowLutDescFilled(info.shadow, &lengths);
    checkOrder(info);
    if (info.eye.irisRadius == 0) info.eye.irisRadius = info.eye.limbusRadius;
    return info;
}

LutLayout layoutOf(const PelLutInfo& info) {
    LutLayout layout{};
    double longest = 1, shortest = 1;
    switch (info.kind) {
        case PEL_LUT_CURVATURE:
            layout.width = info.curvature.width;
            layout.height = info.curvature.height;
            layout.axis = uint32_t(info.curvature.axis);
            layout.radius = info.curvature.diffusionRadius;
            longest = info.curvature.radiusMax;
            shortest = info.curvature.radiusMin;
            break;
        case PEL_LUT_SHADOW:
            layout.width = info.shadow.width;
            layout.height = info.shadow.height;
            layout.axis = uint32_t(info.shadow.axis);
            layout.radius = info.shadow.diffusionRadius;
            longest = info.shadow.widthMax;
            shortest = info.shadow.widthMin;
            break;
        case PEL_LUT_SPECULAR:
            layout.width = info.specular.width;
            layout.height = info.specular.height;
            break;
        case PEL_LUT_EYE:  // slice below slice
            layout.width = info.eye.width;
            layout.height = info.eye.height * info.eye.depth;
            break;
    }
    layout.rowTexels = layout.width + 1;
    const RowAxis rows = rowAxis(PelLutAxis(layout.axis), layout.height, 1 / longest, 1 / shortest);
    layout.rowMin = float(rows.min);
    layout.rowScale = float(rows.scale);
    return layout;
}

Ref<Profile> profileOf(const PelLutInfo& info) {
    const PelProfile handle = profileHandle(info);
    return handle ? fromHandle<Profile>(handle) : Profile::skin();
}

}  // namespace

Lut::Lut(Ref<Device> device, const PelLutInfo& info)
    : Object(kind),
      device_(std::move(device)),
      profile_(profileOf(info)),
      info_(resolved(info, *profile_)),
      ownRadius_(info.kind == PEL_LUT_SHADOW ? info.shadow.diffusionRadius == 0
                                             : info.curvature.diffusionRadius == 0),
      layout_(layoutOf(info_)),
      texels_(device_->allocate(size_t(layout_.rowTexels) * (layout_.height + 1) * sizeof(cl_float4))) {}

}  // namespace pel
