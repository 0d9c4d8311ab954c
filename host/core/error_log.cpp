#include "core/error_log.h"

#include <mutex>

#include "cl/machine.h"

namespace pel {
namespace {

std::mutex callbackMutex;
PelErrorCallback callback = nullptr;
void* callbackUser = nullptr;
thread_local std::string message;

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
        message.clear();  // out of memory for the message: the code is still returned
    }
}

}  // namespace

void setErrorCallback(PelErrorCallback newCallback, void* user) {
    const auto lock = lockCallback();
    callback = newCallback;
    callbackUser = user;
}

const char* lastErrorMessage() {
    return message.c_str();
}

PelError report(PelError code, const char* what) noexcept {
    keep(what);
    // An error inside the callback is not reported to the callback again: it might fail again and again.
    thread_local bool telling = false;
    if (telling) return code;
    PelErrorCallback call;
    void* user;
    {
        const auto lock = lockCallback();
        call = callback;
        user = callbackUser;
    }
    if (!call) return code;
    telling = true;
    try {
        call(user, code, what);
    } catch (...) {  // no exception may leave through C
    }
    telling = false;
    keep(what);
    return code;
}

}  // namespace pel
