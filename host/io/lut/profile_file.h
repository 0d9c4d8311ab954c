// Diffusion profiles as TOML files, and a library of materials in the same form. Keys and units:
// docs/profiles.md.
#pragma once
#include <optional>
#include <pellucid/pellucid.hpp>
#include <span>
#include <string>
#include <string_view>

namespace pellucid::io {

struct ProfileFile {
    std::string name, kind, source;  // source: where the numbers come from
    Profile profile;                 // lengths in mm, whatever the file's unit; named `name`
};

struct LibraryProfile {
    std::string_view name, text;  // TOML
};
// Built-in materials, "skin" first.
std::span<const LibraryProfile> profileLibrary();

// Reads a profile from TOML text; `file` is for messages. Throws FileError with the line: unknown key, wrong
// type, value out of range, missing key.
ProfileFile parseProfile(const std::string& file, const std::string& text);

// A material of the library by name, or a file whose name ends in .toml. Throws FileError; an unknown name
// lists the library.
ProfileFile findProfile(const std::string& nameOrPath);

// The text of a material of the library; none if there is no such name.
std::optional<std::string_view> libraryProfile(std::string_view name);

}  // namespace pellucid::io
