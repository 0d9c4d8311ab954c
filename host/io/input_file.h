// Input files: read completely, after their size was checked.
#pragma once
#include <cstdint>
#include <initializer_list>

#include "io/file_error.h"

namespace pellucid::io {

// Most bytes that one input may have, on the disk and again as floats in memory: PELLUCID_INPUT_LIMIT_MIB,
// 2048 MiB without it. Throws FileError if the variable is not a whole number of at least 1.
uint64_t inputLimit();

// A number of bytes for messages, in MiB, and what raises the limit.
std::string tooLarge(double bytes, uint64_t limit);

// Most bytes of texts that become trees (scenes, profiles, ...), which take some thirty times as much.
inline constexpr uint64_t textLimit = uint64_t{16} << 20;

// Throws FileError: a file of so many bytes is more than `limit`.
[[noreturn]] void refuseTooLarge(const std::string& path, uint64_t bytes, uint64_t limit);

// The whole file. Throws FileError if it is missing, unreadable, not a regular file (a folder, a pipe, a
// device), or larger than `limit` bytes. The size is checked before anything is read.
std::string readWholeFile(const std::string& path, uint64_t limit = inputLimit());

// Throws FileError if the file does not exist, is not a regular file, or is unreadable.
void checkReadable(const std::string& path);

// What a path is if it is not a regular file: "a folder", "a pipe", "a device", "a socket". "" for a regular
// file and for a path that does not exist. Follows links.
std::string otherThanFile(const std::string& path);

// The extension in lower case, without the dot; "" if there is none.
std::string extensionOf(const std::string& path);

// The name of a file has an extension that stands for no format. The command reports a usage error if the
// name is one of its arguments, for input or output.
class ExtensionError : public FileError {
    using FileError::FileError;
};

// The extension of `path`. Throws ExtensionError unless it is one of `known`; the message lists them.
std::string requireExtension(const std::string& path, std::initializer_list<std::string_view> known);

}  // namespace pellucid::io
