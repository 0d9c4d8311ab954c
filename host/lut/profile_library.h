// The library of named materials.
#pragma once
#include <span>

#include "lut/profile.h"

namespace pel {

// Lengths in mm. dipole: absorption and reduced scattering (1/mm) and eta; burley: mean free path and albedo.
struct LibraryProfile {
    const char* name;
    PelProfileKind kind;
    const char* source;
    float first[3], second[3], eta;
};

// "skin" first.
std::span<const LibraryProfile> profileLibrary();

// Throws PEL_ERROR_INVALID_ARGUMENT, with a list of the library, for an unknown name.
Ref<Profile> namedProfile(const char* name);

}  // namespace pel
