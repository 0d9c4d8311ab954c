// Structures that cross the C interface carry their size, so that callers built with an older or newer header
// fit.
#pragma once
#include <algorithm>
#include <cstring>

#include "cl/error.h"

namespace pel {

// The caller's structure over `defaults`; fields that its header did not have keep their defaults.
template <class T>
T readStruct(const T* from, T defaults, const char* name) {
    if (!from) invalidArgument("a ", name, " is needed, not NULL");
    if (from->structSize < sizeof(uint32_t) || from->structSize > 1u << 16)
        invalidArgument(name, ".structSize is ", from->structSize,
                        ": start from the pel...Defaults() function of ", name);
    std::memcpy(&defaults, from, std::min<size_t>(from->structSize, sizeof(T)));
    defaults.structSize = sizeof(T);
    return defaults;
}

template <class T>
void writeStruct(T* to, const T& value, const char* name) {
    if (!to) invalidArgument("a ", name, " to fill is needed, not NULL");
    const uint32_t size = to->structSize;
    if (size < sizeof(uint32_t) || size > 1u << 16)
        invalidArgument(name, ".structSize is ", size, ": start from the pel...Defaults() function of ",
                        name);
    std::memcpy(to, &value, std::min<size_t>(size, sizeof(T)));
    to->structSize = size;
}

}  // namespace pel
