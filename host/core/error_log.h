// The last error of each thread and the process's error callback.
#pragma once

#include "cl/error.h"

namespace pel {

void setErrorCallback(PelErrorCallback callback, void* user);
const char* lastErrorMessage();
// Stores the message for this thread, calls the callback, returns the code.
PelError report(PelError code, const char* message) noexcept;

}  // namespace pel
