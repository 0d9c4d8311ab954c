// Files that this process trusts: of this user or root, and no links to pipes or devices.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace pel::cl {

// The whole file, whose time of last use becomes now. Empty if it is no such file, larger than `limit` bytes, or
// unreadable.
std::optional<std::string> readPrivateFile(const std::filesystem::path& path, uint64_t limit);

// Makes a new file for this user alone; nothing is left of it if that fails.
bool writePrivateFile(const std::filesystem::path& path, std::string_view head, std::string_view rest);

}  // namespace pel::cl
