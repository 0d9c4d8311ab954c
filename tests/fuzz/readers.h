// Every reader of untrusted files as a function of bytes, with seed files.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "fuzz/mutate.h"

namespace fuzz {

struct Reader {
    std::string name;
    std::vector<std::string> seeds;  // whole files that it reads
    // Returns, or throws a documented error; anything else is a fault.
    std::function<void(const std::string& bytes)> read;
    // Corrects check sums after damage, so that the damage reaches the parser; empty if there are none.
    std::function<std::string(std::string bytes)> mend;
    std::vector<std::string> words;  // to put in
    // Makes an input that is damaged inside a structure that stays whole; none: every input is a mutant of
    // bytes.
    std::function<std::string(Random&)> structured = {};
};

// In an order that does not change. Writes seeds into a temporary folder and removes it.
std::vector<Reader> readers();

// Whether `error` is a documented error of the readers.
bool promised(const std::exception& error);

}  // namespace fuzz
