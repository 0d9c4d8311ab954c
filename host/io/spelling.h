// Suggests the correct spelling of a mistyped word.
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace pellucid::io {

// The nearest of `known`, or "" if the nearest is more than 1 + length / 3 edits away.
std::string nearestWord(std::string_view given, std::span<const std::string> known);

}  // namespace pellucid::io
