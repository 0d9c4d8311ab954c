// OpenEXR files, by the OpenEXR library itself: the format of G-buffers is on the way of every frame.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "io/image/image_file.h"

namespace pellucid::io {

// Gives the image pixels for the channels of these names; nullptr: for all.
std::vector<Place> ownPlaces(Image& image, const std::vector<std::string>* names);

// decodeImage for bytes that checkExrHeader accepted; runs on all processors.
void decodeExr(Image& image, const std::string& bytes, const std::function<void(const Image&)>& check,
               uint64_t limit, const PlaceChannels& places);

}  // namespace pellucid::io
