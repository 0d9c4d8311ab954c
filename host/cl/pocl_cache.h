// Where PoCL keeps compiled kernels. Left alone, it ends the process over a damaged file or a full disk, and
// without HOME it runs whatever lies in a folder of fixed name in /tmp, where anybody may have put it.
#pragma once
#include <filesystem>

namespace pel::cl {

// Before drivers are loaded: sets POCL_CACHE_DIR to a private folder of ours that works, unless the user has
// set it. Throws PEL_ERROR_DEVICE when there is none. Once per process.
void choosePoclCache();

// After devices were listed, when PoCL has read it: takes POCL_CACHE_DIR away again if choosePoclCache set it. Programs that this
// one starts choose for themselves; a folder for this process alone may be gone by then, and made again by somebody else.
void poclCacheIsChosen();

// Before a program is built by PoCL. Throws PEL_ERROR_DEVICE when it could not write its files.
void checkPoclCache();

// Deletes programs with files that are not whole, of which PoCL would die. Returns how many.
unsigned removeDamagedPrograms(const std::filesystem::path& folder);

}  // namespace pel::cl
