// Damage to bytes, the same for the same numbers.
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace fuzz {

// Numbers by a counter [Steele, Lea, Flood 2014, SplitMix]: any of a sequence without those before it.
class Random {
  public:
    explicit Random(uint64_t seed) : state_(seed) {}
    uint64_t next() {
        uint64_t z = state_ += 0x9e3779b97f4a7c15u;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
        z = (z ^ z >> 27) * 0x94d049bb133111ebu;
        return z ^ z >> 31;
    }
    size_t below(size_t limit) { return limit ? size_t(next() % limit) : 0; }

  private:
    uint64_t state_;
};

// One of `files`, changed in one to eight places: bits, bytes and whole numbers that are often special,
// pieces left out, doubled, taken from another file, words of the format, and digits.
std::string mutant(Random& random, const std::vector<std::string>& files,
                   const std::vector<std::string>& words);

// Changes one to eight values of a JSON document, which stays well-formed: numbers become special ones,
// elements and members are repeated, erased or replaced by others of the document, texts by one of `words`.
void mutateJson(Random& random, nlohmann::json& document, const std::vector<std::string>& words);

}  // namespace fuzz
