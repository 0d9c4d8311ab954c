// Diffusion profiles as TOML files (docs/guide/profiles.md), and the materials of the library by name.
#pragma once
#include <pellucid/pellucid.hpp>

#include "fields/captured_frame.h"

namespace pellucid::io {

struct ProfileFile {
    std::string name, kind, source;  // source: where the numbers come from
    Profile profile;                 // lengths in mm, whatever the file's unit; named `name`
    std::optional<PelSkin> skin;     // the composition of a profile of pigments
};

// Reads a profile from TOML text; `file` is for messages. Throws FileError with the line: unknown key, wrong
// type, value out of range, missing key.
ProfileFile parseProfile(const std::string& file, const std::string& text);

// The text of a profile file that is read back as the same profile.
std::string profileText(const pel::ProfileRecipe& recipe);

// A material of the library by name, or a .toml file. Throws FileError, which lists the library.
ProfileFile findProfile(const std::string& nameOrPath);

}  // namespace pellucid::io
