#include "core/error_log.h"

#include <mutex>

#include "cl/machine.h"
#include "core/handle_table.h"

namespace pel {
namespace {

std::mutex callbackMutex;
struct Callbacks {
    PelErrorCallback error = nullptr;
    void* errorUser = nullptr;
    PelLogCallback log = nullptr;
    void* logUser = nullptr;
} callbacks;
thread_local std::string message;
thread_local bool telling = false;  // a callback runs on this thread

// If another thread held the lock when this process was forked, nobody would ever release it.
std::unique_lock<std::mutex> lockCallback() {
    std::unique_lock lock(callbackMutex, std::defer_lock);
    if (cl::isFork())
        (void)lock.try_lock();
    else
        lock.lock();
    return lock;
}

void keep(const char* what) noexcept {
    try {
        message = what;
    } catch (...) {
        message.clear();  // no memory for the message: the code is still returned
    }
}

// Calls `tell` with the callbacks, unless one of them is running on this thread and might fail for ever.
template <class Tell>
void call(Tell&& tell) {
    if (telling) return;
    Callbacks now;
    {
        const auto lock = lockCallback();
        now = callbacks;
    }
    telling = true;
    try {
        tell(now);
    } catch (...) {  // no exception may leave through C
    }
    telling = false;
}

}  // namespace

void setErrorCallback(PelErrorCallback callback, void* user) {
    const auto lock = lockCallback();
    callbacks.error = callback;
    callbacks.errorUser = user;
}

void setLogCallback(PelLogCallback callback, void* user) {
    const auto lock = lockCallback();
    callbacks.log = callback;
    callbacks.logUser = user;
}

const char* lastErrorMessage() {
    return message.c_str();
}

bool warn(const std::string& lines) {
    if (lines.empty()) return true;
    const std::string object = nameInCall();  // callbacks may call the library
    bool heard = false;
    std::istringstream each(lines);
    for (std::string line; std::getline(each, line);)
        call([&](const Callbacks& to) {
            if (to.log) to.log(to.logUser, PEL_LOG_WARNING, object.c_str(), line.c_str()), heard = true;
        });
    return heard;
}

PelError report(PelError code, const char* what) noexcept {
    std::string object, whole;
    try {
        object = nameInCall();
        whole = object.empty() ? what : object + ": " + what;
    } catch (...) {
        object.clear();
    }
    const char* const said = whole.empty() ? what : whole.c_str();
    keep(said);
    // One by one: the first may remove the second.
    call([&](const Callbacks& to) {
        if (to.error) to.error(to.errorUser, code, said);
    });
    call([&](const Callbacks& to) {
        if (to.log) to.log(to.logUser, PEL_LOG_ERROR, object.c_str(), what);
    });
    keep(said);
    return code;
}

}  // namespace pel
