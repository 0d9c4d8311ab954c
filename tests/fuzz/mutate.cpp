#include "fuzz/readers.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

namespace fuzz {
namespace {

constexpr size_t longest = 1 << 16;

// Small numbers, and the ends of the integer types and of floats.
constexpr uint64_t special[] = {0,           1,          2,          3,          0x7f,       0x80,
                                0xff,        0x100,      0x3fff,     0x7fff,     0x8000,     0xffff,
                                0x10000,     0x7fffffff, 0x80000000, UINT32_MAX, 0x7f800000, 0x7fc00000,
                                0x100000000, INT64_MAX,  1ull << 63, UINT64_MAX};

// A number in place of 1, 2, 4 or 8 bytes, in either order, or a little more or less than what is there.
void number(Random& r, std::string& b) {
    const size_t size = size_t{1} << r.below(4);
    if (b.size() < size) return;
    char* at = b.data() + r.below(b.size() - size + 1);
    uint64_t value = special[r.below(std::size(special))];
    if (r.below(2)) {
        std::memcpy(&value, at, size);
        value += r.below(33) - 16;
    }
    char bytes[8];
    std::memcpy(bytes, &value, 8);
    if (r.below(4) == 0) std::reverse(bytes, bytes + size);
    std::memcpy(at, bytes, size);
}

// Digits of a text in place of others.
void digits(Random& r, std::string& b) {
    size_t at = r.below(b.size());
    while (at < b.size() && !std::isdigit(uint8_t(b[at]))) ++at;
    size_t end = at;
    while (end < b.size() && std::isdigit(uint8_t(b[end]))) ++end;
    if (at == b.size()) return;
    b.replace(at, end - at, std::to_string(r.below(3) ? special[r.below(std::size(special))] : r.below(100)));
}

void once(Random& r, std::string& b, const std::vector<std::string>& files,
          const std::vector<std::string>& words) {
    const size_t at = r.below(b.size() + 1), left = b.size() - at, some = r.below(r.below(8) ? 32 : 2000) + 1;
    switch (b.empty() ? 9 : r.below(12)) {
        case 0:
            if (left) b[at] = char(b[at] ^ (1 << r.below(8)));
            break;
        case 1:
            if (left) b[at] = char(r.next());
            break;
        case 2:
        case 3:
        case 4:
            number(r, b);
            break;
        case 5:
            b.erase(at, some);
            break;
        case 6:
            b.insert(at, b.substr(r.below(b.size()), some));
            break;
        case 7:
            if (r.below(4) == 0) b.resize(at);
            break;
        case 8: {
            const std::string& other = files[r.below(files.size())];
            const std::string piece = other.substr(r.below(other.size()), some);
            b.replace(at, r.below(2) ? std::min(left, piece.size()) : 0, piece);
            break;
        }
        case 9:
        case 10:
            if (!words.empty()) b.insert(at, words[r.below(words.size())]);
            break;
        default:
            digits(r, b);
    }
    if (b.size() > longest) b.resize(longest);
}

using nlohmann::json;

void collect(json& value, std::vector<json*>& all) {
    all.push_back(&value);
    if (value.is_structured())
        for (json& member : value) collect(member, all);
}

void replaceNumber(Random& r, json& value) {
    constexpr double extremes[] = {0, -1, 1e-30, 0.5, 1e9, 1e12, -1e12, 1e30, 3.5e38, 1e300};
    const size_t kind = r.below(3);
    if (kind == 0)
        value = r.below(6);
    else if (kind == 1)
        value = special[r.below(std::size(special))];
    else
        value = extremes[r.below(std::size(extremes))];
}

}  // namespace

void mutateJson(Random& r, json& document, const std::vector<std::string>& words) {
    for (size_t changes = 1 + r.below(8); changes > 0; --changes) {
        std::vector<json*> all;
        collect(document, all);
        json& value = *all[r.below(all.size())];
        const json other = *all[r.below(all.size())];
        if (value.is_number()) {
            replaceNumber(r, value);
        } else if (value.is_string()) {
            value = words[r.below(words.size())];
        } else if (value.is_array() && !value.empty()) {
            const size_t at = r.below(value.size());
            if (r.below(3) == 0)
                value.erase(at);
            else
                value.insert(value.end(), r.below(20) ? 1 : 2000, json(value[at]));
        } else if (value.is_object() && !value.empty()) {
            const auto member = std::next(value.begin(), std::ptrdiff_t(r.below(value.size())));
            if (r.below(3) == 0)
                value.erase(member);
            else if (r.below(3) == 0)
                *member = other;
        }
        if (document.dump().size() > longest) return;
    }
}

std::string mutant(Random& random, const std::vector<std::string>& files,
                   const std::vector<std::string>& words) {
    std::string bytes = files[random.below(files.size())];
    for (size_t changes = 1 + random.below(random.below(3) ? 3 : 8); changes > 0; --changes)
        once(random, bytes, files, words);
    return bytes;
}

}  // namespace fuzz
