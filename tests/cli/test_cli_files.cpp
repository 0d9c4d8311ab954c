// What the command does with files that are none, disks that are full, names that are no text, and limits of
// the system.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

#include "cli_run.h"
#include "io/atomic_file.h"
#include "io/small_disk.h"

namespace {

class Files : public CommandTest {
  protected:
    const std::string mesh_ = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

    // Of this machine, as it stands in the names of temporary files.
    std::string tag() const {
        const pellucid::io::AtomicFile file(path("x"));
        for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
            const std::string name = entry.path().filename().string();
            if (name.starts_with(".x.")) return name.substr(3, 8);
        }
        return "";
    }
    static int shell(const std::string& line) {
        const int status = std::system(line.c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    // Runs the command with redirections of its own.
    int redirected(const std::string& arguments, const std::string& redirections) const {
        return shell("timeout 60 '" + std::string(PELLUCID_COMMAND) + "' " + arguments + " " + redirections);
    }
};

}  // namespace

// Some 250 libraries come with OpenImageIO; the command starts without them. tests/outside checks that they
// are found.
TEST_F(Files, PicturesAreAModuleOfTheirOwn) {
    const std::string libraries = run({"--version"}, "LD_TRACE_LOADED_OBJECTS=1").out;
    EXPECT_TRUE(contains(libraries, "libpellucid.so"));
    EXPECT_FALSE(contains(libraries, "OpenImageIO"));
    EXPECT_LT(std::ranges::count(libraries, '\n'), 40);
    EXPECT_FALSE(contains(
        run({"lut", "specular", "--size", "4x4", "-o", path("t.exr")}, "LD_DEBUG=files").err, "OpenImageIO"));
    EXPECT_TRUE(contains(run({"lut", "specular", "--size", "4x4", "-o", path("t.png")}, "LD_DEBUG=files").err,
                         "OpenImageIO"));
}

TEST_F(Files, AFullDiskIsAnErrorOfEveryCommand) {
    const SmallDisk disk(256);
    NEEDS_DISK(disk);
    const std::string mesh = write("m.off", mesh_);
    const std::vector<std::vector<std::string>> commands = {
        {"lut", "shadow", "-o", disk.path("o.png"), "--size", "256x256"},
        {"lut", "shadow", "-o", disk.path("o.bmp"), "--size", "64x64"},
        {"lut", "shadow", "-o", disk.path("o.tga"), "--size", "64x64"},
        {"lut", "shadow", "-o", disk.path("o.exr"), "--size", "64x64"},
        {"lut", "shadow", "-o", disk.path("o.npy"), "--size", "64x64"},
        {"lut", "shadow", "-o", disk.path("o.dds"), "--size", "64x64"},
        {"lut", "shadow", "-o", disk.path("o.ktx2"), "--size", "64x64", "--encoding", "bc6h"},
        {"curvature", mesh, "-o", disk.path("o.npy"), "--weld", "none"},
        {"curvature", mesh, "-o", disk.path("o.ply")},
        {"curvature", mesh, "-o", path("o.npy"), "--picture", disk.path("o.png")},
        {"profile", "plot", "skin", "-o", disk.path("o.png")},
        {"profile", "fit", "skin", "-o", disk.path("o.toml"), "--gaussians", "2"},
        {"batch", write("m.toml", "[[lut]]\nsize = 64\nkind = \"shadow\"\n"), "-o", disk.path("tables")}};
    for (size_t left : {size_t{0}, size_t{4096}})
        for (const auto& command : commands) {
            disk.empty();
            std::filesystem::create_directory(disk.path("tables"));
            disk.fill(left);
            const bool small =
                command[0] == "curvature" && command[3].starts_with(disk.path("o.")) && left > 0;
            const bool text = command[1] == "fit" && left > 0;
            const Result result = run(command);
            if (small || text) continue;  // a page holds it
            EXPECT_EQ(result.exitCode, 3)
                << command[0] << " " << command.back() << " with " << left << " bytes left";
            EXPECT_TRUE(contains(result.err, "cannot be written: No space left on device")) << command[0];
            EXPECT_EQ(disk.files(), 1u) << command[0] << " leaves something behind";
        }
    // The demo and the benchmark write several files.
    disk.empty();
    disk.fill(8192);
    const Result demo = run({"demo", mesh, "-o", disk.path("demo"), "--size", "64x48"});
    EXPECT_EQ(demo.exitCode, 3) << demo.err;
    EXPECT_TRUE(contains(demo.err, "No space left on device"));
    disk.empty();
    disk.fill(4096);
    const Result bench = run({"bench", "-o", disk.path("bench"), "--quick", "--only", "table-shadow"});
    EXPECT_NE(bench.exitCode, 0);
}

TEST_F(Files, ALimitOnTheSizeOfFilesIsLikeAFullDisk) {
    // The driver keeps its programs in files too.
    ASSERT_EQ(run({"lut", "shadow", "-o", path("o.npy"), "--size", "512x512"}).exitCode, 0);
    std::filesystem::remove(path("o.npy"));
    EXPECT_EQ(shell("ulimit -f 2048; timeout 60 '" PELLUCID_COMMAND "' lut shadow -o '" + path("o.npy") +
                    "' --size 512x512 2>'" + path("said") + "' >/dev/null"),
              3);
    EXPECT_TRUE(contains(read(path("said")), "File too large"));
    EXPECT_FALSE(std::filesystem::exists(path("o.npy")));
}

TEST_F(Files, StandardOutputThatIsFullOrClosed) {
    for (const char* arguments : {"profile list", "profile list --json", "profile show skin", "devices",
                                  "devices --json", "--help", "--version", "lut --help"})
        for (const char* to : {">/dev/full", ">&-"}) {
            EXPECT_EQ(redirected(arguments, std::string(to) + " 2>'" + path("said") + "'"), 3)
                << arguments << to;
            EXPECT_TRUE(contains(read(path("said")), "standard output cannot be written")) << arguments << to;
        }
    // A file does not become standard output because that was closed.
    EXPECT_EQ(redirected("lut shadow --size 8x8 -o '" + path("o.npy") + "'", ">&- 2>/dev/null"), 3);
    EXPECT_EQ(std::filesystem::file_size(path("o.npy")), 128 + 8 * 8 * 3 * 4u);
    EXPECT_EQ(redirected("profile list", "<&- >/dev/null 2>&-"), 0);
}

TEST_F(Files, PipesAndDevicesAreNoFiles) {
    ASSERT_EQ(::mkfifo(path("pipe.exr").c_str(), 0600), 0);
    std::filesystem::create_symlink("/dev/zero", path("zero.exr"));
    for (const char* extension : {"toml", "off", "npy", "png", "json"}) {
        ASSERT_EQ(::mkfifo(path(std::string("pipe.") + extension).c_str(), 0600), 0);
        std::filesystem::create_symlink("/dev/zero", path(std::string("zero.") + extension));
    }
    std::filesystem::create_directory(path("o"));
    const std::string scene = write("s.toml", "version = 1\n");
    for (const auto& [name, what] : {std::pair<std::string, const char*>{"pipe", "is a pipe, not a file"},
                                     {"zero", "is a device, not a file"}}) {
        expectRefused({"curvature", path(name + ".off"), "-o", path("o.npy")}, 3, what);
        expectRefused({"profile", "show", path(name + ".toml")}, 3, what);
        expectRefused({"batch", path(name + ".toml"), "-o", path("o")}, 3, what);
        expectRefused({"shade", path("g.exr"), "--scene", path(name + ".toml"), "-o", path("o.exr")}, 3,
                      what);
        expectRefused({"warm-up", path(name + ".toml")}, 3, what);
        expectRefused({"bench", "compare", path(name + ".json"), path(name + ".json")}, 3, what);
    }
    expectRefused({"lut", "shadow", "-o", path("pipe.npy")}, 2,
                  "is a pipe; the output must be the name of a file");
    expectRefused({"lut", "shadow", "-o", path("zero.npy")}, 2,
                  "is a device; the output must be the name of a file");
    expectRefused({"curvature", write("m.off", mesh_), "-o", path("o.npy"), "--picture", path("zero.png")}, 2,
                  "is a device");
}

TEST_F(Files, NamesThatAreNoUtf8) {
    const std::string name = path("caf\xe9.npy");
    const Result result = run({"lut", "shadow", "--size", "8x8", "-o", name, "--json"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_TRUE(contains(result.json().at("output"), "caf\xef\xbf\xbd.npy"));
    EXPECT_TRUE(std::filesystem::exists(name));
    const Result text = run({"lut", "shadow", "--size", "8x8", "-o", name});
    EXPECT_TRUE(contains(text.out, "caf\xe9.npy"));
    const std::string bad = write("b\xe9.toml", "[[lut]]\nsize = 0\n");
    const Result batch = run({"batch", bad, "-o", path("t"), "--json"});
    EXPECT_EQ(batch.exitCode, 3);
    EXPECT_TRUE(contains(batch.json().at("warnings").at(0), "b\xef\xbf\xbd.toml"));
}

TEST_F(Files, WhatStandsInATextIsNeitherAKeyNorABracket) {
    std::string text = std::string(40, '[') + std::string(40, '{');
    for (int i = 0; i < 40; ++i) text += ".a";
    for (const std::string& source :
         {'"' + text + " # \\\" " + text + '"', "'" + text + " \\'",
          "\"\"\"" + text + "\" \"\"" + text + "\"\"\"", "'''\n" + text + "''''"}) {
        const std::string file =
            write("t.toml", "name = \"t\"\nkind = \"gaussians\"\nunit = \"mm\"\nsource = " + source +
                                "\n[[gaussian]] # " + text + "\nvariance = 1\nweight = [1, 1, 1]\n");
        const Result result = run({"profile", "show", file, "--json"});
        ASSERT_EQ(result.exitCode, 0) << source << "\n" << result.err;
        EXPECT_TRUE(contains(result.json()["source"].get<std::string>(), text)) << source;
    }
}

TEST_F(Files, KeysWithoutEndAndBracketsWithoutEnd) {
    std::string key = "a";
    for (int i = 0; i < 31000; ++i) key += ".a";
    const std::string brackets = "a = " + std::string(31000, '[') + std::string(31000, ']') + "\n";
    for (const auto& [text, message] : {std::pair{key + " = 1\n", "a key has more than 16 parts"},
                                        {"[" + key + "]\n", "a key has more than 16 parts"},
                                        {"[[" + key + "]]\n", "a key has more than 16 parts"},
                                        {"x = {" + key + " = 1}\n", "a key has more than 16 parts"},
                                        {brackets, "nested more than 16 deep"}}) {
        const std::string file = write("d.toml", "version = 1\n" + text);
        for (const auto& command : {std::vector<std::string>{"profile", "show", file},
                                    {"batch", file, "-o", path("t")},
                                    {"shade", path("g.exr"), "--scene", file, "-o", path("o.exr")},
                                    {"warm-up", file},
                                    {"lut", "shadow", "--profile", file, "-o", path("o.npy")}}) {
            const Result result = run(command);
            EXPECT_EQ(result.exitCode, 3) << command[0] << result.err.substr(0, 200);
            EXPECT_TRUE(contains(result.err.substr(0, 500), message)) << command[0];
            EXPECT_TRUE(contains(result.err.substr(0, 500), "d.toml:2")) << command[0];
        }
    }
}

TEST_F(Files, ManifestsThatExpandWithoutLimit) {
    std::string radii = "1";
    for (int i = 2; i <= 1000; ++i) radii += ", " + std::to_string(i);
    const std::string grid = "[[grid]]\ndiffusion_radius = [" + radii + "]\nsize = [" + radii +
                             "]\nform = [\"arc\", \"sphere\"]\n";
    const Result result = run({"batch", write("m.toml", grid + "[[lut]]\nsize = 8\n"), "-o", path("t")});
    EXPECT_EQ(result.exitCode, 3);
    EXPECT_TRUE(
        contains(result.err, "asks for 2000000 tables, and a manifest may ask for 1000000 in all; split it"));
    EXPECT_TRUE(contains(result.out, "1 tables: 1 made"));
}

TEST_F(Files, MoreJobsThanFileHandles) {
    std::string sizes = "4";
    for (int i = 5; i < 200; ++i) sizes += ", " + std::to_string(i);
    const std::string manifest = write("m.toml", "[[grid]]\nkind = \"shadow\"\nsize = [" + sizes + "]\n");
    EXPECT_EQ(shell("ulimit -n 64; timeout 300 '" PELLUCID_COMMAND "' batch '" + manifest + "' -j 256 -o '" +
                    path("t") + "' >'" + path("out") + "' 2>'" + path("err") + "'"),
              0)
        << read(path("err"));
    EXPECT_TRUE(contains(read(path("out")), "196 tables: 196 made"));
}

TEST_F(Files, WhatKilledCommandsLeftIsSwept) {
    const std::string mesh = write("m.off", mesh_);
    const std::vector<std::vector<std::string>> commands = {
        {"lut", "shadow", "--size", "8x8", "-o", path("o.exr")},
        {"curvature", mesh, "-o", path("o.ply")},
        {"demo", mesh, "-o", folder_.string(), "--size", "32x24"},
        {"profile", "plot", "skin", "-o", path("o.png")},
        {"profile", "fit", "marble", "--gaussians", "1", "-o", path("o.toml")}};
    for (const auto& command : commands) {
        // Made by a process that is killed in its write.
        const pid_t child = ::fork();
        if (child == 0) {
            const std::string file = path(".old." + tag() + "-0123456789abcdef.tmp.exr");
            const int fd = ::open(file.c_str(), O_CREAT | O_WRONLY, 0600);
            if (::write(fd, "half", 4) != 4) ::_exit(1);
            ::raise(SIGKILL);
        }
        int status = 0;
        ::waitpid(child, &status, 0);
        const std::string left = path(".old." + tag() + "-0123456789abcdef.tmp.exr");
        ASSERT_TRUE(std::filesystem::exists(left));
        std::filesystem::last_write_time(
            left, std::filesystem::file_time_type::clock::now() - std::chrono::seconds(90));
        const Result result = run(command);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        EXPECT_FALSE(std::filesystem::exists(left)) << command[0] << " sweeps nothing";
    }
}

TEST_F(Files, AFolderForKernelsThatCannotBeWrittenToIsNamed) {
    write("file", "");
    const std::string unset = "env -u XDG_CACHE_HOME -u POCL_CACHE_DIR ";
    EXPECT_EQ(run({"devices"}, unset + "HOME='" + path("file") + "'").exitCode, 0);
    EXPECT_EQ(run({"devices"}, unset + "-u HOME").exitCode, 0);
    const Result result = run({"devices"}, "POCL_CACHE_DIR='" + path("file") + "'");
    if (result.exitCode == 0) return;  // of a device that needs no folder
    EXPECT_EQ(result.exitCode, 4);
    EXPECT_TRUE(contains(result.err, "POCL_CACHE_DIR"));
    EXPECT_TRUE(contains(result.err, "file"));
}
