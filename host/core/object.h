// Reference-counted objects. References of the library are counted here, the caller's in the handle table
// (core/handle_table.h). So no caller can release an object that another one, or the library, still uses.
#pragma once
#include <atomic>
#include <cstdint>
#include <utility>

#include "cl/error.h"

namespace pel {

enum class Kind {
    device,
    event,
    buffer,
    meshTopology,
    liveMesh,
    lut,
    shader,
    profile,
    scatter,
    textureScatter
};
const char* kindName(Kind kind);

class Object {
  public:
    Object(const Object&) = delete;
    Object& operator=(const Object&) = delete;
    void retain() { count_.fetch_add(1, std::memory_order_relaxed); }
    void release() {
        if (count_.fetch_sub(1, std::memory_order_acq_rel) == 1) delete this;
    }
    Kind objectKind() const { return kind_; }
    // How many exist in the process, including those that only other objects hold.
    static uint64_t alive() { return alive_.load(std::memory_order_relaxed); }

  protected:
    explicit Object(Kind kind) : kind_(kind) { alive_.fetch_add(1, std::memory_order_relaxed); }
    virtual ~Object() { alive_.fetch_sub(1, std::memory_order_relaxed); }

  private:
    static inline std::atomic<uint64_t> alive_{0};
    std::atomic<uint32_t> count_{1};
    const Kind kind_;
};

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
    T& operator*() const& { return *object_; }
    T& operator*() const&& = delete;  // the object might be gone with the temporary
    explicit operator bool() const { return object_ != nullptr; }
    T* detach() { return std::exchange(object_, nullptr); }

  private:
    T* object_ = nullptr;
};

template <class T, class... Args>
Ref<T> make(Args&&... args) {
    return Ref<T>::adopt(new T(std::forward<Args>(args)...));
}

}  // namespace pel
