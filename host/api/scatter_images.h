// Images of a PelScatter, as its calls name them.
#pragma once
#include "diffusion/scatter.h"

namespace pel {

inline ImageView viewOf(const PelImageDesc* desc, Device& device, const char* name, bool needed = true) {
    if (desc) return makeImageView(desc, device, name);
    if (needed) invalidArgument("`", name, "` is needed, not NULL");
    return {};
}

inline ScatterImages scatterImages(Device& device, const PelImageDesc* irradiance,
                                   const PelImageDesc* positions, const PelImageDesc* depth,
                                   const PelImageDesc* ids, const PelImageDesc* out) {
    return {viewOf(irradiance, device, "irradiance"), viewOf(positions, device, "positions", false),
            viewOf(depth, device, "depth", false), viewOf(ids, device, "ids", false),
            viewOf(out, device, "out")};
}

}  // namespace pel
