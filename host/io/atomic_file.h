// The only way to write files here: a file appears complete or not at all, and the old one stays until then.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace pellucid::io {

// A file under a temporary, random name beside its target: newly made, never through a link, locked while its
// writer lives. commit() renames it and flushes the folder; without it the destructor removes the file.
class AtomicFile {
  public:
    // Throws FileError if the folder is missing or not writable, or if the name is not that of a file.
    explicit AtomicFile(std::string target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    // Appends; throws FileError (disk full, …).
    void write(const void* bytes, size_t count);
    // Waits for the disk, renames, and waits until the folder is on the disk too; throws FileError. When many
    // files go to one folder, each may leave the folder out, and flushFolder() is called once for all.
    void commit(bool folderToo = true);

  private:
    [[noreturn]] void fail(const char* what = "cannot be written: ") const;
    std::string target_, name_, temporary_;  // the last two without the folder
    int folder_ = -1, file_ = -1;
};

// All steps: an AtomicFile, written and committed.
void writeWholeFile(const std::string& path, std::string_view bytes);

// Waits until the names in a folder are on the disk, if the file system can do that; throws FileError.
void flushFolder(const std::string& path);

// The part of temporary names that says whose locks this program can see: everything under this kernel,
// including containers. 8 hexadecimal digits.
const std::string& machineTag();

// Removes temporary files of killed programs from a folder, and returns how many: those that nobody locks, a
// minute after the last write, and those of other machines, whose locks may not be visible, after a day.
size_t removeAbandonedFiles(const std::string& folder);

// Throws FileError unless `path` can be written; call it before long work. Removes abandoned files, too.
void checkWritable(const std::string& path);

// For the sources of each system. A name .STEM.MACHINE-RANDOM.tmp.EXTENSION that nobody can predict, shorter
// than any file system's limit:
std::string temporaryName(const std::string& name);
// The files of such names in a folder, and after how many seconds without a write they count as abandoned.
struct TemporaryFile {
    std::string name;
    double abandonedAfter;
};
std::vector<TemporaryFile> temporaryFiles(const std::string& folder);
std::string folderOf(const std::string& path);
void refuseOtherThanFile(const std::string& path);

}  // namespace pellucid::io
