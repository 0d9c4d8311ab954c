#include "scene/scene_frame.h"

namespace pellucid::io {
namespace {

// The full names of these channels; empty if one is missing. "" is the only channel.
ChannelGroup fullNames(const Image& image, const ChannelGroup& group) {
    ChannelGroup names;
    for (const std::string& name : group)
        if (name.empty() && image.channels.size() == 1)
            names.push_back(image.channels[0].name);
        else if (!name.empty() && image.has(name))
            names.push_back(image.channel(name).name);
        else
            return {};
    return names;
}

}  // namespace

Image DeviceImages::read(const std::string& path, const std::set<ChannelGroup>& groups) {
    struct Copy {
        size_t channel;
        Place to;
    };
    std::vector<Place> places;
    std::vector<Copy> copies;  // of channels that are in several groups
    std::vector<MappedBuffer> mapped;
    std::map<ChannelGroup, OwnedImage> made;
    Image read = readChannelsTo(path, [&](const Image& image) {
        places.resize(image.channels.size());
        for (const ChannelGroup& group : groups) {
            const ChannelGroup names = fullNames(image, group);
            if (names.empty() || names.size() > std::size(groupFormats) || made.contains(names)) continue;
            Buffer buffer(device_, names.size() * image.pixelCount() * sizeof(float));
            float* const first = mapped.emplace_back(buffer).at();
            made.emplace(names, imageDesc(std::move(buffer), groupFormats[names.size() - 1],
                                          uint32_t(image.width), uint32_t(image.height)));
            for (size_t k = 0; k < names.size(); ++k) {
                const auto channel = size_t(&image.channel(names[k]) - image.channels.data());
                const Place to{first + k, names.size()};
                if (places[channel].first)
                    copies.push_back({channel, to});
                else
                    places[channel] = to;
            }
        }
        return places;
    });
    for (const Copy& copy : copies) {
        const Place& from = places[copy.channel];
        for (size_t i = 0; i < read.pixelCount(); ++i)
            copy.to.first[i * copy.to.stride] = from.first[i * from.stride];
    }
    for (auto& [names, image] : made) images_.insert_or_assign({path, names}, std::move(image));
    return read;
}

const OwnedImage* DeviceImages::find(const Image& image, const ChannelGroup& channels) const {
    const auto found = images_.find({image.source, fullNames(image, channels)});
    return found == images_.end() ? nullptr : &found->second;
}

std::set<ChannelGroup> gbufferGroups(const SceneFile& scene) {
    std::set<ChannelGroup> groups;
    for (const ChannelGroup& slot : scene.channels)
        if (!slot.empty()) groups.insert(slot);
    for (const SceneLight& light : scene.lights)
        if (!light.wideShadow.empty()) groups.insert({light.wideShadow});
    return groups;
}

std::set<std::string> namesOf(const std::set<ChannelGroup>& groups) {
    std::set<std::string> names;
    for (const ChannelGroup& group : groups) names.insert(group.begin(), group.end());
    return names;
}

PixelValues::PixelValues(const Image& image, const ChannelGroup& channels, const DeviceImages* images) {
    if (const OwnedImage* known = images ? images->find(image, channels) : nullptr) {
        pelBufferRetain((*known)->buffer);
        mapped_.emplace(Buffer((*known)->buffer));
    } else
        own_ = image.interleaved(channels);
}

}  // namespace pellucid::io
