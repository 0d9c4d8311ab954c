// A table as the bytes of an EXR, made in memory without other software: the file of a batch entry. Every
// program that makes the same entry on the same kind of device makes the same bytes.
#pragma once
#include <pellucid/pellucid.h>

#include <string>
#include <string_view>

namespace pellucid::io {

// Uncompressed scan lines of R, G and B with what the table is (io/lut/lut_describe.h), `key` and a check sum of
// the whole file as attributes. `texels`: as pelLutRead gives them in that encoding, float or half [OpenEXR
// File Layout, version 2].
std::string encodeLutExr(const PelLutInfo& info, PelLutEncoding encoding, std::string_view texels,
                         const std::string& key);

// Whether these are the bytes that were encoded for that key: not cut short, not changed, no other request.
bool verifyLutExr(std::string_view file, std::string_view key);

}  // namespace pellucid::io
