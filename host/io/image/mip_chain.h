// Levels of a normal map for pelShaderSetNormalMap.
#pragma once
#include <cstddef>
#include <vector>

namespace pellucid::io {

struct MipLevel {
    int width = 0, height = 0;
    size_t byteOffset = 0;  // of its first texel in `texels`
};

// RGB float32 texels of all levels, one after another, the finest first. Each texel of a level is the mean of
// the texels that it covers: two, or three where a side is odd, in each direction. Means of different normals
// are shorter than 1, as they should be.
struct MipChain {
    std::vector<MipLevel> levels;
    std::vector<float> texels;
};
MipChain mipChain(int width, int height, std::vector<float> rgb);

}  // namespace pellucid::io
