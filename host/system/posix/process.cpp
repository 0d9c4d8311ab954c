#include "system/process.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <pwd.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <fstream>

#ifdef __APPLE__
#include <crt_externs.h>  // libraries have no `environ` there
#include <mach-o/dyld.h>
#define environ (*_NSGetEnviron())
#define MSG_NOSIGNAL 0
#define SOCK_CLOEXEC 0
#else
extern char** environ;
#endif

namespace pel::system {
namespace fs = std::filesystem;
namespace {

// Removes the folders of processes that were killed: each process holds a lock on its own for as long as it
// runs. A folder that is younger than a minute may not be locked yet.
void removeAbandoned(const fs::path& parent, const std::string& prefix) {
    std::error_code error;
    for (auto at = fs::directory_iterator(parent, error); !error && at != fs::directory_iterator();
         at.increment(error)) {
        if (!at->path().filename().string().starts_with(prefix)) continue;
        const int folder = ::open(at->path().c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
        if (folder < 0) continue;
        struct stat status {};
        const bool old = ::fstat(folder, &status) == 0 && status.st_uid == ::geteuid() &&
                         status.st_mtime + 60 < std::time(nullptr);
        std::error_code gone;
        if (old && ::flock(folder, LOCK_EX | LOCK_NB) == 0) fs::remove_all(at->path(), gone);
        ::close(folder);
    }
}

std::string homeInSystem() {
    std::vector<char> room(1 << 14);
    struct passwd entry {
    }, *found = nullptr;
    if (::getpwuid_r(::geteuid(), &entry, room.data(), room.size(), &found) != 0 || !found || !entry.pw_dir)
        return {};
    return entry.pw_dir;
}

}  // namespace

std::vector<fs::path> cacheHomes() {
    std::vector<fs::path> all;
    const auto add = [&](const fs::path& base, const char* below) {
        if (base.is_absolute()) all.push_back(base / below);
    };
    if (const char* cache = std::getenv("XDG_CACHE_HOME")) add(cache, "");
    if (const char* home = std::getenv("HOME")) add(home, ".cache");
    add(homeInSystem(), ".cache");
    return all;
}

unsigned long processId() {
    return static_cast<unsigned long>(::getpid());
}

std::vector<std::string> environment() {
    std::vector<std::string> all;
    for (char** entry = environ; entry && *entry; ++entry) all.emplace_back(*entry);
    return all;
}

void setVariable(const char* name, const char* value) {
    value ? ::setenv(name, value, 1) : ::unsetenv(name);
}

// A CPU's name does not determine its instruction set: virtual machines hide parts of it.
std::string instructionSet() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("flags") || line.starts_with("Features")) return line;
    return {};
}

std::string makeTemporaryFolder(const std::string& parent, const std::string& prefix) {
    removeAbandoned(parent, prefix);
    std::string name = (fs::path(parent) / (prefix + "XXXXXX")).string();
    if (!::mkdtemp(name.data())) return "";  // nobody else can enter it
    // The lock ends with the process, however that ends.
    if (const int folder = ::open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); folder >= 0)
        ::flock(folder, LOCK_SH);
    return name;
}

std::string programFile() {
    std::error_code error;
#ifdef __APPLE__
    char path[4096];
    uint32_t size = sizeof path;
    return ::_NSGetExecutablePath(path, &size) == 0 ? fs::canonical(path, error).string() : "";
#else
    return fs::read_symlink("/proc/self/exe", error).string();
#endif
}

bool errorsAreSeen() {
    return ::isatty(2);
}

bool prepareStreams() {
    std::signal(SIGXFSZ, SIG_IGN);
    for (int fd = 0; fd < 3; ++fd)  // writing to one that was closed still fails
        if (::fcntl(fd, F_GETFD) < 0 && ::open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY) != fd)
            return false;
    return true;
}

static std::atomic<int> keptErrors{-1};
void discardErrors() {
    const int before = errno;  // of the code that the signal interrupts
    const int kept = keptErrors < 0 ? ::fcntl(2, F_DUPFD_CLOEXEC, 3) : -1;
    const int none = kept < 0 ? -1 : ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (none >= 0) ::dup2(none, 2), ::close(none);
    if (kept >= 0) keptErrors = kept;
    errno = before;
}
void restoreErrors() {
    const int kept = keptErrors.exchange(-1);
    if (kept >= 0) ::dup2(kept, 2), ::close(kept);
}

std::FILE* keepOutput() {
    const int kept = ::fcntl(1, F_DUPFD_CLOEXEC, 3);
    return kept >= 0 && ::dup2(2, 1) == 1 ? ::fdopen(kept, "w") : nullptr;
}

std::string becomeProgram(const std::vector<std::string>& words) {
    std::vector<char*> argv;
    for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    ::execvp(argv[0], argv.data());
    return std::strerror(errno);
}

Child::Child(const std::vector<std::string>& words) {
    std::vector<char*> argv;
    for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) return;
    for (const int end : ends) ::fcntl(end, F_SETFD, FD_CLOEXEC);  // where there is no such flag
    posix_spawn_file_actions_t streams;
    ::posix_spawn_file_actions_init(&streams);
    for (int fd = 0; fd < 2; ++fd) ::posix_spawn_file_actions_adddup2(&streams, ends[1], fd);
    ::posix_spawn_file_actions_addopen(&streams, 2, "/dev/null", O_WRONLY, 0);
    pid_t child = 0;
    if (::posix_spawn(&child, argv[0], &streams, nullptr, argv.data(), environ) == 0) process_ = child;
    ::posix_spawn_file_actions_destroy(&streams);
    ::close(ends[1]);
    connection_ = ends[0];
#ifdef SO_NOSIGPIPE
    const int on = 1;
    ::setsockopt(connection_, SOL_SOCKET, SO_NOSIGPIPE, &on, sizeof on);
#endif
}

Child::~Child() {
    if (connection_ >= 0) ::close(connection_);
    while (process_ && ::waitpid(pid_t(process_), nullptr, 0) < 0 && errno == EINTR) {
    }
}

void Child::end() {
    if (process_) ::kill(pid_t(process_), SIGKILL);
}

bool Child::write(const void* bytes, size_t count) {
    const auto* at = static_cast<const char*>(bytes);
    while (count > 0) {
        const ssize_t sent = ::send(connection_, at, count, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR) continue;
        if (sent <= 0) return false;
        at += sent;
        count -= size_t(sent);
    }
    return true;
}

bool Child::read(void* bytes, size_t count) {
    auto* at = static_cast<char*>(bytes);
    while (count > 0) {
        const ssize_t got = ::recv(connection_, at, count, 0);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        at += got;
        count -= size_t(got);
    }
    return true;
}

size_t filesLeft() {
    rlimit limit{};
    if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return SIZE_MAX;
    rlim_t taken = 0;
    std::error_code error;
    for (fs::directory_iterator at("/dev/fd", error), end; !error && at != end; at.increment(error)) ++taken;
    return limit.rlim_cur > taken ? size_t(limit.rlim_cur - taken) : 0;
}

void* openLibrary(const std::string& name, std::string& why) {
    void* library = ::dlopen(name.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (!library) why = ::dlerror();
    return library;
}

void* symbolIn(void* library, const char* name) {
    return ::dlsym(library, name);
}

std::string folderOf(const void* address) {
    Dl_info where{};
    if (!::dladdr(address, &where) || !where.dli_fname) return {};
    const std::string file = where.dli_fname;
    return file.substr(0, file.rfind('/') + 1);
}

}  // namespace pel::system
