#include "io/lut/profile_file.h"

namespace pellucid::io {
namespace {

// Coefficients of Jensen, Marschner, Levoy, Hanrahan, A Practical Model for Subsurface Light Transport,
// SIGGRAPH 2001, table in figure 5; 1/mm. eta 1.3 (1.5 for marble) as there.
constexpr LibraryProfile library[] = {
    {"skin", R"toml(name = "skin"
kind = "skin"
source = "d'Eon and Luebke, GPU Gems 3, chapter 14 (six Gaussians); FaceWorks 1.0 (sigmas)"
)toml"},
    {"skin-pale", R"toml(name = "skin-pale"
kind = "dipole"
unit = "mm"
source = "Jensen et al. 2001, figure 5: skin2"
absorption = [0.013, 0.070, 0.145]
reduced_scattering = [1.09, 1.59, 1.79]
eta = 1.3
)toml"},
    {"skin-dark", R"toml(name = "skin-dark"
kind = "dipole"
unit = "mm"
source = "Jensen et al. 2001, figure 5: skin1"
absorption = [0.032, 0.17, 0.48]
reduced_scattering = [0.74, 0.88, 1.01]
eta = 1.3
)toml"},
    {"marble", R"toml(name = "marble"
kind = "dipole"
unit = "mm"
source = "Jensen et al. 2001, figure 5"
absorption = [0.0021, 0.0041, 0.0071]
reduced_scattering = [2.19, 2.62, 3.00]
eta = 1.5
)toml"},
    {"whole-milk", R"toml(name = "whole-milk"
kind = "dipole"
unit = "mm"
source = "Jensen et al. 2001, figure 5"
absorption = [0.0011, 0.0024, 0.014]
reduced_scattering = [2.55, 3.21, 3.77]
eta = 1.3
)toml"},
    {"skim-milk", R"toml(name = "skim-milk"
kind = "dipole"
unit = "mm"
source = "Jensen et al. 2001, figure 5"
absorption = [0.0014, 0.0025, 0.0142]
reduced_scattering = [0.70, 1.22, 1.90]
eta = 1.3
)toml"},
    {"cream", R"toml(name = "cream"
kind = "dipole"
unit = "mm"
source = "Jensen et al. 2001, figure 5"
absorption = [0.0002, 0.0028, 0.0163]
reduced_scattering = [7.38, 5.47, 3.15]
eta = 1.3
)toml"},
    {"ketchup", R"toml(name = "ketchup"
kind = "dipole"
unit = "mm"
source = "Jensen et al. 2001, figure 5"
absorption = [0.061, 0.97, 1.45]
reduced_scattering = [0.18, 0.07, 0.03]
eta = 1.3
)toml"},
    {"apple", R"toml(name = "apple"
kind = "dipole"
unit = "mm"
source = "Jensen et al. 2001, figure 5"
absorption = [0.0030, 0.0034, 0.046]
reduced_scattering = [2.29, 2.39, 1.97]
eta = 1.3
)toml"},
    {"potato", R"toml(name = "potato"
kind = "dipole"
unit = "mm"
source = "Jensen et al. 2001, figure 5"
absorption = [0.0024, 0.0090, 0.12]
reduced_scattering = [0.68, 0.70, 0.55]
eta = 1.3
)toml"},
    {"chicken", R"toml(name = "chicken"
kind = "dipole"
unit = "mm"
source = "Jensen et al. 2001, figure 5: chicken1"
absorption = [0.015, 0.077, 0.19]
reduced_scattering = [0.15, 0.21, 0.38]
eta = 1.3
)toml"},
    {"skin-burley", R"toml(name = "skin-burley"
kind = "burley"
unit = "mm"
source = "mean free paths 1/(absorption + reduced scattering) of skin1 of Jensen et al. 2001, its diffuse reflectance there as albedo; shape of Christensen and Burley 2015"
mean_free_path = [1.295, 0.952, 0.671]
albedo = [0.44, 0.22, 0.13]
fit = "diffuse-transmission"
)toml"},
    {"paraffin", R"toml(name = "paraffin"
kind = "burley"
unit = "mm"
source = "chosen for its look, not measured; shape of Christensen and Burley 2015"
mean_free_path = [4.0, 3.2, 2.2]
albedo = [0.92, 0.89, 0.80]
fit = "diffuse-transmission"
)toml"},
    {"jade", R"toml(name = "jade"
kind = "burley"
unit = "mm"
source = "chosen for its look, not measured; shape of Christensen and Burley 2015"
mean_free_path = [1.2, 2.6, 1.5]
albedo = [0.35, 0.70, 0.42]
fit = "diffuse-transmission"
)toml"},
};

}  // namespace

std::span<const LibraryProfile> profileLibrary() {
    return library;
}

}  // namespace pellucid::io
