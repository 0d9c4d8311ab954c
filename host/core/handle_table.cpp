#include "core/handle_table.h"

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <new>
#include <optional>

#include "cl/machine.h"

namespace pel {
namespace {

// The bits of a handle, from the lowest: one, the index of the slot, its generation, a mark. An odd number is
// not the address of an object, and with the mark it is no address at all on 64-bit processors. So no pointer
// is mistaken for a handle, and none is dereferenced.
constexpr bool wide = sizeof(void*) == 8;
constexpr int placeBits = wide ? 24 : 14, generationBits = wide ? 32 : 15, markBits = wide ? 7 : 2;
constexpr int generationShift = 1 + placeBits, markShift = generationShift + generationBits;
constexpr uint64_t mark = wide ? 0x2d : 0x2;
static_assert(markShift + markBits == 8 * sizeof(void*));

constexpr uint64_t mask(int bits) {
    return (uint64_t(1) << bits) - 1;
}

// Neighbouring slots begin with generations far apart, so that a handle plus a small number is not a handle.
// After 2^31 objects (2^14 on 32 bits) a slot is retired: it would repeat old handles.
constexpr uint64_t uses = uint64_t(1) << (generationBits - 1);
uint64_t firstGeneration(uint64_t place) {
    return place * 0x9e3779b1u & (uses - 1);
}

struct Slot {
    // Lower half: the callers' count. Upper half: look-ups in progress. 0: the slot is free. The thread that
    // brings it to 0 releases the object, and only addHandle raises it from there.
    std::atomic<uint64_t> counts{0};
    std::atomic<uint64_t> handle{0};
    Object* object = nullptr;  // used by threads that hold a count
    uint64_t generation = 0;   // of the next handle; under the table's lock
};
constexpr uint64_t holder = 1, visitor = uint64_t(1) << 32, mostHolders = uint64_t(1) << 31;

constexpr uint32_t holders(uint64_t counts) {
    return uint32_t(counts);
}

class HandleTable {
  public:
    uint64_t add(Ref<Object> object) {
        std::lock_guard lock(mutex_);
        if (free_ == none) grow();
        const uint32_t place = free_;
        Slot& slot = *find(place);
        free_ = nextFree_[place / chunkSlots][place % chunkSlots];
        const uint64_t handle =
            mark << markShift | slot.generation << generationShift | uint64_t(place) << 1 | 1;
        slot.handle.store(handle, std::memory_order_relaxed);
        slot.object = object.detach();
        slot.counts.store(holder, std::memory_order_release);
        live_.fetch_add(1, std::memory_order_relaxed);
        return handle;
    }

    // Finds the object's slot and counts one more look-up in progress; leave() ends it.
    Slot& visit(const void* pointer, Kind kind) {
        if (!pointer) invalidArgument("a ", kindName(kind), " is needed here, not NULL");
        const uint64_t handle = reinterpret_cast<uintptr_t>(pointer);
        Slot* slot = (handle & 1) && handle >> markShift == mark
                         ? find(uint32_t(handle >> 1 & mask(placeBits)))
                         : nullptr;
        if (!slot) unknown(handle, kind);
        uint64_t counts = slot->counts.load(std::memory_order_relaxed);
        do {
            if (holders(counts) == 0) gone(*slot, handle, kind);
        } while (!slot->counts.compare_exchange_weak(counts, counts + visitor, std::memory_order_acquire,
                                                     std::memory_order_relaxed));
        // Only now is the slot stable: it may have been given to another object just before.
        if (slot->handle.load(std::memory_order_relaxed) != handle) {
            leave(*slot);
            gone(*slot, handle, kind);
        }
        const Kind found = slot->object->objectKind();
        if (found != kind) {
            leave(*slot);
            invalidArgument("a ", kindName(kind), " is needed here, not a ", kindName(found));
        }
        return *slot;
    }
    void leave(Slot& slot) { lower(slot, visitor); }

    void addHolder(Slot& slot, Kind kind) {
        uint64_t counts = slot.counts.load(std::memory_order_relaxed);
        do {
            if (holders(counts) == 0) released(slot.handle.load(std::memory_order_relaxed), kind);
            if (holders(counts) >= mostHolders)
                invalidArgument("this ", kindName(kind), " was retained ", holders(counts), " times");
        } while (!slot.counts.compare_exchange_weak(counts, counts + holder, std::memory_order_relaxed));
    }
    // The look-up of the calling function keeps the slot meanwhile.
    void dropHolder(Slot& slot, Kind kind) {
        uint64_t counts = slot.counts.load(std::memory_order_relaxed);
        do {
            if (holders(counts) == 0) released(slot.handle.load(std::memory_order_relaxed), kind);
        } while (!slot.counts.compare_exchange_weak(counts, counts - holder, std::memory_order_acq_rel,
                                                    std::memory_order_relaxed));
        if (holders(counts) == 1) live_.fetch_sub(1, std::memory_order_relaxed);
    }

    uint64_t live() const { return live_.load(std::memory_order_relaxed); }

  private:
    static constexpr uint32_t chunkSlots = 2048, chunks = (1u << placeBits) / chunkSlots, none = UINT32_MAX;

    // nullptr for a slot that was never made.
    Slot* find(uint32_t place) const {
        Slot* const chunk = chunks_[place / chunkSlots].load(std::memory_order_acquire);
        return chunk ? &chunk[place % chunkSlots] : nullptr;
    }

