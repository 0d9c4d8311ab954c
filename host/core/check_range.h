// Number fields of public structures against the table of their ranges.
#pragma once
#include "cl/error.h"
#include "shared/field_ranges.h"

namespace pel {

inline void checkRange(std::string_view structure, const char* field, float value, const FieldRange& range) {
    if (!range.holds(value))
        invalidArgument(structure, ".", field, " is ", value, "; it must be ", describe(range));
}
inline void checkRange(std::string_view structure, const char* field, uint32_t value, const FieldRange& range) {
    if (!range.holds(float(value)))
        invalidArgument(structure, ".", field, " is ", value, "; it must be ", describe(range));
}
template <size_t N>
void checkRange(std::string_view structure, const char* field, const float (&values)[N], const FieldRange& range) {
    for (const float value : values) checkRange(structure, field, value, range);
}

}  // namespace pel

// For the lists of shared/field_ranges.h, where `structure` is a name and `fields` the object.
#define PEL_CHECK_RANGE(field, least, most, special) \
    checkRange(structure, #field, fields.field, {least, most, special});
