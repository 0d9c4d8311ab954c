// Light that scatters from the texels of shadow maps (section 10 of the mathematics, "Light space" and "Near
// and far") in double precision: every pixel sums over every texel of every map, and near it over every
// pixel.
#pragma once

#include "reference/diffusion_screen.h"
#include "reference/shade.h"

namespace reference {

// One depth map of a light: a cascade's, or a face's of a cube. Texels that show no surface are NaN.
struct LightDepths {
    int width = 0, height = 0;
    std::vector<double> depth;
    Matrix4 worldToShadow{};  // to homogeneous (u, v, depth); of a cube's face not used
    int face = -1;            // 0 to 5: of a cube round the light, with its axes along the world's
    bool radial = false;      // the face's depths are distances from the light, over `decoding.range`
    DepthDecoding decoding;   // of a face
};

struct MappedLight {
    Rgb color{1, 1, 1};
    bool directional = true;
    Vec3 toLight;   // directional: unit
    Vec3 position;  // else
    // Spot: smooth from 1 at the inner cosine to 0 at the outer one.
    bool spot = false;
    Vec3 spotDirection;
    double cosInner = 1, cosOuter = 0;
    std::vector<LightDepths> maps;  // of cascades the finest first: it has what it holds
};

// All of a picture's pixels, by the profile cut at its reach (scatterReach) and renormalised.
// `picture.camera` is ignored.
std::vector<Rgb> scatterFromLights(const ScatterPicture& picture, const std::vector<MappedLight>& lights,
                                   const Profile& profile);

}  // namespace reference
