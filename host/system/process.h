// This process: its environment, program and streams.
#pragma once
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace pel::system {

unsigned long processId();
// "NAME=VALUE" of every variable.
std::vector<std::string> environment();
void setVariable(const char* name, const char* value);  // nullptr removes it
// This user's cache folders, which need not exist, the preferred one first: XDG_CACHE_HOME, ~/.cache by HOME,
// ~/.cache by the user's entry in the system. Relative paths are ignored [XDG base directory specification].
std::vector<std::filesystem::path> cacheHomes();
// Ours: PELLUCID_CACHE_DIR, else "pellucid" in the first of them. Empty: none.
inline std::filesystem::path cacheFolder() {
    if (const char* const own = std::getenv("PELLUCID_CACHE_DIR")) {
        const std::string text = own;
        return text == "0" || text == "off" ? std::filesystem::path() : std::filesystem::path(text);
    }
    const std::vector<std::filesystem::path> homes = cacheHomes();
    return homes.empty() ? std::filesystem::path() : homes.front() / "pellucid";
}
// The processor's instruction set extensions, as the system lists them; "" if unknown.
std::string instructionSet();
// A new folder for this process only in `parent`, whose name begins with `prefix`; "" if none can be made.
// Such folders of this user's processes that were killed are removed first (not on Windows).
std::string makeTemporaryFolder(const std::string& parent, const std::string& prefix);

// The file of this program; "" if the system does not say.
std::string programFile();
// Whether standard error is a terminal.
bool errorsAreSeen();
// Opens the standard streams that are closed, so that no file takes their place; false if that fails. From
// now on a limit on file sizes is an error, as a full disk is.
bool prepareStreams();
// Discards what is written to standard error, until restoreErrors(). May be called in a signal handler. Does
// nothing on Windows.
void discardErrors();
void restoreErrors();
// Standard output for this program only: from now on, output of libraries goes to standard error.
std::FILE* keepOutput();

// Another program that runs beside this one. Its standard input and output are a connection to this process;
// its errors are not shown. None runs on Windows.
class Child {
  public:
    explicit Child(const std::vector<std::string>& words);
    ~Child();  // closes its input, and waits for its end
    Child(const Child&) = delete;
    // Wait for all bytes. False if it has ended.
    bool write(const void* bytes, size_t count);
    bool read(void* bytes, size_t count);
    void end();  // at once

  private:
    int connection_ = -1;
    long process_ = 0;  // 0: none
};

// Replaces this program by another one. Returns only if that fails, with the reason.
std::string becomeProgram(const std::vector<std::string>& words);
// How many files this process can still open.
size_t filesLeft();

// nullptr and the reason if it cannot be loaded. A library stays loaded until the process ends.
void* openLibrary(const std::string& name, std::string& why);
// nullptr if it has no such symbol.
void* symbolIn(void* library, const char* name);
// The folder of the library or program that contains this address, with a separator at its end; "" if
// unknown.
std::string folderOf(const void* address);

// openLibrary() for a file in that folder, in a folder "pellucid" there (a build, an installed tree that may
// have been moved, or the Python package), or in the system's search path.
inline void* openBeside(const void* address, const std::string& name, std::string& why) {
    const std::string beside = folderOf(address);
    for (const std::string& folder : {beside, beside + "pellucid/", std::string()}) {
        std::string reason;
        if (void* const library = openLibrary(folder + name, reason)) return library;
        why += (why.empty() ? "" : "; ") + reason;
    }
    return nullptr;
}

}  // namespace pel::system
