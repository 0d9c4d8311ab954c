#include "demo_pictures.h"

#include <algorithm>
#include <cmath>

#include "io/image/picture.h"
#include "io/image/tone_map.h"
#include "mesh_curvature.h"

namespace pellucid::cli {
namespace {

constexpr int sheetShrink = 2;  // the sheet shows pictures at half size, so that three fit a screen
constexpr int lutSize = 320;    // pixels a side on the sheet

// Before a dark backdrop that is lighter in the middle.
io::Picture developed(const DemoView& view, std::vector<float> radiance) {
    const int width = view.gbuffer.width, height = view.gbuffer.height;
    const std::vector<float>& material = view.gbuffer.channel("Material.I").pixels;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const size_t i = size_t(y) * width + x;
            if (material[i] > 0) continue;
            const float r = std::hypot(x - 0.5f * width, y - 0.45f * height) / height;
            const float grey = 0.012f + 0.03f * std::exp(-3 * r * r);
            radiance[3 * i] = 0.9f * grey, radiance[3 * i + 1] = grey, radiance[3 * i + 2] = 1.15f * grey;
        }
    return {width, height, io::toSrgb8(radiance)};
}

// The table as a picture, nearest texel, with values as linear radiance.
io::Picture lutPicture(const Lut& lut) {
    const std::vector<float> texels = lut.read<float>(PEL_LUT_FLOAT);
    const PelLutInfo info = lut.info();
    const size_t width = info.kind == PEL_LUT_CURVATURE ? info.curvature.width : info.shadow.width;
    const size_t height = info.kind == PEL_LUT_CURVATURE ? info.curvature.height : info.shadow.height;
    std::vector<float> shown(size_t(lutSize) * lutSize * 3);
    for (size_t y = 0; y < lutSize; ++y)
        for (size_t x = 0; x < lutSize; ++x)
            std::copy_n(&texels[(y * height / lutSize * width + x * width / lutSize) * 3], 3,
                        &shown[(y * lutSize + x) * 3]);
    return {lutSize, lutSize, io::toSrgb8(shown, {1.0f, 1.0f})};
}

// What is not background, with a margin.
struct Crop {
    int left, top, right, bottom;  // pixels, the last two exclusive
};

Crop coveredPart(const DemoView& view) {
    constexpr int margin = 40;
    const int width = view.gbuffer.width, height = view.gbuffer.height;
    const std::vector<float>& material = view.gbuffer.channel("Material.I").pixels;
    Crop c{width, height, 0, 0};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            if (material[size_t(y) * width + x] > 0)
                c = {std::min(c.left, x), std::min(c.top, y), std::max(c.right, x + 1),
                     std::max(c.bottom, y + 1)};
    if (c.right == 0) return {0, 0, width, height};
    return {std::max(c.left - margin, 0), std::max(c.top - margin, 0), std::min(c.right + margin, width),
            std::min(c.bottom + margin, height)};
}

io::Picture cropped(const io::Picture& picture, const Crop& c) {
    io::Picture part(c.right - c.left, c.bottom - c.top);
    for (int y = 0; y < part.height; ++y)
        std::copy_n(&picture.rgb[3 * (size_t(c.top + y) * picture.width + c.left)], 3 * part.width,
                    &part.rgb[3 * size_t(y) * part.width]);
    return part;
}

io::Picture curvatureMap(const DemoView& view) {
    const std::vector<float>& curvature = view.gbuffer.channel("Curvature.V").pixels;
    const std::vector<float>& material = view.gbuffer.channel("Material.I").pixels;
    std::vector<float> seen;
    for (size_t i = 0; i < curvature.size(); ++i)
        if (material[i] > 0) seen.push_back(curvature[i]);
    const float high = std::max(percentile(seen, 0.98), 1e-6f);
    const io::Picture whole = io::colored(view.gbuffer.width, view.gbuffer.height, curvature, 0, high, material);
    const io::Picture map = io::shrunk(cropped(whole, coveredPart(view)), sheetShrink);
    return io::withColorBar(map, 0, high, "1/mm");
}

}  // namespace

std::string writeParts(const std::string& folder, const DemoView& view, const Frame& frame) {
    constexpr float longest = 30;  // mm; hardly anything comes through more
    const Crop part = coveredPart(view);
    std::vector<io::Tile> tiles;
    const auto add = [&](const char* title, const io::Picture& whole) {
        tiles.push_back({title, io::shrunk(cropped(whole, part), sheetShrink)});
    };
    add("sum", developed(view, frame.radiance()));
    add("diffuse", developed(view, frame.output(PEL_SLOT_OUT_DIFFUSE)));
    add("transmission", developed(view, frame.output(PEL_SLOT_OUT_DEEP_SCATTER)));
    add("specular", developed(view, frame.output(PEL_SLOT_OUT_SPECULAR)));
    add("thickness", io::colored(view.gbuffer.width, view.gbuffer.height, frame.output(PEL_SLOT_OUT_THICKNESS),
                                 0, longest, view.gbuffer.channel("Material.I").pixels));
    tiles.back().picture = io::withColorBar(tiles.back().picture, 0, longest, "mm", 1);
    const io::Picture sheet = io::contactSheet(tiles, int(tiles.size()));
    const std::string file = folder + "/" + view.name + "_parts.png";
    io::writeImage8(file, sheet.width, sheet.height, 3, sheet.rgb);
    return file;
}

std::vector<std::string> writePictures(const std::string& folder, const std::vector<ShadedView>& views,
                                       const Lut& curvatureLut, const Lut& shadowLut) {
    std::vector<std::string> files;
    const auto write = [&](const std::string& name, const io::Picture& p) {
        files.push_back(folder + "/" + name);
        io::writeImage8(files.back(), p.width, p.height, 3, p.rgb);
    };
    std::vector<io::Tile> tiles;
    for (const ShadedView& view : views) {
        const Crop part = coveredPart(view.view);
        write(view.view.name + ".png", cropped(developed(view.view, view.pictures.back().radiance), part));
        for (const ShadedPicture& p : view.pictures)
            tiles.push_back({view.view.name + ": " + p.title,
                             io::shrunk(cropped(developed(view.view, p.radiance), part), sheetShrink)});
    }
    tiles.push_back({"curvature", curvatureMap(views.front().view)});
    tiles.push_back({"curvature LUT: N.L across, curvature down", lutPicture(curvatureLut)});
    tiles.push_back({"shadow LUT: shadow across, 1/width down", lutPicture(shadowLut)});
    write("demo.png", io::contactSheet(tiles, 3));
    return files;
}

}  // namespace pellucid::cli
