// OpenEXR files, by the OpenEXR library itself, since every frame's G-buffer is read from this format.
#pragma once
#include <memory>

#include "io/image/image_file.h"

namespace pellucid::io {

// Gives the image pixels for the channels of these names; nullptr: for all.
std::vector<Place> ownPlaces(Image& image, const std::vector<std::string>* names);

// decodeImage for bytes that checkExrHeader accepted; runs on all processors.
void decodeExr(Image& image, const std::string& bytes, const std::function<void(const Image&)>& check,
               uint64_t limit, const PlaceChannels& places);

// Scan lines of OpenEXR files by OpenEXR's C library, which takes a third of the time of the C++ one for fast
// lossless compression: none, RLE and ZIP.

class ExrLines {
  public:
    // A file that the C++ library has read the headers of. `bytes` must outlive this. Throws FileError.
    ExrLines(const std::string& path, const std::string& bytes);
    ~ExrLines();

    // Where the values of the file's channel `name` go: those of the first row at `first`.
    struct Target {
        std::string name;
        float* first;
        size_t pixelStride, rowStride;  // floats
    };
    // Rows of `width` values from `begin` to before `end`, in the coordinates of the file; both lie between
    // chunks. The part has scan lines without compression, or RLE or ZIP. May be called by several threads.
    void read(int part, int begin, int end, size_t width, const std::vector<Target>& targets) const;

  private:
    struct File;
    std::unique_ptr<File> file_;
};

}  // namespace pellucid::io
