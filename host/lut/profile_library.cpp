// The library of materials.
#include "lut/profile_library.h"

namespace pel {
namespace {

constexpr const char* jensen = "Jensen et al. 2001, figure 5";
constexpr const char* jensenSkin1 = "Jensen et al. 2001, figure 5: skin1";
constexpr const char* jensenSkin2 = "Jensen et al. 2001, figure 5: skin2";
constexpr const char* jensenChicken = "Jensen et al. 2001, figure 5: chicken1";
constexpr const char* gems =
    "d'Eon and Luebke, GPU Gems 3, chapter 14 (six Gaussians); FaceWorks 1.0 (sigmas)";
constexpr const char* look = "chosen for its look, not measured; shape of Christensen and Burley 2015";
constexpr const char* skin1ByBurley =
    "mean free paths 1/(absorption + reduced scattering) of skin1 of Jensen et al. 2001, its diffuse "
    "reflectance there as albedo; shape of Christensen and Burley 2015";
constexpr PelProfileKind dipole = PEL_PROFILE_DIPOLE, burley = PEL_PROFILE_BURLEY;

// Dipoles: coefficients of Jensen, Marschner, Levoy, Hanrahan, A Practical Model for Subsurface Light
// Transport, SIGGRAPH 2001, figure 5, in 1/mm, with eta as there. Burley: mean free path in mm, and albedo.
constexpr LibraryProfile library[] = {
    {"skin", PEL_PROFILE_SKIN, gems, {}, {}, 0},
    {"skin-pale", dipole, jensenSkin2, {0.013f, 0.070f, 0.145f}, {1.09f, 1.59f, 1.79f}, 1.3f},
    {"skin-dark", dipole, jensenSkin1, {0.032f, 0.17f, 0.48f}, {0.74f, 0.88f, 1.01f}, 1.3f},
    {"marble", dipole, jensen, {0.0021f, 0.0041f, 0.0071f}, {2.19f, 2.62f, 3.00f}, 1.5f},
    {"whole-milk", dipole, jensen, {0.0011f, 0.0024f, 0.014f}, {2.55f, 3.21f, 3.77f}, 1.3f},
    {"skim-milk", dipole, jensen, {0.0014f, 0.0025f, 0.0142f}, {0.70f, 1.22f, 1.90f}, 1.3f},
    {"cream", dipole, jensen, {0.0002f, 0.0028f, 0.0163f}, {7.38f, 5.47f, 3.15f}, 1.3f},
    {"ketchup", dipole, jensen, {0.061f, 0.97f, 1.45f}, {0.18f, 0.07f, 0.03f}, 1.3f},
    {"apple", dipole, jensen, {0.0030f, 0.0034f, 0.046f}, {2.29f, 2.39f, 1.97f}, 1.3f},
    {"potato", dipole, jensen, {0.0024f, 0.0090f, 0.12f}, {0.68f, 0.70f, 0.55f}, 1.3f},
    {"chicken", dipole, jensenChicken, {0.015f, 0.077f, 0.19f}, {0.15f, 0.21f, 0.38f}, 1.3f},
    {"skin-burley", burley, skin1ByBurley, {1.295f, 0.952f, 0.671f}, {0.44f, 0.22f, 0.13f}, 0},
    {"paraffin", burley, look, {4.0f, 3.2f, 2.2f}, {0.92f, 0.89f, 0.80f}, 0},
    {"jade", burley, look, {1.2f, 2.6f, 1.5f}, {0.35f, 0.70f, 0.42f}, 0},
};

}  // namespace

std::span<const LibraryProfile> profileLibrary() {
    return library;
}

Ref<Profile> namedProfile(const char* name) {
    if (!name) invalidArgument("a name is needed, not NULL");
    std::string known;
    for (const LibraryProfile& entry : library) {
        known.append(known.empty() ? "" : ", ").append(entry.name);
        if (std::string_view(entry.name) != name) continue;
        constexpr PelBurleyFit fit = PEL_BURLEY_DIFFUSE_TRANSMISSION;
        Ref<Profile> profile = entry.kind == PEL_PROFILE_SKIN ? Profile::skin()
                               : entry.kind == dipole ? Profile::dipole(entry.first, entry.second, entry.eta)
                                                      : Profile::burley(entry.first, entry.second, fit);
        profile->setName(entry.name);
        profile->setSource(entry.source);
        return profile;
    }
    invalidArgument("'", name, "' is not a material of the library (", known, ")");
}

}  // namespace pel
