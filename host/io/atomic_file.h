// The one way to a file on the disk: it appears complete or not at all, and what stood there before stays
// until then.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace pellucid::io {

// A file under a temporary name beside its target: of random letters, made anew and never through a link,
// locked while its writer lives. write() puts it on the disk, commit() gives it its name and flushes the
// folder. Without commit() the destructor removes it.
class AtomicFile {
  public:
    // Throws FileError when the folder is missing or may not be written to, or when a folder, a pipe or a
    // device has this name.
    explicit AtomicFile(std::string target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    // Appends; throws FileError (disk full, …).
    void write(const void* bytes, size_t count);
    // Waits for the disk, renames, and waits until the folder is there too; throws FileError. Of many files in one folder each may leave
    // the folder out, and flushFolder() be called for all.
    void commit(bool folderToo = true);

  private:
    [[noreturn]] void fail(const char* what = "cannot be written: ") const;
    std::string target_, name_, temporary_;  // the last two without the folder
    int folder_ = -1, file_ = -1;
};

// All of it: an AtomicFile written and committed.
void writeWholeFile(const std::string& path, std::string_view bytes);

// Waits until the names in a folder are on the disk, where the file system can do that; throws FileError.
void flushFolder(const std::string& path);

// Removes what programs that were killed left in a folder: temporary files that nobody locks any more, a
// minute after they were last written, and those of other machines, whose locks are not seen everywhere,
// after a day. Returns how many.
size_t removeAbandonedFiles(const std::string& folder);

// Throws FileError unless a file can be created or replaced at `path`: call it before long work, not after.
// Removes abandoned files beside it.
void checkWritable(const std::string& path);

}  // namespace pellucid::io
