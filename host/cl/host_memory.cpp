#include "cl/host_memory.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <deque>
#include <memory>
#include <mutex>

#include "cl/machine.h"

namespace pel::cl {
namespace {

constexpr size_t page = 4096, cacheLine = 128;
// From this size on memory is mapped separately: it is zero, and returns to the system when it is freed.
constexpr size_t mapped = 32 << 20;
// The same for memory that must be zero, as the system's pages are.
constexpr size_t mappedZeros = 2 << 20;
// Freed blocks of these sizes are kept for a while, up to the larger one; the allocator keeps smaller ones.
constexpr size_t leastSpared = 128 << 10, mostSpared = 16 << 20;
// Bytes allocated before the free memory is measured again, which takes 100 us.
constexpr size_t unasked = 16 << 20;

// Keeps the last freed blocks for new ones of their sizes: whether the allocator maps new pages for each of
// several tables depends on its other blocks.
class Spares {
  public:
    static Spares& all() {
        static Spares& one = *new Spares;  // buffers may outlive static objects
        return one;
    }
    void* take(size_t bytes) {
        const std::lock_guard lock(mutex_);
        const auto found =
            std::find_if(spares_.begin(), spares_.end(), [&](const auto& s) { return s.first == bytes; });
        if (found == spares_.end()) return nullptr;
        void* const at = found->second;
        spares_.erase(found);
        held_ -= bytes;
        return at;
    }
    void give(size_t bytes, void* at) {
        const std::lock_guard lock(mutex_);
        spares_.emplace_back(bytes, at);
        for (held_ += bytes; held_ > mostSpared; spares_.pop_front()) {
            held_ -= spares_.front().first;
            freeAligned(spares_.front().second);
        }
    }

  private:
    std::mutex mutex_;
    std::deque<std::pair<size_t, void*>> spares_;  // the oldest first
    size_t held_ = 0;
};

class Block {
  public:
    Block(size_t bytes, bool zeros) : bytes_(bytes), mapped_(bytes >= (zeros ? mappedZeros : mapped)) {
        if (mapped_) {
            at_ = bytes >= mapped ? mapPages(bytes) : mapZeros(bytes);
            if (!at_) none();
        } else {
            const size_t alignment = bytes < page ? cacheLine : page;
            if (isSpared()) at_ = Spares::all().take(bytes);
            if (!at_) at_ = allocateAligned(alignment, (bytes + alignment - 1) / alignment * alignment);
            if (!at_) none();
            if (zeros) std::memset(at_, 0, bytes);
        }
    }
    ~Block() {
        if (mapped_)
            unmapPages(at_, bytes_);
        else if (isSpared())
            Spares::all().give(bytes_, at_);
        else
            freeAligned(at_);
    }
    Block(const Block&) = delete;
    Block& operator=(const Block&) = delete;
    void* at() const { return at_; }

  private:
    bool isSpared() const { return bytes_ >= leastSpared && bytes_ <= mostSpared; }
    [[noreturn]] void none() const {
        fail(PEL_ERROR_OUT_OF_MEMORY, "the system has no ", bytes_, " bytes of memory for a buffer");
    }
    size_t bytes_;
    bool mapped_;
    void* at_ = nullptr;
};

// Measures the free memory once enough has been allocated to matter.
void checkNow(size_t bytes) {
    static std::atomic<uint64_t> since{0};
    if (since.fetch_add(bytes, std::memory_order_relaxed) + bytes < unasked) return;
    since.store(0, std::memory_order_relaxed);
    requireMemory(bytes, "a buffer");
}

}  // namespace

Memory createInHostMemory(cl_context context, size_t bytes, const void* initial, bool zeros) {
    checkNow(bytes);
    auto block = std::make_unique<Block>(bytes, zeros && !initial);
    if (initial) std::memcpy(block->at(), initial, bytes);
    cl_int code = CL_SUCCESS;
    Memory memory(
        clCreateBuffer(context, CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes, block->at(), &code));
    if (code != CL_SUCCESS) check(code, text("clCreateBuffer(", bytes, " bytes)").c_str());
    const auto giveBack = [](cl_mem, void* user) { delete static_cast<Block*>(user); };
    code = clSetMemObjectDestructorCallback(memory.get(), +giveBack, block.get());
    if (code == CL_INVALID_OPERATION)
        return {};  // Wine's loader has no callbacks; `memory` goes before `block`
    check(code, "clSetMemObjectDestructorCallback");
    (void)block.release();
    return memory;
}

}  // namespace pel::cl
