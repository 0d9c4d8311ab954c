// The attributes by which a table's file describes the table: names and values.
#pragma once
#include <pellucid/pellucid.h>

#include "fields/field_ranges.h"
#include "io/choice_keys.h"
#include "io/image/image_file.h"

namespace pellucid::io {

inline constexpr int lutFormatVersion = 1;

// Width and height in texels: of an eye's table those of all slices, one below the other.
std::pair<uint32_t, uint32_t> lutSize(const PelLutInfo& info);

// The numbers of a description, except its size: visit(attribute name, float&).
#define PELLUCID_NUMBER_FLOAT(name) visit("pellucid:" #name, numbers.name);
#define PELLUCID_NUMBER_UINT(name)
#define PELLUCID_NUMBER(type, name, ...) PELLUCID_NUMBER_##type(name)
template <class Info, class Visit>
void visitLutNumbers(Info& info, Visit&& visit) {
    if (info.kind == PEL_LUT_CURVATURE) {
        auto& numbers = info.curvature;
        PEL_EACH_CURVATURE_LUT_FIELD(PELLUCID_NUMBER)
    } else if (info.kind == PEL_LUT_SHADOW) {
        auto& numbers = info.shadow;
        PEL_EACH_SHADOW_LUT_FIELD(PELLUCID_NUMBER)
    } else if (info.kind == PEL_LUT_EYE) {
        auto& numbers = info.eye;
        PEL_EACH_EYE_LUT_FIELD(PELLUCID_NUMBER)
    }
}
#undef PELLUCID_NUMBER
#undef PELLUCID_NUMBER_UINT
#undef PELLUCID_NUMBER_FLOAT

// Everything: kind, versions, colour space, profile's name, form, axis, numbers.
std::vector<std::pair<std::string, Attribute>> describeLut(const PelLutInfo& info);

}  // namespace pellucid::io
