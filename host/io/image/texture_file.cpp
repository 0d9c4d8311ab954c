#include "io/image/texture_file.h"

#include <bit>

#include "io/atomic_file.h"

namespace pellucid::io {
namespace {

static_assert(std::endian::native == std::endian::little, "both containers are little-endian");

constexpr uint32_t texelBytes = 8;

class Bytes {
  public:
    template <class T>
    Bytes& add(T value) {
        data_.append(reinterpret_cast<const char*>(&value), sizeof value);
        return *this;
    }
    Bytes& text(const std::string& text) {
        data_ += text;
        return *this;
    }
    Bytes& zeros(size_t count) {
        data_.append(count, '\0');
        return *this;
    }
    Bytes& align(size_t to) { return zeros((to - data_.size() % to) % to); }
    Bytes& append(const Bytes& other) { return text(other.data_); }
    size_t size() const { return data_.size(); }
    void write(const std::string& path, const Texture& t) {
        data_.append(reinterpret_cast<const char*>(t.halves.data()), t.halves.size_bytes());
        writeWholeFile(path, data_);
    }

  private:
    std::string data_;
};

// The data format descriptor [Khronos Data Format Specification 1.3]: one basic block with four samples.
Bytes formatDescriptor() {
    constexpr uint32_t blockSize = 24 + 16 * 4;
    constexpr uint8_t rgbsda = 1, bt709 = 1, linear = 1, straightAlpha = 0, isFloat = 0x80, isSigned = 0x40;
    Bytes d;
    d.add(uint32_t(4 + blockSize)).add(uint32_t(0)).add(uint16_t(2)).add(uint16_t(blockSize));
    d.add(rgbsda).add(bt709).add(linear).add(straightAlpha);
    d.zeros(4).add(uint8_t(texelBytes)).zeros(7);  // blocks of one texel
    for (uint8_t channel : {0, 1, 2, 15}) {
        const uint16_t bit = uint16_t(16 * (channel == 15 ? 3 : channel));
        d.add(bit).add(uint8_t(15)).add(uint8_t(isFloat | isSigned | channel)).zeros(4);
        d.add(-1.0f).add(1.0f);
    }
    return d;
}

}  // namespace

void writeDds(const std::string& path, const Texture& t) {
    constexpr uint32_t caps = 0x1, height = 0x2, width = 0x4, pitch = 0x8, pixelFormat = 0x1000;
    constexpr uint32_t fourCc = 0x4, textureCaps = 0x1000, texture2d = 3, rgba16Float = 10;
    Bytes b;
    b.text("DDS ").add(uint32_t(124)).add(caps | height | width | pitch | pixelFormat);
    b.add(t.height).add(t.width).add(t.width * texelBytes);
    b.add(uint32_t(0)).add(uint32_t(1)).zeros(11 * 4);
    b.add(uint32_t(32)).add(fourCc).text("DX10").zeros(5 * 4);
    b.add(textureCaps).zeros(4 * 4);
    b.add(rgba16Float).add(texture2d).add(uint32_t(0)).add(uint32_t(1)).add(uint32_t(0));
    b.write(path, t);
}

void writeKtx2(const std::string& path, const Texture& t,
               const std::map<std::string, std::string>& keyValues) {
    constexpr uint32_t headerSize = 80, levelIndexSize = 24, rgba16Float = 97, typeSize = 2;
    const Bytes descriptor = formatDescriptor();
    Bytes pairs;  // a map is sorted, as the format requires for keys
    for (const auto& [key, value] : keyValues)
        pairs.add(uint32_t(key.size() + value.size() + 2)).text(key).zeros(1).text(value).zeros(1).align(4);
    const uint32_t descriptorAt = headerSize + levelIndexSize,
                   pairsAt = descriptorAt + uint32_t(descriptor.size());
    const uint64_t texelsAt = (pairsAt + pairs.size() + texelBytes - 1) / texelBytes * texelBytes,
                   size = t.halves.size_bytes();
    Bytes b;
    b.text(std::string("\xABKTX 20\xBB\r\n\x1A\n", 12));
    b.add(rgba16Float).add(typeSize).add(t.width).add(t.height).add(uint32_t(0)).add(uint32_t(0));
    b.add(uint32_t(1)).add(uint32_t(1)).add(uint32_t(0));
    b.add(descriptorAt).add(uint32_t(descriptor.size()));
    b.add(pairs.size() ? pairsAt : 0u).add(uint32_t(pairs.size())).add(uint64_t(0)).add(uint64_t(0));
    b.add(texelsAt).add(size).add(size);
    b.append(descriptor).append(pairs).align(texelBytes).write(path, t);
}

}  // namespace pellucid::io
