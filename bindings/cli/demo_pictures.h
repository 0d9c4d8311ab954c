// What people look at after the demo.
#pragma once
#include <string>
#include <vector>

#include "demo_view.h"
#include "io/image/picture.h"

namespace pellucid::cli {

struct ShadedPicture {
    std::string title;
    std::vector<float> radiance;  // RGB per pixel
};

struct ShadedView {
    DemoView view;
    std::vector<float> lambert, tables, complete;  // RGB per pixel
    // Twice as large on each side, before the backdrop: lambert, tables, complete. Empty for views that are
    // large already.
    std::vector<io::Picture> fine;
};

// Before a dark backdrop that is lighter in the middle.
io::Picture developed(const DemoView& view, std::vector<float> radiance);

// The complete picture of a view, NAME.png in `folder`. Returns the file name, as do the next two.
std::string writePicture(const std::string& folder, const ShadedView& view);

// The contact sheet, demo.png: a row per view with its difference, where light comes through most, curvature,
// both tables, and `materials`.
std::string writeSheet(const std::string& folder, const std::vector<ShadedView>& views,
                       const std::vector<ShadedPicture>& materials, const Lut& curvatureLut,
                       const Lut& shadowLut);

// The parts of one view's radiance side by side, with its thickness: NAME_parts.png. `frame`: shaded with all
// outputs.
std::string writeParts(const std::string& folder, const DemoView& view, const io::SceneFrame& frame);

}  // namespace pellucid::cli
