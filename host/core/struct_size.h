// Structures of the C interface carry their size, so that callers built with another version's header work.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <vector>

#include "cl/error.h"

namespace pel {

// Whether `size` bytes of T are whole fields, more than structSize. An older header's structure ends where a
// field of this one ends, or where the next begins. A newer one's is longer, by a multiple of 4 bytes.
template <class T>
bool isWholeStruct(uint32_t size);

#define PEL_FIELD(T, name) {offsetof(T, name), offsetof(T, name) + sizeof(T::name)},
#define PEL_STRUCT(T, fields)                                                 \
    template <>                                                               \
    inline bool isWholeStruct<T>(uint32_t size) {                             \
        static constexpr struct { size_t begin, end; } all[] = {fields};      \
        if (size >= sizeof(T)) return size % sizeof(uint32_t) == 0;           \
        return std::any_of(all + 1, std::end(all), [&](const auto& f) {       \
            return size == f.end || (size == f.begin && size > all[1].begin); \
        });                                                                   \
    }
#include "struct_fields.inc"  // cmake/StructFieldsScript.cmake, from pellucid.h
#undef PEL_STRUCT
#undef PEL_FIELD

template <class T>
void checkStructSize(uint32_t size, const char* name) {
    if (size > 1u << 16 || !isWholeStruct<T>(size))
        invalidArgument(name, ".structSize is ", size, ", which is not its size in any version; it is ",
                        sizeof(T), " in this version: start from the pel...Defaults() function of ", name);
}

// Copies the caller's structure over `defaults`. Fields that its header did not have keep their defaults.
template <class T>
T readStruct(const T* from, T defaults, const char* name) {
    if (!from) invalidArgument("a ", name, " is needed, not NULL");
    checkStructSize<T>(from->structSize, name);
    std::memcpy(&defaults, from, std::min<size_t>(from->structSize, sizeof(T)));
    defaults.structSize = sizeof(T);
    return defaults;
}

// The same, where NULL stands for the defaults.
template <class T>
T readStructOr(const T* from, const T& defaults, const char* name) {
    return from ? readStruct(from, defaults, name) : defaults;
}

template <class T>
void writeStruct(T* to, const T& value, const char* name) {
    if (!to) invalidArgument("a ", name, " to fill is needed, not NULL");
    const uint32_t size = to->structSize;
    checkStructSize<T>(size, name);
    std::memcpy(to, &value, std::min<size_t>(size, sizeof(T)));
    to->structSize = size;
}

// An array of `room` structures, each as long as the first says. Nothing is written if there are more.
template <class T>
void writeStructs(T* to, uint32_t room, const std::vector<T>& values, const char* name) {
    if (values.size() > room)
        invalidArgument("there are ", values.size(), " structures ", name, " and room for ", room);
    if (values.empty()) return;
    const uint32_t size = to ? to->structSize : 0;
    for (size_t i = 0; i < values.size(); ++i) {
        T* const one = reinterpret_cast<T*>(reinterpret_cast<char*>(to) + i * size);
        if (i > 0) one->structSize = size;
        writeStruct(one, values[i], name);
    }
}

}  // namespace pel
