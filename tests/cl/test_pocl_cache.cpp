// PoCL's folder of compiled kernels: private to this user, without files that would crash PoCL.
#include <fcntl.h>
#include <sched.h>
#include <sys/file.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include "cl/machine.h"
#include "cl/pocl_cache.h"
#include "core/in_fork.h"
#include "io/io_files.h"
#include "system/process.h"
#include "variable.h"

namespace fs = std::filesystem;
using pel::cl::whyNotPrivate;

namespace {

class PoclCache : public FolderTest {
  protected:
    // Of a process that is the first to use OpenCL: 0, or the error of a small table that is made there after
    // `set` was called.
    int table(const std::function<void()>& set) {
        return inFork([&]() -> int { std::exit(tableHere(set)); });
    }
    int tableHere(const std::function<void()>& set) {
        ::unsetenv("POCL_CACHE_DIR");
        ::unsetenv("XDG_CACHE_HOME");
        ::setenv("HOME", path("home").c_str(), 1);
        set();
        try {
            const pellucid::Device device("");
            PelSpecularLutDesc desc = pelSpecularLutDescDefaults();
            desc.width = desc.height = 4;
            pellucid::Lut(device, desc).read<float>(PEL_LUT_FLOAT);
            if (std::getenv("POCL_CACHE_DIR") && fs::path(std::getenv("POCL_CACHE_DIR")) != path("own"))
                throw pellucid::Error(PEL_ERROR_UNKNOWN, "the environment was left changed");
        } catch (const pellucid::Error& e) {
            std::ofstream(path("message")) << e.what();
            return e.code();
        }
        return 0;
    }
    std::vector<fs::path> kernels(const fs::path& below, const std::string& extension) const {
        std::vector<fs::path> found;
        std::error_code none;
        for (const auto& entry : fs::recursive_directory_iterator(below, none))
            if (entry.path().extension() == extension) found.push_back(entry.path());
        return found;
    }
    static mode_t mode(const fs::path& at) {
        struct stat status {};
        return ::stat(at.c_str(), &status) == 0 ? status.st_mode & 07777 : 0;
    }
    void SetUp() override {
        FolderTest::SetUp();
        const bool other = inFork([] {
            return std::string(pellucid::Device("").info().platform) != "Portable Computing Language";
        });
        if (other) GTEST_SKIP() << "the device is no PoCL";
        fs::create_directory(path("home"));
        fs::permissions(path("home"), fs::perms::owner_all);
    }
    fs::path ours() const { return fs::path(path("home")) / ".cache/pellucid/pocl"; }
};

}  // namespace

TEST_F(PoclCache, IsAPrivateFolderOfOurs) {
    ASSERT_EQ(table([] {}), 0);
    EXPECT_GE(kernels(ours(), ".so").size(), 1u);
    EXPECT_EQ(mode(ours()), 0700u);
    EXPECT_EQ(mode(ours().parent_path()), 0700u);
    EXPECT_FALSE(fs::exists(fs::path(path("home")) / ".cache/pocl"));
    // Whole files are kept.
    const auto before = kernels(ours(), ".so");
    std::vector<fs::file_time_type> times;
    for (const auto& file : before) times.push_back(fs::last_write_time(file));
    ASSERT_EQ(table([] {}), 0);
    fs::remove(ours() / "checked");
    EXPECT_EQ(pel::cl::removeDamagedPrograms(ours()), 0u);
    for (size_t i = 0; i < before.size(); ++i)
        EXPECT_EQ(fs::last_write_time(before[i]), times[i]) << "compiled again";
}

TEST_F(PoclCache, TheUsersOwnIsLeftAlone) {
    fs::create_directory(path("own"));
    ASSERT_EQ(table([&] { ::setenv("POCL_CACHE_DIR", path("own").c_str(), 1); }), 0);
    EXPECT_GE(kernels(path("own"), ".so").size(), 1u);
    EXPECT_FALSE(fs::exists(ours()));
}

