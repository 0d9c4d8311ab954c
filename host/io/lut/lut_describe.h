// The attributes by which a table's file describes the table: names and values.
#pragma once
#include <pellucid/pellucid.h>

#include "io/choice_keys.h"
#include "io/image/image_file.h"

namespace pellucid::io {

inline constexpr int lutFormatVersion = 1;

// Width and height in texels: of an eye's table those of all slices, one below the other.
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
    } else if (info.kind == PEL_LUT_EYE) {
        visit("pellucid:scleraRadius", info.eye.scleraRadius);
        visit("pellucid:corneaRadius", info.eye.corneaRadius);
        visit("pellucid:corneaConic", info.eye.corneaConic);
        visit("pellucid:limbusRadius", info.eye.limbusRadius);
        visit("pellucid:chamberDepth", info.eye.chamberDepth);
        visit("pellucid:corneaIndex", info.eye.corneaIndex);
        visit("pellucid:aqueousIndex", info.eye.aqueousIndex);
        visit("pellucid:irisRadius", info.eye.irisRadius);
        visit("pellucid:irisConcavity", info.eye.irisConcavity);
        visit("pellucid:millimetresPerUnit", info.eye.millimetresPerUnit);
    }
}

// Everything: kind, versions, colour space, profile's name, form, axis, numbers.
std::vector<std::pair<std::string, Attribute>> describeLut(const PelLutInfo& info);

}  // namespace pellucid::io
