// Forked processes. OpenCL drivers have threads, and a fork has none of them: it would wait for them for
// ever.
#pragma once

namespace pel::cl {

// To be called before the first use of OpenCL: from now on this process may use it. Throws as checkProcess
// does.
void claimProcess();
// Whether this process is a fork of the owner.
bool isFork();
// Throws PEL_ERROR_INVALID_STATE in a fork.
void checkProcess();

}  // namespace pel::cl
