// A small file system in memory, to be filled.
#pragma once
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

// A tmpfs of so many KiB, which only this program and its children see. It ends with the program. Mounting
// needs root.
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

    bool mounted() const { return mounted_; }
    const std::string& why() const { return why_; }
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

#define NEEDS_DISK(disk)   \
    if (!(disk).mounted()) \
    GTEST_SKIP() << "no tmpfs can be mounted here (" << (disk).why() << "): run as root"
