// Reference-counted ownership of OpenCL objects, and the check of OpenCL's return codes.
#pragma once
#include <CL/cl.h>

#include <utility>

#include "cl/error.h"

namespace pel::cl {

const char* errorName(cl_int code);

// Throws with OpenCL's name: PEL_ERROR_OUT_OF_MEMORY where memory ran out, else PEL_ERROR_DEVICE.
void check(cl_int code, const char* call);

#define PEL_OBJECT(H, Type)                                                          \
    inline cl_int retain(H h) {                                                      \
        return clRetain##Type(h);                                                    \
    }                                                                                \
    inline cl_int release(H h) {                                                     \
        return clRelease##Type(h);                                                   \
    }                                                                                \
    inline void getInfo(H h, cl_uint what, size_t bytes, void* to) {                 \
        check(clGet##Type##Info(h, what, bytes, to, nullptr), "clGet" #Type "Info"); \
    }
PEL_OBJECT(cl_context, Context)
PEL_OBJECT(cl_command_queue, CommandQueue)
PEL_OBJECT(cl_mem, MemObject)
PEL_OBJECT(cl_program, Program)
PEL_OBJECT(cl_kernel, Kernel)
PEL_OBJECT(cl_event, Event)
#undef PEL_OBJECT

// A property of an object, from OpenCL's query function for its type.
template <class T, class H>
T info(H object, cl_uint what) {
    T value{};
    getInfo(object, what, sizeof value, &value);
    return value;
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
