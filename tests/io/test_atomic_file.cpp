// host/io/atomic_file.h and input_file.h: files that appear whole or not at all, under unpredictable
// temporary names; files that are not regular; limits.
//
// This program defines calls to the disk itself, which are linked before the C library's and fail on demand.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <regex>

#include "io/atomic_file.h"
#include "io/input_file.h"
#include "io_files.h"
#include "variable.h"

using namespace pellucid::io;

namespace {

std::atomic<int> failFileSync{0}, failFolderSync{0}, failClose{0}, failRename{0};  // errno; 0: as ever
std::atomic<int> fileSyncs{0}, folderSyncs{0}, renames{0};

template <class F>
F* next(const char* name) {
    return reinterpret_cast<F*>(dlsym(RTLD_NEXT, name));
}

bool isFolder(int fd) {
    struct stat status {};
    return ::fstat(fd, &status) == 0 && S_ISDIR(status.st_mode);
}

int failing(std::atomic<int>& with) {
    errno = with.exchange(0);
    return -1;
}

}  // namespace

extern "C" int fsync(int fd) {
    const bool folder = isFolder(fd);
    ++(folder ? folderSyncs : fileSyncs);
    if (folder) {
        EXPECT_GT(renames.load(), 0) << "the folder is flushed before the name is in it";
    }
    if (folder ? failFolderSync : failFileSync) return failing(folder ? failFolderSync : failFileSync);
    return next<int(int)>("fsync")(fd);
}
extern "C" int close(int fd) {
    const int result = next<int(int)>("close")(fd);
    return failClose && result == 0 ? failing(failClose) : result;
}
extern "C" int renameat(int from, const char* name, int to, const char* newName) noexcept {
    EXPECT_GT(fileSyncs.load(), 0) << "the file gets its name before it is on the disk";
    if (failRename) return failing(failRename);
    ++renames;
    return next<int(int, const char*, int, const char*)>("renameat")(from, name, to, newName);
}

namespace {

class AtomicFileTest : public FolderTest {
  protected:
    // The one temporary file in the folder.
    std::string temporary() const {
        std::string found;
        for (const auto& entry : std::filesystem::directory_iterator(folder_))
            if (entry.path().filename().string().find(".tmp") != std::string::npos)
                found = entry.path().string();
        return found;
    }
    std::string refusal(const std::string& name) const {
        return messageOf<FileError>([&] { writeWholeFile(path(name), "new"); });
    }
    static void age(const std::string& file, double seconds) {
        timespec times[2];
        ::clock_gettime(CLOCK_REALTIME, &times[0]);
        times[0].tv_sec -= time_t(seconds);
        times[1] = times[0];
        ASSERT_EQ(::utimensat(AT_FDCWD, file.c_str(), times, 0), 0);
    }
};

}  // namespace

// tests/core/test_system.cpp has what holds on every system.
TEST_F(AtomicFileTest, FileAndFolderAreFlushedInTurn) {
    fileSyncs = folderSyncs = renames = 0;
    writeWholeFile(path("o.ply"), "new");
    EXPECT_TRUE(fileSyncs == 1 && renames == 1 && folderSyncs == 1);
}

TEST_F(AtomicFileTest, FailuresOfTheDiskAreErrors) {
    write("o", "old");
    for (std::atomic<int>* fault : {&failFileSync, &failClose, &failRename})
        for (int code : {EIO, ENOSPC, EDQUOT}) {
            *fault = code;
            EXPECT_TRUE(contains(refusal("o"), std::string("o: cannot be written: ") + std::strerror(code)));
            EXPECT_EQ(*fault, 0) << "never called";
            EXPECT_EQ(read(path("o")), "old");
            EXPECT_EQ(filesInFolder(), 1u);
        }
    failFolderSync = EIO;
    EXPECT_TRUE(contains(refusal("o"), "may be lost in a power cut: Input/output error"));
    EXPECT_EQ(read(path("o")), "new");
    failFolderSync = EINVAL;  // of file systems that cannot
    EXPECT_EQ(refusal("o"), "");
}

TEST_F(AtomicFileTest, TemporaryNamesAreRandomAndNoLinkIsFollowed) {
    const AtomicFile one(path("o.exr"));
    const std::string first = temporary();
    EXPECT_TRUE(std::regex_match(first, std::regex(R"(.*/\.o\.[0-9a-f]{8}-[0-9a-f]{16}\.tmp\.exr)")))
        << first;
    std::filesystem::rename(first, path("away"));
    const AtomicFile two(path("o.exr"));
    EXPECT_NE(temporary(), first);
    // A link in place of the target is replaced; the file that it points to stays.
    write("elsewhere", "precious");
    std::filesystem::create_symlink("elsewhere", path("link"));
    writeWholeFile(path("link"), "new");
    EXPECT_EQ(read(path("elsewhere")), "precious");
    EXPECT_EQ(read(path("link")), "new");
    const std::string longName(250, 'n');
    writeWholeFile(path(longName), "new");
    EXPECT_EQ(read(path(longName)), "new");
}

