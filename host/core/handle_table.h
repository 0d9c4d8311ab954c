// The C handles. A handle is no address but a place in a table and the generation of that place: none is
// given out twice in a process, so that a released, mistaken or invented one is an error and never another
// object. Looking one up takes no lock.
#pragma once
#include "core/object.h"

namespace pel {

// A new handle that the caller holds once; the reference passes to the table. Throws PEL_ERROR_OUT_OF_MEMORY.
void* addHandle(Ref<Object> object);
// The object, held for as long as the caller of this keeps the Ref. Throws PEL_ERROR_INVALID_ARGUMENT with
// the reason unless the handle is held by somebody and of that kind.
Ref<Object> lookUpHandle(const void* handle, Kind kind);
// One more holder, or one less; errors as above. The last to go lets go of the object.
void retainHandle(const void* handle, Kind kind);
void releaseHandle(const void* handle, Kind kind);
// How many handles callers hold now, each counted once however often it was retained.
uint64_t liveHandles();

template <class T>
Ref<T> fromHandle(const void* handle) {
    return Ref<T>::adopt(static_cast<T*>(lookUpHandle(handle, T::kind).detach()));
}

template <class Handle, class T>
Handle toHandle(Ref<T> object) {
    return reinterpret_cast<Handle>(addHandle(Ref<Object>::adopt(object.detach())));
}

// For structures of the C interface that the library itself fills: a handle that lasts as long as this.
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
