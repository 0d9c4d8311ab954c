// Containers that graphics engines load: DDS and KTX2, with one image of RGBA float16 texels.
#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>

namespace pellucid::io {

// One image, row-major, top row first.
struct Texture {
    uint32_t width, height;
    std::span<const uint16_t> halves;  // R, G, B, A
};

// Both: complete or not at all; throw FileError when the file cannot be written. DDS: the DX10 header,
// DXGI_FORMAT_R16G16B16A16_FLOAT [Microsoft, Programming Guide for DDS].
void writeDds(const std::string& path, const Texture& texture);
// KTX2: VK_FORMAT_R16G16B16A16_SFLOAT, linear [Khronos, KTX File Format 2.0].
void writeKtx2(const std::string& path, const Texture& texture,
               const std::map<std::string, std::string>& keyValues);

}  // namespace pellucid::io
