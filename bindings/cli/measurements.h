#pragma once
#include "measure/module.h"

namespace pellucid::cli {

// The module, loaded the first time. Throws UsageError where it is missing.
const bench::Measurements& measurements();

}  // namespace pellucid::cli
