#include "system/library.h"

#include <windows.h>

#include <filesystem>

namespace pel::system {

void* openLibrary(const std::string& name, std::string& why) {
    const HMODULE library = ::LoadLibraryW(std::filesystem::path(name).c_str());
    if (!library)
        why = name + " cannot be loaded (error " + std::to_string(::GetLastError()) + " of Windows)";
    return reinterpret_cast<void*>(library);
}

void* symbolIn(void* library, const char* name) {
    return reinterpret_cast<void*>(::GetProcAddress(static_cast<HMODULE>(library), name));
}

std::string folderOf(const void* address) {
    HMODULE module = nullptr;
    wchar_t path[4096];
    if (!::GetModuleHandleExW(
            GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT,
            static_cast<const wchar_t*>(address), &module))
        return {};
    const DWORD length = ::GetModuleFileNameW(module, path, 4096);
    if (length == 0 || length == 4096) return {};
    return (std::filesystem::path(path).parent_path() / "").string();
}

}  // namespace pel::system
