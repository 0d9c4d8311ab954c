// Windows has no forks.
#include "cl/process.h"

namespace pel::cl {

void claimProcess() {}

bool isFork() {
    return false;
}

void checkProcess() {}

}  // namespace pel::cl
