// Shared libraries that are found at run time.
#pragma once
#include <string>

namespace pel::system {

// nullptr and the reason if it cannot be loaded. A library stays loaded until the process ends.
void* openLibrary(const std::string& name, std::string& why);
// nullptr if it has no such symbol.
void* symbolIn(void* library, const char* name);
// The folder of the library or program that contains this address, with a separator at its end; "" if
// unknown.
std::string folderOf(const void* address);

}  // namespace pel::system
