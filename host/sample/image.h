// Float images in planes: value(c, x, y) at data[(c * height + y) * width + x], row 0 on top.
#pragma once
#include <cstddef>
#include <vector>

namespace pellucid::sample {

struct Image {
    int width = 0, height = 0, channels = 0;
    std::vector<float> data;

    Image() = default;
    Image(int w, int h, int c, float value = 0)
        : width(w), height(h), channels(c), data(size_t(w) * size_t(h) * size_t(c), value) {}

    size_t planeSize() const { return size_t(width) * size_t(height); }
    float* plane(int c) { return data.data() + planeSize() * size_t(c); }
    const float* plane(int c) const { return data.data() + planeSize() * size_t(c); }
    float& at(int c, int x, int y) { return plane(c)[size_t(y) * size_t(width) + size_t(x)]; }
    float at(int c, int x, int y) const { return plane(c)[size_t(y) * size_t(width) + size_t(x)]; }
};

}  // namespace pellucid::sample
