// This process: its environment, program and streams.
#pragma once
#include <string>
#include <vector>

namespace pel::system {

unsigned long processId();
// "NAME=VALUE" of every variable.
std::vector<std::string> environment();
void setVariable(const char* name, const char* value);  // nullptr removes it
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

// Another program that runs beside this one, with these variables ("NAME=VALUE") added to the environment and
// without standard streams. Does nothing on Windows.
class Child {
  public:
    Child(const std::vector<std::string>& words, const std::vector<std::string>& variables);
    ~Child();  // ends it
    Child(Child&& other) noexcept : process_(other.process_) { other.process_ = 0; }
    void wait();

  private:
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

}  // namespace pel::system
