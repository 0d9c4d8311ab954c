#include "core/handle_table.h"

#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <unordered_map>

#include "cl/machine.h"

namespace pel {
namespace {

// The bits of a handle, from the lowest: one, its scattered number, a mark. An odd number is not the address
// of an object, and with the mark it is no address at all on 64-bit processors. So no pointer is mistaken for
// a handle, and none is dereferenced.
constexpr bool wide = sizeof(void*) == 8;
constexpr int markBits = wide ? 7 : 2, numberBits = 8 * int(sizeof(void*)) - 1 - markBits;
constexpr uint64_t mark = wide ? 0x2d : 0x2, numbers = (uint64_t(1) << numberBits) - 1;

// Numbers are multiplied by an odd factor, so that a handle plus a small number is not a handle. The inverse
// modulo 2^64 by Newton's iteration.
constexpr uint64_t factor = 0x9e3779b97f4a7c15;
constexpr uint64_t inverseOf(uint64_t odd) {
    uint64_t inverse = odd;
    for (int i = 0; i < 5; ++i) inverse *= 2 - odd * inverse;
    return inverse;
}
static_assert(factor * inverseOf(factor) == 1);

thread_local std::string called;  // nameInCall()

struct Entry {
    Ref<Object> object;
    uint64_t holders = 1;  // the callers' count
    std::string name{};
};
using Entries = std::unordered_map<uint64_t, Entry>;

struct HandleTable {
    std::mutex mutex;  // of the rest
    Entries entries;
    uint64_t next = 0;  // number of the next handle; none is given out twice
};
// Never destroyed: other static objects may release handles at the end of the process.
HandleTable& handles() {
    static HandleTable& t = *new HandleTable;
    return t;
}

// The table's mutex is locked.
Entries::iterator find(const void* pointer, Kind kind) {
    if (!pointer) invalidArgument("a ", kindName(kind), " is needed here, not NULL");
    const uint64_t handle = reinterpret_cast<uintptr_t>(pointer);
    const auto entry = handles().entries.find(handle);
    if (entry == handles().entries.end()) {
        const bool wasThere = (handle & 1) && handle >> (numberBits + 1) == mark &&
                              ((handle >> 1 & numbers) * inverseOf(factor) & numbers) < handles().next;
        if (wasThere) invalidArgument("this ", kindName(kind), " was released already: ", pointer);
        invalidArgument("this is not a ", kindName(kind), ": ", pointer,
                        " was never returned by the library");
    }
    const Kind found = entry->second.object->objectKind();
    if (found != kind) invalidArgument("a ", kindName(kind), " is needed here, not a ", kindName(found));
    return entry;
}

}  // namespace

void* addHandle(Ref<Object> object) {
    std::lock_guard lock(handles().mutex);
    if (handles().next > numbers) fail(PEL_ERROR_OUT_OF_MEMORY, "there are no handles left");
    const uint64_t handle = mark << (numberBits + 1) | (handles().next * factor & numbers) << 1 | 1;
    handles().entries.emplace(handle, Entry{std::move(object)});
    ++handles().next;
    return reinterpret_cast<void*>(uintptr_t(handle));
}

Ref<Object> lookUpHandle(const void* handle, Kind kind) {
    std::lock_guard lock(handles().mutex);
    const Entry& entry = find(handle, kind)->second;
    if (called.empty()) called = entry.name;
    return entry.object;
}

void nameHandle(const void* handle, const char* name) {
    std::lock_guard lock(handles().mutex);
    const auto entry = handles().entries.find(reinterpret_cast<uintptr_t>(handle));
    if (entry == handles().entries.end())
        invalidArgument("this is not a handle of the library, so it cannot be named: ", handle);
    entry->second.name = name ? name : "";
}

const char* nameInCall() {
    return called.c_str();
}

void beginCall() {
    called.clear();
}

void retainHandle(const void* handle, Kind kind) {
    std::lock_guard lock(handles().mutex);
    ++find(handle, kind)->second.holders;
}

void releaseHandle(const void* handle, Kind kind) {
    Ref<Object> last;  // released after unlocking: a device waits, other objects release objects
    std::lock_guard lock(handles().mutex);
    const auto entry = find(handle, kind);
    if (--entry->second.holders > 0) return;
    last = std::move(entry->second.object);
    handles().entries.erase(entry);
}

uint64_t liveHandles() {
    std::lock_guard lock(handles().mutex);
    return handles().entries.size();
}

// With PELLUCID_CHECK_LEFT set, a process that leaves handles unreleased reports them and ends with 1.
// Runs after the static objects of the program. A forked child inherits the parent's objects.
[[gnu::destructor]] static void tellWhatIsLeft() {
    const uint64_t handles = liveHandles(), objects = Object::alive();
    if ((handles == 0 && objects == 0) || !std::getenv("PELLUCID_CHECK_LEFT") || cl::isFork()) return;
    std::fprintf(stderr, "\npellucid: %llu handles were never released; %llu objects are left\n",
                 static_cast<unsigned long long>(handles), static_cast<unsigned long long>(objects));
    std::fflush(nullptr);
    std::_Exit(1);
}

const char* kindName(Kind kind) {
    static constexpr const char* names[] = {"PelDevice",   "PelEvent",         "PelBuffer", "PelMeshTopology",
                                            "PelLiveMesh", "PelLut",           "PelShader", "PelProfile",
                                            "PelScatter",  "PelTextureScatter"};
    return names[size_t(kind)];
}

}  // namespace pel
