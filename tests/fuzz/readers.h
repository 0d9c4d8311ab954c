// Every reader of files that strangers may have made, as a function of bytes, with files to begin from.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "fuzz/mutate.h"

namespace fuzz {

struct Reader {
    std::string name;
    std::vector<std::string> seeds;  // whole files that it reads
    // Reads. Returns, or throws what the interface promises: anything else is a fault.
    std::function<void(const std::string& bytes)> read;
    // Makes check sums right again, so that damage comes past them; none where there are no sums.
    std::function<std::string(std::string bytes)> mend;
    std::vector<std::string> words;  // to put in
    // Makes an input that is damaged inside a structure that stays whole; none: every input is a mutant of
    // bytes.
    std::function<std::string(Random&)> structured = {};
};

// In an order that does not change. Writes seeds into a temporary folder and removes it.
std::vector<Reader> readers();

// Whether `error` is one that a reader may end with: it has a message for the file's owner.
bool promised(const std::exception& error);

}  // namespace fuzz
