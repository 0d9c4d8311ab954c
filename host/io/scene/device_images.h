// Channels of image files in a device's memory, read straight into it: nothing is copied on the way.
#pragma once
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "io/image/image_file.h"
#include "io/scene/scene_file.h"
#include "pellucid/pellucid.hpp"

namespace pellucid::io {

// Channels that are read together: they become one image of as many components. "" is a file's only channel.
using ChannelGroup = std::vector<std::string>;

class DeviceImages {
  public:
    explicit DeviceImages(const Device& device) : device_(device) {}

    // Reads those groups whose channels are in the file; what else is in it is not read. The image that is returned lists all channels and has
    // no pixels. Throws what readImage() throws.
    Image read(const std::string& path, const std::set<ChannelGroup>& groups);
    // nullptr: not read. `image` is what read() returned.
    const OwnedImage* find(const Image& image, const ChannelGroup& channels) const;

  private:
    Device device_;
    std::map<std::pair<std::string, ChannelGroup>, OwnedImage> images_;  // by file
};

// What a scene reads from its G-buffer.
std::set<ChannelGroup> gbufferGroups(const SceneFile& scene);

// Channels of an image interleaved, wherever their pixels are.
class PixelValues {
  public:
    PixelValues(const Image& image, const ChannelGroup& channels, const DeviceImages* images);
    PixelValues(const PixelValues&) = delete;
    PixelValues& operator=(const PixelValues&) = delete;
    ~PixelValues();
    const float* at() const { return at_; }

  private:
    std::vector<float> own_;
    PelBuffer mapped_ = nullptr;
    const float* at_ = nullptr;
};

}  // namespace pellucid::io
