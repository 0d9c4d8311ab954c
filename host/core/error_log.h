// The last error of each thread, and the process's callbacks for errors and warnings.
#pragma once
#include "cl/error.h"

namespace pel {

void setErrorCallback(PelErrorCallback callback, void* user);
void setLogCallback(PelLogCallback callback, void* user);
const char* lastErrorMessage();
// Passes each line to the log callback. False if there is none.
bool warn(const std::string& lines);
// Stores the message for this thread, calls the callbacks, returns the code.
PelError report(PelError code, const char* message) noexcept;

}  // namespace pel
