// Look-up tables as files. EXR files carry a description of the table, so that they can be read back and
// checked; other files are pixels only.
#pragma once
#include <optional>
#include <pellucid/pellucid.hpp>

namespace pellucid::io {

// Writes texels with the top row first. The extension chooses the container: .exr (float or half; with the
// description in attributes named "pellucid:..."), .npy (any encoding; height x width x 3 or 4), .png, .bmp
// and .tga (faceworks8), .dds and .ktx2 (half, alpha 1). Without an encoding: float for .exr and .npy, half
// for .dds and .ktx2, faceworks8 for the others. Complete or not at all. Throws FileError when it cannot be
// written, std::invalid_argument when container and encoding do not go together.
void writeLut(const std::string& path, const Lut& lut, std::optional<PelLutEncoding> encoding = {});

// The encoding that writeLut would choose. Throws as writeLut does. Call it before long work.
PelLutEncoding checkLutPath(const std::string& path, std::optional<PelLutEncoding> encoding);

// A table that was read but is not on a device yet.
struct LutTexels {
    PelLutInfo info = pelLutInfoDefaults();
    std::vector<float> texels;  // R, G, B
};
// From the bytes of a file; `path` is for messages. Throws FileError: no or incomplete description, damaged,
// more than a quarter of inputLimit() as floats.
LutTexels decodeLut(const std::string& path, std::string bytes);

// Reads an .exr of writeLut. Throws FileError: no such file, incomplete description, wrong size.
Lut readLut(const Device& device, const std::string& path);

// Checks a table that was read from `path` against the request: its kind, and the keys of a scene file that
// are in `keys` ("form", "radius_min", ...). Throws FileError with both values.
void checkLutInfo(const std::string& path, const PelLutInfo& found, const PelLutInfo& wanted,
                  const std::vector<std::string>& keys);

}  // namespace pellucid::io
