// The only way in which this program writes files: a file appears complete or not at all, and the previous
// file stays until then.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace pellucid::io {

// A file under a temporary, random name beside its target: newly made, never through a link, and locked while
// its writer lives. write() adds to it, commit() renames it and flushes the folder. Without commit() the
// destructor removes it.
class AtomicFile {
  public:
    // Throws FileError if the folder is missing or not writable, or if a folder, a pipe or a device has this
    // name.
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

// Removes what killed programs left in a folder: temporary files that nobody locks, a minute after they were
// last written; and those of other machines, whose locks are not visible everywhere, after a day. Returns how
// many.
size_t removeAbandonedFiles(const std::string& folder);

// Throws FileError unless a file can be created or replaced at `path`; call it before long work. Removes
// abandoned files beside it.
void checkWritable(const std::string& path);

}  // namespace pellucid::io
