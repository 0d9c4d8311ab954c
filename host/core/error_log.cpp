#include "core/error_log.h"

#include <mutex>

namespace pel {
namespace {

std::mutex callbackMutex;
PelErrorCallback callback = nullptr;
void* callbackUser = nullptr;
thread_local std::string message;

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
    try {
        message = what;
    } catch (...) {
        message.clear();  // out of memory while saying so: the code still tells
    }
    PelErrorCallback call;
    void* user;
    {
        std::lock_guard lock(callbackMutex);
        call = callback;
        user = callbackUser;
    }
    if (call) call(user, code, message.c_str());
    return code;
}

}  // namespace pel
