// Common code of C entry points: runs the call, and turns exceptions into an error code and a message.
#pragma once
#include <new>

#include "cl/machine.h"
#include "core/error_log.h"
#include "core/handle_table.h"
#include "core/struct_size.h"

namespace pel {

template <class Body>
PelError entry(Body&& body) noexcept {
    try {
        beginCall();
        cl::checkProcess();
        body();
        return PEL_SUCCESS;
    } catch (const Error& e) {
        return report(e.code(), e.what());
    } catch (const std::bad_alloc&) {
        return report(PEL_ERROR_OUT_OF_MEMORY, "the host is out of memory");
    } catch (const std::exception& e) {
        return report(PEL_ERROR_UNKNOWN, e.what());
    } catch (...) {
        return report(PEL_ERROR_UNKNOWN, "an unknown error in the library");
    }
}

// pel...Retain and Release: NULL does nothing. An error can only be reported by the message and the callback.
#define PEL_COUNTED(T)                                              \
    void pel##T##Retain(Pel##T handle) {                            \
        if (handle) entry([&] { retainHandle(handle, T::kind); });  \
    }                                                               \
    void pel##T##Release(Pel##T handle) {                           \
        if (handle) entry([&] { releaseHandle(handle, T::kind); }); \
    }

// Throws if an output parameter is NULL.
template <class T>
T& output(T* pointer, const char* name) {
    if (!pointer) invalidArgument(name, " receives the result: it must not be NULL");
    return *pointer;
}

// An entry point that returns a handle of the object from `make`, which is called only if `to` is not NULL.
template <class Handle, class Make>
PelError create(Handle* to, const char* name, const Make& make) noexcept {
    return entry([&] {
        Handle& place = output(to, name);
        place = toHandle<Handle>(make());
    });
}

}  // namespace pel
