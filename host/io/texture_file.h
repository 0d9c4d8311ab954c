// Containers that graphics engines load as they are: DDS and KTX2, one image of RGBA float16 texels.
#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>

namespace pellucid::io {

// Four halves per texel, row-major, top row first. Complete or not at all; throws FileError.
// DDS: the DX10 header with DXGI_FORMAT_R16G16B16A16_FLOAT [Microsoft, Programming Guide for DDS].
void writeDds(const std::string& path, uint32_t width, uint32_t height, std::span<const uint16_t> texels);
// KTX2: VK_FORMAT_R16G16B16A16_SFLOAT, linear, with key/value data [Khronos, KTX File Format 2.0].
void writeKtx2(const std::string& path, uint32_t width, uint32_t height, std::span<const uint16_t> texels,
               const std::map<std::string, std::string>& keyValues);

}  // namespace pellucid::io
