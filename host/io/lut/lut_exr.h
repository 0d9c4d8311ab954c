// A table as the bytes of an EXR, made in memory without other software: the file of a batch entry. All
// programs that make the same entry on the same kind of device make the same bytes.
#pragma once
#include <pellucid/pellucid.h>

#include <string>
#include <string_view>

namespace pellucid::io {

// Uncompressed scan lines of R, G and B. Attributes hold the description of the table
// (io/lut/lut_describe.h), `key`, and a checksum of the whole file. `texels`: as pelLutRead returns them in
// that encoding, float or half [OpenEXR File Layout, version 2]. `stack`: number of tables of one size, one
// below the other; above 1 the number is stored instead of a description.
std::string encodeLutExr(const PelLutInfo& info, PelLutEncoding encoding, std::string_view texels,
                         const std::string& key, uint32_t stack = 1);

// Whether these are the bytes that were encoded for that key, whole and unchanged.
bool verifyLutExr(std::string_view file, std::string_view key);

}  // namespace pellucid::io
