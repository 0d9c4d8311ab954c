// The surroundings in the form that shading reads: levels of a cube map, each wider than the one before;
// compiled by host and device.
//
// Level k holds nodes as lib/shading/ambient_cube.clh reads them, of radiance seen through GGX's lobe of
// roughness (k / (PEL_ENVIRONMENT_LEVELS - 1))^2. Level 0 is what a mirror shows. The levels lie one after
// another.
#pragma once
#include "shared/scalars.h"

#define PEL_ENVIRONMENT_SIZE 64  // texels along an edge of level 0; a power of two
#define PEL_ENVIRONMENT_LEAST 8  // the same of the widest level and of irradiance
#define PEL_ENVIRONMENT_LEVELS 6
#define PEL_ENVIRONMENT_MIPS 7  // of the texels that lobes are summed from: 64 to 1
// After the levels, per model (PEL_MODEL_...): the share of uniform light that a lobe reflects, as scale and
// bias of f0. Rows: the root of the roughness; columns: the view's cosine, both from 0 to 1.
#define PEL_SHARE_NODES 32
#define PEL_SHARE_FLOATS (2 * PEL_SHARE_NODES * PEL_SHARE_NODES)  // of a model
#define PEL_ENVIRONMENT_LARGEST 1e10f  // upper bound of radiance; NaN, Inf and negative values count as 0

static inline PelUint32 environmentSize(PelUint32 level) {
    const PelUint32 size = PEL_ENVIRONMENT_SIZE >> level;
    return size > PEL_ENVIRONMENT_LEAST ? size : PEL_ENVIRONMENT_LEAST;
}

// Floats of a level.
static inline PelUint32 environmentFloats(PelUint32 size) {
    return 18 * (size + 2) * (size + 2);
}

// Floats of all levels.
static inline PelUint32 environmentFloatsOfAll() {
    PelUint32 floats = 0;
    for (PelUint32 k = 0; k < PEL_ENVIRONMENT_LEVELS; ++k) floats += environmentFloats(environmentSize(k));
    return floats;
}
