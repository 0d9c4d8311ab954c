// What people look at after the demo.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "demo_reference.h"
#include "io/image/picture.h"

namespace pellucid::cli {

struct ShadedPicture {
    std::string title;
    std::vector<float> radiance;  // RGB per pixel
};

struct ShadedView {
    DemoView view;
    std::vector<float> lambert, tables, complete;  // RGB per pixel
    std::optional<DemoReference> reference;
    // Twice as large on each side, before the backdrop: lambert, tables, complete. Empty for views that are
    // large already.
    std::vector<io::Picture> fine;
};

// Before a dark backdrop that is lighter in the middle.
io::Picture developed(const DemoView& view, std::vector<float> radiance);

// Writes, into `folder`, a PNG per view (the complete one) and demo.png, the contact sheet: a row per view
// with its differences, where light comes through most, curvature, both tables, and `materials`. Returns the
// file names.
std::vector<std::string> writePictures(const std::string& folder, const std::vector<ShadedView>& views,
                                       const std::vector<ShadedPicture>& materials, const Lut& curvatureLut,
                                       const Lut& shadowLut);

// The parts of one view's radiance side by side, with its thickness: NAME_parts.png. `frame`: shaded with all
// outputs. Returns the file name.
std::string writeParts(const std::string& folder, const DemoView& view, const io::SceneFrame& frame);

}  // namespace pellucid::cli
