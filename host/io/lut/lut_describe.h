// The attributes by which a table's file describes the table: names and values.
#pragma once
#include <pellucid/pellucid.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/choice_keys.h"
#include "io/image/image_file.h"

namespace pellucid::io {

inline constexpr int lutFormatVersion = 1;

// Width and height in texels.
std::pair<uint32_t, uint32_t> lutSize(const PelLutInfo& info);

// The numbers of a description, except its size: visit(attribute name, float&).
template <class Info, class Visit>
void visitLutNumbers(Info& info, Visit&& visit) {
    if (info.kind == PEL_LUT_CURVATURE) {
        visit("pellucid:diffusionRadius", info.curvature.diffusionRadius);
        visit("pellucid:radiusMin", info.curvature.radiusMin);
        visit("pellucid:radiusMax", info.curvature.radiusMax);
    } else if (info.kind == PEL_LUT_SHADOW) {
        visit("pellucid:diffusionRadius", info.shadow.diffusionRadius);
        visit("pellucid:widthMin", info.shadow.widthMin);
        visit("pellucid:widthMax", info.shadow.widthMax);
        visit("pellucid:sharpening", info.shadow.sharpening);
    }
}

// Everything: kind, versions, colour space, profile's name, form, axis, numbers.
std::vector<std::pair<std::string, Attribute>> describeLut(const PelLutInfo& info);

}  // namespace pellucid::io
