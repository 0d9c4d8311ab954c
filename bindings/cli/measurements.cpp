#include "measurements.h"

#include <cstring>

#include "command.h"
#include "system/process.h"

namespace pellucid::cli {

const bench::Measurements& measurements() {
    static const auto& loaded = []() -> const bench::Measurements& {
        std::string why;
        if (void* const module =
                pel::system::openBeside(reinterpret_cast<const void*>(&pelVersion), PELLUCID_MEASURE, why)) {
            const auto* found = static_cast<const bench::Measurements*>(
                pel::system::symbolIn(module, "pellucidMeasurements"));
            if (found && std::strcmp(found->version, PELLUCID_VERSION) == 0) return *found;
            why = "it belongs to another version of pellucid";
        }
        throw UsageError("bench and tune need " PELLUCID_MEASURE ", which cannot be loaded (" + why +
                         "); in a source tree ./run build makes it");
    }();
    return loaded;
}

}  // namespace pellucid::cli
