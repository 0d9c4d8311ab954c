// Checks of option values. CLI11's own checks answer a wrong value with lists of names and numbers, let NaN
// pass, and print the largest double in full. The description of a check is its range, "0 to 1000", or its
// words, "{y,z}".
#pragma once
#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "options.h"

namespace pellucid::cli {

// One of these words, in small or capital letters.
Check isOneOf(std::vector<std::string> names);

// Choices by the names that files have for them (io/choice_keys.h).
Check isOneOf(std::span<const std::string_view> names, const std::vector<std::string>& more = {});
template <class Enum>
Enum chosen(std::span<const std::string_view> names, const std::string& name) {
    return Enum(std::find(names.begin(), names.end(), name) - names.begin());
}

// Whole numbers, and numbers, from `low` to `high`; both belong to them.
Check inRange(int low, int high);
Check inRange(double low, double high);

// Finite numbers above 0; from 0 on.
Check isPositive();
Check isNotNegative();

}  // namespace pellucid::cli
