// The plan that a commit makes from a shader's state (shader_state.h), and the data that passes exchange.
#pragma once
#include "shading/time_budget.h"
#include "shared/shade.h"

namespace pel {

// Rows of tiles, [begin, end).
struct TileRows {
    uint32_t begin, end;
};

// A shadow map with bounds of its blocks.
struct BoundedMap {
    uint32_t filtered, cascade;  // of ShaderPlan.filteredLights, and which of its maps
    uint32_t pairs;              // of blocks side by side
    uint32_t offset;             // of its bounds, floats
    uint32_t index() const { return filtered * PEL_CASCADES + cascade; }  // in ShaderPlan.wideShadows
};

struct ShaderPlan {
    ShaderState state;  // as of the commit, with the images that passes make in their slots
    uint32_t features = 0;
    std::string warnings;            // about inputs that auto lacked
    TakenSetting taken;              // by auto, for PelShaderOptions.timeBudget
    std::vector<uint32_t> variants;  // features of each variant of the shading kernel
    uint32_t tilesX = 0, tileRows = 0;

    // Bands: rows of tiles that are shaded at once, and rows that passes need before and after them.
    uint32_t bandRows = 0, haloRows = 0;
    bool wholeFrame = false;
    bool scratch = false;  // whether a pass makes images, which hold the rows of a band and of its halo

    cl::Memory counters;          // PEL_COUNTERS, of tileLists if there are some
    cl::Memory tileLists;         // lists of tiles; none without a material image
    cl::Memory ambientNodes;      // of the ambient cube
    cl::Memory reflectionNodes;   // of the cube that eyes reflect
    cl::Memory environmentNodes;  // of shared/environment.h
    cl::Memory irises;            // texels of all eyes' irises
    cl::Memory tapCells;          // occluder-depth grids (tap_cells.h)
    uint32_t scratchPlane = 0;    // floats from plane to plane of images that passes make (scratch_image.h)
    ImageView radii;              // factors of the profile's radius, where maps of skin make them
    ImageView arriving;           // irradiance before it is scattered, where a pass needs it later
    std::vector<uint32_t> filteredLights;  // of state.lights: wide shadows are made from their shadow maps
    cl::Memory wideShadows;                // PelWideShadow of their maps, room for PEL_CASCADES each
    std::vector<BoundedMap> boundedMaps;
    cl::Memory bounds;

    // Whether passes may compute every second pixel and interpolate the others. Not in frames narrower than a
    // few vectors.
    bool interpolates() const {
        return !state.options.everyPixel && state.images[PEL_SLOT_RADIANCE].width >= 64;
    }
    // Rows of pixels that images of passes hold.
    uint32_t scratchRows() const;
    // Rows of tiles for which tile lists have room.
    uint32_t listRows() const;
};

}  // namespace pel
