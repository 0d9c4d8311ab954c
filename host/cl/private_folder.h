// Folders for machine code that this process will run: nobody else may write there.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace pel::cl {

// This user's folders for caches, the wanted one first: XDG_CACHE_HOME, ~/.cache by HOME, ~/.cache by the
// user's entry in the system. Relative ones are ignored, as the XDG base directory specification asks for.
// They need not exist.
std::vector<std::filesystem::path> cacheHomes();

// Makes the folder and what is missing above it, for this user alone. False when that cannot be done.
bool makePrivateFolder(const std::filesystem::path& folder);

// Why others could change what lies in a folder, or exchange the folder; "" when they cannot. It and all
// above it must be this user's or root's; others may write above it only where they cannot rename what is not
// theirs (as in /tmp).
std::string whyNotPrivate(const std::filesystem::path& folder);

// Bytes that may still be written there; 0 where nothing can be.
uint64_t roomIn(const std::filesystem::path& folder);

}  // namespace pel::cl
