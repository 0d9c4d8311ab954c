// One kernel launch: arguments by position, checked sizes, a padded range.
#pragma once
#include <array>

#include "cl/handle.h"

namespace pel::cl {

// `items` work-items in each dimension, rounded up to whole work-groups of `group` (the kernel's
// reqd_work_group_size). Kernels compare their index with the item count, which they get as an argument.
struct Range {
    std::array<size_t, 3> items{1, 1, 1};
    std::array<size_t, 3> group{1, 1, 1};
};

// `items` work-items in two dimensions below 65,535 each, for PoCL compiles a kernel again for longer ranges.
// Rounded up to whole rows (lib/diffusion/item.clh numbers the items); few items lie in one dimension.
inline Range folded(size_t items, size_t group) {
    constexpr size_t most = 32768;
    if (items <= most) return {{items, 1, 1}, {group, 1, 1}};
    return {{most, (items + most - 1) / most, 1}, {group, 1, 1}};
}

class Launch {
  public:
    // A new cl_kernel: making one costs about a microsecond and needs no lock. `values` are its arguments.
    template <class... Values>
    Launch(const Program& program, const char* kernel, const Values&... values) : Launch(program, kernel) {
        args(values...);
    }
    Launch(const Program& program, const char* kernel);

    Launch& arg(cl_mem memory) { return raw(&memory, sizeof memory); }
    Launch& arg(const Memory& memory) { return arg(memory.get()); }
    // An image, a buffer, constants.
    template <class T>
    requires requires(const T& owner) { owner.memory(); }
    Launch& arg(const T& owner) { return arg(owner.memory()); }
    // The memory and the layout of a view.
    template <class T>
    requires requires(const T& view) { view.layout; }
    Launch& arg(const T& view) { return arg(view.memory).arg(view.layout); }
    // Numbers and structures of kernels/shared, passed by value.
    template <class T>
    requires std::is_trivially_copyable_v<T> &&(!std::is_pointer_v<T>)Launch& arg(const T& value) {
        return raw(&value, sizeof value);
    }
    template <class... Values>
    Launch& args(const Values&... values) {
        (arg(values), ...);
        return *this;
    }

    // Nothing is launched, and the event is empty, if a dimension has no items.
    Event enqueue(cl_command_queue queue, const Range& range);
    const Kernel& kernel() const { return kernel_; }

  private:
    Launch& raw(const void* value, size_t bytes);

    Kernel kernel_;
    const char* name_;
    cl_uint next_ = 0;
};

}  // namespace pel::cl
