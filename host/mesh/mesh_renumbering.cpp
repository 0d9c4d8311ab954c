#include "mesh/mesh_renumbering.h"

#include <algorithm>

namespace pel {

Renumbering::Renumbering(const CornerTable& table)
    : numbers(table.begins.size() - 1, none),
      table_(table),
      slots_(uint32_t(table.begins.size() - 1)),
      queue_(table.begins.size()) {  // one more than slots, for one that turns out to have a number
    moved.corners.resize(table.corners.size());
    moved.begins.resize(table.begins.size());
}

void Renumbering::move(uint32_t next) {
    // Lists lie anywhere in memory: those of the next slots are asked for before their turn.
    if (next + 24 < known_) __builtin_prefetch(table_.begins.data() + queue_[next + 24]);
    if (next + 12 < known_) {
        const Corner* list = table_.corners.data() + table_.begins[queue_[next + 12]];
        __builtin_prefetch(list);
        __builtin_prefetch(list + 6);
    }
    if (next + 6 < known_) {  // this list has come meanwhile
        const uint32_t slot = queue_[next + 6];
        for (uint32_t i = table_.begins[slot]; i < table_.begins[slot + 1]; ++i)
            __builtin_prefetch(numbers.data() + table_.corners[i].from);
    }
    const uint32_t begin = table_.begins[queue_[next]], end = table_.begins[queue_[next] + 1];
    moved.begins[next] = written_;
    Corner* const to = moved.corners.data() + written_;
    for (uint32_t i = begin; i < end; ++i) to[i - begin].from = number(table_.corners[i].from);
    for (uint32_t i = begin; i < end; ++i) to[i - begin].to = number(table_.corners[i].to);
    written_ += end - begin;
}

void Renumbering::run() noexcept {
    uint32_t next = 0, told = 0;
    for (uint32_t first = 0; first < slots_; ++first) {
        if (numbers[first] != none) continue;
        number(first);
        for (; next < known_; ++next) {
            move(next);
            // RingBuilder reads a few corners past a slot's own. So a block is ready only when enough
            // corners follow it.
            if (next - told < block || next % block != 0) continue;
            const uint32_t whole = next - block;
            if (written_ - moved.begins[whole] < RingBuilder::readAhead) continue;
            ready.tell(told = whole);
        }
    }
    moved.begins[slots_] = written_;
    std::ranges::fill(moved.corners.begin() + written_, moved.corners.end(), Corner{0, 0});
    ready.tell(slots_);
}

}  // namespace pel
