#include "system/process.h"

#include <fcntl.h>
#include <io.h>
#include <process.h>
#include <windows.h>

#include <cerrno>
#include <clocale>
#include <cstdint>
#include <cstring>

namespace pel::system {
namespace fs = std::filesystem;

std::vector<fs::path> cacheHomes() {
    std::vector<fs::path> all;
    for (const char* name : {"LOCALAPPDATA", "USERPROFILE"})
        if (const char* folder = std::getenv(name); folder && fs::path(folder).is_absolute())
            all.emplace_back(folder);
    return all;
}

unsigned long processId() {
    return ::GetCurrentProcessId();
}

std::vector<std::string> environment() {
    std::vector<std::string> all;
    for (char** entry = _environ; entry && *entry; ++entry) all.emplace_back(*entry);
    return all;
}

void setVariable(const char* name, const char* value) {
    ::_putenv_s(name, value ? value : "");
}

std::string instructionSet() {
    const char* text = std::getenv("PROCESSOR_IDENTIFIER");
    return text ? text : "";
}

std::string makeTemporaryFolder(const std::string& parent, const std::string& prefix) {
    for (unsigned i = 0; i < 1000; ++i) {
        const fs::path folder =
            fs::path(parent) / (prefix + std::to_string(processId()) + "-" + std::to_string(i));
        std::error_code error;
        if (fs::create_directory(folder, error)) return folder.string();
        if (error) return {};
    }
    return {};
}

std::string programFile() {
    wchar_t path[4096];
    const DWORD length = ::GetModuleFileNameW(nullptr, path, 4096);
    return length > 0 && length < 4096 ? fs::path(path).string() : "";
}

bool errorsAreSeen() {
    return ::_isatty(2);
}

void discardErrors() {}
void restoreErrors() {}

bool prepareStreams() {
    ::_setmode(1, _O_BINARY);      // the same bytes as on other systems
    std::setlocale(LC_CTYPE, "");  // arguments are in the system's code page, and so are paths made of them
    return true;
}

std::string becomeProgram(const std::vector<std::string>& words) {
    // The C library joins words with blanks and quotes none of them.
    std::vector<std::string> quoted;
    for (const std::string& word : words) {
        std::string text = "\"";
        size_t slashes = 0;
        for (const char c : word) {
            if (c == '"') text.append(slashes + 1, '\\');
            slashes = c == '\\' ? slashes + 1 : 0;
            text += c;
        }
        quoted.push_back(text.append(slashes, '\\') + "\"");
    }
    std::vector<const char*> argv;
    for (const std::string& word : quoted) argv.push_back(word.c_str());
    argv.push_back(nullptr);
    const intptr_t code = ::_spawnvp(_P_WAIT, words[0].c_str(), argv.data());
    if (code < 0) return std::strerror(errno);
    std::fflush(nullptr);
    std::_Exit(int(code));
}

Child::Child(const std::vector<std::string>&) {}
Child::~Child() = default;
void Child::end() {}
bool Child::write(const void*, size_t) {
    return false;
}
bool Child::read(void*, size_t) {
    return false;
}

std::FILE* keepOutput() {
    return nullptr;
}

size_t filesLeft() {
    return SIZE_MAX;
}

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
