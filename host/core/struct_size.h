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
// The name of T in messages.
template <class T>
constexpr const char* structName = nullptr;

#define PEL_FIELD(T, name) {offsetof(T, name), offsetof(T, name) + sizeof(T::name)},
#define PEL_STRUCT(T, fields)                                                 \
    template <>                                                               \
    inline constexpr const char* structName<T> = #T;                          \
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
void checkStructSize(uint32_t size) {
    constexpr const char* name = structName<T>;
    if (size > 1u << 16 || !isWholeStruct<T>(size))
        invalidArgument(name, ".structSize is ", size, ", which is not its size in any version; it is ",
                        sizeof(T), " in this version: start from the pel...Defaults() function of ", name);
}

// Copies the caller's structure over `defaults`. Fields that its header did not have keep their defaults.
template <class T>
T readStruct(const T* from, T defaults) {
    if (!from) invalidArgument("a ", structName<T>, " is needed, not NULL");
    checkStructSize<T>(from->structSize);
    std::memcpy(&defaults, from, std::min<size_t>(from->structSize, sizeof(T)));
    defaults.structSize = sizeof(T);
    return defaults;
}

// The same, where NULL stands for the defaults.
template <class T>
T readStructOr(const T* from, const T& defaults) {
    return from ? readStruct(from, defaults) : defaults;
}

// Calls use(structure, i) for each of an array, where each is as long as it says itself.
template <class T, class Use>
void eachStruct(const T* first, uint32_t count, const Use& use) {
    const T* next = first;
    for (uint32_t i = 0; i < count; ++i) {
        use(next, i);
        next = reinterpret_cast<const T*>(reinterpret_cast<const char*>(next) + next->structSize);
    }
}

template <class T>
void writeStruct(T* to, const T& value) {
    if (!to) invalidArgument("a ", structName<T>, " to fill is needed, not NULL");
    const uint32_t size = to->structSize;
    checkStructSize<T>(size);
    std::memcpy(to, &value, std::min<size_t>(size, sizeof(T)));
    to->structSize = size;
}

// An array of `room` structures, each as long as the first says. Nothing is written if there are more.
template <class T>
void writeStructs(T* to, uint32_t room, const std::vector<T>& values) {
    if (values.size() > room)
        invalidArgument("there are ", values.size(), " structures ", structName<T>, " and room for ", room);
    const uint32_t size = to && !values.empty() ? to->structSize : 0;
    for (size_t i = 0; i < values.size(); ++i) {
        T* const one = reinterpret_cast<T*>(reinterpret_cast<char*>(to) + i * size);
        if (i > 0) one->structSize = size;
        writeStruct(one, values[i]);
    }
}

}  // namespace pel
