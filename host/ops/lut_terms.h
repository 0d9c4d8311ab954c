// Profiles and row axes in the units of the integrating kernels: lengths in diffusion radii.
#pragma once
#include <vector>

#include "core/lut.h"
#include "core/profile.h"
#include "shared/lut_integral.h"

namespace pel {

// 1/length times the diffusion radius, kept inside of what float arithmetic on squares bears; beyond, tables
// are at their limits anyway.
double rowLimit(double length, double diffusionRadius);

// FaceWorks ends its integrals at 10 mm of a profile of radius 2.7 mm.
constexpr double profileCut = 10 / 2.7;  // diffusion radii

std::vector<LutGaussian> deviceTerms(const Profile& profile, double steepestRow);

template <class T>
cl::Memory upload(Device& device, const std::vector<T>& values) {
    return device.allocate(values.size() * sizeof(T), values.data());
}

}  // namespace pel
