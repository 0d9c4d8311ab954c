// What people look at after the demo.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "demo_reference.h"

namespace pellucid::cli {

struct ShadedPicture {
    std::string title;
    std::vector<float> radiance;  // RGB per pixel
};

struct ShadedView {
    DemoView view;
    std::vector<float> lambert, tables, complete;  // RGB per pixel
    std::optional<DemoReference> reference;
};

// Writes, into `folder`, a PNG per view (the complete one) and demo.png, the contact sheet: a row per view with its differences, where
// light comes through most, curvature, both tables, and `materials`. Returns the file names.
std::vector<std::string> writePictures(const std::string& folder, const std::vector<ShadedView>& views,
                                       const std::vector<ShadedPicture>& materials, const Lut& curvatureLut,
                                       const Lut& shadowLut);

// The parts of one view's radiance side by side, with its thickness: NAME_parts.png. `frame`: shaded with all
// outputs. Returns the file name.
std::string writeParts(const std::string& folder, const DemoView& view, const io::SceneFrame& frame);

}  // namespace pellucid::cli
