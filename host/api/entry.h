// What every C entry point does: run, and turn an exception into an error code and a message.
#pragma once
#include <new>

#include "core/error_log.h"
#include "core/object.h"
#include "core/struct_size.h"

namespace pel {

template <class Body>
PelError entry(Body&& body) noexcept {
    try {
        body();
        return PEL_SUCCESS;
    } catch (const Error& e) {
        return report(e.code(), e.what());
    } catch (const std::bad_alloc&) {
        return report(PEL_ERROR_OUT_OF_MEMORY, "the host is out of memory");
    } catch (const std::exception& e) {
        return report(PEL_ERROR_UNKNOWN, e.what());
    } catch (...) {
        return report(PEL_ERROR_UNKNOWN, "a fault of unknown kind in the library");
    }
}

inline void retainHandle(void* handle) noexcept {
    if (Object* object = liveObject(handle)) object->retain();
}

inline void releaseHandle(void* handle) noexcept {
    if (Object* object = liveObject(handle)) object->release();
}

// Throws when an output parameter is missing.
template <class T>
T& output(T* pointer, const char* name) {
    if (!pointer) invalidArgument(name, " is where the result goes: it must not be NULL");
    return *pointer;
}

}  // namespace pel
