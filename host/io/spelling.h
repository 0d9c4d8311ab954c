// What somebody who mistyped a word may have meant.
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace pellucid::io {

// The nearest of `known`; "" if none is near: more than one edit, and one for every three letters, away.
std::string nearestWord(std::string_view given, std::span<const std::string> known);

}  // namespace pellucid::io