TEST_F(AtomicFileTest, AbandonedFilesAreRemovedAndLiveOnesAreNot) {
    int ready[2], leave[2];
    ASSERT_EQ(::pipe(ready), 0);
    ASSERT_EQ(::pipe(leave), 0);
    const pid_t child = ::fork();
    if (child == 0) {
        char byte = 0;
        const AtomicFile file(path("o.exr"));
        if (::write(ready[1], &byte, 1) != 1 || ::read(leave[0], &byte, 1) != 1) ::_exit(1);
        ::_exit(0);  // as if killed
    }
    char byte = 0;
    ASSERT_EQ(::read(ready[0], &byte, 1), 1);
    const std::string left = temporary();
    age(left, 100000);
    EXPECT_EQ(removeAbandonedFiles(folder_.string()), 0u) << "its writer lives";
    ASSERT_EQ(::write(leave[1], &byte, 1), 1);
    ::waitpid(child, nullptr, 0);
    age(left, 30);
    EXPECT_EQ(removeAbandonedFiles(folder_.string()), 0u) << "too young";
    age(left, 90);
    checkWritable(path("another.npy"));
    EXPECT_EQ(filesInFolder(), 0u);

    // Files of other programs.
    const std::string tag = std::filesystem::path(left).filename().string().substr(3, 8);
    for (const std::string& name :
         {std::string(".tmp"), "." + tag + "-0123456789abcdef.tmpx", ".o." + tag + "-0123456789abcde.tmp",
          ".o." + tag + "-0123456789abcdeg.tmp", "o." + tag + "-0123456789abcdef.tmp.exr",
          std::string(".o.tmp.exr")})
        age(write(name, "x"), 1e6);
    std::filesystem::create_symlink("/etc/passwd", path(".o." + tag + "-0123456789abcdef.tmp.exr"));
    EXPECT_EQ(removeAbandonedFiles(folder_.string()), 0u);
    EXPECT_EQ(removeAbandonedFiles(path("none")), 0u);
}

// Names from scenes and programs: the system would end them at the NUL.
TEST_F(AtomicFileTest, NamesHaveNoNul) {
    const std::string name = write("a.txt", "abc") + '\0' + ".exr";
    const auto refusal = [](auto&& use) { return messageOf<FileError>(use); };
    for (const std::string& said :
         {refusal([&] { writeWholeFile(name, "x"); }), refusal([&] { readWholeFile(name); }),
          refusal([&] { checkWritable(name); }), refusal([&] { checkReadable(name); })})
        EXPECT_TRUE(contains(said, "a.txt\\x00.exr: is a name with a NUL character")) << said;
    EXPECT_EQ(readWholeFile(path("a.txt")), "abc");
}

// A terminal would obey them.
TEST_F(AtomicFileTest, MessagesHaveNoControlCharacters) {
    EXPECT_STREQ(FileError("a\nb", "has no '\x1b[2J\x7f\xc3\xa4'", 3).what(),
                 "a\\x0ab:3: has no '\\x1b[2J\\x7f\xc3\xa4'");
    EXPECT_EQ(printable("a\tb\nc\r", true), "a\tb\nc\\x0d");
}

TEST_F(AtomicFileTest, InputsHaveALimit) {
    EXPECT_EQ(readWholeFile(write("a", "abc")), "abc");
    EXPECT_EQ(readWholeFile(write("e", "")), "");
    const int input = ::dup(STDIN_FILENO);
    ::close(STDIN_FILENO);
    EXPECT_EQ(readWholeFile(path("a")), "abc") << "a program without an input gets handle 0";
    ::dup2(input, STDIN_FILENO);
    ::close(input);
    EXPECT_FALSE(readWholeFile("/proc/self/status").empty()) << "a file that says it has no bytes";
    ASSERT_EQ(::truncate(path("e").c_str(), off_t{1} << 40), 0);  // nothing of it is on the disk
    EXPECT_TRUE(contains(messageOf<FileError>([&] { readWholeFile(path("e")); }),
                         "more than the limit of 2048 MiB (PELLUCID_INPUT_LIMIT_MIB raises it)"));
    const Variable limit("PELLUCID_INPUT_LIMIT_MIB", "1");
    EXPECT_EQ(inputLimit(), uint64_t{1} << 20);
    ASSERT_EQ(::truncate(path("e").c_str(), (1 << 20) + 1), 0);
    EXPECT_TRUE(contains(messageOf<FileError>([&] { readWholeFile(path("e")); }), "limit of 1 MiB"));
    for (const char* bad : {"0", "-1", "1.5", "x", "99999999999999999999"}) {
        limit.set(bad);
        EXPECT_TRUE(contains(messageOf<FileError>([] { inputLimit(); }), "a whole number of MiB"));
    }
}
