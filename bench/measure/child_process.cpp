#include "child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <stdexcept>

#ifdef __linux__
#include <sys/prctl.h>
#endif

namespace pellucid::bench {
namespace {

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> all;
    for (std::string& text : texts) all.push_back(text.data());
    all.push_back(nullptr);
    return all;
}

}  // namespace

ChildProcess::ChildProcess(std::vector<std::string> command,
                           const std::vector<std::pair<std::string, std::string>>& environment, bool loud) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0)
        throw std::runtime_error(std::string("no pipe: ") + std::strerror(errno));
    // Allocates everything before the fork: this process has the driver's threads, which may hold locks.
    std::vector<std::string> variables;
    for (char** entry = environ; *entry; ++entry) {
        const std::string name(*entry, std::strcspn(*entry, "="));
        if (std::none_of(environment.begin(), environment.end(),
                         [&](const auto& e) { return e.first == name; }))
            variables.push_back(*entry);
    }
    for (const auto& [name, value] : environment)
        variables.push_back(std::string(name).append("=").append(value));
    const std::vector<char*> arguments = pointers(command), values = pointers(variables);
    const pid_t parent = ::getpid();
    process_ = ::fork();
    if (process_ == 0) {
#ifdef __linux__
        // No measuring goes on after this process.
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
        if (::getppid() != parent) ::_exit(127);
        ::dup2(ends[1], STDOUT_FILENO);
        const int null = loud ? -1 : ::open("/dev/null", O_WRONLY);
        if (null >= 0) ::dup2(null, STDERR_FILENO);
        ::execve(arguments[0], arguments.data(), values.data());
        ::_exit(127);
    }
    ::close(ends[1]);
    pipe_ = ends[0];
    if (process_ < 0) {
        ::close(pipe_);
        throw std::runtime_error(std::string("no process: ") + std::strerror(errno));
    }
}

ChildProcess::~ChildProcess() {
    if (process_ > 0) {
        ::kill(process_, SIGKILL);
        while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
        }
    }
    ::close(pipe_);
}

ChildProcess::Answer ChildProcess::next(std::string& line, double seconds,
                                        const std::function<bool()>& cancelled) {
    const double end = now() + seconds;
    for (;;) {
        if (const size_t at = heard_.find('\n'); at != std::string::npos) {
            line = heard_.substr(0, at);
            heard_.erase(0, at + 1);
            return Answer::heard;
        }
        if (cancelled && cancelled()) return Answer::silent;
        const double left = end - now();
        if (left <= 0) return Answer::silent;
        pollfd waits{pipe_, POLLIN, 0};
        if (::poll(&waits, 1, int(std::clamp(left * 1e3, 1.0, 200.0))) <= 0) continue;
        char part[4096];
        const ssize_t got = ::read(pipe_, part, sizeof part);
        if (got > 0) heard_.append(part, size_t(got));
        if (got == 0 || (got < 0 && errno != EINTR)) return Answer::ended;
    }
}

std::string ChildProcess::ending() {
    if (process_ < 0) return "";
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    if (WIFSIGNALED(status))
        return "was ended by signal " + std::to_string(WTERMSIG(status)) + " (" +
               ::strsignal(WTERMSIG(status)) + ")";
    return WEXITSTATUS(status) ? "ended with exit code " + std::to_string(WEXITSTATUS(status)) : "";
}

}  // namespace pellucid::bench
