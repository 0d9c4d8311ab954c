// Reference-counted ownership of OpenCL objects, and the check of OpenCL's return codes.
#pragma once
#include <CL/cl.h>

#include <utility>

#include "cl/error.h"

namespace pel::cl {

const char* errorName(cl_int code);

// Throws with OpenCL's error name; out-of-memory codes become PEL_ERROR_OUT_OF_MEMORY, all others
// PEL_ERROR_DEVICE.
void check(cl_int code, const char* call);

inline cl_int retain(cl_context h) {
    return clRetainContext(h);
}
inline cl_int release(cl_context h) {
    return clReleaseContext(h);
}
inline cl_int retain(cl_command_queue h) {
    return clRetainCommandQueue(h);
}
inline cl_int release(cl_command_queue h) {
    return clReleaseCommandQueue(h);
}
inline cl_int retain(cl_mem h) {
    return clRetainMemObject(h);
}
inline cl_int release(cl_mem h) {
    return clReleaseMemObject(h);
}
inline cl_int retain(cl_program h) {
    return clRetainProgram(h);
}
inline cl_int release(cl_program h) {
    return clReleaseProgram(h);
}
inline cl_int retain(cl_kernel h) {
    return clRetainKernel(h);
}
inline cl_int release(cl_kernel h) {
    return clReleaseKernel(h);
}
inline cl_int retain(cl_event h) {
    return clRetainEvent(h);
}
inline cl_int release(cl_event h) {
    return clReleaseEvent(h);
}

template <class H>
class Handle {
  public:
    Handle() = default;
    explicit Handle(H owned) : h_(owned) {}
    static Handle retained(H h) {
        if (h) check(retain(h), "clRetain");
        return Handle(h);
    }
    Handle(const Handle& other) : h_(other.h_) {
        if (h_) check(retain(h_), "clRetain");
    }
    Handle(Handle&& other) noexcept : h_(std::exchange(other.h_, nullptr)) {}
    Handle& operator=(Handle other) noexcept {
        std::swap(h_, other.h_);
        return *this;
    }
    ~Handle() {
        if (h_) release(h_);
    }
    H get() const { return h_; }
    explicit operator bool() const { return h_ != nullptr; }

  private:
    H h_ = nullptr;
};

using Context = Handle<cl_context>;
using Queue = Handle<cl_command_queue>;
using Memory = Handle<cl_mem>;
using Program = Handle<cl_program>;
using Kernel = Handle<cl_kernel>;
using Event = Handle<cl_event>;

}  // namespace pel::cl
