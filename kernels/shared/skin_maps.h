// Constants of maps of skin, with the same layout on host and device (docs/mathematics.md, section 15).
#pragma once
#include "shared/shade.h"

#define PEL_SKIN_SIDE 65         // nodes over the square roots of melanin and of blood, over their ranges
#define PEL_SKIN_OXYGENATIONS 5  // over oxygenation, where the image has it
#define PEL_SKIN_IDS 256

typedef struct PelSkinMapsMaterial {
    float albedo[3];  // of other materials than skin, without an albedo image
    PelUint32 table;  // 1 + its number; 0: no skin
    float own[3];     // melanin, blood, oxygenation of the profile
    PelUint32 set;    // 0: no material has the id
} PelSkinMapsMaterial;

typedef struct PelSkinMaps {
    PelUint32 width;  // pixels
    PelUint32 height;
    float most[2];  // melanin and blood at the last node
    PelShadeImage skin, ids, albedo, radii, outAlbedo, outRadii;
    PelSkinMapsMaterial materials[PEL_SKIN_IDS];
} PelSkinMaps;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(PelSkinMaps) == 16 + 6 * 32 + 32 * PEL_SKIN_IDS);
#endif
