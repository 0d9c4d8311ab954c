// Says in an error's message what it is about.
#pragma once
#include "cl/error.h"

namespace pel {

// What body() returns. The message of an error that it throws begins with `parts`.
template <class Body, class... Parts>
auto about(Body&& body, const Parts&... parts) {
    try {
        return body();
    } catch (const Error& e) {
        fail(e.code(), parts..., ": ", e.what());
    }
}

}  // namespace pel
