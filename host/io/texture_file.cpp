#include "io/texture_file.h"

#include <bit>
#include <stdexcept>
#include <vector>

#include "io/atomic_file.h"

namespace pellucid::io {
namespace {

static_assert(std::endian::native == std::endian::little, "both containers are little-endian");

class Bytes {
  public:
    template <class T>
    Bytes& add(T value) {
        const char* from = reinterpret_cast<const char*>(&value);
        data_.insert(data_.end(), from, from + sizeof value);
        return *this;
    }
    Bytes& text(const std::string& text) {
        data_.insert(data_.end(), text.begin(), text.end());
        return *this;
    }
    Bytes& zeros(size_t count) {
        data_.resize(data_.size() + count);
        return *this;
    }
    Bytes& align(size_t to) { return zeros((to - data_.size() % to) % to); }
    Bytes& append(const Bytes& other) {
        data_.insert(data_.end(), other.data_.begin(), other.data_.end());
        return *this;
    }
    Bytes& append(std::span<const uint16_t> halves) {
        const char* from = reinterpret_cast<const char*>(halves.data());
        data_.insert(data_.end(), from, from + halves.size_bytes());
        return *this;
    }
    size_t size() const { return data_.size(); }
    void write(const std::string& path) const {
        AtomicFile file(path);
        file.write(data_.data(), data_.size());
        file.commit();
    }

  private:
    std::vector<char> data_;
};

void checkCount(uint32_t width, uint32_t height, std::span<const uint16_t> texels) {
    if (texels.size() != size_t(width) * height * 4)
        throw std::invalid_argument("four halves per texel are needed");
}

// What the bytes of a texel mean [Khronos Data Format Specification 1.3]: one basic block, four float
// samples.
Bytes formatDescriptor() {
    constexpr uint32_t samples = 4, blockSize = 24 + 16 * samples;
    Bytes d;
    d.add(uint32_t(4 + blockSize)).add(uint32_t(0)).add(uint16_t(2)).add(uint16_t(blockSize));
    d.add(uint8_t(1))
        .add(uint8_t(1))
        .add(uint8_t(1))
        .add(uint8_t(0));                 // RGBSDA, BT.709, linear, straight alpha
    d.zeros(4).add(uint8_t(8)).zeros(7);  // 1x1x1x1 texel block of 8 bytes
    for (uint8_t channel : {0, 1, 2, 15}) {
        const uint16_t bit = uint16_t(16 * (channel == 15 ? 3 : channel));
        d.add(bit).add(uint8_t(15)).add(uint8_t(0xC0 | channel)).zeros(4);  // 16 bits, signed float
        d.add(-1.0f).add(1.0f);
    }
    return d;
}

}  // namespace

void writeDds(const std::string& path, uint32_t width, uint32_t height, std::span<const uint16_t> texels) {
    checkCount(width, height, texels);
    constexpr uint32_t caps = 0x1, heightFlag = 0x2, widthFlag = 0x4, pitch = 0x8, pixelFormat = 0x1000;
    constexpr uint32_t fourCc = 0x4, textureCaps = 0x1000, dxgiRgba16Float = 10, texture2d = 3;
    Bytes b;
    b.text("DDS ").add(uint32_t(124)).add(caps | heightFlag | widthFlag | pitch | pixelFormat);
    b.add(height).add(width).add(width * 8).add(uint32_t(0)).add(uint32_t(1)).zeros(11 * 4);
    b.add(uint32_t(32)).add(fourCc).text("DX10").zeros(5 * 4);
    b.add(textureCaps).zeros(4 * 4);
    b.add(dxgiRgba16Float).add(texture2d).add(uint32_t(0)).add(uint32_t(1)).add(uint32_t(0));
    b.append(texels).write(path);
}

void writeKtx2(const std::string& path, uint32_t width, uint32_t height, std::span<const uint16_t> texels,
               const std::map<std::string, std::string>& keyValues) {
    checkCount(width, height, texels);
    constexpr uint32_t vkRgba16Float = 97, headerSize = 80, levelIndexSize = 24;
    const Bytes descriptor = formatDescriptor();
    Bytes pairs;  // a map is sorted, as the format wants the keys
    for (const auto& [key, value] : keyValues) {
        pairs.add(uint32_t(key.size() + value.size() + 2)).text(key).zeros(1).text(value).zeros(1).align(4);
    }
    const uint32_t descriptorAt = headerSize + levelIndexSize,
                   pairsAt = descriptorAt + uint32_t(descriptor.size());
    const uint64_t texelsAt = (pairsAt + pairs.size() + 7) / 8 * 8;
    Bytes b;
    b.text(std::string("\xABKTX 20\xBB\r\n\x1A\n", 12));
    b.add(vkRgba16Float).add(uint32_t(2)).add(width).add(height).add(uint32_t(0)).add(uint32_t(0));
    b.add(uint32_t(1)).add(uint32_t(1)).add(uint32_t(0));
    b.add(descriptorAt).add(uint32_t(descriptor.size()));
    b.add(pairs.size() ? pairsAt : 0u).add(uint32_t(pairs.size())).add(uint64_t(0)).add(uint64_t(0));
    b.add(texelsAt).add(uint64_t(texels.size_bytes())).add(uint64_t(texels.size_bytes()));
    b.append(descriptor).append(pairs).align(8).append(texels).write(path);
}

}  // namespace pellucid::io
