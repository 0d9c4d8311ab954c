// A fork of the test, which may be limited, damaged or end by itself.
#pragma once
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <functional>
#include <thread>

// Its exit status, which is what `work` returns; 1000 more than the signal that ended it, also after two
// minutes.
inline int inFork(const std::function<int()>& work) {
    std::fflush(nullptr);
    const pid_t child = ::fork();
    if (child == 0) ::_exit(work());
    int status = 0;
    for (int i = 0; ::waitpid(child, &status, WNOHANG) != child; ++i) {
        if (i == 12000) ::kill(child, SIGKILL);
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}
