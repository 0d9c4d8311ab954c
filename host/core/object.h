// Counted objects behind the C handles. Every live object is on record, so that a null, released or mistaken
// handle is an error and not a crash.
#pragma once
#include <atomic>
#include <utility>

#include "cl/error.h"

namespace pel {

enum class Kind { device, event, buffer, meshTopology, liveMesh, lut, shader, profile };
const char* kindName(Kind kind);

class Object {
  public:
    Object(const Object&) = delete;
    Object& operator=(const Object&) = delete;
    void retain() { count_.fetch_add(1, std::memory_order_relaxed); }
    void release() {
        if (count_.fetch_sub(1, std::memory_order_acq_rel) == 1) delete this;
    }

  protected:
    explicit Object(Kind kind);
    virtual ~Object();

  private:
    std::atomic<uint32_t> count_{1};
};

// Throws PEL_ERROR_INVALID_ARGUMENT unless `handle` is a live object of that kind.
Object& checkedObject(void* handle, Kind kind);
// As above, but null is fine and so is an unknown handle (returns null): for Release, which reports nothing.
Object* liveObject(void* handle);

template <class T>
T& fromHandle(void* handle) {
    return static_cast<T&>(checkedObject(handle, T::kind));
}

template <class T>
class Ref {
  public:
    Ref() = default;
    explicit Ref(T* object) : object_(object) {
        if (object_) object_->retain();
    }
    static Ref adopt(T* object) {
        Ref ref;
        ref.object_ = object;
        return ref;
    }
    Ref(const Ref& other) : Ref(other.object_) {}
    Ref(Ref&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
    Ref& operator=(Ref other) noexcept {
        std::swap(object_, other.object_);
        return *this;
    }
    ~Ref() {
        if (object_) object_->release();
    }
    T* get() const { return object_; }
    T* operator->() const { return object_; }
    T& operator*() const { return *object_; }
    explicit operator bool() const { return object_ != nullptr; }
    T* detach() { return std::exchange(object_, nullptr); }

  private:
    T* object_ = nullptr;
};

template <class T, class... Args>
Ref<T> make(Args&&... args) {
    return Ref<T>::adopt(new T(std::forward<Args>(args)...));
}

// The C handle of a new object: its one reference passes to the caller.
template <class Handle, class T>
Handle toHandle(Ref<T> object) {
    return reinterpret_cast<Handle>(static_cast<Object*>(object.detach()));
}

}  // namespace pel
