// Light in layers, walked naively: the truth for host/lut/skin*. Mathematics, section 15.
#pragma once
#include <cstdint>
#include <vector>

namespace reference {

struct WalkLayer {
    double thickness;               // length; the last layer has no end, whatever it says
    double absorption, scattering;  // 1/length; scattering is isotropic
};

struct SkinWalk {
    double reflectance;  // of diffuse light from outside, without what the surface itself reflects
    double distance;  // length, the sum over walks of what leaves times how far; over reflectance: the mean
    double error;     // standard error of reflectance
    double beyond;    // of it, what leaves on the other side of a line at the distance `edge` > 0
};

// `index`: of all layers, against 1 outside; a smooth surface.
SkinWalk walkSkin(const std::vector<WalkLayer>& layers, double index, int walks, uint64_t seed,
                  double edge = 1);

// Skin as docs/mathematics.md, section 15, describes it; without water, carotene and bilirubin.
struct WalkedSkin {
    double melanin, eumelanin, blood, oxygenation, epidermis, scattering, scatteringPower;
};
// nanometres: a multiple of 10 from 380 to 720.
std::vector<WalkLayer> layersOf(const WalkedSkin& skin, double nanometres);

// Per channel of linear sRGB, from walks every 10 nm.
struct WalkedChannels {
    double albedo[3], meanDistance[3];
};
WalkedChannels walkChannels(const WalkedSkin& skin, int walks);

}  // namespace reference
