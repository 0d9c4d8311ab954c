// Number fields of public structures against the table of their ranges.
#pragma once
#include "cl/error.h"
#include "fields/field_ranges.h"

namespace pel {

inline void checkRange(std::string_view structure, const char* field, float value, const FieldRange& range) {
    if (!range.holds(value))
        invalidArgument(structure, ".", field, " is ", value, "; it must be ", describe(range));
}
inline void checkRange(std::string_view structure, const char* field, uint32_t value,
                       const FieldRange& range) {
    if (!range.holds(float(value)))
        invalidArgument(structure, ".", field, " is ", value, "; it must be ", describe(range));
}
template <size_t N>
void checkRange(std::string_view structure, const char* field, const float (&values)[N],
                const FieldRange& range) {
    for (const float value : values) checkRange(structure, field, value, range);
}

}  // namespace pel

// For the lists of pellucid_fields.h, where `structure` is a name and `fields` the object.
#define PEL_CHECK_RANGE(type, name, value, min, max, special, ...) \
    PEL_CHECK_##type##_(name, min, max, special)
#define PEL_CHECK_FLOAT_(name, min, max, special) \
    checkRange(structure, #name, fields.name, {float(min), float(max), float(special)});
#define PEL_CHECK_UINT_ PEL_CHECK_FLOAT_
#define PEL_CHECK_COLOR_ PEL_CHECK_FLOAT_
// Not checked where they are set.
#define PEL_CHECK_FREE_(...)
#define PEL_CHECK_FREE_UINT_(...)
#define PEL_CHECK_VECTOR_(...)
#define PEL_CHECK_MATRIX_(...)
