#include "core/profile.h"

namespace pel {

const GaussianSum& skinProfile() {
    // d'Eon and Luebke, GPU Gems 3, chapter 14: the six-Gaussian fit to a three-layer skin model, by its
    // sigmas in mm as FaceWorks takes them. (The variances printed beside them are their squares, rounded:
    // 3e-5 in a table.) FaceWorks takes 2.7 mm, not the widest sigma of 2.722 mm, for the profile's radius;
    // so do all tables made with it.
    static const GaussianSum skin{2.7,
                                  {{0.080 * 0.080, {0.233, 0.455, 0.649}},
                                   {0.220 * 0.220, {0.100, 0.336, 0.344}},
                                   {0.432 * 0.432, {0.118, 0.198, 0.0}},
                                   {0.753 * 0.753, {0.113, 0.007, 0.007}},
                                   {1.411 * 1.411, {0.358, 0.004, 0.0}},
                                   {2.722 * 2.722, {0.078, 0.0, 0.0}}}};
    return skin;
}

}  // namespace pel
