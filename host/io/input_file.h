// Files that are read: whole, and of a size that was checked first.
#pragma once
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

namespace pellucid::io {

// Most bytes that one input may have, on the disk and again as floats in memory: PELLUCID_INPUT_LIMIT_MIB,
// 2048 MiB without it. Throws FileError when the variable is no whole number from 1 on.
uint64_t inputLimit();

// How a message tells a number of bytes, in MiB, and what would raise the limit.
std::string tooLarge(double bytes, uint64_t limit);

// Texts that are parsed into trees (scenes, profiles, manifests, reports) may have this many bytes: in memory
// they take some thirty times as much.
inline constexpr uint64_t textLimit = uint64_t{16} << 20;

// The whole file. Throws FileError when it is missing, unreadable, no regular file (a folder, a pipe, a
// device), or larger than `limit` bytes, which is found out before anything is read.
std::string readWholeFile(const std::string& path, uint64_t limit = inputLimit());

// Throws FileError when there is no such file, it is no regular file, or unreadable.
void checkReadable(const std::string& path);

// What a path is instead of a regular file: "a folder", "a pipe", "a device", "a socket"; "" for a regular
// file and for nothing at all. Follows links.
std::string otherThanFile(const std::string& path);

// The extension in lower case, without the dot; "" if there is none.
std::string extensionOf(const std::string& path);

// Throws FileError unless the extension of `path` is one of `known`; the message lists them. Returns the
// extension.
std::string requireExtension(const std::string& path, std::initializer_list<std::string_view> known);

}  // namespace pellucid::io
