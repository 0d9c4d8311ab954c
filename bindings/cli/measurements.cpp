#include "measurements.h"

#include "command.h"
#include "system/module.h"

namespace pellucid::cli {

const bench::Measurements& measurements() {
    static std::string why;
    static const auto* const loaded = pel::system::tableOfModule<bench::Measurements>(
        reinterpret_cast<const void*>(&pelVersion), PELLUCID_MEASURE, "pellucidMeasurements",
        PELLUCID_VERSION, why);
    if (!loaded)
        throw UsageError("bench and tune need " PELLUCID_MEASURE ", which cannot be loaded (" + why +
                         "); in a source tree ./run build makes it");
    return *loaded;
}

}  // namespace pellucid::cli
