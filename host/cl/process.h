// OpenCL drivers have threads, and a fork has none of them: it would wait for them for ever.
#pragma once

namespace pel::cl {

// Called before the first use of OpenCL: this process is the one that may go on using it. Throws as
// checkProcess does.
void claimProcess();
// Whether this process is a fork of the one that claimed it.
bool isFork();
// Throws PEL_ERROR_INVALID_STATE in a fork.
void checkProcess();

}  // namespace pel::cl
