// Which shadow maps are sampled once for all pixels, in cells of taps (kernels/lib/shading/tap_cells.clh).
#pragma once
#include "shading/shader_state.h"
#include "shared/shade.h"

namespace pel {

// Of one disk in one map.
struct MapCells {
    uint32_t light, cascade, disk;
    PelTapCells cells;
    uint64_t samples() const;  // with room for whole vectors
};

// Nodes of a work-item.
uint32_t cellsRun(const Device& device);

// The radii of disks of taps that may have cells, in the order of the materials that take them.
std::vector<float> tapDisks(const ShaderState& state);
// Index of a material's disk; PEL_TAP_DISKS: none.
uint32_t tapDiskOf(const std::vector<float>& disks, const ShaderState& state, const ShaderMaterial& material);
// How much of one of a light's maps a length in the first of them covers, along u (0) or v (1).
float tapScale(const ShaderLight& light, uint32_t cascade, int axis);
// Whether frames of some size have cells. Kernel variants depend only on this, so that another frame size
// needs no other program.
bool mayHaveCells(const ShaderState& state);
// Empty if pixels take taps of their own: because the caller wants that, or because the frame has too few
// pixels for the nodes of such a disk. Does not depend on results of an execution, so that bands and skipping
// change no bit.
std::vector<MapCells> mapCells(const ShaderState& state);

}  // namespace pel
