#include "io/scene/device_images.h"

namespace pellucid::io {
namespace {

constexpr PelFormat formats[] = {PEL_FORMAT_R32F, PEL_FORMAT_RG32F, PEL_FORMAT_RGB32F, PEL_FORMAT_RGBA32F};

// Unmaps what it mapped.
class Mapped {
  public:
    explicit Mapped(const Buffer& buffer) : buffer_(buffer), at_(static_cast<float*>(buffer.map())) {}
    Mapped(Mapped&& other) noexcept
        : buffer_(std::move(other.buffer_)), at_(std::exchange(other.at_, nullptr)) {}
    ~Mapped() {
        if (at_) pelBufferUnmap(buffer_.get());
    }
    float* at() const { return at_; }

  private:
    Buffer buffer_;
    float* at_;
};

// The full names of those channels; empty if one is not there. "" is the only channel.
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
    std::vector<Mapped> mapped;
    std::map<ChannelGroup, OwnedImage> made;
    Image read = readChannelsTo(path, [&](const Image& image) {
        places.resize(image.channels.size());
        for (const ChannelGroup& group : groups) {
            const ChannelGroup names = fullNames(image, group);
            if (names.empty() || names.size() > std::size(formats) || made.contains(names)) continue;
            Buffer buffer(device_, names.size() * image.pixelCount() * sizeof(float));
            float* const first = mapped.emplace_back(buffer).at();
            made.emplace(names, imageDesc(std::move(buffer), formats[names.size() - 1], uint32_t(image.width),
                                          uint32_t(image.height)));
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

PixelValues::PixelValues(const Image& image, const ChannelGroup& channels, const DeviceImages* images) {
    if (const OwnedImage* known = images ? images->find(image, channels) : nullptr) {
        pelBufferRetain((*known)->buffer);
        mapped_ = (*known)->buffer;
        void* at = nullptr;
        check(pelBufferMap(mapped_, &at));
        at_ = static_cast<const float*>(at);
        return;
    }
    own_ = image.interleaved(channels);
    at_ = own_.data();
}

PixelValues::~PixelValues() {
    if (!mapped_) return;
    pelBufferUnmap(mapped_);
    pelBufferRelease(mapped_);
}

}  // namespace pellucid::io
