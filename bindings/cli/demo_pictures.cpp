#include "demo.h"

#include "io/image/tone_map.h"
#include "mesh_curvature.h"

namespace pellucid::cli {

io::Picture developed(const DemoView& view, const std::vector<float>& radiance) {
    return {view.gbuffer.width, view.gbuffer.height, io::toSrgb8(radiance)};
}

namespace {

constexpr int lutSize = 200;  // pixels a side on the sheet

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

// A part of a picture, so small that the sheet fits a screen.
io::Picture reduced(const io::Picture& picture, const Crop& part) {
    constexpr int sheetShrink = 2;
    return io::shrunk(cropped(picture, part), sheetShrink);
}

// The change by scattering, in its own colour; grey where nothing changes.
io::Picture difference(const ShadedView& view, float times) {
    std::vector<float> d(view.radiance[DEMO_COMPLETE]);
    for (size_t i = 0; i < d.size(); ++i) d[i] = 0.2f + times * (d[i] - view.radiance[DEMO_LAMBERT][i]);
    return {view.view.gbuffer.width, view.view.gbuffer.height,
            io::toSrgb8(d, {1.0f, 1.0f, io::ToneCurve::none})};
}

// The part of a head where scattering and transmission add most red light: a backlit ear.
Crop brightestChange(const ShadedView& view) {
    constexpr int step = 8;
    const std::vector<float>&lambert = view.radiance[DEMO_LAMBERT], &complete = view.radiance[DEMO_COMPLETE];
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
                    if (lambert[i] < 0.15f) sum += redness(complete) - redness(lambert);
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
    const io::Picture map = reduced(whole, coveredPart(view));
    return io::withColorBar(map, 0, high, "1/mm");
}

Crop timesTwo(const Crop& c) {
    return {2 * c.left, 2 * c.top, 2 * c.right, 2 * c.bottom};
}

// A part of a variant's picture, twice as large where there is a finer one.
io::Picture largest(const ShadedView& view, size_t variant, const Crop& part) {
    return view.fine.empty() ? cropped(developed(view.view, view.radiance[variant]), part)
                             : cropped(view.fine[variant], timesTwo(part));
}

// What is seen of a variant, its edges smooth where there is a finer picture.
io::Picture smooth(const ShadedView& view, size_t variant) {
    return io::shrunk(largest(view, variant, coveredPart(view.view)), view.fine.empty() ? 1 : 2);
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
        tiles.push_back({title, reduced(whole, part)});
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
    write(name + "_lambert.png", smooth(view, DEMO_LAMBERT));
    return write(name + ".png", smooth(view, DEMO_COMPLETE));
}

std::string writeSheet(const std::string& folder, const std::vector<ShadedView>& views,
                       const std::vector<io::Tile>& materials, const Lut& curvatureLut,
                       const Lut& shadowLut) {
    constexpr size_t columns = 4;
    std::vector<io::Tile> tiles;
    for (const ShadedView& view : views) {
        const std::string& name = view.view.name;
        const Crop part = coveredPart(view.view);
        const auto add = [&](const std::string& title, const io::Picture& whole) {
            tiles.push_back({title, reduced(whole, part)});
        };
        for (size_t i = 0; i < std::size(demoVariants); ++i)
            add(name + ": " + demoVariants[i], developed(view.view, view.radiance[i]));
        add("difference, x 4", difference(view, 4));
    }
    const ShadedView& lit = views.back();
    const Crop glow = brightestChange(lit);
    for (size_t i = 0; i < std::size(demoVariants); ++i)
        tiles.push_back({std::string("from behind: ") + demoVariants[i], largest(lit, i, glow)});
    tiles.push_back({"curvature", curvatureMap(views.front().view)});
    tiles.push_back({"curvature LUT: N.L across", lutPicture(curvatureLut)});
    tiles.push_back({"shadow LUT: shadow across", lutPicture(shadowLut)});
    while (tiles.size() % columns)  // the rest of the row
        tiles.push_back({"", io::Picture(1, 1, io::Srgb8{20, 20, 20})});
    for (const io::Tile& m : materials)
        tiles.push_back({m.label, reduced(m.picture, coveredPart(views.front().view))});
    return write(folder + "/demo.png", io::contactSheet(tiles, int(columns)));
}

}  // namespace pellucid::cli
