// XXH64 with seed 0 [Collet, xxHash fast digest algorithm, specification 0.1.1]: eight bytes at a time, for
// checksums of whole files.
#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace pellucid::io {

inline uint64_t xxHash64(std::string_view bytes) {
    constexpr uint64_t p1 = 11400714785074694791u, p2 = 14029467366897019727u, p3 = 1609587929392839161u,
                       p4 = 9650029242287828579u, p5 = 2870177450012600261u;
    const char* at = bytes.data();
    const char* const end = at + bytes.size();
    const auto left = [&] { return size_t(end - at); };
    const auto take = [&]<class T>(T value) -> uint64_t {
        std::memcpy(&value, at, sizeof value);
        at += sizeof value;
        return value;
    };
    const auto round = [&](uint64_t lane, uint64_t input) { return std::rotl(lane + input * p2, 31) * p1; };
    uint64_t hash = p5;
    if (bytes.size() >= 32) {
        uint64_t lane[4] = {p1 + p2, p2, 0, 0 - p1};
        while (left() >= 32)
            for (uint64_t& l : lane) l = round(l, take(uint64_t{}));
        hash = std::rotl(lane[0], 1) + std::rotl(lane[1], 7) + std::rotl(lane[2], 12) + std::rotl(lane[3], 18);
        for (uint64_t l : lane) hash = (hash ^ round(0, l)) * p1 + p4;
    }
    hash += bytes.size();
    while (left() >= 8) hash = std::rotl(hash ^ round(0, take(uint64_t{})), 27) * p1 + p4;
    if (left() >= 4) hash = std::rotl(hash ^ take(uint32_t{}) * p1, 23) * p2 + p3;
    while (left() > 0) hash = std::rotl(hash ^ take(uint8_t{}) * p5, 11) * p1;
    hash = (hash ^ hash >> 33) * p2;
    hash = (hash ^ hash >> 29) * p3;
    return hash ^ hash >> 32;
}

}  // namespace pellucid::io
