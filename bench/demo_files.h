// Where `./run demo` leaves its views, for benchmarks and figures.
#pragma once
#include <cstdlib>
#include <string>

namespace demo {

inline std::string directory() {
    const char* value = std::getenv("PELLUCID_DEMO_DIR");
    return value && *value ? value : PELLUCID_SOURCE_DIR "/out/demo";
}

}  // namespace demo
