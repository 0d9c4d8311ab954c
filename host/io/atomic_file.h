// Files that appear complete or not at all.
#pragma once
#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>

namespace pellucid::io {

// A file under a temporary name beside its target. Write to temporaryPath(), then commit(): it is flushed to
// the disk and renamed. Without commit() the destructor removes it, and what stood at the target stays as it
// was.
class AtomicFile {
  public:
    explicit AtomicFile(std::string target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    const std::string& temporaryPath() const { return temporary_; }  // keeps the target's extension
    // Creates or truncates, writes all, waits for the disk; throws FileError (disk full, …).
    void write(const void* bytes, size_t count);
    void commit();  // throws FileError

  private:
    std::string target_, temporary_;
    bool flushed_ = false, done_ = false;
};

// Removes what programs that were killed left in a folder: temporary files of processes of this machine that
// are gone, older than a minute, and anyone's older than a day. Returns how many.
size_t removeAbandonedFiles(const std::string& folder);

// Throws FileError unless a file can be created or replaced at `path`: call it before long work, not after.
void checkWritable(const std::string& path);

// The extension in lower case, without the dot; "" if there is none.
std::string extensionOf(const std::string& path);

// Throws FileError unless the extension of `path` is one of `known`; the message lists them. Returns the
// extension.
std::string requireExtension(const std::string& path, std::initializer_list<std::string_view> known);

// Throws FileError when there is no such file, or it is a folder or unreadable.
void checkReadable(const std::string& path);

// The whole file. Throws FileError when it is missing, a folder, or unreadable.
std::string readWholeFile(const std::string& path);

}  // namespace pellucid::io
