#include "lut/lut.h"

#include <cstring>

#include "core/check_range.h"
#include "core/handle_table.h"
#include "lut/lut_terms.h"

namespace pel {
namespace {

static_assert(int(PEL_AXIS_LINEAR) == PEL_LUT_AXIS_LINEAR && int(PEL_AXIS_ROOT) == PEL_LUT_AXIS_ROOT);

// Of NAMEMin and NAMEMax.
void checkOrder(float min, float max, const char* name) {
    if (min > max)
        invalidArgument(name, "Min (", min, ") is greater than ", name, "Max (", max, "); exchange them");
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
    info.profile[sizeof info.profile - 1] = '\0';
    const PelProfileInfo lengths = profile.info();
    info.curvature = pelCurvatureLutDescFilled(info.curvature, &lengths);
    info.shadow = pelShadowLutDescFilled(info.shadow, &lengths);
    if (info.kind == PEL_LUT_CURVATURE)
        checkOrder(info.curvature.radiusMin, info.curvature.radiusMax, "PelCurvatureLutDesc.radius");
    if (info.kind == PEL_LUT_SHADOW)
        checkOrder(info.shadow.widthMin, info.shadow.widthMax, "PelShadowLutDesc.width");
    if (info.eye.irisRadius == 0) info.eye.irisRadius = info.eye.limbusRadius;
    return info;
}

LutLayout layoutOf(const PelLutInfo& info) {
    LutLayout layout{};
    double longest = 1, shortest = 1;
    const auto set = [&](const auto& desc, float least, float most) {
        layout.width = desc.width, layout.height = desc.height;
        layout.axis = uint32_t(desc.axis);
        layout.radius = desc.diffusionRadius;
        longest = most, shortest = least;
    };
    if (info.kind == PEL_LUT_CURVATURE)
        set(info.curvature, info.curvature.radiusMin, info.curvature.radiusMax);
    if (info.kind == PEL_LUT_SHADOW) set(info.shadow, info.shadow.widthMin, info.shadow.widthMax);
    if (info.kind == PEL_LUT_SPECULAR)
        layout.width = info.specular.width, layout.height = info.specular.height;
    if (info.kind == PEL_LUT_EYE)  // slice below slice
        layout.width = info.eye.width, layout.height = info.eye.height * info.eye.depth;
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

Lut::Lut(Ref<Device> device, const PelLutInfo& info, bool ofStack)
    : Object(kind),
      device_(std::move(device)),
      profile_(profileOf(info)),
      info_(resolved(info, *profile_)),
      ownRadius_(info.kind == PEL_LUT_SHADOW ? info.shadow.diffusionRadius == 0
                                             : info.curvature.diffusionRadius == 0),
      layout_(layoutOf(info_)) {
    if (!ofStack) texels_ = device_->allocate(texelBytes());
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
