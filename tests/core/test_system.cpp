// The code in folders named `posix` and `windows`: outputs, inputs, this process, libraries.
#ifndef _WIN32
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#endif

#include <thread>

#include "io/atomic_file.h"
#include "io/input_file.h"
#include "io/io_files.h"
#include "system/process.h"

namespace fs = std::filesystem;
namespace io = pellucid::io;
namespace host = pel::system;

using System = FolderTest;

#ifdef _WIN32
constexpr const char *library = "kernel32.dll", *function = "GetTickCount";
#else
constexpr const char *library = "libc.so.6", *function = "strlen";
#endif

#ifndef _WIN32
TEST_F(System, AConnectionEndsWithTheOtherProcess) {
    const std::string sent(1 << 20, 'x');
    std::string back(sent.size(), '\0');
    host::Child echo({"/bin/cat"});
    std::thread reader([&] { EXPECT_TRUE(echo.read(back.data(), back.size())); });
    EXPECT_TRUE(echo.write(sent.data(), sent.size()));
    reader.join();
    EXPECT_EQ(back, sent);
    echo.end();
    EXPECT_FALSE(echo.read(back.data(), 1));
    EXPECT_FALSE(echo.write(sent.data(), sent.size()));
    host::Child none({path("nothing")});
    EXPECT_FALSE(none.write(sent.data(), sent.size()));
}

// But for the one that looks.
TEST_F(System, CountsTheFilesThatMayStillBeOpened) {
    const pid_t child = ::fork();
    if (child == 0) {
        constexpr rlimit limit{64, 64};
        for (int file = 3; file < 4096; ++file) ::close(file);
        if (::setrlimit(RLIMIT_NOFILE, &limit) != 0) ::_exit(2);
        const size_t left = host::filesLeft();
        size_t opened = 0;
        while (::open("/dev/null", O_RDONLY) >= 0) ++opened;
        ::_exit(opened == left + 1 ? 0 : 1);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
}
#endif

TEST_F(System, OutputsAppearWholeOrNotAtAll) {
    const std::string target = write("a.txt", "before");
    {
        io::AtomicFile file(target);
        file.write("half", 4);
        EXPECT_EQ(read(target), "before");
        EXPECT_EQ(filesInFolder(), 2u);
    }
    EXPECT_EQ(filesInFolder(), 1u) << "what was not committed is gone";
    EXPECT_EQ(read(target), "before");
    const std::string bytes("line\n\r\n\0\x1a end",
                            13);  // as they are: no line ends are translated, Ctrl-Z ends nothing
    io::writeWholeFile(target, bytes);
    EXPECT_EQ(read(target), bytes);
    EXPECT_EQ(io::readWholeFile(target), bytes);
    EXPECT_EQ(filesInFolder(), 1u);
    io::checkWritable(path("new.txt"));
    EXPECT_EQ(filesInFolder(), 1u);

    for (const auto& [name, message] : {std::pair{folder_.string(), "is a folder"},
                                        {path("no/a.txt"), "there is no folder"},
                                        {std::string(), "needs a file name"}})
        EXPECT_TRUE(
            contains(messageOf<io::FileError>([&, name = name] { io::AtomicFile file(name); }), message));
}

TEST_F(System, AnOpenTargetIsKept) {
    const std::string target = write("a.txt", "before");
    std::ifstream reader(target);  // by which Windows refuses to replace it
    const std::string said = messageOf<io::FileError>([&] { io::writeWholeFile(target, "after"); });
    if (said.empty()) {
        EXPECT_EQ(read(target), "after");
    } else {
        EXPECT_TRUE(contains(said, "cannot be written: "));
        EXPECT_EQ(read(target), "before");
    }
    EXPECT_EQ(filesInFolder(), 1u);
}

TEST_F(System, RemovesWhatKilledProgramsLeft) {
    const auto left = [&](const std::string& machine, std::chrono::seconds age) {
        const std::string file = write(".a." + machine + "-0123456789abcdef.tmp.exr", "half");
        fs::last_write_time(file, fs::file_time_type::clock::now() - age);
    };
    left(io::machineTag(), std::chrono::seconds(30));
    write(".a.tmp", "somebody else's");
    EXPECT_EQ(io::removeAbandonedFiles(folder_.string()), 0u);
    left(io::machineTag(), std::chrono::seconds(90));
    left("deadbeef", std::chrono::seconds(3600));
    EXPECT_EQ(io::removeAbandonedFiles(folder_.string()), 1u);
    left("deadbeef", std::chrono::seconds(2 * 86400));
    EXPECT_EQ(io::removeAbandonedFiles(folder_.string()), 1u);
    EXPECT_EQ(filesInFolder(), 1u);
}

TEST_F(System, InputsAreFiles) {
    const std::string file = write("a.txt", std::string(100, 'x'));
    EXPECT_EQ(io::readWholeFile(file, 100).size(), 100u);
    const auto refusal = [](const std::string& name) {
        return messageOf<io::FileError>([&] { io::readWholeFile(name, 99); });
    };
    EXPECT_TRUE(contains(refusal(file), "may have 99"));
    EXPECT_TRUE(contains(refusal(folder_.string()), "is a folder"));
    EXPECT_TRUE(
        contains(messageOf<io::FileError>([&] { io::checkReadable(path("none")); }), "cannot be read"));
}

TEST_F(System, ProcessesKnowThemselves) {
    EXPECT_TRUE(fs::exists(host::programFile()));
    EXPECT_TRUE(fs::equivalent(host::programFile(), testing::internal::GetArgvs().front()));
    const auto count = [] { return std::ranges::count(host::environment(), "PELLUCID_TEST=a b"); };
    host::setVariable("PELLUCID_TEST", "a b");
    EXPECT_EQ(count(), 1);
    host::setVariable("PELLUCID_TEST", nullptr);
    EXPECT_EQ(count(), 0);
    const std::string first = host::makeTemporaryFolder(folder_.string(), "t-"),
                      second = host::makeTemporaryFolder(folder_.string(), "t-");
    EXPECT_TRUE(fs::is_directory(first) && fs::is_directory(second));
    EXPECT_NE(first, second);
    EXPECT_EQ(host::makeTemporaryFolder(path("nowhere"), "t-"), "");
}

TEST_F(System, LibrariesAreLoaded) {
    std::string why;
    EXPECT_EQ(host::openLibrary("no_such_library", why), nullptr);
    EXPECT_TRUE(contains(why, "no_such_library"));
    void* const loaded = host::openLibrary(library, why);
    ASSERT_NE(loaded, nullptr);
    EXPECT_NE(host::symbolIn(loaded, function), nullptr);
    EXPECT_EQ(host::symbolIn(loaded, "no_such_function"), nullptr);
    static const int here = 0;
    const std::string name = fs::path(host::programFile()).filename().string();
    EXPECT_EQ(fs::canonical(host::folderOf(&here) + name), fs::path(host::programFile()));
}
