#include "core/error_log.h"

#include <mutex>

namespace pel {
namespace {

std::mutex callbackMutex;
PelErrorCallback callback = nullptr;
void* callbackUser = nullptr;
thread_local std::string message;

void keep(const char* what) noexcept {
    try {
        message = what;
    } catch (...) {
        message.clear();  // out of memory while saying so: the code still tells
    }
}

}  // namespace

void setErrorCallback(PelErrorCallback newCallback, void* user) {
    std::lock_guard lock(callbackMutex);
    callback = newCallback;
    callbackUser = user;
}

const char* lastErrorMessage() {
    return message.c_str();
}

PelError report(PelError code, const char* what) noexcept {
    keep(what);
    // What fails inside the callback is told to nobody: it might fail again and again.
    thread_local bool telling = false;
    if (telling) return code;
    PelErrorCallback call;
    void* user;
    {
        std::lock_guard lock(callbackMutex);
        call = callback;
        user = callbackUser;
    }
    if (!call) return code;
    telling = true;
    try {
        call(user, code, what);
    } catch (...) {  // no exception leaves through C
    }
    telling = false;
    keep(what);
    return code;
}

}  // namespace pel
