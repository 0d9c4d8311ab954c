#include "demo_pictures.h"

#include <algorithm>

#include "io/picture.h"
#include "io/tone_map.h"
#include "mesh_curvature.h"

namespace pellucid::cli {
namespace {

constexpr int sheetShrink = 2;  // the sheet shows pictures at half size, so that three fit a screen
constexpr int lutSize = 320;    // pixels a side on the sheet

io::Picture developed(const DemoView& view, const std::vector<float>& radiance) {
    return {view.gbuffer.width, view.gbuffer.height, io::toSrgb8(radiance)};
}

io::Picture curvatureMap(const DemoView& view) {
    const std::vector<float>& curvature = view.gbuffer.channel("Curvature.V").pixels;
    const std::vector<float>& material = view.gbuffer.channel("Material.I").pixels;
    std::vector<float> seen;
    for (size_t i = 0; i < curvature.size(); ++i)
        if (material[i] > 0) seen.push_back(curvature[i]);
    const float high = std::max(percentile(seen, 0.98), 1e-6f);
    const io::Picture map = io::shrunk(
        io::colored(view.gbuffer.width, view.gbuffer.height, curvature, 0, high, material), sheetShrink);
    const io::Picture bar = io::colorBar(map.width, 0, high, "1/mm");
    io::Picture both(map.width, map.height + bar.height);
    both.paste(0, 0, map);
    both.paste(0, map.height, bar);
    return both;
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

}  // namespace

std::vector<std::string> writePictures(const std::string& folder, const std::vector<ShadedView>& views,
                                       const Lut& curvatureLut, const Lut& shadowLut) {
    std::vector<std::string> files;
    const auto write = [&](const std::string& name, const io::Picture& p) {
        files.push_back(folder + "/" + name);
        io::writeImage8(files.back(), p.width, p.height, 3, p.rgb);
    };
    std::vector<io::Tile> tiles;
    for (const ShadedView& view : views) {
        write(view.view.name + ".png", developed(view.view, view.pictures.back().radiance));
        for (const ShadedPicture& p : view.pictures)
            tiles.push_back(
                {view.view.name + ": " + p.title, io::shrunk(developed(view.view, p.radiance), sheetShrink)});
    }
    tiles.push_back({"curvature", curvatureMap(views.front().view)});
    tiles.push_back({"curvature LUT: N.L across, curvature down", lutPicture(curvatureLut)});
    tiles.push_back({"shadow LUT: shadow across, 1/width down", lutPicture(shadowLut)});
    write("demo.png", io::contactSheet(tiles, 3));
    return files;
}

}  // namespace pellucid::cli
