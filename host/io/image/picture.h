// Small pictures of 8-bit sRGB pixels: contact sheets with labels, and colour bars.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/image/color_map.h"

namespace pellucid::io {

struct Picture {
    int width = 0;  // pixels
    int height = 0;
    std::vector<uint8_t> rgb;  // sRGB, 3 * width * height, row 0 on top

    Picture() = default;
    Picture(int width, int height, Srgb8 background = {0, 0, 0});
    Picture(int width, int height, std::vector<uint8_t> rgb);

    void paint(int x, int y, Srgb8 color);  // outside the picture: nothing
    // Copies `other` with its upper left corner at (x, y); parts outside are dropped.
    void paste(int x, int y, const Picture& other);
    // Writes text in DejaVu Sans with its upper left corner at (x, y), textHeight(scale) pixels high. Without
    // that font (Debian's fonts-dejavu-core) nothing is written: a missing label must not fail a picture.
    // Returns the x after it.
    int write(int x, int y, std::string_view text, Srgb8 color, int scale = 1);
};

// Pixels that write() needs.
int textWidth(std::string_view text, int scale = 1);
constexpr int textHeight(int scale = 1) {
    return 9 * scale;
}

// The mean of factor x factor pixels for each, in linear light; sizes are rounded down, at least 1 pixel.
Picture shrunk(const Picture& picture, int factor);

struct Tile {
    std::string label;
    Picture picture;
};

// Tiles row by row with labels below, on dark grey. Columns and rows are as large as their largest tile.
Picture contactSheet(std::span<const Tile> tiles, int columns, int textScale = 2);

// A horizontal bar of scaleColor from `low` to `high`, with numbers and the unit.
Picture colorBar(int width, double low, double high, std::string_view unit, int textScale = 2);

// The picture with a bar as wide as itself below.
Picture withColorBar(const Picture& picture, double low, double high, std::string_view unit,
                     int textScale = 2);

// Values in [low, high] as scaleColor; `outside` where mask (empty, or one per value) is 0.
Picture colored(int width, int height, std::span<const float> values, float low, float high,
                std::span<const float> mask = {}, Srgb8 outside = {20, 20, 20});

}  // namespace pellucid::io
