#include "io/image/texture_file.h"

#include <bit>

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
    Bytes& append(std::span<const uint8_t> bytes) {
        data_.insert(data_.end(), bytes.begin(), bytes.end());
        return *this;
    }
    size_t size() const { return data_.size(); }
    void write(const std::string& path) const { writeWholeFile(path, {data_.data(), data_.size()}); }

  private:
    std::vector<char> data_;
};

// The differences between the two formats.
struct FormatFacts {
    uint32_t blockSide, blockBytes;  // texels; bytes of a block (or texel)
    uint32_t dxgi, vulkan, typeSize;
    uint8_t colorModel;  // of the data format descriptor
};
FormatFacts factsOf(Texture::Format format) {
    if (format == Texture::Format::Bc6hUnsigned) return {4, 16, 95, 143, 1, 133};
    return {1, 8, 10, 97, 2, 1};
}

// The data format descriptor [Khronos Data Format Specification 1.3]: one basic block with four float
// samples, or with one sample for a compressed block.
Bytes formatDescriptor(Texture::Format format) {
    const FormatFacts f = factsOf(format);
    const bool compressed = f.blockSide > 1;
    const uint32_t samples = compressed ? 1 : 4, blockSize = 24 + 16 * samples;
    constexpr uint8_t bt709 = 1, linear = 1, straightAlpha = 0, isFloat = 0x80, isSigned = 0x40;
    Bytes d;
    d.add(uint32_t(4 + blockSize)).add(uint32_t(0)).add(uint16_t(2)).add(uint16_t(blockSize));
    d.add(f.colorModel).add(bt709).add(linear).add(straightAlpha);
    d.add(uint8_t(f.blockSide - 1)).add(uint8_t(f.blockSide - 1)).zeros(2);  // texel block, less one
    d.add(uint8_t(f.blockBytes)).zeros(7);
    if (compressed) return d.add(uint16_t(0)).add(uint8_t(127)).add(isFloat).zeros(4).add(0.0f).add(1.0f);
    for (uint8_t channel : {0, 1, 2, 15}) {
        const uint16_t bit = uint16_t(16 * (channel == 15 ? 3 : channel));
        d.add(bit).add(uint8_t(15)).add(uint8_t(isFloat | isSigned | channel)).zeros(4);
        d.add(-1.0f).add(1.0f);
    }
    return d;
}

}  // namespace

void writeDds(const std::string& path, const Texture& t) {
    constexpr uint32_t caps = 0x1, heightFlag = 0x2, widthFlag = 0x4, pitch = 0x8, pixelFormat = 0x1000,
                       linearSize = 0x80000;
    constexpr uint32_t fourCc = 0x4, textureCaps = 0x1000, texture2d = 3;
    const FormatFacts f = factsOf(t.format);
    const bool compressed = f.blockSide > 1;
    Bytes b;
    b.text("DDS ").add(uint32_t(124));
    b.add(caps | heightFlag | widthFlag | pixelFormat | (compressed ? linearSize : pitch));
    b.add(t.height).add(t.width).add(compressed ? uint32_t(t.bytes.size()) : t.width * f.blockBytes);
    b.add(uint32_t(0)).add(uint32_t(1)).zeros(11 * 4);
    b.add(uint32_t(32)).add(fourCc).text("DX10").zeros(5 * 4);
    b.add(textureCaps).zeros(4 * 4);
    b.add(f.dxgi).add(texture2d).add(uint32_t(0)).add(uint32_t(1)).add(uint32_t(0));
    b.append(t.bytes).write(path);
}

void writeKtx2(const std::string& path, const Texture& t,
               const std::map<std::string, std::string>& keyValues) {
    constexpr uint32_t headerSize = 80, levelIndexSize = 24;
    const FormatFacts f = factsOf(t.format);
    const Bytes descriptor = formatDescriptor(t.format);
    Bytes pairs;  // a map is sorted, as the format requires for keys
    for (const auto& [key, value] : keyValues)
        pairs.add(uint32_t(key.size() + value.size() + 2)).text(key).zeros(1).text(value).zeros(1).align(4);
    const uint32_t descriptorAt = headerSize + levelIndexSize,
                   pairsAt = descriptorAt + uint32_t(descriptor.size());
    const uint64_t texelsAt = (pairsAt + pairs.size() + f.blockBytes - 1) / f.blockBytes * f.blockBytes;
    Bytes b;
    b.text(std::string("\xABKTX 20\xBB\r\n\x1A\n", 12));
    b.add(f.vulkan).add(f.typeSize).add(t.width).add(t.height).add(uint32_t(0)).add(uint32_t(0));
    b.add(uint32_t(1)).add(uint32_t(1)).add(uint32_t(0));
    b.add(descriptorAt).add(uint32_t(descriptor.size()));
    b.add(pairs.size() ? pairsAt : 0u).add(uint32_t(pairs.size())).add(uint64_t(0)).add(uint64_t(0));
    b.add(texelsAt).add(uint64_t(t.bytes.size())).add(uint64_t(t.bytes.size()));
    b.append(descriptor).append(pairs).align(f.blockBytes).append(t.bytes).write(path);
}

}  // namespace pellucid::io
