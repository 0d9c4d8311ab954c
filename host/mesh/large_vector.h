// Vectors of many megabytes that are written once.
#pragma once
#include <memory>
#include <new>
#include <utility>

#include "cl/machine.h"

namespace pel {

// Takes large arrays from the system in whole pages at once: touching them page by page takes longer than
// to sort into them. New elements are uninitialised, where std::vector would write zeros first.
template <class T>
struct LargeAllocator {
    using value_type = T;
    LargeAllocator() = default;
    template <class U>
    explicit LargeAllocator(const LargeAllocator<U>&) {}

    static constexpr size_t large = size_t{4} << 20;  // bytes

    T* allocate(size_t count) {
        if (count < large / sizeof(T)) return std::allocator<T>().allocate(count);
        void* const at = count > SIZE_MAX / sizeof(T) ? nullptr : cl::mapPages(count * sizeof(T));
        if (!at) throw std::bad_alloc();
        return static_cast<T*>(at);
    }
    void deallocate(T* at, size_t count) {
        if (count < large / sizeof(T))
            std::allocator<T>().deallocate(at, count);
        else
            cl::unmapPages(at, count * sizeof(T));
    }
    template <class U>
    void construct(U* at) {
        ::new (static_cast<void*>(at)) U;
    }
    template <class U, class... Arguments>
    void construct(U* at, Arguments&&... arguments) {
        ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
    }
    bool operator==(const LargeAllocator&) const { return true; }
};

template <class T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

}  // namespace pel
