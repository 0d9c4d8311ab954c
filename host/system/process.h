// This process: its environment, program and streams.
#pragma once
#include <string>
#include <vector>

namespace pel::system {

unsigned long processId();
// "NAME=VALUE" of every variable.
std::vector<std::string> environment();
void setVariable(const char* name, const char* value);  // nullptr removes it
// What tells apart processors whose names are the same; "" if the system does not say.
std::string instructionSet();
// A new folder for this process only in `parent`, whose name begins with `prefix`; "" if none can be made. First
// removes such folders of this user's processes that were killed (not on Windows).
std::string makeTemporaryFolder(const std::string& parent, const std::string& prefix);

// The file of this program; "" if the system does not say.
std::string programFile();
// Whether a person looks at what is written to standard error.
bool errorsAreSeen();
// Opens the standard streams that are closed, so that no file takes their place; false if that fails. A limit on file sizes becomes an
// error like a full disk.
bool prepareStreams();
// Runs another program in the place of this one: comes back only if that fails, with the reason.
std::string becomeProgram(const std::vector<std::string>& words);
// How many files this process can still open.
size_t filesLeft();

}  // namespace pel::system
