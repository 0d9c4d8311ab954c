// Where PoCL keeps compiled kernels. By default PoCL ends the process if a file there is damaged or the disk
// is full; without HOME it runs what is in a folder of /tmp, where anybody may have put it.
#pragma once
#include <filesystem>

namespace pel::cl {

// To be called before drivers are loaded: sets POCL_CACHE_DIR to a private folder of this library, unless the
// user has set it. Throws PEL_ERROR_DEVICE if no folder works. Runs once per process.
void choosePoclCache();

// To be called after devices were listed, when PoCL has read the variable: removes POCL_CACHE_DIR again if
// choosePoclCache set it. Child processes choose their own folder: a temporary one of this process may be
// deleted by then, and made again by another user.
void poclCacheIsChosen();

// To be called before PoCL builds a program. Throws PEL_ERROR_DEVICE if PoCL could not write its files.
void checkPoclCache();

// Deletes programs whose files are incomplete, which would crash PoCL. Returns how many.
unsigned removeDamagedPrograms(const std::filesystem::path& folder);

}  // namespace pel::cl
