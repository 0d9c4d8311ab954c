#include "io/image/mip_chain.h"

#include <algorithm>

namespace pellucid::io {

MipChain mipChain(int width, int height, std::vector<float> rgb) {
    MipChain chain{{{width, height, 0}}, std::move(rgb)};
    while (width > 1 || height > 1) {
        const int w = std::max(width / 2, 1), h = std::max(height / 2, 1);
        const size_t from = chain.levels.back().byteOffset / sizeof(float);
        chain.levels.push_back({w, h, chain.texels.size() * sizeof(float)});
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x) {
                // The last texel of an odd side takes its third neighbour too.
                const int x0 = width > 1 ? 2 * x : 0, x1 = x + 1 == w ? width : x0 + 2;
                const int y0 = height > 1 ? 2 * y : 0, y1 = y + 1 == h ? height : y0 + 2;
                double sum[3] = {};
                for (int j = y0; j < y1; ++j)
                    for (int i = x0; i < x1; ++i)
                        for (int c = 0; c < 3; ++c)
                            sum[c] +=
                                chain.texels[from + 3 * (size_t(j) * size_t(width) + size_t(i)) + size_t(c)];
                for (double s : sum) chain.texels.push_back(float(s / double((x1 - x0) * (y1 - y0))));
            }
        width = w;
        height = h;
    }
    return chain;
}

}  // namespace pellucid::io
