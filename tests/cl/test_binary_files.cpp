// Files of compiled programs: complete or absent, and no more than the limit.
#include <sys/stat.h>

#include "cl/binary_files.h"
#include "io/io_files.h"
#include "system/process.h"
#include "variable.h"

namespace fs = std::filesystem;
using pel::cl::BinaryFiles;
using pel::cl::Digest;

namespace {

class BinaryFile : public FolderTest {
  protected:
    std::vector<fs::path> files(const std::string& folder = "cache") const {
        std::vector<fs::path> found;
        std::error_code none;
        for (const auto& entry : fs::directory_iterator(path(folder), none)) found.push_back(entry.path());
        return found;
    }
    static std::string contents(const fs::path& file) { return read(file.string()); }
    static void damage(const fs::path& file, const std::string& text) {
        std::ofstream(file, std::ios::binary) << text;
    }
    static void age(const fs::path& file, int hours) {
        fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(hours));
    }
};

std::string temporaryOf(const Digest& name) {
    return std::string(".").append(name.text()).append(".bin.1-1.tmp");
}

const Digest one = Digest().add("one"), two = Digest().add("two"), three = Digest().add("three");

}  // namespace

TEST_F(BinaryFile, DigestIsXxh3OfAllThatWasAdded) {
    EXPECT_EQ(Digest().text(), "99aa06d3014798d86001c324468d497f");
    EXPECT_EQ(Digest().add("a").add("bc").text(), Digest().add("abc").text());
    EXPECT_EQ(Digest().add("abc").text(), "06b05ab6733a618578af5f94892f3950");
    EXPECT_NE(Digest().addPart("ab").addPart("c").text(), Digest().addPart("a").addPart("bc").text());
}

TEST_F(BinaryFile, KeepsWhatWasStoredAndNothingElse) {
    const BinaryFiles store(path("cache"), 1 << 20);
    const std::string binary = std::string("machine\0code", 12) + std::string(70000, 'x');
    EXPECT_FALSE(store.load(one));
    ASSERT_TRUE(store.store(one, binary));
    EXPECT_EQ(store.load(one), binary);
    EXPECT_FALSE(store.load(two));
    EXPECT_FALSE(store.store(two, ""));
    ASSERT_EQ(files().size(), 1u) << "nothing temporary is left";
    struct stat status {};
    ASSERT_EQ(::stat(path("cache").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0700u);
    const fs::path file = files()[0];
    EXPECT_EQ(file.filename(), one.text() + ".bin");
    const std::string good = contents(file);
    // Every byte counts, and so does every length.
    for (const size_t at :
         {size_t{0}, size_t{9}, size_t{20}, size_t{25}, size_t{40}, size_t{60}, good.size() - 1}) {
        std::string bad = good;
        bad[at] = char(bad[at] ^ 4);
        damage(file, bad);
        EXPECT_FALSE(store.load(one)) << "byte " << at;
    }
    for (const std::string& bad :
         {std::string(), good.substr(0, 10), good.substr(0, good.size() - 1), good + "x"}) {
        damage(file, bad);
        EXPECT_FALSE(store.load(one)) << bad.size() << " bytes";
    }
    damage(fs::path(path("cache")) / (two.text() + ".bin"), good);
    EXPECT_FALSE(store.load(two)) << "another program's file under this name";
    damage(file, good);
    EXPECT_EQ(store.load(one), binary);
    fs::remove(file);
    ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
    EXPECT_FALSE(store.load(one)) << "a pipe";
    ASSERT_TRUE(store.store(one, binary)) << "is replaced";
    EXPECT_EQ(store.load(one), binary);
}

TEST_F(BinaryFile, OldestGoWhenThereIsTooMuch) {
    const BinaryFiles store(path("cache"), 2500);
    const std::string kilobyte(1000, 'k');
    const auto file = [&](const Digest& name) { return fs::path(path("cache")) / (name.text() + ".bin"); };
    ASSERT_TRUE(store.store(one, kilobyte));
    ASSERT_TRUE(store.store(two, kilobyte));
    age(file(one), 3);
    age(file(two), 2);
    EXPECT_TRUE(store.load(one)) << "used again: younger now";
    write("cache/note.txt", std::string(9000, 'n'));
    damage(fs::path(path("cache")) / temporaryOf(one), "left by a process that was killed");
    damage(fs::path(path("cache")) / temporaryOf(two), "of one that still writes");
    age(fs::path(path("cache")) / temporaryOf(one), 2);
    ASSERT_TRUE(store.store(three, kilobyte));
    EXPECT_TRUE(store.load(one));
    EXPECT_TRUE(store.load(three));
    EXPECT_FALSE(store.load(two));
    EXPECT_TRUE(fs::exists(path("cache/note.txt"))) << "nobody else's files";
    EXPECT_EQ(files().size(), 4u) << "two programs, the note, and what is being written";
    EXPECT_FALSE(store.store(two, std::string(3000, 'k'))) << "more than there may be";
}

TEST_F(BinaryFile, WhereItIs) {
    const auto folder = [](const char* own, const char* xdg, const char* home) {
        const Variable ours("PELLUCID_CACHE_DIR", own), caches("XDG_CACHE_HOME", xdg), user("HOME", home);
        return pel::system::cacheFolder().string();
    };
    EXPECT_EQ(folder(nullptr, nullptr, "/home/x"), "/home/x/.cache/pellucid");
    EXPECT_EQ(folder(nullptr, "/var/c", "/home/x"), "/var/c/pellucid");
    EXPECT_EQ(folder(nullptr, "relative", "/home/x"), "/home/x/.cache/pellucid");
    EXPECT_EQ(folder("/mine", "/var/c", "/home/x"), "/mine");
    for (const char* off : {"", "0", "off"}) EXPECT_EQ(folder(off, "/var/c", "/home/x"), "");
    // Without HOME, in the user's home folder according to the system.
    const std::string system = folder(nullptr, nullptr, nullptr);
    EXPECT_TRUE(system.starts_with("/") && system.ends_with("/.cache/pellucid")) << system;
}
