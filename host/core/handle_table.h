// The C handles. A handle is not an address but a number. Handles are never reused in a process, so a
// released or invalid handle is an error and never another object.
#pragma once
#include "core/object.h"

namespace pel {

// A new handle with a caller's count of 1; takes the reference. Throws PEL_ERROR_OUT_OF_MEMORY.
void* addHandle(Ref<Object> object);
// The object, alive for as long as the caller keeps the Ref. Throws PEL_ERROR_INVALID_ARGUMENT with the
// reason if the handle is not in use or of another kind.
Ref<Object> lookUpHandle(const void* handle, Kind kind);
// Raises or lowers the callers' count; errors as above. At 0 the table releases the object.
void retainHandle(const void* handle, Kind kind);
void releaseHandle(const void* handle, Kind kind);
// Names a handle of any kind: pelSetName.
void nameHandle(const void* handle, const char* name);
// The name of the first object with one that this thread looked up since beginCall(); "" if none has.
const char* nameInCall();
void beginCall();
// Number of handles in use, each counted once however often it was retained.
uint64_t liveHandles();

template <class T>
Ref<T> fromHandle(const void* handle) {
    return Ref<T>::adopt(static_cast<T*>(lookUpHandle(handle, T::kind).detach()));
}

template <class Handle, class T>
Handle toHandle(Ref<T> object) {
    return reinterpret_cast<Handle>(addHandle(Ref<Object>::adopt(object.detach())));
}

// For structures of the C interface that the library fills: a handle that lives as long as this object.
template <class Handle, class T>
class LentHandle {
  public:
    explicit LentHandle(Ref<T> object)
        : handle_(reinterpret_cast<Handle>(addHandle(Ref<Object>(object.get())))) {}
    LentHandle(const LentHandle&) = delete;
    LentHandle& operator=(const LentHandle&) = delete;
    ~LentHandle() { releaseHandle(handle_, T::kind); }
    Handle get() const { return handle_; }

  private:
    Handle handle_;
};

}  // namespace pel
