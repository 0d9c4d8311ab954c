// Every reader of untrusted files as a function of bytes, with seed files; and damage to bytes, the same for
// the same numbers.
#pragma once
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <random>
#include <string>
#include <vector>

namespace fuzz {

struct Random : std::mt19937_64 {
    using mersenne_twister_engine::mersenne_twister_engine;
    uint64_t next() { return (*this)(); }
    size_t below(size_t limit) { return limit ? size_t(next() % limit) : 0; }
};

// One of `files`, changed in one to eight places: bits, bytes and whole numbers that are often special,
// pieces left out, doubled, taken from another file, words of the format, and digits.
std::string mutant(Random& random, const std::vector<std::string>& files,
                   const std::vector<std::string>& words);

// Changes one to eight values of a JSON document, which stays well-formed: numbers become special ones,
// elements and members are repeated, erased or replaced by others of the document, texts by one of `words`.
void mutateJson(Random& random, nlohmann::json& document, const std::vector<std::string>& words);

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
