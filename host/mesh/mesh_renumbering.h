// New numbers for the slots of a mesh, so that neighbours are near in memory.
#pragma once
#include <atomic>
#include <cstdint>
#include <vector>

#include "mesh/mesh_corners.h"

namespace pel {

// How many slots one thread has written for others to read.
class Written {
  public:
    explicit Written(uint32_t slots) : slots_(slots) {}
    void tell(uint32_t slots) {
        slots_.store(slots, std::memory_order_release);
        slots_.notify_all();
    }
    // At least `slots`; waits until there are so many.
    uint32_t waitFor(uint32_t slots) const {
        for (;;) {
            const uint32_t now = slots_.load(std::memory_order_acquire);
            if (now >= slots) return now;
            slots_.wait(now);
        }
    }

  private:
    std::atomic<uint32_t> slots_;
};

// Breadth first from the first slot of each part of the mesh.
class Renumbering {
  public:
    explicit Renumbering(const CornerTable& table);
    void run() noexcept;

    // Filled by run(). Another thread may read the corners of as many slots as `ready` says meanwhile, and
    // RingBuilder::readAhead more.
    CornerTable moved;
    Written ready{0};
    std::vector<uint32_t> numbers;  // the new number of each slot, once all is done

  private:
    static constexpr uint32_t none = UINT32_MAX, block = 4096;
    uint32_t number(uint32_t slot) {
        const bool isNew = numbers[slot] == none;
        queue_[known_] = slot;
        const uint32_t n = isNew ? known_ : numbers[slot];
        numbers[slot] = n;
        known_ += isNew;
        return n;
    }
    void move(uint32_t next);

    const CornerTable& table_;
    uint32_t slots_;
    LargeVector<uint32_t> queue_;
    uint32_t known_ = 0, written_ = 0;
};

}  // namespace pel