// A folder open to others, another user's, a file, a link: none is used, and nothing is left in /tmp.
TEST_F(PoclCache, FoldersOfOthersAreRefused) {
    fs::create_directory(path("temporary"));
    fs::permissions(path("temporary"), fs::perms::owner_all);
    const auto set = [&] { ::setenv("TMPDIR", path("temporary").c_str(), 1); };
    fs::create_directories(ours());
    for (const mode_t open : {0777, 0770, 0707, 01777}) {
        ::chmod(ours().c_str(), open);
        EXPECT_EQ(table(set), 0) << std::oct << open;
    }
    ::chmod(ours().c_str(), 0700);
    ::chmod(path("home").c_str(), 0777);  // where the folder could be exchanged
    EXPECT_EQ(table(set), 0);
    ::chmod(path("home").c_str(), 0700);
    if (::geteuid() == 0) {
        ASSERT_EQ(::chown(ours().c_str(), 12345, 12345), 0);
        EXPECT_EQ(table(set), 0);
    }
    EXPECT_EQ(kernels(ours(), ".so").size(), 0u);
    fs::remove_all(ours());
    std::ofstream(ours()) << "a file";
    EXPECT_EQ(table(set), 0);
    if (::geteuid() == 0) {  // a user without a home
        ASSERT_EQ(::chown(path("temporary").c_str(), 12345, 12345), 0);
        ASSERT_EQ(::chmod(path("home").c_str(), 0700), 0);
        for (const char* name : {"temporary", "none"})
            EXPECT_EQ(table([&] {
                          ::setenv("TMPDIR", path(name).c_str(), 1);
                          if (::setuid(12345) != 0) throw pellucid::Error(PEL_ERROR_UNKNOWN, "setuid");
                      }),
                      0)
                << name;
    }
    EXPECT_TRUE(fs::is_empty(path("temporary"))) << "its own folder went with the process";
}

TEST_F(PoclCache, WithoutHomeNothingInTheTemporaryFolderIsTrusted) {
    // What PoCL would use, by its name.
    const fs::path fixed = "/tmp/pocl";
    const bool there = fs::exists(fixed);
    EXPECT_EQ(table([&] {
                  ::unsetenv("HOME");
                  ::setenv("XDG_CACHE_HOME", path("home").c_str(), 1);
              }),
              0);
    EXPECT_GE(kernels(fs::path(path("home")) / "pellucid/pocl", ".so").size(), 1u);
    const auto homes = pel::system::cacheHomes();
    const Variable home("HOME", nullptr);
    EXPECT_FALSE(pel::system::cacheHomes().empty()) << "the system knows";
    for (const fs::path& each : pel::system::cacheHomes()) EXPECT_TRUE(each.is_absolute());
    EXPECT_EQ(fs::exists(fixed), there);
}

TEST_F(PoclCache, DamagedFilesAreCompiledAgain) {
    ASSERT_EQ(table([] {}), 0);
    for (const char* extension : {".so", ".bc"})
        for (const std::string how : {"empty", "half", "other"}) {
            const auto files = kernels(ours(), extension);
            ASSERT_GE(files.size(), 1u);
            for (const fs::path& file : files) {
                const auto size = fs::file_size(file);
                if (how == "other")
                    std::ofstream(file, std::ios::binary) << std::string(size, 'x');
                else
                    fs::resize_file(file, how == "half" ? size / 2 : 0);
            }
            EXPECT_EQ(table([] {}), 0) << extension << " " << how;
            EXPECT_GE(kernels(ours(), extension).size(), 1u);
            // And again, if the last check is later than the damage could be.
            EXPECT_EQ(pel::cl::removeDamagedPrograms(ours()), 0u) << extension << " " << how;
        }
}

// Of a 32-bit library the table of sections is elsewhere.
TEST_F(PoclCache, LibrariesOfOtherMachinesAreLeftAlone) {
    for (const char width : {1, 2}) {
        const fs::path program = fs::path(path("programs")) / "ab" / std::string(1, 'c' + width);
        fs::create_directories(program);
        std::string elf(64, '\x7f');
        elf.replace(0, 5, {'\x7f', 'E', 'L', 'F', width});
        std::ofstream(program / "kernel.so", std::ios::binary) << elf;
    }
    EXPECT_EQ(pel::cl::removeDamagedPrograms(path("programs")), 1u);
    EXPECT_TRUE(fs::exists(path("programs") + "/ab/d/kernel.so"));
}

