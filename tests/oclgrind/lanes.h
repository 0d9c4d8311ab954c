// What defined.cpp follows, and how it reports.
#pragma once
#include <fcntl.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "llvm/IR/DerivedTypes.h"
#include "llvm/IR/Value.h"

namespace oclgrind {
class Memory;  // its header has no include guard, and Plugin.h needs it first
}

namespace {

using oclgrind::Memory;
using Lanes = uint64_t;  // bit i: nothing has set lane i of a value; structures and numbers are one lane

unsigned countLanes(const llvm::Type* type) {
    const auto* vector = llvm::dyn_cast<llvm::FixedVectorType>(type);
    return vector ? vector->getNumElements() : 1;
}
Lanes everyLane(unsigned count) {
    return count >= 64 ? ~Lanes(0) : (Lanes(1) << count) - 1;
}
Lanes everyLane(const llvm::Value* value) {
    return everyLane(countLanes(value->getType()));
}
bool bit(Lanes lanes, unsigned i) {
    return lanes >> i & 1;
}

void append(const char* file, const std::string& text) {
    const char* folder = getenv("PELLUCID_OCLGRIND_DIR");
    if (!folder) return;
    const int to = open((std::string(folder) + "/" + file).c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
    if (to < 0) abort();
    if (write(to, text.data(), text.size()) != ssize_t(text.size())) abort();
    close(to);
}

// What is released after main crashes in Oclgrind, whose thread-local stack of calls is gone by then.
// Handlers run in the reverse order of their registration: the last of these, which comes after all that
// the test has made so far, before any release.
void endWithoutReleasing() {
    on_exit(
        +[](int status, void*) { fflush(nullptr), _exit(status); }, nullptr);
}

struct Access {
    const Memory* memory;
    size_t address, size;
};

// What one thread's current instruction has read and written so far.
thread_local std::vector<Access> loads, stores;
thread_local Access hostLoad;

}  // namespace
