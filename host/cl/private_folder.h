// Private folders: they hold machine code that this process will run, so nobody else may write there.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace pel::cl {

// This user's cache folders, the preferred one first: XDG_CACHE_HOME, ~/.cache by HOME, ~/.cache by the
// user's entry in the system. Relative paths are ignored, as the XDG base directory specification says. They
// need not exist.
std::vector<std::filesystem::path> cacheHomes();

// Makes the folder and its missing parents, for this user alone. False if that is not possible.
bool makePrivateFolder(const std::filesystem::path& folder);

// The reason why others could change files in the folder or replace the folder; "" if they cannot. The folder
// and all its parents must belong to this user or root. Others may write to a parent only if they cannot
// rename files of other users there (as in /tmp).
std::string whyNotPrivate(const std::filesystem::path& folder);

// The system's reason why this process cannot make files in the folder; "" if it can.
std::string whyNotWritable(const std::filesystem::path& folder);

// Bytes that can still be written there; 0 if none.
uint64_t roomIn(const std::filesystem::path& folder);

}  // namespace pel::cl
