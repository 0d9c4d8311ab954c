// The command with non-files, full disks, names that are not UTF-8, and limits of the system.
#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "cli_run.h"
#include "io/atomic_file.h"

namespace {

// A tmpfs of so many KiB for this program and its children alone, until it ends. Mounting needs root.
class SmallDisk {
  public:
    explicit SmallDisk(size_t kibibytes) {
        char name[] = "/tmp/pellucid-disk-XXXXXX";
        if (!::mkdtemp(name)) throw std::runtime_error("no folder to mount on");
        folder_ = name;
        const std::string size = "size=" + std::to_string(kibibytes) + "k";
        mounted_ = ::unshare(CLONE_NEWNS) == 0 &&
                   ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                   ::mount("tmpfs", name, "tmpfs", 0, size.c_str()) == 0;
        if (!mounted_) why_ = std::strerror(errno);
    }
    ~SmallDisk() {
        if (mounted_) ::umount2(folder_.c_str(), MNT_DETACH);
        ::rmdir(folder_.c_str());
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;

    const std::string& why() const { return why_; }  // it is not mounted; "": it is
    std::string path(const std::string& name) const { return folder_ + "/" + name; }

    // Leaves so many bytes, in whole pages.
    void fill(size_t left) const {
        const size_t free = std::filesystem::space(folder_).available;
        std::ofstream file(path("filling"), std::ios::binary);
        file << std::string(free > left ? free - left : 0, 'x');
    }
    void empty() const {
        for (const auto& entry : std::filesystem::directory_iterator(folder_))
            std::filesystem::remove_all(entry);
    }
    // Names of the files, without that of fill().
    size_t files() const {
        size_t count = 0;
        for (const auto& entry : std::filesystem::directory_iterator(folder_))
            count += entry.path().filename() != "filling";
        return count;
    }

  private:
    std::string folder_, why_;
    bool mounted_ = false;
};

class Files : public CommandTest {
  protected:
    // Of this machine, as it stands in the names of temporary files.
    std::string tag() const {
        const pellucid::io::AtomicFile file(path("x"));
        for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
            const std::string name = entry.path().filename().string();
            if (name.starts_with(".x.")) return name.substr(3, 8);
        }
        return "";
    }
    void SetUp() override {
        CommandTest::SetUp();
        write("m.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
    }
};

}  // namespace

// The command starts without OpenImageIO's 250 libraries. tests/outside checks that they are found.
TEST_F(Files, PicturesAreAModuleOfTheirOwn) {
    const std::string libraries = cli("--version", "LD_TRACE_LOADED_OBJECTS=1").out;
    EXPECT_TRUE(contains(libraries, "libpellucid.so"));
    EXPECT_FALSE(contains(libraries, "OpenImageIO"));
    EXPECT_LT(std::ranges::count(libraries, '\n'), 40);
    for (const char* file : {"t.exr", "t.png", "t.bmp"})
        EXPECT_EQ(bool(contains(cli(std::string("lut specular --size 4x4 -o @") + file, "LD_DEBUG=files").err,
                                "OpenImageIO")),
                  file == std::string("t.bmp"));
}

TEST_F(Files, AFullDiskIsAnErrorOfEveryCommand) {
    const SmallDisk disk(256);
    if (!disk.why().empty())
        GTEST_SKIP() << "no tmpfs can be mounted here (" << disk.why() << "): run as root";
    write("m.toml", "[[lut]]\nsize = 64\nkind = \"shadow\"\n");
    const struct {
        std::string line, file;
        size_t pages = 2;  // of the disk, which its file takes at least
    } rows[] = {{"lut shadow --size 256x256 -o ", "o.png"},
                {"lut shadow --size 64x64 -o ", "o.bmp"},
                {"lut shadow --size 64x64 -o ", "o.tga"},
                {"lut shadow --size 64x64 -o ", "o.exr"},
                {"lut shadow --size 64x64 -o ", "o.npy"},
                {"lut shadow --size 64x64 -o ", "o.dds"},
                {"lut shadow --size 64x64 -o ", "o.ktx2"},
                {"curvature @m.off --weld none -o ", "o.npy", 1},
                {"curvature @m.off -o ", "o.ply", 1},
                {"curvature @m.off -o @o.npy --picture ", "o.png"},
                {"batch @m.toml -o ", "tables"}};
    for (const auto& [line, file, pages] : rows)
        for (size_t left = 0; left < pages; ++left) {
            SCOPED_TRACE(line + file + " with " + std::to_string(left) + " pages left");
            disk.empty();
            const std::string target = disk.path(file);
            const bool folder = file == "tables";
            if (folder)
                std::filesystem::create_directory(target);
            else
                std::ofstream(target) << "old";
            disk.fill(4096 * left);
            const Result result = cli(line + target);
            EXPECT_EQ(result.exitCode, 3);
            EXPECT_TRUE(contains(result.err, "cannot be written: No space left on device"));
            EXPECT_EQ(disk.files(), 1u) << "something is left behind";
            if (!folder) {
                EXPECT_EQ(read(target), "old");
            }
        }
    // The demo and the benchmark write several files.
    disk.empty();
    disk.fill(8192);
    const Result demo = cli("demo @m.off --size 64x48 -o " + disk.path("demo"));
    EXPECT_EQ(demo.exitCode, 3) << demo.err;
    EXPECT_TRUE(contains(demo.err, "No space left on device"));
    disk.empty();
    disk.fill(0);
    EXPECT_NE(cli("bench --quick --only table-shadow -o " + disk.path("bench")).exitCode, 0);
}

TEST_F(Files, ALimitOnTheSizeOfFilesIsLikeAFullDisk) {
    done("lut shadow -o @o.npy --size 512x512");  // the driver keeps its programs in files too
    std::filesystem::remove(path("o.npy"));
    refused("lut shadow -o @o.npy --size 512x512", 3, "File too large", "ulimit -f 2048; timeout 60");
}

TEST_F(Files, StandardOutputThatIsFullOrClosed) {
    for (const std::string line : {"profile list", "profile list --json", "profile show skin", "devices",
                                   "devices --json", "--help", "--version", "lut --help"})
        for (const char* to : {" >/dev/full", " >&-"})
            refused(line + to, 3, "standard output cannot be written", "timeout 60");
    // If standard output is closed, no file may get its descriptor.
    EXPECT_EQ(cli("lut shadow --size 8x8 -o @o.npy >&- 2>/dev/null").exitCode, 3);
    EXPECT_EQ(std::filesystem::file_size(path("o.npy")), 128 + 8 * 8 * 3 * 4u);
    done("profile list <&- >/dev/null 2>&-");
}

TEST_F(Files, ClosedStreamsThatNothingCanStandInFor) {
    const pid_t child = ::fork();
    if (child == 0) {
        const rlimit one{1, 1};  // open files
        for (int fd = 0; fd < 3; ++fd) ::close(fd);
        ::setrlimit(RLIMIT_NOFILE, &one);
        ::execl(PELLUCID_COMMAND, "pellucid", "--version", nullptr);
        ::_exit(0);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(WEXITSTATUS(status), 2);
}

TEST_F(Files, PipesAndDevicesAreNoFiles) {
    for (const std::string extension : {"toml", "off", "npy", "png", "json"}) {
        ASSERT_EQ(::mkfifo(path("pipe." + extension).c_str(), 0600), 0);
        std::filesystem::create_symlink("/dev/zero", path("zero." + extension));
    }
    std::filesystem::create_directory(path("o"));
    for (const auto& [name, what] :
         {std::pair<std::string, std::string>{"@pipe", "is a pipe"}, {"@zero", "is a device"}}) {
        for (const std::string& line :
             {"curvature " + name + ".off -o @o.npy", "profile show " + name + ".toml",
              "batch " + name + ".toml -o @o", "shade @g.exr -o @o.exr --scene " + name + ".toml",
              "warm-up " + name + ".toml", "bench compare " + name + ".json " + name + ".json"})
            refused(line, 3, what + ", not a file");
        refused("lut shadow -o " + name + ".npy", 2, what + "; the output must be the name of a file");
        refused("curvature @m.off -o @o.npy --picture " + name + ".png", 2, what);
    }
}

TEST_F(Files, NamesThatAreNoUtf8) {
    const std::string line = "lut shadow --size 8x8 -o @caf\xe9.npy";
    EXPECT_TRUE(contains(reportOf(line).at("output"), "caf\xef\xbf\xbd.npy"));
    EXPECT_TRUE(std::filesystem::exists(path("caf\xe9.npy")));
    EXPECT_TRUE(contains(done(line).out, "caf\xe9.npy"));
    EXPECT_TRUE(contains(reportOf("compare @caf\xe9.npy @caf\xe9.npy").at("a"), "caf\xef\xbf\xbd.npy"));
    write("b\xe9.toml", "[[lut]]\nsize = 0\n");
    const Result batch = cli("batch @b\xe9.toml -o @t --json");
    EXPECT_EQ(batch.exitCode, 3);
    EXPECT_TRUE(contains(batch.json().at("warnings").at(0), "b\xef\xbf\xbd.toml"));
}

TEST_F(Files, KeysWithoutEndAndBracketsWithoutEnd) {
    std::string key = "a";
    for (int i = 0; i < 31000; ++i) key += ".a";
    const std::string brackets = "a = " + std::string(31000, '[') + std::string(31000, ']') + "\n";
    for (const auto& [text, message] : {std::pair{key + " = 1\n", "a key has more than 1000 parts"},
                                        {"[" + key + "]\n", "a key has more than 1000 parts"},
                                        {"[[" + key + "]]\n", "a key has more than 1000 parts"},
                                        {"x = {" + key + " = 1}\n", "a key has more than 1000 parts"},
                                        {brackets, "maximum nested value depth of 256"}}) {
        write("d.toml", "version = 1\n" + text);
        for (const char* line :
             {"profile show @d.toml", "batch @d.toml -o @t", "shade @g.exr --scene @d.toml -o @o.exr",
              "warm-up @d.toml", "lut shadow --profile @d.toml -o @o.npy"}) {
            const Result result = cli(line);
            EXPECT_EQ(result.exitCode, 3) << line << result.err.substr(0, 200);
            EXPECT_TRUE(contains(result.err.substr(0, 500), message)) << line;
            EXPECT_TRUE(contains(result.err.substr(0, 500), "d.toml:2")) << line;
        }
    }
}

TEST_F(Files, ManifestsThatExpandWithoutLimit) {
    std::string radii = "1";
    for (int i = 2; i <= 1000; ++i) radii += ", " + std::to_string(i);
    write("m.toml", "[[grid]]\ndiffusion_radius = [" + radii + "]\nsize = [" + radii +
                        "]\nform = [\"arc\", \"sphere\"]\n[[lut]]\nsize = 8\n");
    const Result result = cli("batch @m.toml -o @t");
    EXPECT_EQ(result.exitCode, 3);
    EXPECT_TRUE(contains(result.err,
                         "asks for 2000000 tables; a manifest may ask for at most 1000000 in all; split it"));
    EXPECT_TRUE(contains(result.out, "1 tables: 1 made"));
}

TEST_F(Files, MoreJobsThanFileHandles) {
    std::string sizes = "4";
    for (int i = 5; i < 200; ++i) sizes += ", " + std::to_string(i);
    write("m.toml", "[[grid]]\nkind = \"shadow\"\nsize = [" + sizes + "]\n");
    EXPECT_TRUE(contains(done("batch @m.toml -j 256 -o @t", "ulimit -n 64; timeout 300").out,
                         "196 tables: 196 made"));
}

TEST_F(Files, WhatKilledCommandsLeftIsSwept) {
    for (const char* line : {"lut shadow --size 8x8 -o @o.exr", "curvature @m.off -o @o.ply"}) {
        // Made by a process that is killed in its write.
        const std::string left = path(".old." + tag() + "-0123456789abcdef.tmp.exr");
        const pid_t child = ::fork();
        if (child == 0) {
            const int fd = ::open(left.c_str(), O_CREAT | O_WRONLY, 0600);
            if (::write(fd, "half", 4) != 4) ::_exit(1);
            ::raise(SIGKILL);
        }
        ::waitpid(child, nullptr, 0);
        ASSERT_TRUE(std::filesystem::exists(left));
        std::filesystem::last_write_time(
            left, std::filesystem::file_time_type::clock::now() - std::chrono::seconds(90));
        done(line);
        EXPECT_FALSE(std::filesystem::exists(left)) << line << " sweeps nothing";
    }
}

TEST_F(Files, AFolderForKernelsThatCannotBeWrittenToIsNamed) {
    write("file", "");
    const std::string unset = "env -u XDG_CACHE_HOME -u POCL_CACHE_DIR ";
    done("devices", unset + "HOME=@file");
    done("devices", unset + "-u HOME");
    const Result result = cli("devices", "POCL_CACHE_DIR=@file");
    if (result.exitCode == 0) return;  // of a device that needs no folder
    EXPECT_EQ(result.exitCode, 4);
    EXPECT_TRUE(contains(result.err, "POCL_CACHE_DIR"));
    EXPECT_TRUE(contains(result.err, "file"));
}
