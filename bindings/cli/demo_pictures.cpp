#include "demo.h"

#include "io/image/tone_map.h"
#include "mesh_curvature.h"

namespace pellucid::cli {

io::Picture developed(const DemoView& view, const std::vector<float>& radiance) {
    return {view.gbuffer.width, view.gbuffer.height, io::toSrgb8(radiance)};
}

namespace {

constexpr int sheetShrink = 2;  // of pictures, so that the sheet fits a screen
constexpr int lutSize = 200;    // pixels a side on the sheet

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

// The change by scattering, in its own colour; grey where nothing changes.
io::Picture difference(const ShadedView& view, float times) {
    std::vector<float> d(view.complete);
    for (size_t i = 0; i < d.size(); ++i) d[i] = 0.2f + times * (d[i] - view.lambert[i]);
    return {view.view.gbuffer.width, view.view.gbuffer.height,
            io::toSrgb8(d, {1.0f, 1.0f, io::ToneCurve::none})};
}

// The part of a head where scattering and transmission add most red light: a backlit ear.
Crop brightestChange(const ShadedView& view) {
    constexpr int step = 8;
    const int width = view.view.gbuffer.width, height = view.view.gbuffer.height;
    const int w = std::min(width, height / 6), h = std::min(height, height / 6);
    Crop best{0, 0, w, h};
    double most = -1;
    for (int y = 0; y + h <= height; y += step)
        for (int x = 0; x + w <= width; x += step) {
            double sum = 0;
            for (int v = y; v < y + h; v += step)
                for (int u = x; u < x + w; u += step) {
                    const size_t i = 3 * (size_t(v) * width + u);
                    // Transmitted light is red. Places lit by Lambert are excluded: they are bright enough,
                    // and have pores.
                    const auto redness = [i](const std::vector<float>& v) { return v[i] - v[i + 2]; };
                    if (view.lambert[i] < 0.15f) sum += redness(view.complete) - redness(view.lambert);
                }
            if (sum > most) most = sum, best = {x, y, x + w, y + h};
        }
    return best;
}

io::Picture curvatureMap(const DemoView& view) {
    const std::vector<float>& curvature = view.gbuffer.channel("Curvature.V").pixels;
    const std::vector<float>& material = view.gbuffer.channel("Material.I").pixels;
    std::vector<float> seen;
    for (size_t i = 0; i < curvature.size(); ++i)
        if (material[i] > 0) seen.push_back(curvature[i]);
    const float high = std::max(percentile(seen, 0.98), 1e-6f);
    const io::Picture whole =
        io::colored(view.gbuffer.width, view.gbuffer.height, curvature, 0, high, material);
    const io::Picture map = io::shrunk(cropped(whole, coveredPart(view)), sheetShrink);
    return io::withColorBar(map, 0, high, "1/mm");
}

Crop timesTwo(const Crop& c) {
    return {2 * c.left, 2 * c.top, 2 * c.right, 2 * c.bottom};
}

// A picture, its edges smooth where there is a finer one. `which`: of ShadedView::fine.
io::Picture smooth(const ShadedView& view, const std::vector<float>& radiance, size_t which) {
    const Crop part = coveredPart(view.view);
    if (view.fine.empty()) return cropped(developed(view.view, radiance), part);
    return io::shrunk(cropped(view.fine[which], timesTwo(part)), 2);
}

std::string write(const std::string& file, const io::Picture& p) {
    io::writeImage8(file, p.width, p.height, 3, p.rgb);
    return file;
}

}  // namespace

std::string writeParts(const std::string& folder, const DemoView& view, const io::SceneFrame& frame) {
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
    add("thickness",
        io::colored(view.gbuffer.width, view.gbuffer.height, frame.output(PEL_SLOT_OUT_THICKNESS), 0, longest,
                    view.gbuffer.channel("Material.I").pixels));
    tiles.back().picture = io::withColorBar(tiles.back().picture, 0, longest, "mm", 1);
    return write(folder + "/" + view.name + "_parts.png", io::contactSheet(tiles, int(tiles.size())));
}

std::string writePicture(const std::string& folder, const ShadedView& view) {
    const std::string name = folder + "/" + view.view.name;
    write(name + "_lambert.png", smooth(view, view.lambert, 0));
    return write(name + ".png", smooth(view, view.complete, 2));
}

std::string writeSheet(const std::string& folder, const std::vector<ShadedView>& views,
                       const std::vector<io::Tile>& materials, const Lut& curvatureLut,
                       const Lut& shadowLut) {
    constexpr size_t columns = 4;
    std::vector<io::Tile> tiles;
    const auto fill = [&] {  // the rest of a row
        while (tiles.size() % columns) tiles.push_back({"", io::Picture(1, 1, io::Srgb8{20, 20, 20})});
    };
    for (const ShadedView& view : views) {
        const std::string& name = view.view.name;
        const Crop part = coveredPart(view.view);
        const auto add = [&](const char* title, const std::vector<float>& radiance) {
            tiles.push_back({name + ": " + title,
                             io::shrunk(cropped(developed(view.view, radiance), part), sheetShrink)});
        };
        add("Lambert", view.lambert);
        add("by tables", view.tables);
        add("on the screen", view.complete);
        tiles.push_back({"difference, x 4", io::shrunk(cropped(difference(view, 4), part), sheetShrink)});
    }
    const ShadedView& lit = views.back();
    const Crop glow = brightestChange(lit);
    const auto close = [&](const char* title, const std::vector<float>& radiance, size_t fine) {
        tiles.push_back({std::string("from behind: ") + title,
                         lit.fine.empty() ? cropped(developed(lit.view, radiance), glow)
                                          : cropped(lit.fine[fine], timesTwo(glow))});
    };
    close("Lambert", lit.lambert, 0);
    close("by tables", lit.tables, 1);
    close("on the screen", lit.complete, 2);
    tiles.push_back({"curvature", curvatureMap(views.front().view)});
    tiles.push_back({"curvature LUT: N.L across", lutPicture(curvatureLut)});
    tiles.push_back({"shadow LUT: shadow across", lutPicture(shadowLut)});
    fill();
    for (const io::Tile& m : materials)
        tiles.push_back(
            {m.label, io::shrunk(cropped(m.picture, coveredPart(views.front().view)), sheetShrink)});
    return write(folder + "/demo.png", io::contactSheet(tiles, int(columns)));
}

}  // namespace pellucid::cli
