#include "io/image/picture.h"

#include <algorithm>
#include <cmath>

#include "io/image/picture_library.h"

namespace pellucid::io {

constexpr Srgb8 paper = {28, 28, 30}, ink = {225, 225, 225};

static constexpr int fontSize(int scale) {
    return 8 * scale;
}

Picture::Picture(int w, int h, Srgb8 background) : width(w), height(h) {
    rgb.reserve(size_t(w) * size_t(h) * 3);
    for (size_t i = 0; i < size_t(w) * size_t(h); ++i)
        rgb.insert(rgb.end(), background.begin(), background.end());
}

Picture::Picture(int w, int h, std::vector<uint8_t> pixels) : width(w), height(h), rgb(std::move(pixels)) {
    if (rgb.size() != size_t(w) * size_t(h) * 3)
        throw std::invalid_argument("Picture: the number of bytes does not fit the size");
}

void Picture::paint(int x, int y, Srgb8 color) {
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    std::copy(color.begin(), color.end(), &rgb[3 * (size_t(y) * size_t(width) + size_t(x))]);
}

void Picture::paste(int x, int y, const Picture& other) {
    for (int row = 0; row < other.height; ++row)
        for (int column = 0; column < other.width; ++column) {
            const uint8_t* from = &other.rgb[3 * (size_t(row) * size_t(other.width) + size_t(column))];
            paint(x + column, y + row, {from[0], from[1], from[2]});
        }
}

int Picture::write(int x, int y, std::string_view text, Srgb8 color, int scale) {
    const float ink_[3] = {color[0] / 255.0f, color[1] / 255.0f, color[2] / 255.0f};
    pictureLibrary("a label").drawText(rgb.data(), width, height, x, y + 7 * scale, std::string(text),
                                       fontSize(scale), ink_);  // y: the baseline
    return x + textWidth(text, scale);
}

int textWidth(std::string_view text, int scale) {
    return pictureLibrary("a label").textWidth(std::string(text), fontSize(scale));
}

Picture shrunk(const Picture& picture, int factor) {
    if (factor <= 1) return picture;
    Picture small(std::max(1, picture.width / factor), std::max(1, picture.height / factor));
    for (int y = 0; y < small.height; ++y)
        for (int x = 0; x < small.width; ++x) {
            float sum[3] = {0, 0, 0};
            int count = 0;
            for (int dy = 0; dy < factor && y * factor + dy < picture.height; ++dy)
                for (int dx = 0; dx < factor && x * factor + dx < picture.width; ++dx, ++count) {
                    const size_t at =
                        size_t(y * factor + dy) * size_t(picture.width) + size_t(x * factor + dx);
                    for (size_t c = 0; c < 3; ++c)
                        sum[c] += decodeSrgb(float(picture.rgb[3 * at + c]) / 255.0f);
                }
            Srgb8 mean;
            for (size_t c = 0; c < 3; ++c)
                mean[c] = uint8_t(std::lround(255.0f * encodeSrgb(sum[c] / float(count))));
            small.paint(x, y, mean);
        }
    return small;
}

Picture contactSheet(std::span<const Tile> tiles, int columns, int textScale) {
    const int gap = 6 * textScale, labelHeight = textHeight(textScale) + gap;
    columns = std::max(1, std::min<int>(columns, int(tiles.size())));
    const int rows = (int(tiles.size()) + columns - 1) / columns;
    std::vector<int> widths(size_t(columns), 0), heights(size_t(rows), 0);
    for (size_t i = 0; i < tiles.size(); ++i) {
        const size_t column = i % widths.size(), row = i / widths.size();
        widths[column] =
            std::max({widths[column], tiles[i].picture.width, textWidth(tiles[i].label, textScale)});
        heights[row] = std::max(heights[row], tiles[i].picture.height + labelHeight);
    }
    int width = gap, height = gap;
    for (int w : widths) width += w + gap;
    for (int h : heights) height += h + gap;
    Picture sheet(width, height, paper);
    int y = gap;
    for (size_t row = 0; row < heights.size(); ++row) {
        int x = gap;
        for (size_t column = 0; column < widths.size() && row * widths.size() + column < tiles.size();
             ++column) {
            const Tile& tile = tiles[row * widths.size() + column];
            sheet.paste(x, y, tile.picture);
            sheet.write(x, y + tile.picture.height + gap / 2, tile.label, ink, textScale);
            x += widths[column] + gap;
        }
        y += heights[row] + gap;
    }
    return sheet;
}

Picture colorBar(int width, double low, double high, std::string_view unit, int textScale) {
    const int barHeight = 2 * textHeight(textScale), textTop = barHeight + 2 * textScale;
    Picture bar(width, textTop + 2 * textHeight(textScale), paper);
    for (int x = 0; x < width; ++x) {
        const double value = low + (high - low) * (x + 0.5) / width;
        const Srgb8 color = scaleColor(float(value), float(low), float(high));
        for (int y = 0; y < barHeight; ++y) bar.paint(x, y, color);
    }
    const std::string middle = printed("%.3g", (low + high) / 2), right = printed("%.3g", high);
    bar.write(0, textTop, printed("%.3g", low), ink, textScale);
    bar.write((width - textWidth(middle, textScale)) / 2, textTop, middle, ink, textScale);
    bar.write(width - textWidth(right, textScale), textTop, right, ink, textScale);
    bar.write((width - textWidth(unit, textScale)) / 2, textTop + textHeight(textScale), unit, ink,
              textScale);
    return bar;
}

Picture withColorBar(const Picture& picture, double low, double high, std::string_view unit, int textScale) {
    const Picture bar = colorBar(picture.width, low, high, unit, textScale);
    Picture both(picture.width, picture.height + bar.height);
    both.paste(0, 0, picture);
    both.paste(0, picture.height, bar);
    return both;
}

Picture colored(int width, int height, std::span<const float> values, float low, float high,
                std::span<const float> mask, Srgb8 outside) {
    Picture picture(width, height, outside);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const size_t i = size_t(y) * size_t(width) + size_t(x);
            if (mask.empty() || mask[i] != 0.0f) picture.paint(x, y, scaleColor(values[i], low, high));
        }
    return picture;
}

}  // namespace pellucid::io
