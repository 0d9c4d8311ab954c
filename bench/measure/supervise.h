// Measures a device in processes of its own, so that a failure there cannot stop the rest.
#pragma once
#include "measure.h"

namespace pellucid::bench {

// measureCases() by the pellucid command `request.command`. A case that does not answer within
// request.limitSeconds, or ends its process, is among the operations as {"name", "group", "failed": why}; the
// others are measured without it.
nlohmann::ordered_json measureCasesApart(const Request& request);

// "first_use" and "warm_start" of a report: the command again in an empty cache of every driver known here,
// then in the cache that this left.
void measureFirstUse(const Request& request, nlohmann::ordered_json& report);

}  // namespace pellucid::bench
