// Channels of image files in a device's memory, read straight into it: nothing is copied on the way.
#pragma once
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "io/image/image_file.h"
#include "io/scene/scene_file.h"
#include "pellucid/pellucid.hpp"

namespace pellucid::io {

// Channels that become one image with that many components. "" is the only channel of a file.
using ChannelGroup = std::vector<std::string>;

// Format of an image by its number of components minus one.
inline constexpr PelFormat groupFormats[] = {PEL_FORMAT_R32F, PEL_FORMAT_RG32F, PEL_FORMAT_RGB32F,
                                             PEL_FORMAT_RGBA32F};

// Maps a buffer while this object lives.
class MappedBuffer {
  public:
    explicit MappedBuffer(Buffer buffer)
        : buffer_(std::move(buffer)), at_(static_cast<float*>(buffer_.map())) {}
    MappedBuffer(MappedBuffer&& other) noexcept = default;
    ~MappedBuffer() {
        if (buffer_) pelBufferUnmap(buffer_.get());
    }
    float* at() const { return at_; }

  private:
    Buffer buffer_;
    float* at_;
};

class DeviceImages {
  public:
    explicit DeviceImages(const Device& device) : device_(device) {}

    // Reads the groups whose channels exist in the file. The returned image lists all channels and has no
    // pixels. Throws as readImage() does.
    Image read(const std::string& path, const std::set<ChannelGroup>& groups);
    // `image` was returned by read(). nullptr: these channels were not read.
    const OwnedImage* find(const Image& image, const ChannelGroup& channels) const;

  private:
    Device device_;
    std::map<std::pair<std::string, ChannelGroup>, OwnedImage> images_;  // by file
};

// The channel groups that a scene reads from its G-buffer.
std::set<ChannelGroup> gbufferGroups(const SceneFile& scene);
// The names in all groups; "" among them where a file's only channel is.
std::set<std::string> namesOf(const std::set<ChannelGroup>& groups);

// Interleaved channels of an image whose pixels are in host or device memory.
class PixelValues {
  public:
    PixelValues(const Image& image, const ChannelGroup& channels, const DeviceImages* images);
    const float* at() const { return mapped_ ? mapped_->at() : own_.data(); }

  private:
    std::vector<float> own_;
    std::optional<MappedBuffer> mapped_;
};

}  // namespace pellucid::io
