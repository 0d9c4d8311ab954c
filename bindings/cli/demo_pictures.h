// What people look at after the demo.
#pragma once
#include <string>
#include <vector>

#include "demo_view.h"

namespace pellucid::cli {

struct ShadedPicture {
    std::string title;
    std::vector<float> radiance;  // RGB per pixel
};

struct ShadedView {
    DemoView view;
    std::vector<ShadedPicture> pictures;  // from plain to complete
};

// Writes, into `folder`, a PNG per view (the complete one) and demo.png, the contact sheet of all of them
// with the curvature as a colour map and both tables. Returns the file names.
std::vector<std::string> writePictures(const std::string& folder, const std::vector<ShadedView>& views,
                                       const Lut& curvatureLut, const Lut& shadowLut);

// The parts of one view's radiance side by side, with its thickness: NAME_parts.png. `frame`: shaded with all
// outputs. Returns the file name.
std::string writeParts(const std::string& folder, const DemoView& view, const Frame& frame);

}  // namespace pellucid::cli