// A large cache is not searched: only programs that were used can be damaged.
TEST_F(PoclCache, ProgramsThatNobodyUsesAreNotRead) {
    ASSERT_EQ(table([] {}), 0);
    pel::cl::removeDamagedPrograms(ours());
    const auto now = fs::file_time_type::clock::now();
    const auto damage = [&](std::chrono::minutes lastUse) {
        size_t programs = 0;
        for (const fs::path& file : kernels(ours(), ".so")) fs::resize_file(file, 0);
        for (const fs::path& file : kernels(ours(), ""))
            if (file.filename() == "last_accessed") fs::last_write_time(file, now - lastUse), ++programs;
        return programs;
    };
    const size_t programs = damage(std::chrono::minutes(11));
    ASSERT_GE(programs, 1u);
    EXPECT_EQ(pel::cl::removeDamagedPrograms(ours()), 0u);
    damage(std::chrono::minutes(9));
    EXPECT_EQ(pel::cl::removeDamagedPrograms(ours()), programs);

    // If the machine has restarted since, it may have lost power before all was on its disk.
    ASSERT_EQ(table([] {}), 0);
    damage(std::chrono::minutes(11));
    fs::last_write_time(ours() / "checked", now - std::chrono::years(10));
    EXPECT_EQ(pel::cl::removeDamagedPrograms(ours()), programs);
}

// PoCL's own temporary files in the folder, and folders of this library for a single process.
TEST_F(PoclCache, WhatKilledProcessesLeaveIsRemoved) {
    const auto age = [](const fs::path& at, std::chrono::minutes by) {
        fs::last_write_time(at, fs::file_time_type::clock::now() - by);
    };
    fs::create_directories(ours() / "tempdir_old");
    for (const char* name : {"tempfile_old.so", "tempfile_old.so.o", "tempfile_new.so", "note"})
        std::ofstream(ours() / name) << "half a file";
    for (const char* name : {"tempfile_old.so", "tempfile_old.so.o", "tempdir_old", "note"})
        age(ours() / name, std::chrono::minutes(90));
    pel::cl::removeDamagedPrograms(ours());
    std::set<std::string> left;
    for (const auto& entry : fs::directory_iterator(ours())) left.insert(entry.path().filename().string());
    EXPECT_EQ(left, (std::set<std::string>{"checked", "note", "tempfile_new.so"}));

    const fs::path temporary = path("temporary");
    for (const char* name : {"pellucid-pocl-killed", "pellucid-pocl-running", "pellucid-pocl-new", "other"})
        fs::create_directories(temporary / name);
    std::ofstream(temporary / "pellucid-pocl-killed" / "program.bc") << "half a file";
    const int running = ::open((temporary / "pellucid-pocl-running").c_str(), O_RDONLY);
    ASSERT_EQ(::flock(running, LOCK_SH), 0);
    for (const char* name : {"pellucid-pocl-killed", "pellucid-pocl-running", "other"})
        age(temporary / name, std::chrono::minutes(2));
    const fs::path made = pel::system::makeTemporaryFolder(temporary, "pellucid-pocl-");
    EXPECT_EQ(mode(made), 0700u);
    age(made, std::chrono::minutes(2));
    const std::string second = pel::system::makeTemporaryFolder(temporary, "pellucid-pocl-");
    EXPECT_TRUE(fs::remove(made)) << "it is locked";
    EXPECT_TRUE(fs::remove(second));
    ::close(running);
    left.clear();
    for (const auto& entry : fs::directory_iterator(temporary)) left.insert(entry.path().filename().string());
    EXPECT_EQ(left, (std::set<std::string>{"pellucid-pocl-running", "pellucid-pocl-new", "other"}));
}

// Mounting needs a name space of its own: skipped where that is not allowed.
TEST_F(PoclCache, AFullDiskIsAnError) {
    fs::create_directory(path("full"));
    const auto mountIt = [&] {
        if (::unshare(CLONE_NEWNS) != 0 || ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
            ::mount("tmpfs", path("full").c_str(), "tmpfs", 0, "size=4m,mode=700") != 0)
            ::_exit(99);
    };
    const int own = table([&] {
        mountIt();
        ::setenv("POCL_CACHE_DIR", path("full").c_str(), 1);
    });
    if (own == 99) GTEST_SKIP() << "this user may not mount";
    EXPECT_EQ(own, PEL_ERROR_DEVICE);
    EXPECT_NE(read(path("message")).find(path("full")), std::string::npos) << read(path("message"));
    // Where the user set no folder, another one is taken.
    EXPECT_EQ(table([&] {
                  mountIt();
                  ::setenv("HOME", path("full").c_str(), 1);
                  ::setenv("XDG_CACHE_HOME", path("full").c_str(), 1);
              }),
              0);
}

TEST(PrivateFolder, LooksAtAllAbove) {
    EXPECT_EQ(whyNotPrivate("/"), "");
    EXPECT_NE(whyNotPrivate("/tmp"), "") << "others write there";
    EXPECT_NE(whyNotPrivate("/no such folder"), "");
    EXPECT_NE(whyNotPrivate("/etc/passwd"), "") << "no folder";
}
