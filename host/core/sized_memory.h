// Device memory whose size changes occasionally.
#pragma once
#include "core/device.h"

namespace pel {

// While one that is `on` lives, resizing on this thread keeps memory that is long enough.
class KeepsLarger {
  public:
    explicit KeepsLarger(bool on) { on_ = on; }
    ~KeepsLarger() { on_ = false; }
    KeepsLarger(const KeepsLarger&) = delete;
    KeepsLarger& operator=(const KeepsLarger&) = delete;
    // Whether memory of `held` bytes serves for `bytes`.
    static bool fits(size_t held, size_t bytes) { return held == bytes || (on_ && bytes && held > bytes); }
    static bool on() { return on_; }

  private:
    inline static thread_local bool on_ = false;
};

class SizedMemory {
  public:
    const cl::Memory& memory() const { return memory_; }
    size_t bytes() const { return held_; }
    // Changes the size; the content is undefined, or zeros. Returns false, without effect, if it is the same.
    bool resize(Device& device, size_t bytes, bool zeros = false) {
        if (bytes == bytes_) return false;
        bytes_ = 0;
        if (!KeepsLarger::fits(held_, bytes)) {
            release();
            if (bytes) memory_ = zeros ? device.allocateZeros(bytes) : device.allocate(bytes);
            held_ = bytes;
        } else if (zeros && bytes) {
            device.fill(memory_.get(), 0, bytes, 0);
        }
        bytes_ = bytes;
        return true;
    }
    // The next resize() has an effect. Releases the memory, unless KeepsLarger is on.
    void forget() {
        bytes_ = 0;
        if (!KeepsLarger::on()) release();
    }
    // At least this long.
    const cl::Memory& grow(Device& device, size_t bytes) {
        if (held_ < bytes) resize(device, bytes);
        return memory_;
    }

  private:
    void release() {
        memory_ = cl::Memory();
        held_ = 0;
    }

    cl::Memory memory_;
    size_t bytes_ = 0, held_ = 0;  // in use; allocated
};

}  // namespace pel
