// Containers that graphics engines load: DDS and KTX2, one image of RGBA float16 texels or BC6H blocks.
#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>

namespace pellucid::io {

// One image, row-major, top row first.
struct Texture {
    enum class Format {
        Rgba16Float,  // four halves per texel
        Bc6hUnsigned  // 16 bytes per 4x4 texels (io/lut/bc6h.h); sizes need be no multiple of 4
                      // from KTX2 (Vulkan), and not from DDS (Direct3D)
    };
    Format format;
    uint32_t width, height;          // texels
    std::span<const uint8_t> bytes;  // as many as the format takes for the size
};

// Both: complete or not at all; throw FileError when the file cannot be written. DDS: the DX10 header,
// DXGI_FORMAT_R16G16B16A16_FLOAT or _BC6H_UF16 [Microsoft, Programming Guide for DDS].
void writeDds(const std::string& path, const Texture& texture);
// KTX2: VK_FORMAT_R16G16B16A16_SFLOAT or _BC6H_UFLOAT_BLOCK, linear [Khronos, KTX File Format 2.0].
void writeKtx2(const std::string& path, const Texture& texture,
               const std::map<std::string, std::string>& keyValues);

}  // namespace pellucid::io