    void grow() {
        if (grown_ == chunks)
            fail(PEL_ERROR_OUT_OF_MEMORY, "there are ", live(), " handles, and no room for more");
        auto chunk = std::make_unique<Slot[]>(chunkSlots);
        auto next = std::make_unique<uint32_t[]>(chunkSlots);
        const uint32_t first = grown_ * chunkSlots;
        for (uint32_t i = 0; i < chunkSlots; ++i) {
            chunk[i].generation = firstGeneration(first + i);
            next[i] = i + 1 < chunkSlots ? first + i + 1 : none;
        }
        nextFree_[grown_] = std::move(next);
        chunks_[grown_++].store(chunk.release(), std::memory_order_release);
        free_ = first;
    }

    void lower(Slot& slot, uint64_t by) {
        if (slot.counts.fetch_sub(by, std::memory_order_acq_rel) != by) return;
        // The last one releases the object after the lock is free: it may be a device, which waits, or hold
        // other objects.
        Object* const object = slot.object;
        {
            std::lock_guard lock(mutex_);
            const uint32_t place =
                uint32_t(slot.handle.load(std::memory_order_relaxed) >> 1 & mask(placeBits));
            slot.handle.store(0, std::memory_order_relaxed);
            slot.object = nullptr;
            ++slot.generation;
            if (slot.generation < firstGeneration(place) + uses) {
                nextFree_[place / chunkSlots][place % chunkSlots] = free_;
                free_ = place;
            }
        }
        object->release();
    }

    [[noreturn]] static void unknown(uint64_t handle, Kind kind) {
        invalidArgument("this is not a ", kindName(kind), ": ", reinterpret_cast<void*>(uintptr_t(handle)),
                        " was never returned by the library");
    }
    [[noreturn]] static void released(uint64_t handle, Kind kind) {
        invalidArgument("this ", kindName(kind),
                        " was released already: ", reinterpret_cast<void*>(uintptr_t(handle)));
    }
    // The error for a handle that its slot does not hold.
    [[noreturn]] void gone(const Slot& slot, uint64_t handle, Kind kind) {
        const uint64_t place = handle >> 1 & mask(placeBits),
                       generation = handle >> generationShift & mask(generationBits);
        std::unique_lock lock(mutex_);
        const bool wasThere =
            generation >= firstGeneration(place) && generation < slot.generation + (slot.object != nullptr);
        lock.unlock();
        if (wasThere) released(handle, kind);
        unknown(handle, kind);
    }

    std::atomic<Slot*> chunks_[chunks] = {};  // chunks are never freed: a look-up needs no lock
    std::atomic<uint64_t> live_{0};
    std::mutex mutex_;  // of the rest
    std::unique_ptr<uint32_t[]> nextFree_[chunks];
    uint32_t free_ = none, grown_ = 0;
};

// Never destroyed: other static objects may release handles at the end of the process.
HandleTable& table() {
    static HandleTable& t = *new HandleTable;
    return t;
}

class Visit {
  public:
    Visit(const void* handle, Kind kind) : slot_(table().visit(handle, kind)) {}
    Visit(const Visit&) = delete;
    ~Visit() { table().leave(slot_); }
    Slot& slot() const { return slot_; }

  private:
    Slot& slot_;
};

}  // namespace

void* addHandle(Ref<Object> object) {
    return reinterpret_cast<void*>(uintptr_t(table().add(std::move(object))));
}

Ref<Object> lookUpHandle(const void* handle, Kind kind) {
    const Visit visit(handle, kind);
    return Ref<Object>(visit.slot().object);
}

void retainHandle(const void* handle, Kind kind) {
    const Visit visit(handle, kind);
    table().addHolder(visit.slot(), kind);
}

void releaseHandle(const void* handle, Kind kind) {
    const Visit visit(handle, kind);
    table().dropHolder(visit.slot(), kind);
}

uint64_t liveHandles() {
    return table().live();
}

// With PELLUCID_CHECK_LEFT set, a process that leaves handles unreleased reports them and ends with 1.
namespace {

// After all static objects of whoever uses the library. A fork holds what its parent does.
[[gnu::destructor]] void tellWhatIsLeft() {
    const uint64_t handles = liveHandles(), objects = Object::alive();
    if ((handles == 0 && objects == 0) || !std::getenv("PELLUCID_CHECK_LEFT") || cl::isFork()) return;
    std::fprintf(stderr, "\npellucid: %llu handles were never released; %llu objects are left\n",
                 static_cast<unsigned long long>(handles), static_cast<unsigned long long>(objects));
    std::fflush(nullptr);
    std::_Exit(1);
}

std::atomic<uint64_t> objects{0};

}  // namespace

const char* kindName(Kind kind) {
    static constexpr const char* names[] = {"PelDevice",   "PelEvent",         "PelBuffer", "PelMeshTopology",
                                            "PelLiveMesh", "PelLut",           "PelShader", "PelProfile",
                                            "PelScatter",  "PelTextureScatter"};
    return names[size_t(kind)];
}

Object::Object(Kind kind) : kind_(kind) {
    objects.fetch_add(1, std::memory_order_relaxed);
}

Object::~Object() {
    objects.fetch_sub(1, std::memory_order_relaxed);
}

uint64_t Object::alive() {
    return objects.load(std::memory_order_relaxed);
}

}  // namespace pel
